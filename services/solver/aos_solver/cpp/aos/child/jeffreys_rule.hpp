// A belief in which the probability of a variable's value is another one (Jeffrey's rule).
#pragma once

#include "aos/model/values.hpp"

namespace aos {

template <class Model>
class JeffreysRule {
 public:
  // Variables and values have the names that marginals have.
  JeffreysRule(const Belief<Model>& belief, std::string_view variable, std::string_view value) : belief_(belief) {
    for (const auto& particle : belief.particles()) {
      bool has_value = false;
      NamedLeaves leaves{[&](const std::string& name, const Leaf& leaf) {
        if (name != variable) return;
        has_variable_ = true;
        has_value = leaf_text(leaf) == value;
      }};
      Model::visit_values(particle.state, leaves);
      has_value_.push_back(has_value);
      (has_value ? with_ : without_) += particle.weight;
    }
  }

  bool has_variable() const { return has_variable_; }
  double probability() const { return with_ / (with_ + without_); }

  // The belief with another probability; none where no state has the value, or each has, and that is not what is wanted.
  std::optional<Belief<Model>> moved_to(double probability) const {
    if (!has_variable_ || (with_ <= 0 && probability > 0) || (without_ <= 0 && probability < 1)) return std::nullopt;
    List<Particle<Model>> particles;
    for (std::size_t number = 0; number < has_value_.size(); ++number) {
      const auto& [state, weight] = belief_.particles()[number];
      const double moved = has_value_[number] ? weight / with_ * probability : weight / without_ * (1 - probability);
      if (moved > 0) particles.push_back({state, moved});
    }
    return Belief<Model>::of({std::move(particles), {}, {}}, belief_.error_bound(), belief_.is_drawn());
  }

 private:
  const Belief<Model>& belief_;
  std::vector<bool> has_value_;
  bool has_variable_ = false;
  double with_ = 0;
  double without_ = 0;
};

}
