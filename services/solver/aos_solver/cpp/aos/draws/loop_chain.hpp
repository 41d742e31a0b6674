// The heads of drawing loops as an absorbing Markov chain.
//
// A head is a place in the code before a round of a loop, together with all that the loop may change. Two paths that come to
// equal heads go on with the same probabilities, so what follows a head is walked once. The chain then tells how often a run
// comes to each head on average: the sum of the probabilities of all paths there, however often they go round.
#pragma once

#include <cstdint>
#include <queue>
#include <string>
#include <unordered_map>

#include "aos/base/list.hpp"

namespace aos {

struct TooManyHeads {};

class LoopChain {
 public:
  using Number = std::uint32_t;
  static constexpr Number start = 0;  // where a path begins
  // Limits: of the heads' keys together, and of the steps of one elimination.
  static constexpr std::size_t max_key_bytes = std::size_t{64} << 20;
  static constexpr std::size_t max_steps = 50'000'000;
  static constexpr std::size_t min_tree = 4096;  // heads

  // A head on the way to another: how many draws and events of loops there are up to it.
  struct Stop {
    Number head;
    std::size_t draws;
    std::uint64_t events;
  };

  void clear() {
    heads_.assign(1, Head{});
    numbers_.clear();
    entries_.clear();
    likeliest_ = {};
    bytes_ = listed_heads_ = met_again_ = 0;
    waiting_ = 0;
  }
  std::size_t size() const { return heads_.size(); }
  // Whether the heads are too many to keep, or so many without ever being equal that it does not pay.
  bool is_too_large() const {
    const bool is_a_tree = listed_heads_ > min_tree && met_again_ < listed_heads_ / 8 && size() > listed_heads_ + listed_heads_ / 2;
    return is_a_tree || bytes_ > max_key_bytes;
  }

  // The number of a way into a loop.
  std::uint32_t entry(const std::string& way) {
    const auto [found, is_new] = entries_.try_emplace(way, static_cast<std::uint32_t>(entries_.size()));
    if (is_new) bytes_ += way.size();
    return found->second;
  }
  // The number of the head with this key. A new head is reached from `before` by `choices`.
  Number find_or_add(const std::string& key, Number before, List<int> choices, std::uint64_t events) {
    const auto [found, is_new] = numbers_.try_emplace(key, static_cast<Number>(heads_.size()));
    met_again_ += !is_new;
    if (is_new) {
      bytes_ += sizeof(Head) + key.size() + choices.size() * sizeof(int);
      heads_.push_back({.before = before, .choices = std::move(choices), .events = events});
    }
    return found->second;
  }
  // Writes the draws on the way to a head, and the heads on it in their order; the last is the head itself.
  void write_way(Number to, List<int>& draws, List<Stop>& stops) const;

  // Adds a way from the head that is being listed to another one.
  void add_edge(Number to, double probability) {
    listed_.push_back({to, probability});
    if (heads_[to].is_listed) return;
    Head& head = heads_[to];
    head.mass += mass_of_listed_ * probability;
    waiting_ += mass_of_listed_ * probability;
    likeliest_.push({head.mass, to});
  }
  // Begins the list of ways from a head.
  void begin(Number head) {
    heads_[head].is_listed = true;
    mass_of_listed_ = head == start ? 1 : heads_[head].mass;
    if (head != start) waiting_ = std::max(waiting_ - mass_of_listed_, 0.0);
    listed_.clear();
  }
  // Ends the list: with `ends` a path ends without another head, and with `lost` it was not walked.
  void end(Number head, double ends, double lost);

  bool is_waiting() {
    while (!likeliest_.empty() && heads_[likeliest_.top().second].is_listed) likeliest_.pop();
    return !likeliest_.empty();
  }
  // At most the probability of coming to a head that is not listed; as much if no path comes to a head twice.
  double waiting() const { return waiting_; }
  // The head to list next.
  Number likeliest() const { return likeliest_.top().second; }

  // Computes how often a run comes to each head. Returns the probability of what is not listed, or lost. A head of a
  // loop that never ends is the end of the paths that come there.
  double settle();
  double visits(Number head) const { return heads_[head].visits; }
  bool has_ends(Number head) const { return heads_[head].ends > 0 || heads_[head].is_endless; }
  bool is_endless(Number head) const { return heads_[head].is_endless; }

 private:
  struct Edge {
    Number to;
    double probability;
  };
  struct Head {
    Number before = start;
    List<int> choices{};  // since `before`
    std::uint64_t events = 0;
    bool is_listed = false;
    bool is_endless = false;
    double mass = 0;  // a lower bound of `visits`, as long as the head is not listed
    double visits = 0;
    List<Edge> edges{};
    double ends = 0;
    double lost = 0;
  };
  class Elimination;
  class LastHeads;

  // Notes the heads of loops that never end. One that only leads to such a loop may be of a harmless one before it.
  void find_endless();

  List<Head> heads_;
  std::unordered_map<std::string, Number> numbers_;
  std::unordered_map<std::string, std::uint32_t> entries_;
  std::priority_queue<std::pair<double, Number>> likeliest_;
  List<Edge> listed_;
  double mass_of_listed_ = 0;
  double waiting_ = 0;
  std::size_t bytes_ = 0;
  std::size_t listed_heads_ = 0;
  std::size_t met_again_ = 0;
};

}
