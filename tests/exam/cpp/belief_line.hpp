// A line of beliefs: the probability of one variable's value is moved by Jeffrey's rule. The truth tells where along it
// another action becomes the better one.
#pragma once

#include "aos/belief/belief.hpp"
#include "aos/child/jeffreys_rule.hpp"
#include "flat.hpp"
#include "problem.hpp"
#include "table_model.hpp"
#include "truth.hpp"

namespace exam {

// Where the exact choice changes along a line: each between two probabilities. Unknown if the brackets stay too wide.
struct Changes {
  bool is_known = true;
  aos::List<std::pair<double, double>> between;
};

class BeliefLine {
 public:
  // Moves the likeliest value of the variable of which least is known. The belief is that of a mission that goes on.
  BeliefLine(const Problem& problem, Mass belief) : problem_(problem), belief_(std::move(belief)) {
    double most = 0;
    for (std::size_t variable = 0; variable < problem.variables; ++variable) {
      std::map<int, double> values;
      for (const auto& [state, weight] : belief_) values[value_of(state, variable)] += weight;
      double entropy = 0;
      for (const auto& [value, weight] : values) entropy -= weight > 0 ? weight * std::log(weight) : 0;
      if (entropy <= most + 1e-12) continue;
      most = entropy;
      variable_ = variable;
      const auto is_less = [](const auto& one, const auto& other) { return one.second < other.second; };
      const auto likeliest = std::max_element(values.begin(), values.end(), is_less);
      value_ = likeliest->first;
      now_ = likeliest->second;
    }
  }

  // Whether there is a value that is neither certain nor excluded.
  bool is_open() const { return now_ > certain && now_ < 1 - certain; }
  double now() const { return now_; }

  // The belief of the engine, moved by the engine's own rule.
  aos::Belief<TableModel> moved(const aos::Belief<TableModel>& belief, double probability) const {
    const aos::JeffreysRule<TableModel> rule{belief, "v" + std::to_string(variable_), std::to_string(value_)};
    return rule.moved_to(probability).value();
  }

  // Looks at a grid of probabilities, and halves the parts of it in which the choice changes.
  Changes changes(Truth& truth, const Flat& flat, std::size_t chosen, std::size_t other, double seconds) const {
    const auto sign = [&](double place) { return sign_at(place, truth, flat, chosen, other, seconds); };
    Changes found;
    double last = 0;  // place of the last probability at which one of both is better
    int last_sign = 0;
    for (int part = 0; part <= parts && found.is_known; ++part) {
      const double place = static_cast<double>(part) / parts;
      const int here = sign(place);
      if (here == unknown) found.is_known = false;
      if (here == unknown || here == 0) continue;
      if (last_sign != 0 && here != last_sign) found.between.push_back(halved(last, place, last_sign, sign));
      last = place;
      last_sign = here;
    }
    return found;
  }

 private:
  static constexpr double certain = 1e-9;
  static constexpr int parts = 16;
  static constexpr int halvings = 5;
  static constexpr int unknown = 2;

  int value_of(std::uint32_t state, std::size_t variable) const {
    return problem_.values[state * problem_.variables + variable];
  }

  Mass moved(double probability) const {
    Mass moved;
    for (const auto& [state, weight] : belief_) {
      const bool has_value = value_of(state, variable_) == value_;
      const double share = has_value ? probability / now_ : (1 - probability) / (1 - now_);
      if (share > 0) moved.push_back({state, weight * share});
    }
    return moved;
  }

  // 1 where the chosen action is better, -1 where the other one is, 0 where they tie. Brackets are as narrow as that takes.
  int sign_at(double place, Truth& truth, const Flat& flat, std::size_t chosen, std::size_t other, double seconds) const {
    const Mass belief = moved(place);
    const double tie = 1e-4 * flat.largest_reward();
    for (double gap = 100 * tie; gap > tie / 20; gap /= 10) {
      for (const std::size_t action : {chosen, other}) truth.narrow_action(belief, action, truth.decisions(), gap, seconds);
      const Bracket one = truth.action_value(belief, chosen, truth.decisions());
      const Bracket two = truth.action_value(belief, other, truth.decisions());
      if (one.lower > two.upper + tie) return 1;
      if (two.lower > one.upper + tie) return -1;
      if (std::max(one.upper - two.lower, two.upper - one.lower) <= 2 * tie) return 0;
    }
    return unknown;
  }

  template <class Sign>
  static std::pair<double, double> halved(double low, double high, int sign_below, Sign&& sign) {
    for (int i = 0; i < halvings; ++i) {
      const double middle = (low + high) / 2;
      const int here = sign(middle);
      if (here == 0 || here == unknown) break;
      (here == sign_below ? low : high) = middle;
    }
    return {low, high};
  }

  const Problem& problem_;
  Mass belief_;
  std::size_t variable_ = 0;
  int value_ = 0;
  double now_ = 1;
};

}
