// Values as lists of their leaves: the name, the number and the address of each.
#pragma once

#include <functional>

#include "aos/model/reflection.hpp"

namespace aos {

template <class T>
T stored_at(const void* place) {
  T value;
  std::memcpy(&value, place, sizeof value);
  return value;
}

// Calls `use` with the leaf's number: a real number as it is, any other widened to 64 bits.
void with_number(const Leaf& leaf, auto&& use) {
  const auto widened = [&](auto narrow) {
    if (leaf.kind == Leaf::Kind::unsigned_number || leaf.kind == Leaf::Kind::boolean) {
      use(std::uint64_t{static_cast<std::make_unsigned_t<decltype(narrow)>>(narrow)});
    } else {
      use(std::int64_t{narrow});
    }
  };
  if (leaf.kind == Leaf::Kind::real) {
    leaf.size == sizeof(float) ? use(stored_at<float>(leaf.place)) : use(stored_at<double>(leaf.place));
  } else if (leaf.size == 1) {
    widened(stored_at<std::int8_t>(leaf.place));
  } else if (leaf.size == 2) {
    widened(stored_at<std::int16_t>(leaf.place));
  } else if (leaf.size == 4) {
    widened(stored_at<std::int32_t>(leaf.place));
  } else {
    widened(stored_at<std::int64_t>(leaf.place));
  }
}

inline bool is_text(const Leaf& leaf) { return leaf.kind == Leaf::Kind::text || leaf.kind == Leaf::Kind::string; }

inline std::string_view characters_of(const Leaf& leaf) {
  if (leaf.kind == Leaf::Kind::text) return static_cast<const Text*>(leaf.place)->view();
  return *static_cast<const std::string*>(leaf.place);
}

// Calls `use` for every leaf with its name: `v1.visited`, `grid[3]`, `cell[1,2]`.
class NamedLeaves final : public ValueVisitor {
 public:
  explicit NamedLeaves(std::function<void(const std::string& name, const Leaf& leaf)> use) : use_(std::move(use)) {}

  void leaf(const Leaf& leaf) override { use_(name_, leaf); }
  void begin_compound() override { owners_.push_back(name_.size()); }
  void begin_sequence(std::size_t) override { owners_.push_back(name_.size()); }
  void begin_mapping() override { owners_.push_back(name_.size()); }
  void member(const char* name) override {
    name_.resize(owners_.back());
    if (!name_.empty()) name_ += '.';
    name_ += name;
  }
  void element(std::size_t index) override { entry(std::to_string(index)); }
  void entry(const std::string& key) override {
    name_.resize(owners_.back());
    (name_ += '[').append(key) += ']';
  }
  void end() override {
    name_.resize(owners_.back());
    owners_.pop_back();
  }

 private:
  std::function<void(const std::string& name, const Leaf& leaf)> use_;
  std::string name_;
  std::vector<std::size_t> owners_;  // the lengths of the names around the current leaf
};

// A number of a state by its place, which is the same in all states.
struct PlacedNumber {
  Leaf leaf;  // of any state
  std::size_t offset;

  double of(const void* state) const {
    Leaf own = leaf;
    own.place = static_cast<const std::byte*>(state) + offset;
    double number = 0;
    with_number(own, [&](auto value) { number = static_cast<double>(value); });
    return number;
  }
};

// Calls `use(name, number)` for each number of a state that lies in it.
template <class Model, class Use>
void for_each_number(const typename Model::State& state, Use&& use) {
  NamedLeaves leaves{[&](const std::string& name, const Leaf& leaf) {
    const auto offset = static_cast<const std::byte*>(leaf.place) - Model::bytes_of(state);
    if (offset >= 0 && offset < static_cast<std::ptrdiff_t>(Model::state_bytes()) && !is_text(leaf)) use(name, PlacedNumber{leaf, static_cast<std::size_t>(offset)});
  }};
  Model::visit_values(state, leaves);
}

// A leaf as 64 bits: a text by its hash, any number by its bits.
inline std::uint64_t leaf_number(const Leaf& leaf) {
  if (is_text(leaf)) return std::hash<std::string_view>{}(characters_of(leaf));
  std::uint64_t bits = 0;
  with_number(leaf, [&](auto number) {
    if constexpr (std::is_floating_point_v<decltype(number)>) {
      bits = std::bit_cast<std::uint64_t>(double{number});
    } else {
      bits = static_cast<std::uint64_t>(number);
    }
  });
  return bits;
}

// The leaves of a value as numbers, in their order. Values of the same shape have leaves with the same names.
struct LeafNumbers final : ValueVisitor {
  std::vector<std::uint64_t> numbers;
  std::uint64_t shape = 0;

  void clear() {
    numbers.clear();
    shape = 0;
  }

  void leaf(const Leaf& leaf) override { numbers.push_back(leaf_number(leaf)); }
  void begin_sequence(std::size_t size) override { shape = mixed(shape, size); }
};

}
