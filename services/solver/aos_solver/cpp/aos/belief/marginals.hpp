// The distribution of each variable under weighted states, for people: the likeliest values of each variable, and
// quantiles of numbers with many values.
#pragma once

#include <unordered_map>

#include "aos/base/mixed.hpp"
#include "aos/base/number_index.hpp"
#include "aos/base/stable_order.hpp"
#include "aos/belief/gathering.hpp"
#include "aos/model/values.hpp"
#include "aos/text/json.hpp"

namespace aos {

inline constexpr std::size_t max_reported_values = 16;  // of one variable
inline constexpr std::size_t max_reported_in_all = 4096;
inline constexpr std::size_t max_reals_told_apart = 8;  // A real number with more values has quantiles.
inline constexpr std::array reported_quantiles{0.05, 0.25, 0.5, 0.75, 0.95};

template <class Model>
class Marginals {
 public:
  using State = typename Model::State;

  // The particles must outlive this object.
  explicit Marginals(const List<Particle<Model>>& particles) : particles_(particles) {
    if (particles.empty()) return;
    const List<std::byte> differences = differing_bits();
    const StateLeaves leaves{particles.front().state};
    if (leaves.hold_all_of(differences)) add_by_place(leaves.all, differences);
    else add_by_visit();
  }

  // Writes an array with an entry for each variable: its name, its likeliest values, the probability of the others, and
  // the quantiles of a number whose values are too many to be told apart.
  void write(JsonWriter& json, std::size_t max_of_one = max_reported_values, std::size_t max_in_all = max_reported_in_all) {
    choose_reported(max_of_one, max_in_all);
    write_texts();
    json.begin_array();
    for (const Variable& variable : variables_) {
      double others = 0;
      for (std::size_t i = variable.texts.size(); i < variable.values.size(); ++i) others += variable.values[i].weight;
      json.begin_object().member("variable", variable.name).key("values").begin_object();
      for (std::size_t i = 0; i < variable.texts.size(); ++i) json.member(variable.texts[i], variable.values[i].weight);
      json.end_object();
      if (others > 0) json.member("others", others);
      write_quantiles(json, variable);
      json.end_object();
    }
    json.end_array();
  }

 private:
  struct Value {
    std::uint64_t number;
    double weight;
    std::size_t particle;  // the first one with this value, in its leaf `leaf`
    std::size_t leaf;
  };

  struct Variable {
    std::string name;
    Leaf::Kind kind;
    List<Value> values;
    List<std::string> texts;  // of the reported values
    NumberIndex places;

    void add(const Value& added) {
      const auto known = static_cast<std::uint32_t>(values.size());
      const auto is_it = [&](std::uint32_t place) { return values[place].number == added.number; };
      const std::uint32_t place = places.find_or_add(mixed(0, added.number), known, is_it);
      if (place < known) values[place].weight += added.weight;
      else values.push_back(added);
    }
  };

  // The leaves of a state, with their addresses.
  struct StateLeaves final : ValueVisitor {
    explicit StateLeaves(const State& state) : state(Model::bytes_of(state)) { Model::visit_values(state, *this); }
    void leaf(const Leaf& leaf) override { all.push_back(leaf); }
    std::size_t offset(const Leaf& leaf) const {
      return static_cast<std::size_t>(static_cast<const std::byte*>(leaf.place) - state);
    }

    // Whether no byte differs outside of the leaves. Then all states have the same shape.
    bool hold_all_of(const List<std::byte>& differences) const {
      List<std::byte> outside = differences;
      for (const Leaf& leaf : all) std::memset(outside.data() + offset(leaf), 0, leaf.size);
      return std::all_of(outside.begin(), outside.end(), [](std::byte byte) { return byte == std::byte{0}; });
    }

    const std::byte* state;
    List<Leaf> all;
  };

  // The bits in which any state differs from the first one.
  List<std::byte> differing_bits() const {
    List<std::byte> differences(Model::state_bytes());
    const std::byte* const first = Model::bytes_of(particles_.front().state);
    for (const auto& particle : particles_) {
      const std::byte* const other = Model::bytes_of(particle.state);
      for (std::size_t i = 0; i < differences.size(); ++i) differences[i] |= first[i] ^ other[i];
    }
    return differences;
  }

  // In states of one shape, a leaf has one place. Most leaves have the same value in all states.
  void add_by_place(const List<Leaf>& leaves, const List<std::byte>& differences) {
    const std::byte* const first = Model::bytes_of(particles_.front().state);
    const double total = total_weight<Model>(particles_);
    variables_of(0, particles_.front().state);
    List<std::size_t> varied;
    for (std::size_t leaf = 0; leaf < leaves.size(); ++leaf) {
      const auto* const bits = differences.data() + (static_cast<const std::byte*>(leaves[leaf].place) - first);
      if (std::any_of(bits, bits + leaves[leaf].size, [](std::byte byte) { return byte != std::byte{0}; })) {
        varied.push_back(leaf);
      } else {
        variables_[leaf].add({leaf_number(leaves[leaf]), total, 0, leaf});
      }
    }
    for (std::size_t number = 0; number < particles_.size(); ++number) {
      const std::byte* const state = Model::bytes_of(particles_[number].state);
      for (const std::size_t leaf : varied) {
        Leaf there = leaves[leaf];
        there.place = state + (static_cast<const std::byte*>(there.place) - first);
        variables_[leaf].add({leaf_number(there), particles_[number].weight, number, leaf});
      }
    }
  }

  void add_by_visit() {
    LeafNumbers leaves;
    for (std::size_t number = 0; number < particles_.size(); ++number) {
      leaves.clear();
      Model::visit_values(particles_[number].state, leaves);
      const List<std::size_t>& variables = variables_of(leaves.shape, particles_[number].state);
      for (std::size_t leaf = 0; leaf < variables.size(); ++leaf) {
        variables_[variables[leaf]].add({leaves.numbers[leaf], particles_[number].weight, number, leaf});
      }
    }
  }

  const List<std::size_t>& variables_of(std::uint64_t shape, const State& state) {
    const auto [entry, is_new] = shapes_.try_emplace(shape);
    if (is_new) {
      NamedLeaves leaves{[&](const std::string& name, const Leaf& leaf) {
        const auto [place, is_unknown] = names_.try_emplace(name, variables_.size());
        if (is_unknown) variables_.push_back({name, leaf.kind, {}, {}, {}});
        entry->second.push_back(place->second);
      }};
      Model::visit_values(state, leaves);
    }
    return entry->second;
  }

  void choose_reported(std::size_t max_of_one, std::size_t max_in_all) {
    const std::size_t share = max_in_all / std::max<std::size_t>(variables_.size(), 1);
    const std::size_t max_values = std::clamp<std::size_t>(share, 1, max_of_one);
    for (Variable& variable : variables_) {
      sort_stably(variable.values, [](const Value& left, const Value& right) { return left.weight > right.weight; });
      variable.texts.resize(std::min(max_values, variable.values.size()));
    }
  }

  // The least value up to which each share of the probability lies. Infinite numbers have no place in JSON.
  static void write_quantiles(JsonWriter& json, const Variable& variable) {
    const bool is_real = variable.kind == Leaf::Kind::real;
    if (!is_real && variable.kind != Leaf::Kind::signed_number && variable.kind != Leaf::Kind::unsigned_number) return;
    if (variable.values.size() <= (is_real ? max_reals_told_apart : variable.texts.size())) return;
    List<std::pair<double, double>> weighted;
    double total = 0;
    for (const Value& value : variable.values) {
      weighted.emplace_back(number_of(variable.kind, value.number), value.weight);
      if (!std::isfinite(weighted.back().first)) return;
      total += value.weight;
    }
    std::sort(weighted.begin(), weighted.end());
    json.key("quantiles").begin_array();
    auto value = weighted.begin();
    double below = 0;
    for (const double share : reported_quantiles) {
      while (below + value->second < share * total && value + 1 != weighted.end()) below += (value++)->second;
      json.value(value->first);
    }
    json.end_array();
  }

  static double number_of(Leaf::Kind kind, std::uint64_t bits) {
    if (kind == Leaf::Kind::real) return std::bit_cast<double>(bits);
    if (kind == Leaf::Kind::signed_number) return static_cast<double>(static_cast<std::int64_t>(bits));
    return static_cast<double>(bits);
  }

  // Making texts takes long, so only reported values get one, and each state makes all of its texts at once.
  void write_texts() {
    struct Wanted {
      std::size_t particle, leaf;
      std::string* text;
    };
    List<Wanted> wanted;
    for (Variable& variable : variables_) {
      for (std::size_t i = 0; i < variable.texts.size(); ++i) {
        wanted.push_back({variable.values[i].particle, variable.values[i].leaf, &variable.texts[i]});
      }
    }
    std::sort(wanted.begin(), wanted.end(), [](const Wanted& left, const Wanted& right) {
      return std::pair{left.particle, left.leaf} < std::pair{right.particle, right.leaf};
    });
    for (auto next = wanted.begin(); next != wanted.end();) {
      const std::size_t particle = next->particle;
      const StateLeaves leaves{particles_[particle].state};
      for (; next != wanted.end() && next->particle == particle; ++next) *next->text = leaf_text(leaves.all[next->leaf]);
    }
  }

  const List<Particle<Model>>& particles_;
  List<Variable> variables_;
  std::unordered_map<std::string, std::size_t> names_;
  std::unordered_map<std::uint64_t, List<std::size_t>> shapes_;
};

}
