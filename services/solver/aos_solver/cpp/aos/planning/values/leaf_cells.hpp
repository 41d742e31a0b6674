// The variables that steps change, as cells: a real number falls into cells about as wide as its larger steps, and any
// other value is a cell of its own. A search tells by them what is new.
#pragma once

#include <cstring>
#include <map>
#include <set>

#include "aos/base/switches.hpp"
#include "aos/belief/belief.hpp"
#include "aos/model/reflection.hpp"
#include "aos/model/values.hpp"
#include "aos/planning/values/random_walk.hpp"

namespace aos {

// Whether two states are the same byte by byte, which takes less than to compare their cells.
template <class Model>
bool are_alike(const typename Model::State& one, const typename Model::State& other) {
  return std::memcmp(Model::bytes_of(one), Model::bytes_of(other), Model::state_bytes()) == 0;
}

template <class Model>
class LeafCells {
 public:
  using State = typename Model::State;

  // Finds the variables by random walks from the belief. Where one element of a list has moved, all of them can: what lies below
  // others does not move in a walk.
  void prepare(const Belief<Model>& belief, Sampler& random) {
    find_leaves(belief.particles().front().state);
    List<List<double>> changes(leaves_.size());  // by the first leaf of the list
    std::vector<bool> has_changed(leaves_.size());
    RandomWalk<Model>{}.explore(belief, walks, longest, random, [&](const State& before, const State& after) {
      for (const Place& leaf : leaves_) {
        if (bits(leaf, after) == bits(leaf, before)) continue;
        has_changed[leaf.list] = true;
        if (leaf.is_real) changes[leaf.list].push_back(std::abs(number(leaf, after) - number(leaf, before)));
      }
    });
    List<Place> moving;
    resting_.clear();
    for (Place& leaf : leaves_) {
      if (!has_changed[leaf.list]) {
        if (!leaf.is_real) resting_.push_back(leaf);
        continue;
      }
      if (leaf.is_real) leaf.width = width_of(changes[leaf.list]);
      moving.push_back(leaf);
    }
    leaves_ = std::move(moving);
  }

  // The same with the variables that no walk has changed, but for real ones: what a key opens moves in few walks.
  LeafCells with_resting() const {
    LeafCells all = *this;
    all.leaves_.insert(all.leaves_.end(), resting_.begin(), resting_.end());
    return all;
  }

  // The same without the variables for which `is_left_out(number)` holds.
  LeafCells without(auto&& is_left_out) const {
    LeafCells some = *this;
    some.leaves_.clear();
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      if (!is_left_out(i)) some.leaves_.push_back(leaves_[i]);
    }
    return some;
  }

  // Takes up what was at rest and differs between two states, with all of its list, behind the others.
  void add_moved(const State& before, const State& after) {
    std::set<std::size_t> lists;
    for (const Place& leaf : resting_) {
      if (bits(leaf, before) != bits(leaf, after)) lists.insert(leaf.list);
    }
    if (lists.empty()) return;
    const auto moved = std::ranges::stable_partition(resting_, [&](const Place& leaf) { return !lists.contains(leaf.list); });
    leaves_.insert(leaves_.end(), moved.begin(), moved.end());
    resting_.erase(moved.begin(), moved.end());
  }

  std::size_t size() const { return leaves_.size(); }

  void write(const State& state, std::uint64_t* cells) const {
    for (const Place& leaf : leaves_) {
      *cells++ = leaf.is_real ? static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(number(leaf, state) / leaf.width)))
                              : bits(leaf, state);
    }
  }

 private:
  struct Place {
    std::size_t offset;
    std::size_t size;
    bool is_real;
    std::size_t list;  // the first leaf with the same name but for indices
    double width = 1;
  };
  static constexpr int walks = 100;
  static constexpr int longest = 16;
  static constexpr double larger = 0.9;     // of the changes are smaller than a larger one
  static constexpr double of_larger = 0.5;  // the width of a cell

  void find_leaves(const State& state) {
    leaves_.clear();
    std::map<std::string, std::size_t> lists;
    for_each_number<Model>(state, [&](const std::string& name, const PlacedNumber& number) {
      const std::size_t list = lists.emplace(switches::whole_lists ? without_indices(name) : name, leaves_.size()).first->second;
      leaves_.push_back({number.offset, number.leaf.size, number.leaf.kind == Leaf::Kind::real, list});
    });
  }
  static std::string without_indices(std::string name) {
    for (std::size_t start; (start = name.find('[')) != std::string::npos;) name.erase(start, name.find(']', start) - start + 1);
    return name;
  }
  static std::uint64_t bits(const Place& leaf, const State& state) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, Model::bytes_of(state) + leaf.offset, leaf.size);
    return bits;
  }
  static double number(const Place& leaf, const State& state) {
    const std::byte* const place = Model::bytes_of(state) + leaf.offset;
    return leaf.size == sizeof(float) ? static_cast<double>(stored_at<float>(place)) : stored_at<double>(place);
  }
  static double width_of(List<double>& changes) {
    std::sort(changes.begin(), changes.end());
    return std::max(of_larger * changes[static_cast<std::size_t>(larger * static_cast<double>(changes.size() - 1))], 1e-9);
  }

  List<Place> leaves_;
  List<Place> resting_;
};

}
