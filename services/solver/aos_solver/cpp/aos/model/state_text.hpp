// Writes a state as one line of text and reads it back, for beliefs that outlive their process.
#pragma once

#include <vector>

#include "aos/model/reflection.hpp"

namespace aos {

// Writes numbers separated by blanks. A leaf is one number, and a real number is its bits. Vectors and texts
// begin with their size.
class StateWriter {
 public:
  void write(AnyValue value);
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

// Reads what a StateWriter wrote. A constant keeps its value, and its text is skipped. Bad text is a ModelFault.
class StateReader {
 public:
  explicit StateReader(std::string_view text) : rest_(text) {}

  template <class T>
  void read(T& value) {
    if constexpr (std::is_const_v<T>) {
      std::remove_const_t<T> ignored = value;
      read(ignored);
    } else if constexpr (Compound<T>) {
      T::aos_fields(value, [this](const char*, auto& member) { read(member); });
    } else if constexpr (Mapping<T>) {
      for (auto& entry : value) read(entry.second);
    } else if constexpr (Enumerated<T>) {
      for (auto& element : value) read(element);
    } else if constexpr (std::derived_from<T, std::vector<bool>>) {
      value.resize(next());
      for (auto element : value) element = next() != 0;
    } else if constexpr (Sequence<T>) {
      resize(value, static_cast<std::size_t>(next()));
      for (auto& element : value) read(element);
    } else {
      read_leaf(leaf_kind<T>(), sizeof value, &value);
    }
  }
  void finish() const {
    if (!rest_.empty()) malformed();
  }

 private:
  [[noreturn]] static void malformed();

  static void resize(auto& value, std::size_t size) {
    if constexpr (requires { value.resize(size); }) {
      value.resize(size);
    } else if (size != value.size()) {
      malformed();
    }
  }
  void read_leaf(Leaf::Kind kind, std::size_t size, void* place);
  std::string next_characters();
  std::int64_t next();

  std::string_view rest_;
};

// A variable that states hold at `offset`.
template <class T>
constexpr Member member_at(const char* name, std::size_t offset) {
  return {name, offset, nullptr, [](const void* variable, ValueVisitor& visitor) {
            visit_value(*static_cast<const T*>(variable), visitor);
          },
          [](void* variable, StateReader& text) { text.read(*static_cast<T*>(variable)); }};
}
template <class T>
constexpr Member constant_member(const char* name, const T& constant) {
  Member member = member_at<T>(name, 0);
  member.constant = &constant;
  member.read = [](void* variable, StateReader& text) { text.read(*static_cast<const T*>(variable)); };
  return member;
}

class NamedTexts {
 public:
  void add(std::string_view name, std::string_view text);
  bool empty() const { return texts_.empty(); }
  const std::vector<std::pair<std::string, std::string>>& texts() const { return texts_; }
  // The text of this name; null if there is none.
  const std::string* find(std::string_view name) const;

 private:
  std::vector<std::pair<std::string, std::string>> texts_;
};

// The variables that were constants in the model that saved the states. Their texts are saved once and not
// with each state.
struct SavedConstants : NamedTexts {
  void add_all(std::span<const Member> members);

  // Reads a variable: from these constants if it was one of them, else from the rest of a saved state.
  void read(const Member& member, void* state, StateReader& text) const;
  void read_all(std::span<const Member> members, void* state, StateReader& text) const;
};

}
