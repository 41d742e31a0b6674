// The fully observable (MDP) values of a listed model, by decisions to go. No robot earns more.
#pragma once

#include "point_based/flat_model.hpp"

namespace aos {

// Values have settled where no change is larger than this share of the largest value.
inline constexpr double settled_share = 1e-4;

// The value of an action in a state, from those of the states after it.
inline double backed_up(const point_based::FlatModel& rows, std::size_t row, const List<double>& later) {
  return rows.rewards[row] + rows.discount * rows.later_value(row, later);
}

// What one more decision brings.
struct MoreValues {
  double change = 0;   // the largest one
  double highest = 0;  // value
};

// Writes the values of the model's listed states with one decision more to go, and those of their actions, by row, where
// they are wanted.
MoreValues one_more_decision(const point_based::FlatModel& rows, const List<double>& later, List<double>& values,
                             List<float>* action_values = nullptr);

// Values from 0 decisions to go on. States that are not listed are worth any amount.
class ObservableValues {
 public:
  ObservableValues() = default;
  ObservableValues(const point_based::FlatModel& rows, point_based::Numbering numbering, int horizon) {
    prepare(rows, numbering, horizon);
  }

  // Computes the values for fewer than `horizon` decisions, or none if there are too many. What is known is kept.
  void prepare(const point_based::FlatModel& rows, point_based::Numbering numbering, int horizon);

  std::size_t states() const { return numbering_.states; }
  std::size_t layers() const { return layers_.size(); }
  const List<double>& layer(int left) const { return layers_[left]; }

 private:
  point_based::Numbering numbering_;
  List<List<double>> layers_;
};

}
