// The distribution of each single variable under weighted states, for people: of every variable its likeliest values.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "aos/base/json.hpp"
#include "aos/belief/gathering.hpp"
#include "aos/model/values.hpp"

namespace aos {

inline constexpr std::size_t most_told_values = 16;  // of one variable
inline constexpr std::size_t most_told_in_all = 4096;

template <class Model>
class Marginals {
 public:
  using State = typename Model::State;

  // The particles must outlive this.
  explicit Marginals(const std::vector<Particle<Model>>& particles) : particles_(particles) {
    LeafNumbers leaves;
    for (std::size_t number = 0; number < particles.size(); ++number) {
      leaves.clear();
      Model::visit_values(particles[number].state, leaves);
      const std::vector<std::size_t>& variables = variables_of(leaves.shape, particles[number].state);
      for (std::size_t leaf = 0; leaf < variables.size(); ++leaf) {
        variables_[variables[leaf]].add({leaves.numbers[leaf], particles[number].weight, number, leaf});
      }
    }
  }

  // An array with an entry for each variable: its name, its likeliest values, and the probability of all others.
  void write(JsonWriter& json) {
    choose_told();
    write_texts();
    json.begin_array();
    for (const Variable& variable : variables_) {
      double others = 0;
      for (std::size_t i = variable.texts.size(); i < variable.values.size(); ++i) others += variable.values[i].weight;
      json.begin_object().member("variable", variable.name).key("values").begin_object();
      for (std::size_t i = 0; i < variable.texts.size(); ++i) json.member(variable.texts[i], variable.values[i].weight);
      json.end_object();
      if (others > 0) json.member("others", others);
      json.end_object();
    }
    json.end_array();
  }

 private:
  struct Value {
    std::uint64_t number;
    double weight;
    std::size_t particle;  // the first that has it, and as which of its leaves
    std::size_t leaf;
  };

  struct Variable {
    std::string name;
    std::vector<Value> values;
    std::vector<std::string> texts;  // of those that are told
    std::unordered_map<std::uint64_t, std::size_t> places;  // of many values

    void add(const Value& added) {
      const std::size_t place = place_of(added.number);
      if (place < values.size()) {
        values[place].weight += added.weight;
      } else {
        values.push_back(added);
      }
    }

   private:
    static constexpr std::size_t few = 8;

    std::size_t place_of(std::uint64_t number) {
      if (values.size() <= few) {
        const auto found = std::find_if(values.begin(), values.end(), [&](const Value& v) { return v.number == number; });
        if (found != values.end() || values.size() < few) return static_cast<std::size_t>(found - values.begin());
        for (std::size_t i = 0; i < values.size(); ++i) places.try_emplace(values[i].number, i);
      }
      return places.try_emplace(number, values.size()).first->second;
    }
  };

  // The variable of each leaf, for states of a shape.
  const std::vector<std::size_t>& variables_of(std::uint64_t shape, const State& state) {
    const auto [entry, is_new] = shapes_.try_emplace(shape);
    if (is_new) {
      Model::visit(state, [&](const std::string& name, const Leaf&) {
        const auto [place, is_unknown] = names_.try_emplace(name, variables_.size());
        if (is_unknown) variables_.push_back({name, {}, {}, {}});
        entry->second.push_back(place->second);
      });
    }
    return entry->second;
  }

  void choose_told() {
    const std::size_t share = most_told_in_all / std::max<std::size_t>(variables_.size(), 1);
    const std::size_t most = std::clamp<std::size_t>(share, 1, most_told_values);
    for (Variable& variable : variables_) {
      std::stable_sort(variable.values.begin(), variable.values.end(),
                       [](const Value& left, const Value& right) { return left.weight > right.weight; });
      variable.texts.resize(std::min(most, variable.values.size()));
    }
  }

  // Texts take long and are made of what is told only, of all that a state shows at once.
  void write_texts() {
    struct Wanted {
      std::size_t particle, leaf;
      std::string* text;
    };
    std::vector<Wanted> wanted;
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
      std::size_t leaf = 0;
      Model::visit(particles_[particle].state, [&](const std::string&, const Leaf& value) {
        if (next != wanted.end() && next->particle == particle && next->leaf == leaf) *next++->text = leaf_text(value);
        ++leaf;
      });
    }
  }

  const std::vector<Particle<Model>>& particles_;
  std::vector<Variable> variables_;
  std::unordered_map<std::string, std::size_t> names_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> shapes_;
};

}  // namespace aos
