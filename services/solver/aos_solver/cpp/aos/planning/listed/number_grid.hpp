// The cells of one observed number. Neighbouring cells are merged where that loses least information.
//
// The information is the mutual information of the cell and the distribution that the number is drawn from
// (the agglomerative information bottleneck: Slonim and Tishby, 1999; only neighbours are merged here).
#pragma once

#include "aos/draws/described_distribution.hpp"

namespace aos {

class NumberGrid {
 public:
  struct Source {
    const DescribedDistribution* distribution;
    double weight;
  };

  // Begins with small cells. The sources must not be empty.
  explicit NumberGrid(const List<Source>& sources) {
    edges_ = first_edges(sources);
    double total = 0;
    const std::size_t step = 1 + sources.size() / max_sources;
    for (std::size_t i = 0; i < sources.size(); i += step) total += sources[i].weight;
    joint_.assign(cells(), {});
    List<double> whole;
    for (std::size_t i = 0; i < sources.size(); i += step) {
      const double weight = sources[i].weight / total;
      const List<double> probabilities = probabilities_of(*sources[i].distribution);
      for (std::size_t cell = 0; cell < cells(); ++cell) joint_[cell].push_back(weight * probabilities[cell]);
      whole.push_back(weight);
    }
    information_ = -information_of(whole);
    for (const auto& cell : joint_) information_ += information_of(cell);
    for (std::size_t cell = 0; cell + 1 < cells(); ++cell) losses_.push_back(loss_at(cell));
  }

  std::size_t cells() const { return edges_.size() + 1; }
  // The smallest loss of a merge; infinite if only one cell is left.
  double next_loss() const {
    if (losses_.empty()) return std::numeric_limits<double>::infinity();
    return *std::min_element(losses_.begin(), losses_.end());
  }
  // Merges the two neighbours with the smallest loss.
  void merge() {
    const auto place = std::min_element(losses_.begin(), losses_.end()) - losses_.begin();
    const auto cell = static_cast<std::size_t>(place);
    for (std::size_t i = 0; i < joint_[cell].size(); ++i) joint_[cell][i] += joint_[cell + 1][i];
    joint_.erase(joint_.begin() + place + 1);
    edges_.erase(edges_.begin() + place);
    losses_.erase(losses_.begin() + place);
    if (cell > 0) losses_[cell - 1] = loss_at(cell - 1);
    if (cell < losses_.size()) losses_[cell] = loss_at(cell);
  }
  // Merges as long as the sum of the losses is negligible.
  void merge_alike() {
    const double allowed = negligible_share * std::max(information_, 0.0) + negligible_loss;
    double lost = 0;
    while (!losses_.empty() && (lost += std::max(next_loss(), 0.0)) <= allowed) merge();
  }

  // The probability of each cell under a distribution.
  List<double> probabilities_of(const DescribedDistribution& distribution) const {
    List<double> probabilities;
    double before = 0;
    for (const double edge : edges_) {
      const double below = distribution.below(edge);
      probabilities.push_back(std::max(below - before, 0.0));
      before = std::max(before, below);
    }
    probabilities.push_back(std::max(1 - before, 0.0));
    return probabilities;
  }

 private:
  static constexpr std::size_t max_cells = 256;  // of the first cells
  static constexpr std::size_t max_sources = 1000;
  static constexpr double negligible_share = 0.001;
  static constexpr double negligible_loss = 1e-12;

  static List<double> first_edges(const List<Source>& sources) {
    List<double> edges;
    for (const Source& source : sources) source.distribution->add_edges(edges);
    std::sort(edges.begin(), edges.end());
    const double too_near = edges.empty() ? 0 : 1e-9 * (edges.back() - edges.front());
    const auto is_same = [&](double left, double right) { return right - left <= too_near; };
    edges.erase(std::unique(edges.begin(), edges.end(), is_same), edges.end());
    if (edges.size() < max_cells) return edges;
    List<double> some;
    for (std::size_t i = 0; i + 1 < max_cells; ++i) some.push_back(edges[i * (edges.size() - 1) / (max_cells - 2)]);
    return some;
  }

  // What a cell adds to the information. `parts` are its joint probabilities with each distribution.
  static double information_of(const List<double>& parts) {
    double sum = 0;
    double added = 0;
    for (const double part : parts) {
      if (part <= 0) continue;
      sum += part;
      added += part * std::log(part);
    }
    return sum > 0 ? added - sum * std::log(sum) : 0;
  }
  double loss_at(std::size_t cell) const {
    List<double> merged = joint_[cell];
    for (std::size_t i = 0; i < merged.size(); ++i) merged[i] += joint_[cell + 1][i];
    return information_of(joint_[cell]) + information_of(joint_[cell + 1]) - information_of(merged);
  }

  List<double> edges_;  // between cells; an edge belongs to the cell above it
  List<List<double>> joint_;  // by cell: its joint probability with each distribution
  List<double> losses_;             // of merging a cell with the next
  double information_ = 0;  // of the first cells, in nats
};

}
