// Pairs, sets and maps of fixed storage, with the part of the standard ones' interface that documents use.
#pragma once

#include "aos/model/containers.hpp"

namespace aos {

// It converts from and to std::pair, and has std::get.
template <class First, class Second>
struct Pair {
  First first{};
  Second second{};

  Pair() = default;
  Pair(const First& one, const Second& other) : first(one), second(other) {}
  template <class One, class Other>
  Pair(const std::pair<One, Other>& pair) : first(pair.first), second(pair.second) {}
  template <class One, class Other>
  operator std::pair<One, Other>() const {
    return {first, second};
  }
  template <class Self, class Visit>
  static void aos_fields(Self& self, Visit&& visit) {
    visit("first", self.first);
    visit("second", self.second);
  }
  bool operator==(const Pair&) const = default;
  auto operator<=>(const Pair&) const = default;
};

// An element that was taken out of a map or a set, to be put back with another key.
template <class Element>
struct Node {
  Element element{};
  bool is_held = false;

  auto& key() { return element.first; }
  auto& mapped() { return element.second; }
  Element& value() { return element; }
  bool empty() const { return !is_held; }
  explicit operator bool() const { return is_held; }
};

// A Vector in the order of its elements' keys, each of which is there once: those of pairs in a map, else the elements
// themselves. It converts from and to the standard containers. More keys than the capacity are a ModelFault.
template <class Store, class Key>
class Sorted : public Store {
  using T = typename Store::value_type;

 public:
  using key_type = Key;
  using iterator = typename Store::iterator;
  using Store::begin;
  using Store::end;
  using Store::erase;

  Sorted() = default;
  Sorted(std::initializer_list<T> elements) { insert(elements.begin(), elements.end()); }
  template <class Iterator>
  Sorted(Iterator first, Iterator last) { insert(first, last); }
  template <class Other>
    requires requires { typename Other::node_type; }
  Sorted(const Other& other) : Sorted(other.begin(), other.end()) {}
  template <class Other>
    requires requires { typename Other::node_type; }
  operator Other() const { return Other(begin(), end()); }

  iterator lower_bound(const Key& key) {
    return std::partition_point(begin(), end(), [&](const T& each) { return key_in(each) < key; });
  }
  iterator find(const Key& key) {
    const iterator at = lower_bound(key);
    return at != end() && key_in(*at) == key ? at : end();
  }
  iterator upper_bound(const Key& key) {
    const iterator at = lower_bound(key);
    return at != end() && key_in(*at) == key ? std::next(at) : at;
  }
  std::pair<iterator, iterator> equal_range(const Key& key) { return {lower_bound(key), upper_bound(key)}; }
  const T* lower_bound(const Key& key) const { return mine().lower_bound(key); }
  const T* upper_bound(const Key& key) const { return mine().upper_bound(key); }
  std::pair<const T*, const T*> equal_range(const Key& key) const { return mine().equal_range(key); }
  const T* find(const Key& key) const { return mine().find(key); }
  bool contains(const Key& key) const { return find(key) != end(); }
  std::size_t count(const Key& key) const { return contains(key); }

  std::pair<iterator, bool> insert(const T& element) {
    const iterator at = lower_bound(key_in(element));
    if (at != end() && key_in(*at) == key_in(element)) return {at, false};
    return {Store::insert(at, element), true};
  }
  std::pair<iterator, bool> insert(const Node<T>& node) {
    return node.is_held ? insert(node.element) : std::pair{end(), false};
  }
  iterator insert(const T* /*hint*/, const T& element) { return insert(element).first; }
  template <class Iterator>
  void insert(Iterator first, Iterator last) {
    for (; first != last; ++first) insert(T(*first));
  }
  void insert(std::initializer_list<T> elements) { insert(elements.begin(), elements.end()); }
  template <class... Arguments>
  std::pair<iterator, bool> emplace(Arguments&&... arguments) {
    return insert(T(std::forward<Arguments>(arguments)...));
  }
  template <class Other>
  void merge(Other&& other) {
    for (auto at = other.begin(); at != other.end();) at = insert(T(*at)).second ? other.erase(at) : std::next(at);
  }
  std::size_t erase(const Key& key) {
    const iterator at = find(key);
    if (at == end()) return 0;
    Store::erase(at);
    return 1;
  }
  Node<T> extract(iterator at) {
    const Node<T> node{*at, true};
    Store::erase(at);
    return node;
  }
  Node<T> extract(const Key& key) {
    const iterator at = find(key);
    return at == end() ? Node<T>{} : extract(at);
  }

  friend bool operator==(const Sorted& left, const Sorted& right) {
    return static_cast<const Store&>(left) == static_cast<const Store&>(right);
  }

 protected:
  static const Key& key_in(const T& element) {
    if constexpr (std::is_same_v<Key, T>) {
      return element;
    } else {
      return element.first;
    }
  }

 private:
  Sorted& mine() const { return const_cast<Sorted&>(*this); }
};

template <class Store>
using Set = Sorted<Store, typename Store::value_type>;

template <class Store>
class Map : public Sorted<Store, std::remove_cvref_t<decltype(Store::value_type::first)>> {
  using Base = Sorted<Store, std::remove_cvref_t<decltype(Store::value_type::first)>>;
  using Key = typename Base::key_type;

 public:
  using Base::Base;
  Map() = default;

  auto& operator[](const Key& key) { return this->insert({key, {}}).first->second; }
  /** The value of a key, of a map that no code changes: that of a missing key is a new one's. */
  const auto& operator[](const Key& key) const {
    using Value = std::remove_cvref_t<decltype(Store::value_type::second)>;
    static const Value missing{};
    const auto at = this->find(key);
    return at == this->end() ? missing : at->second;
  }
  auto& at(const Key& key) { return found(this->find(key)); }
  const auto& at(const Key& key) const { return found(this->find(key)); }
  auto try_emplace(const Key& key, auto&&... arguments) {
    const auto at = this->find(key);
    if (at != this->end()) return std::pair{at, false};
    using Value = std::remove_reference_t<decltype(at->second)>;
    return this->insert({key, Value(std::forward<decltype(arguments)>(arguments)...)});
  }
  auto insert_or_assign(const Key& key, const auto& value) {
    const bool is_new = !this->contains(key);
    (*this)[key] = value;
    return std::pair{this->find(key), is_new};
  }

 private:
  auto& found(auto at) const {
    if (at == this->end()) no_such_key(this->size());
    return at->second;
  }
};

}  // namespace aos

namespace std {
template <size_t index, class First, class Second>
auto& get(aos::Pair<First, Second>& pair) {
  if constexpr (index == 0) return pair.first;
  else return pair.second;
}
template <size_t index, class First, class Second>
const auto& get(const aos::Pair<First, Second>& pair) {
  return get<index>(const_cast<aos::Pair<First, Second>&>(pair));
}
}  // namespace std
