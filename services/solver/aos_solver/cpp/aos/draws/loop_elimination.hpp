// The functions of LoopChain that are compiled once and not with every model. Only support.hpp includes this file.
//
// Heads are eliminated one by one after Grassmann, Taksar and Heyman (1985). Nothing is ever subtracted, so every result
// is as accurate as the probabilities are, however rarely a loop ends.
#pragma once

#include <functional>

#include "aos/base/add_up.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/draws/loop_chain.hpp"

namespace aos {

void LoopChain::write_way(Number to, List<int>& draws, List<Stop>& stops) const {
  draws.clear();
  stops.clear();
  for (Number head = to; head != start; head = heads_[head].before) stops.push_back({head, 0, heads_[head].events});
  std::reverse(stops.begin(), stops.end());
  for (Stop& stop : stops) {
    const List<int>& choices = heads_[stop.head].choices;
    draws.insert(draws.end(), choices.begin(), choices.end());
    stop.draws = draws.size();
  }
}

void LoopChain::end(Number head, double ends, double lost) {
  std::sort(listed_.begin(), listed_.end(), [](const Edge& left, const Edge& right) { return left.to < right.to; });
  add_up_neighbours(listed_, &Edge::to, &Edge::probability);
  heads_[head].edges = listed_;
  heads_[head].ends = ends;
  heads_[head].lost = lost;
  ++listed_heads_;
}

class LoopChain::Elimination {
 public:
  explicit Elimination(const List<Head>& heads) : heads_(heads), rows_(heads.size()), sources_(heads.size()) {
    for (Number from = 0; from < heads.size(); ++from) {
      if (!heads[from].is_listed) continue;
      Row& row = rows_[from];
      row.is_left = true;
      row.exit = heads[from].is_endless ? 1 : heads[from].ends + heads[from].lost;
      if (heads[from].is_endless) continue;
      for (const auto& [to, probability] : heads[from].edges) {
        if (!heads[to].is_listed) {
          row.exit += probability;
        } else if (to != from) {
          row.to[to] += probability;
          sources_[to].push_back(from);
        }
      }
    }
  }

  // How often a run comes to each head.
  List<double> visits() {
    for (Number head = start + 1; head < heads_.size(); ++head) {
      if (rows_[head].is_left) order_.push({degree(head), head});
    }
    while (!order_.empty()) {
      const auto [degree_then, head] = order_.top();
      order_.pop();
      if (rows_[head].is_left && degree_then == degree(head)) eliminate(head);
    }
    List<double> visits(heads_.size(), 0);
    visits[start] = 1;
    for (auto step = steps_.rbegin(); step != steps_.rend(); ++step) {
      for (const auto& [from, share] : step->shares) visits[step->head] += visits[from] * share;
    }
    return visits;
  }

 private:
  // The probabilities of leaving a head, to other heads and for good. What leads back to it is left out.
  struct Row {
    std::unordered_map<Number, double> to;
    double exit = 0;
    bool is_left = false;  // not eliminated
  };
  // One visit to `from` makes so many visits to the head.
  struct Share {
    Number from;
    double share;
  };
  struct Step {
    Number head;
    List<Share> shares;
  };

  std::size_t degree(Number head) const { return sources_[head].size() * rows_[head].to.size(); }

  // Leads every way through the head around it.
  void eliminate(Number head) {
    Row& row = rows_[head];
    row.is_left = false;
    double leaving = row.exit;
    for (const auto& [to, probability] : row.to) leaving += probability;
    if (!(leaving > 0)) throw NotEnumerable{"a loop may never end"};
    Step step{head, {}};
    for (const Number from : sources_[head]) {
      const auto found = rows_[from].to.find(head);
      if (!rows_[from].is_left || found == rows_[from].to.end()) continue;
      const double share = found->second / leaving;
      rows_[from].to.erase(found);
      step.shares.push_back({from, share});
      rows_[from].exit += share * row.exit;
      for (const auto& [to, probability] : row.to) {
        if (to == from) continue;
        const auto [entry, is_new] = rows_[from].to.try_emplace(to, 0.0);
        entry->second += share * probability;
        if (is_new) sources_[to].push_back(from);
        if (++work_ > max_steps) throw TooManyHeads{};
      }
      if (from != start) order_.push({degree(from), from});
    }
    for (const auto& [to, probability] : row.to) {
      erase_if(sources_[to], [&](Number from) { return from == head; });
      if (to != start) order_.push({degree(to), to});
    }
    row.to.clear();
    steps_.push_back(std::move(step));
  }

  const List<Head>& heads_;
  List<Row> rows_;
  List<List<Number>> sources_;  // the heads with a way to this one
  std::priority_queue<std::pair<std::size_t, Number>, List<std::pair<std::size_t, Number>>, std::greater<>> order_;
  List<Step> steps_;
  std::size_t work_ = 0;
};

// Where paths without an end stay: a strongly connected component that nothing leaves, after Tarjan (1972).
class LoopChain::LastHeads {
 public:
  explicit LastHeads(List<Head>& heads) : heads_(heads), found_(heads.size()) {}

  void note_from(Number first) {
    if (found_[first].order == 0) begin(first);
    while (!path_.empty()) {
      const Number head = path_.back();
      Found& own = found_[head];
      if (own.next_edge == heads_[head].edges.size()) {
        end(head);
        continue;
      }
      const Number to = heads_[head].edges[own.next_edge++].to;
      if (found_[to].order == 0) {
        begin(to);
      } else if (found_[to].is_open) {
        own.earliest = std::min(own.earliest, found_[to].order);
      } else {
        own.leaves = true;
      }
    }
  }

 private:
  // `earliest` is the order of the first open head that a head leads back to.
  struct Found {
    Number order = 0, earliest = 0;
    std::size_t next_edge = 0;
    bool is_open = false;  // its component is not complete
    bool leaves = false;   // its component leads to another
  };

  void begin(Number head) {
    ++count_;
    found_[head] = {.order = count_, .earliest = count_, .is_open = true};
    path_.push_back(head);
    open_.push_back(head);
  }
  void end(Number head) {
    const Found own = found_[head];
    path_.pop_back();
    const bool is_complete = own.earliest == own.order;
    if (is_complete) close(head);
    if (path_.empty()) return;
    Found& before = found_[path_.back()];
    before.leaves = before.leaves || own.leaves || is_complete;
    before.earliest = std::min(before.earliest, is_complete ? before.earliest : own.earliest);
  }
  void close(Number root) {
    for (bool is_closed = false; !is_closed;) {
      const Number head = open_.back();
      open_.pop_back();
      found_[head].is_open = false;
      heads_[head].is_endless = !found_[root].leaves;
      is_closed = head == root;
    }
  }

  List<Head>& heads_;
  List<Found> found_;
  List<Number> path_, open_;
  Number count_ = 0;
};

void LoopChain::find_endless() {
  List<List<Number>> sources(heads_.size());
  std::vector<bool> ends(heads_.size(), false);
  List<Number> found;
  const auto note = [&](Number head) {
    if (ends[head]) return;
    ends[head] = true;
    found.push_back(head);
  };
  for (Number from = 0; from < heads_.size(); ++from) {
    Head& head = heads_[from];
    head.is_endless = false;
    if (!head.is_listed || head.ends + head.lost > 0) note(from);
    for (const auto& [to, probability] : head.edges) sources[to].push_back(from);
  }
  while (!found.empty()) {
    const Number head = found.back();
    found.pop_back();
    for (const Number source : sources[head]) note(source);
  }
  LastHeads last{heads_};
  for (Number head = start + 1; head < heads_.size(); ++head) {
    if (!ends[head]) last.note_from(head);
  }
}

double LoopChain::settle() {
  find_endless();
  const List<double> visits = Elimination{heads_}.visits();
  double left_out = 0;
  for (Head& head : heads_) {
    if (!head.is_listed) head.mass = 0;
  }
  for (Number from = 0; from < heads_.size(); ++from) {
    Head& head = heads_[from];
    if (!head.is_listed) continue;
    head.visits = head.mass = visits[from];
    left_out += head.visits * head.lost;
    for (const auto& [to, probability] : head.edges) {
      if (!heads_[to].is_listed) heads_[to].mass += head.visits * probability;
    }
  }
  waiting_ = 0;
  likeliest_ = {};
  for (Number number = 0; number < heads_.size(); ++number) {
    if (heads_[number].is_listed) continue;
    waiting_ += heads_[number].mass;
    likeliest_.push({heads_[number].mass, number});
  }
  return left_out + waiting_;
}

}
