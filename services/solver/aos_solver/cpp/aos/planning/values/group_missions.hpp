// Missions that are played to find what planning by values of seen states promises too much. No search draws their numbers.
//
// A group of states of the belief follows the action that is best on average over the group (QMDP: Littman, Cassandra and
// Kaelbling, 1995), and splits by what is observed. States with rare observations stay together. Half of the states choose the
// actions, and the others tell what is returned: what is best for a few drawn states is too good for these. A mission that plans
// can be expected to return as much, or more.
#pragma once

#include "aos/belief/gathering.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/coming_to_an_end.hpp"
#include "aos/planning/same_observation.hpp"
#include "aos/planning/step_cost.hpp"
#include "aos/planning/values/mdp_values.hpp"
#include "aos/planning/values/random_walk.hpp"
#include "aos/planning/values/state_values.hpp"
#include "aos/planning/values/value_constants.hpp"

namespace aos {

template <class Model>
class GroupMissions {
 public:
  // Begins another mission.
  void start_over() {
    is_first_ = true;
    is_known_ = false;
    saved_ = 0;
  }

  // Saves up a share of a decision's budget. Returns whether it is time to play.
  bool is_due(Budget budget, int horizon) {
    saved_ += share_of_groups * budget.work(horizon) * (is_first_ ? horizon : 1);
    return is_first_ || saved_ >= fewest_later_followers * cost_;
  }

  // Plays a group from the belief's running part that begins with `action`. `listed` are the same values if the states are
  // listed, else null.
  void play(const Belief<Model>& belief, const StateValues<Model>& values, const MdpValues<Model>* listed, int horizon,
            int action, Sampler random) {
    values_ = &values;
    listed_ = listed;
    random_ = random;
    if (step_cost_ == 0) step_cost_ = std::max(cost_of_step<Model>(), operations_of_step);
    cost_ = cost_of_follower(horizon);
    const double affordable = std::clamp(saved_ / cost_, fewest_followers, most_followers);
    saved_ = 0;
    is_first_ = false;
    const ForgottenTexts forgotten;
    comes_to_an_end([&] {
      gather(belief, static_cast<std::size_t>(affordable), horizon);
      follow(action, horizon);
      settle();
    });
  }

  // Whether a group was played to its end in this mission.
  bool is_known() const { return is_known_; }
  // What a mission returns less than the mean value of its states.
  double loss() const { return loss_; }
  double loss_error() const { return loss_error_; }

 private:
  using State = typename Model::State;

  static constexpr double cost_of_listed_action = 2;

  struct Follower {
    State state;
    std::uint32_t number;  // in the list of states
    std::size_t place;     // of its loss
    Observation observation;
  };

  static std::size_t action_count() { return static_cast<std::size_t>(Model::action_count()); }

  double cost_of_follower(int horizon) const {
    const auto of_step = static_cast<double>(step_cost_);
    const double of_choice = (listed_ != nullptr ? cost_of_listed_action : of_step) * action_count();
    return horizon * (of_step + of_choice * asked_followers / fewest_alike);
  }

  void gather(const Belief<Model>& belief, std::size_t count, int horizon) {
    followers_.clear();
    losses_.clear();
    const double running = belief.probability_of(Ending::running);
    const auto drawn = static_cast<std::size_t>(std::ceil(static_cast<double>(count) / running));
    draw_evenly<Model>(belief.particles(), drawn, random_, [&](const State& state) {
      if (Model::ending(state) != Ending::running) return;
      followers_.push_back({state, number_of(state), losses_.size(), default_observation});
      losses_.push_back(listed_ != nullptr ? 0 : values_->value(state, horizon));
    });
    ends_.assign(1, followers_.size());
    chooses_.clear();
    for (std::size_t place = 0; place < losses_.size(); ++place) chooses_.push_back(place % 2 == 0);
  }
  std::uint32_t number_of(const State& state) const { return listed_ != nullptr ? listed_->number_of(state) : no_state; }

  void follow(int action, int horizon) {
    double discount = 1;
    for (int to_go = horizon; to_go > 0 && !followers_.empty(); --to_go, discount *= Model::discount) {
      next_.clear();
      next_ends_.clear();
      std::size_t first = 0;
      for (const std::size_t last : ends_) {
        step(first, last, to_go == horizon ? action : best_on_average(first, last), to_go, discount);
        first = last;
      }
      followers_.swap(next_);
      ends_.swap(next_ends_);
    }
  }

  int best_on_average(std::size_t first, std::size_t last) {
    sums_.assign(action_count(), 0);
    worths_.resize(action_count());
    find_choosers(first, last);
    if (choosers_.empty()) return walk_.draw(followers_[first].state, random_);
    const std::size_t stride = std::max<std::size_t>(choosers_.size() / asked_followers, 1);
    for (std::size_t i = 0; i < choosers_.size(); i += stride) {
      const Follower& chooser = *choosers_[i];
      if (listed_ != nullptr) {
        listed_->add_action_values(chooser.number, sums_);
        continue;
      }
      values_->advantages(chooser.state, worths_.data(), random_);
      for (std::size_t a = 0; a < sums_.size(); ++a) sums_[a] += worths_[a];
    }
    return static_cast<int>(std::max_element(sums_.begin(), sums_.end()) - sums_.begin());
  }

  // Those of a group that choose. Where all of them have ended, every second one of the others does, and tells nothing any more.
  // One that is left alone knows nothing.
  void find_choosers(std::size_t first, std::size_t last) {
    choosers_.clear();
    for (std::size_t i = first; i < last; ++i) {
      if (chooses_[followers_[i].place]) choosers_.push_back(&followers_[i]);
    }
    if (!choosers_.empty()) return;
    for (std::size_t i = first + 1; i < last; i += 2) {
      chooses_[followers_[i].place] = true;
      choosers_.push_back(&followers_[i]);
    }
  }

  // A group takes a step and splits.
  void step(std::size_t first, std::size_t last, int action, int to_go, double discount) {
    group_.clear();
    for (std::size_t i = first; i < last; ++i) {
      Follower& follower = followers_[i];
      const Step step = Model::step(follower.state, action, random_);
      // With a list, a step counts by what the action is worth less than the best one, which leaves out most luck.
      losses_[follower.place] -= discount * (listed_ != nullptr ? listed_->advantage(follower.number, action, to_go) : step.reward);
      if (Model::ending(follower.state) != Ending::running) continue;
      follower.number = number_of(follower.state);
      follower.observation = step.observation;
      group_.push_back(follower);
    }
    for_each_group(group_, fewest_alike, [&](std::span<const Follower> alike) {
      next_.insert(next_.end(), alike.begin(), alike.end());
      next_ends_.push_back(next_.size());
    });
  }

  void settle() {
    const auto count = static_cast<double>(std::count(chooses_.begin(), chooses_.end(), false));
    loss_ = 0;
    double squares = 0;
    for (std::size_t i = 0; i < losses_.size(); ++i) loss_ += chooses_[i] ? 0 : losses_[i] / count;
    for (std::size_t i = 0; i < losses_.size(); ++i) squares += chooses_[i] ? 0 : (losses_[i] - loss_) * (losses_[i] - loss_);
    loss_error_ = std::sqrt(squares / count / std::max(count - 1, 1.0));
    is_known_ = count > 0;
  }

  bool is_first_ = true;  // decision of a mission
  bool is_known_ = false;
  double saved_ = 0;  // operations
  Operations step_cost_ = 0;  // 0: not known yet
  double cost_ = 0;           // of a follower
  double loss_ = 0;
  double loss_error_ = 0;
  // Of the group that is played:
  const StateValues<Model>* values_ = nullptr;
  const MdpValues<Model>* listed_ = nullptr;
  Sampler random_{0};
  List<Follower> followers_;  // group by group
  List<std::size_t> ends_;    // of the groups
  List<Follower> next_;
  List<std::size_t> next_ends_;
  List<Follower> group_;
  std::vector<bool> chooses_;  // by place
  List<const Follower*> choosers_;
  List<double> losses_;
  List<double> sums_;
  List<double> worths_;
  RandomWalk<Model> walk_;
};

}
