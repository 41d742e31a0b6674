// The variables of one type in a state, as documents iterate over them: `state.<Type>Objects`.
#pragma once

#include <cstddef>
#include <functional>
#include <iterator>
#include <map>
#include <string_view>
#include <type_traits>
#include <vector>

#include "aos/base/fault.hpp"

namespace aos {

// Reads like a vector of pointers to the given members of one state. Iterators refer to the state and not to
// the view, so that `x.begin()` and `x.end()` of two views belong together. A bad index is a ModelFault.
template <class State, class T, auto... Members>
class Objects {
 public:
  using Pointer = std::conditional_t<std::is_const_v<State>, const T*, T*>;
  static constexpr std::size_t count = sizeof...(Members);

  class Iterator {
   public:
    using iterator_category = std::random_access_iterator_tag;
    using value_type = Pointer;
    using difference_type = std::ptrdiff_t;
    using pointer = const Pointer*;
    using reference = Pointer;

    Iterator() = default;
    Iterator(State* state, std::ptrdiff_t index) : state_(state), index_(index) {}
    Pointer operator*() const { return Objects{*state_}[index_]; }
    Pointer operator[](std::ptrdiff_t offset) const { return *(*this + offset); }
    Iterator& operator+=(std::ptrdiff_t offset) {
      index_ += offset;
      return *this;
    }
    Iterator& operator-=(std::ptrdiff_t offset) { return *this += -offset; }
    Iterator& operator++() { return *this += 1; }
    Iterator& operator--() { return *this -= 1; }
    Iterator operator++(int) { return {state_, index_++}; }
    Iterator operator--(int) { return {state_, index_--}; }
    friend Iterator operator+(Iterator it, std::ptrdiff_t offset) { return it += offset; }
    friend Iterator operator-(Iterator it, std::ptrdiff_t offset) { return it -= offset; }
    friend std::ptrdiff_t operator-(const Iterator& left, const Iterator& right) { return left.index_ - right.index_; }
    friend bool operator==(const Iterator& left, const Iterator& right) { return left.index_ == right.index_; }
    friend auto operator<=>(const Iterator& left, const Iterator& right) { return left.index_ <=> right.index_; }

   private:
    State* state_ = nullptr;
    std::ptrdiff_t index_ = 0;
  };

  explicit Objects(State& state) : state_(&state) {}
  static constexpr std::size_t size() { return count; }
  static constexpr bool empty() { return count == 0; }
  Pointer operator[](std::ptrdiff_t index) const {
    static constexpr T std::remove_const_t<State>::* members[] = {Members..., nullptr};
    if (static_cast<std::size_t>(index) >= count) {
      throw ModelFault{"AOS215", "object " + std::to_string(index) + " of " + std::to_string(count)};
    }
    return &(state_->*members[index]);
  }
  Pointer at(std::ptrdiff_t index) const { return (*this)[index]; }
  Pointer front() const { return (*this)[0]; }
  Pointer back() const { return (*this)[static_cast<std::ptrdiff_t>(count) - 1]; }
  Iterator begin() const { return {state_, 0}; }
  Iterator end() const { return {state_, static_cast<std::ptrdiff_t>(count)}; }
  Iterator cbegin() const { return begin(); }
  Iterator cend() const { return end(); }
  auto rbegin() const { return std::reverse_iterator(end()); }
  auto rend() const { return std::reverse_iterator(begin()); }
  operator std::vector<Pointer>() const { return {begin(), end()}; }

 private:
  State* state_;
};

// A pointer to an object of a state; it is const if the state is.
template <class T, class State>
using Pointer = std::conditional_t<std::is_const_v<std::remove_reference_t<State>>, const T*, T*>;

template <class T, auto... Members, class State>
Objects<State, T, Members...> objects(State& state) {
  return Objects<State, T, Members...>{state};
}

// The pointers of such a list, which may be put into another order.
template <class List>
std::vector<typename List::Pointer> listed(const List& list) { return list; }

// The values that parameters of one type take, by the name `state.<variable>`. An unknown name is a ModelFault.
template <class T>
struct NamedValues : std::map<std::string, T, std::less<>> {
  void add(const char* name, const T& value) { this->emplace(name, value); }
  const T& operator[](std::string_view name) const {
    const auto found = this->find(name);
    if (found == this->end()) throw ModelFault{"AOS215", "no parameter value is called " + std::string{name}};
    return found->second;
  }
  const T& at(std::string_view name) const { return (*this)[name]; }
};

}
