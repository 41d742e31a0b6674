// A belief of other documents becomes one of these: the variables that both have keep their joint distribution, and the
// others are as the initial belief has them.
#pragma once

#include "aos/belief/belief.hpp"
#include "aos/belief/gathering.hpp"
#include "aos/belief/history.hpp"
#include "aos/model/reflection.hpp"
#include "aos/model/state_text.hpp"

namespace aos {

using Members = List<Member>;

// The values of some variables, as StateWriter writes them.
template <class Model>
std::string text_of(const Members& members, const typename Model::State& state) {
  StateWriter text;
  for (const Member& member : members) {
    const void* const place = member.constant != nullptr ? member.constant : Model::bytes_of(state) + member.offset;
    text.write(AnyValue{place, member.visit});
  }
  return text.text();
}

// What the documents before knew of a state: how it has ended, which special states are spent (of those that these
// documents have, as a bit for each), and the values of the variables that both have.
struct KnownState {
  double weight;
  Ending ending;
  std::uint64_t spent;
  std::string_view values;
};

// The variables that both documents have (`kept`), those among them that only the initial belief ever sets in either
// (`fixed`), and the special states that count once in both (`spendable`, a bit for each).
struct Common {
  Members kept;
  Members fixed;
  std::uint64_t spendable = 0;
};

// The new variables follow the initial belief, given the variables that are fixed: these still have the values that they
// had at the start. Where the initial belief has no such state, and for variables that may have changed since, it tells
// nothing of the new ones: they follow the whole of it.
template <class Model>
class Projection {
 public:
  using State = typename Model::State;

  // `initial` is the initial belief of these documents.
  Projection(const Belief<Model>& initial, Common common)
      : common_(std::move(common)), blank_(text_of<Model>(common_.kept, State{})),
        error_bound_(initial.error_bound()), is_initial_drawn_(initial.is_drawn()) {
    std::unordered_map<std::string, Gathering<Model>> gathered;
    Gathering<Model> all;
    for (const auto& [state, weight] : initial.particles()) {
      const State bare = stripped(state);
      gathered[text_of<Model>(common_.fixed, state)].add(bare, weight);
      all.add(bare, weight);
    }
    for (const auto& [fixed, states] : gathered) groups_.try_emplace(fixed, states);
    all_ = Group{all};
  }

  // Exact as long as both beliefs are, and there are not too many states. `error_bound` and `is_drawn` are of `known`.
  Belief<Model> of(const List<KnownState>& known, double error_bound, bool is_drawn, Sampler& random) const {
    List<const Group*> groups;
    double outcomes = 0;
    for (const KnownState& each : known) {
      groups.push_back(&group_of(with(State{}, each)));
      outcomes += groups.back()->states.size();
    }
    const bool draws = is_drawn || is_initial_drawn_ || outcomes > max_weighted_states;
    Gathering<Model> gathering;
    for (std::size_t i = 0; i < known.size(); ++i) {
      if (draws) {
        draw(gathering, known[i], *groups[i], random);
      } else {
        for (const auto& [state, weight] : groups[i]->states) gathering.add(with(state, known[i]), known[i].weight * weight);
      }
    }
    return Belief<Model>::of({gathering.particles(), {}, {}}, draws ? 1 : error_bound + error_bound_, draws);
  }

 private:
  // States without what is known of them anyway, with weights that sum to 1.
  struct Group {
    List<Particle<Model>> states;
    List<double> cumulative;

    Group() = default;
    explicit Group(const Gathering<Model>& gathering) : states(gathering.particles()) {
      const double total = gathering.total();
      for (auto& [state, weight] : states) {
        weight /= total;
        cumulative.push_back((cumulative.empty() ? 0 : cumulative.back()) + weight);
      }
    }
    const State& at(double share) const { return states[element_at(cumulative, share)].state; }
  };

  // As many draws of the new variables as the weight is worth, at least one; at even distances, from a random start.
  void draw(Gathering<Model>& gathering, const KnownState& known, const Group& group, Sampler& random) const {
    const double count = std::max(1.0, std::round(known.weight * particle_count));
    const double start = random.uniform();
    for (double i = 0; i < count; ++i) gathering.add(with(group.at((start + i) / count), known), known.weight / count);
  }

  const Group& group_of(const State& kept) const {
    const auto found = groups_.find(text_of<Model>(common_.fixed, kept));
    return found == groups_.end() ? all_ : found->second;
  }

  State stripped(const State& state) const { return with(state, {0, Ending::running, 0, blank_}); }
  State with(const State& drawn, const KnownState& known) const {
    State state = drawn;
    StateReader text{known.values};
    for (const Member& member : common_.kept) member.read(Model::bytes_of(state) + member.offset, text);
    text.finish();
    Model::set_end(state, known.ending, (Model::spent(drawn) & ~common_.spendable) | known.spent);
    return state;
  }

  Common common_;
  std::string blank_;
  double error_bound_;
  bool is_initial_drawn_;
  std::unordered_map<std::string, Group> groups_;
  Group all_;
};

}
