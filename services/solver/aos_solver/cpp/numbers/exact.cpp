#include "numbers/exact.hpp"

#include "aos/base/progress.hpp"
#include "aos/base/statistics.hpp"
#include "aos/draws/enumerator.hpp"

namespace aos {

namespace {

constexpr std::uint64_t per_outcome = 80;  // operations, of an outcome that is added to a posterior
constexpr std::uint64_t per_bound = 10;    // of an action in a state
constexpr std::uint64_t per_belief = 300;
constexpr std::uint64_t between_looks = 20'000;  // at the clock, in operations

ExactValue scaled(ExactValue value, double by) { return {by * value.value, by * value.growth}; }

// Makes weights sum to 1, where they are not all 0. Returns their sum before.
double normalise(Weighted& belief) {
  double total = 0;
  for (const auto& part : belief) total += part.second;
  for (auto& part : belief) part.second /= total > 0 ? total : 1;
  return total;
}

}  // namespace

std::size_t soonest_of_best(const List<ExactValue>& values, FunctionRef<bool(std::size_t)> is_barred) {
  constexpr double nearly = 1e-6;  // of the value
  const ExactValue* best = nullptr;
  const auto take = [&](auto&& is_better) {
    for (std::size_t action = 0; action < values.size(); ++action) {
      if (!is_barred(action) && is_better(values[action])) best = &values[action];
    }
  };
  take([&](const ExactValue& value) { return best == nullptr || value.is_better_than(*best); });
  if (best == nullptr) return 0;
  const double least = best->value - nearly * std::abs(best->value);
  take([&](const ExactValue& value) { return value.value >= least && value.is_sooner_than(*best); });
  return static_cast<std::size_t>(best - values.data());
}

List<ExactValue> ExactEvaluation::action_values(const Weighted& belief, int horizon) {
  List<ExactValue> values(rows_.actions);
  if (horizon <= 0 || belief.empty()) return values;
  for (std::size_t action = 0; action < values.size(); ++action) values[action] = action_value(belief, action, horizon);
  return values;
}

List<double> ExactEvaluation::losses(Weighted belief, std::size_t action, int horizon, ExactLimits limits) {
  constexpr std::size_t missions = 30;
  List<double> found;
  const double total = normalise(belief);
  if (total <= 0) return found;
  limits_ = std::move(limits);
  if (limits_.work > 0) limits_.work += work_;
  limits_.beliefs += evaluated_;
  Sampler random{1};
  try {
    while (found.size() < missions) found.push_back(total * loss_of_mission(belief, action, horizon, random));
  } catch (const NotEnumerable&) {
    // What was found counts.
  }
  return found;
}

std::map<std::pair<std::uint32_t, std::size_t>, double> ExactEvaluation::occupancy(const Weighted& belief, std::size_t action, int horizon) {
  struct Visit {
    Weighted belief;  // of sum 1
    double weight = 0;
  };
  std::map<std::pair<std::uint32_t, std::size_t>, double> found;
  std::unordered_map<BeliefKey, Visit, BeliefKey::Hash> level;
  const auto add = [](auto& visits, Weighted states, double weight) {
    const double total = normalise(states);
    if (total <= 0) return;
    Visit& visit = visits[key_of(states)];
    visit.weight += weight * total;
    if (visit.belief.empty()) visit.belief = std::move(states);
  };
  add(level, belief, 1);
  for (int left = horizon; left > 0 && !level.empty(); --left) {
    std::unordered_map<BeliefKey, Visit, BeliefKey::Hash> next;
    for (const auto& [key, visit] : level) {
      const std::size_t chosen = left == horizon ? action : best_action(visit.belief, left);
      for (const auto& [state, weight] : visit.belief) found[{state, chosen}] += visit.weight * weight;
      if (left == 1) continue;
      for (const auto& [observation, states] : posteriors(visit.belief, chosen)) {
        add(next, {states.begin(), states.end()}, visit.weight * rows_.discount);
      }
    }
    level = std::move(next);
  }
  return found;
}

double ExactEvaluation::error(int horizon) const {
  const double once = 1e-12 * (4 + static_cast<double>(observable_.states()));
  return once * largest_size(rows_.rewards) * horizon * horizon;
}

// Posteriors are not normalised here: a weight is the probability of getting to that state.
ExactValue ExactEvaluation::action_value(const Weighted& belief, std::size_t action, int horizon) {
  ExactValue result;
  for (const auto& [state, weight] : belief) result.value += weight * rows_.rewards[rows_.row(state, action)];
  if (horizon == 1) return result;
  for (const auto& [observation, states] : posteriors(belief, action)) {
    const ExactValue later = best_value({states.begin(), states.end()}, horizon - 1);
    result.value += rows_.discount * later.value;
    result.growth += later.value + rows_.discount * later.growth;
  }
  return result;
}

// The weights of the states after an action, by what is observed.
ExactEvaluation::Posteriors ExactEvaluation::posteriors(const Weighted& belief, std::size_t action) {
  Posteriors result;
  for (const auto& [state, weight] : belief) {
    for (const auto& outcome : rows_.outcomes[rows_.row(state, action)]) {
      for (const auto& likelihood : rows_.likelihoods[outcome.sensing]) {
        result[likelihood.observation][outcome.next] += weight * outcome.probability * likelihood.probability;
        work_ += per_outcome;
      }
    }
  }
  if (limits_.work > 0 && work_ > limits_.work) throw NotEnumerable{"there are more outcomes than the budget"};
  look();
  return result;
}

void ExactEvaluation::look() {
  if (work_ - looked_ < between_looks) return;
  looked_ = work_;
  if (limits_.is_over()) throw NotEnumerable{"it takes longer than allowed"};
}

// What a mission loses of an action's value if it plans a whole horizon anew at each later decision. It may put off for
// ever what is best at the end of a horizon.
double ExactEvaluation::loss_of_mission(Weighted belief, std::size_t action, int horizon, Sampler& random) {
  double loss = 0;
  double discount = 1;
  for (int left = horizon; left > 1; --left) {
    // Where the mission has ended, nothing is observed.
    double place = random.uniform();
    Weighted next;
    for (const auto& [observation, states] : posteriors(belief, action)) {
      next.assign(states.begin(), states.end());
      const double total = normalise(next);
      if (place < total) break;
      place -= total;
      next.clear();
    }
    if (next.empty()) break;
    belief = std::move(next);
    discount *= rows_.discount;
    action = soonest_of_best(action_values(belief, horizon), [](std::size_t) { return false; });
    loss += discount * (best_value(belief, left - 1).value - action_value(belief, action, left - 1).value);
  }
  return loss;
}
std::size_t ExactEvaluation::best_action(const Weighted& belief, int horizon) {
  const List<ExactValue> values = action_values(belief, horizon);
  const auto is_worse = [](const ExactValue& one, const ExactValue& other) { return other.is_better_than(one); };
  return std::ranges::max_element(values, is_worse) - values.begin();
}

ExactValue ExactEvaluation::best_value(Weighted belief, int horizon) {
  const double total = normalise(belief);
  if (total <= 0) return {};

  auto& known = values_[static_cast<std::size_t>(horizon)];
  const BeliefKey key = key_of(belief);
  if (const auto found = known.find(key); found != known.end()) return scaled(found->second, total);
  if (++evaluated_ > limits_.beliefs) throw NotEnumerable{"there are too many beliefs to evaluate"};
  if (evaluated_ % 64 == 0) progress::tell("evaluating beliefs", evaluated_);
  const ExactValue best = best_of_actions(belief, horizon);
  known.emplace(key, best);
  return scaled(best, total);
}

// Evaluates the actions in the order of their bounds.
ExactValue ExactEvaluation::best_of_actions(const Weighted& belief, int horizon) {
  List<std::pair<double, std::size_t>> order;
  work_ += per_belief + per_bound * belief.size() * rows_.actions;
  look();
  for (std::size_t action = 0; action < rows_.actions; ++action) order.emplace_back(-bound(belief, action, horizon), action);
  std::sort(order.begin(), order.end());
  ExactValue best = action_value(belief, order.front().second, horizon);
  for (std::size_t next = 1; next < order.size() && -order[next].first > best.value; ++next) {
    const ExactValue candidate = action_value(belief, order[next].second, horizon);
    if (candidate.is_better_than(best)) best = candidate;
  }
  return best;
}

// An upper bound of the action's value; infinite if none is known.
double ExactEvaluation::bound(const Weighted& belief, std::size_t action, int horizon) const {
  if (static_cast<std::size_t>(horizon) > observable_.layers()) return std::numeric_limits<double>::infinity();
  const List<double>& later = observable_.layer(horizon - 1);
  double sum = 0;
  double magnitude = 0;
  for (const auto& [state, weight] : belief) {
    const double value = weight * backed_up(rows_, rows_.row(state, action), later);
    sum += value;
    magnitude += std::abs(value);
  }
  const double rounding = 1e-15 * (100 + belief.size());
  return sum + rounding * magnitude;
}

// Probabilities are rounded to 1e-13, so that sums of the same terms in different orders give the same key.
BeliefKey ExactEvaluation::key_of(const Weighted& belief) {
  BeliefKey key;
  for (const auto& [state, weight] : belief) key.add(state, std::llround(weight * 1e13));
  return key;
}

}  // namespace aos
