// What a nat of information is worth to a search that ends in values of seen states: nothing, or what missions say.
//
// Missions are played from the belief by a policy that needs no search. It takes the action with the highest sum of what is
// earned if all is seen after it (QMDP) and a price for each nat that its observation tells of the state. What missions without
// a price return less than the values of states promise is lost by not seeing. The prices that are tried are shares of this
// loss for each nat of the belief's entropy. If missions by one of them return more, in the same worlds, a search pays a part of
// what these still lose for each nat: it looks further ahead, and pays less.
#pragma once

#include "aos/base/progress.hpp"
#include "aos/base/statistics.hpp"
#include "aos/belief/belief.hpp"
#include "aos/belief/gathering.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/planning/coming_to_an_end.hpp"
#include "aos/planning/earned.hpp"
#include "aos/planning/pomcp/observation_doubts.hpp"
#include "aos/planning/pomcp/pomcp_constants.hpp"
#include "aos/planning/values/few_outcomes.hpp"
#include "aos/planning/values/state_values.hpp"

namespace aos {

template <class Model>
class InformationPrice {
 public:
  // The price for the rest of the mission, from the running belief of its first decision by `values`. Beliefs of the same
  // entropy have the same price.
  double of(const Belief<Model>& belief, const StateValues<Model>& values, int horizon) {
    if (has_begun_ || Model::reports_numbers()) return price_;
    has_begun_ = true;
    const double entropy = belief.entropy();
    if (std::exchange(entropy_, entropy) == entropy) return price_;
    price_ = 0;
    if (entropy < least_entropy) return price_;
    values_ = &values;
    horizon_ = horizon;
    comes_to_an_end([&] { price_ = best(belief, entropy); });
    return price_;
  }

  // What missions lose that go by the price that was found, for each nat of a belief's entropy; nothing without a price.
  double lost_for_each_nat() const { return price_ / price_of_rest; }

  // Begins another mission.
  void start_over() { has_begun_ = false; }

 private:
  using State = typename Model::State;
  using Cloud = List<Particle<Model>>;

  double best(const Belief<Model>& belief, double entropy) {
    double promised = 0;
    work_ = 0;
    std::array<double, priced_missions> without{};
    for (std::size_t i = 0; i < priced_missions; ++i) {
      without[i] = returned(belief, 0, i);
      promised += worth(true_state_) / priced_missions;
    }
    double loss = promised;
    for (const double one : without) loss -= one / priced_missions;
    double price = 0;
    double most = 0;
    for (const double share : priced_shares) {
      const double tried = share * loss / entropy;
      double sum = 0;
      double squares = 0;
      for (std::size_t i = 0; i < priced_missions && tried > 0; ++i) {
        const double gain = returned(belief, tried, i) - without[i];
        sum += gain / priced_missions;
        squares += gain * gain / priced_missions;
      }
      const double error = std::sqrt(std::max(squares - sum * sum, 0.0) / (priced_missions - 1));
      if (sum < 2 * error || sum <= most) continue;
      most = sum;
      price = price_of_rest * (loss - sum) / entropy;
    }
    return price;
  }

  // Plays a mission. The robot of it knows a few states with weights, of which one is the true one. Afterwards `true_state_` is
  // where it began.
  double returned(const Belief<Model>& belief, double price, std::uint64_t mission) {
    progress::tell("finding out what information is worth", mission, priced_missions);
    Sampler random{mission};
    Cloud cloud = drawn(belief, random);
    State state = cloud[random.below(cloud.size())].state;
    true_state_ = state;
    const auto take = [&](std::size_t) {
      const int action = choice(cloud, price);
      const Step step = Model::step(state, action, random);
      if (Model::ending(state) != Ending::running) return step.reward;
      observe(cloud, action, step.observation, random);
      if (cloud.empty()) cloud.push_back({state, 1});
      return step.reward;
    };
    return earned_in<Model>(horizon_, state, take).sum;
  }

  static Cloud drawn(const Belief<Model>& belief, Sampler& random) {
    Cloud cloud;
    while (cloud.empty()) {
      draw_evenly<Model>(belief.particles(), priced_particles, random, [&](const State& state) {
        if (Model::ending(state) == Ending::running) cloud.push_back({state, 1});
      });
    }
    for (auto& particle : cloud) particle.weight /= static_cast<double>(cloud.size());
    return cloud;
  }

  int choice(const Cloud& cloud, double price) {
    return best_of(Model::action_count(), [&](int action) { return merit_of(cloud, action, price); });
  }

  double merit_of(const Cloud& cloud, int action, double price) {
    double sum = 0;
    double doubt = 0;
    all_.clear();
    for (const auto& [state, weight] : cloud) {
      own_.clear();
      walk(state, action, [&](const State& next, const Step& step, double probability) {
        const bool goes_on = Model::ending(next) == Ending::running;
        sum += weight * probability * (step.reward + (goes_on ? Model::discount * worth(next) : 0));
        own_.add(goes_on ? step.observation : no_observation, probability);
      });
      doubt += weight * own_.entropy();
      for (const auto& [seen, probability] : own_.all()) all_.add(seen, weight * probability);
    }
    return sum + Model::discount * price * std::max(all_.entropy() - doubt, 0.0);
  }

  // Bayes' rule. Each state takes one of the steps that report this. Light states give way to heavy ones.
  void observe(Cloud& cloud, int action, Observation seen, Sampler& random) {
    Cloud after;
    for (const auto& [state, weight] : cloud) {
      double sum = 0;
      State next{};
      walk(state, action, [&](const State& to, const Step& step, double probability) {
        if (step.observation != seen || Model::ending(to) != Ending::running) return;
        sum += probability;
        if (random.uniform() * sum <= probability) next = to;
      });
      if (sum > 0) after.push_back({next, weight * sum});
    }
    cloud.swap(after);
    double total = 0;
    double squares = 0;
    for (const auto& particle : cloud) total += particle.weight;
    for (auto& particle : cloud) {
      particle.weight /= total;
      squares += particle.weight * particle.weight;
    }
    if (cloud.empty() || 1 / squares > priced_particles / 4.0) return;
    after.clear();
    draw_evenly<Model>(cloud, priced_particles, random, [&](const State& state) { after.push_back({state, 1.0 / priced_particles}); });
    cloud.swap(after);
  }

  void walk(const State& state, int action, auto&& visit) {
    outcomes_.walk(state, action, [&](const State& next, const Step& step, double probability) {
      if (++work_ > most_priced_steps) throw NotEnumerable{"missions take too long"};
      visit(next, step, probability);
    });
  }

  double worth(const State& state) const { return values_->value(state, horizon_); }

  static constexpr double least_entropy = 0.1;  // that a loss is blamed on

  bool has_begun_ = false;
  double entropy_ = -1;  // of the belief that the price is for
  double price_ = 0;
  // Of the missions that are played:
  const StateValues<Model>* values_ = nullptr;
  int horizon_ = 1;
  std::size_t work_ = 0;  // steps of the model
  FewOutcomes<Model> outcomes_;
  State true_state_{};
  ObservationOddsOfStep own_;
  ObservationOddsOfStep all_;
};

}
