// The functions of the sources of draws that are compiled once and not with every model. Only support.hpp
// includes this file.
#pragma once

#include "aos/draws/directed.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/draws/loop_elimination.hpp"

namespace aos {

namespace detail {

// The next outcome after `taken`, around to `first`, whose weight is positive; -1 if there is none.
inline int next_outcome(const double* weights, int count, int taken, int first) {
  for (int i = taken + 1;; ++i) {
    if (i >= count) i = 0;
    if (i == first) return -1;
    if (weights[i] > 0) return i;
  }
}

void append_bytes(std::string& text, const auto& value) {
  text.append(reinterpret_cast<const char*>(&value), sizeof value);
}

inline bool skips_sensing(const Sampler&) { return false; }
inline bool skips_sensing(DirectedDraws& draws) { return draws.skips_sensing(); }

template <class Source>
inline constexpr AnySource::Functions functions_of{
    .flag = [](void* source, double probability) { return static_cast<Source*>(source)->flag(probability); },
    .choose = [](void* source, const double* weights, int count, double total) {
      return static_cast<Source*>(source)->choose(weights, count, total);
    },
    .uniform = [](void* source) { return static_cast<Source*>(source)->uniform(); },
    .skips_sensing = [](void* source) { return skips_sensing(*static_cast<Source*>(source)); },
    .gives_means = std::is_same_v<Source, DirectedDraws>,
    .report = [](void* source, std::uint32_t key, const Distribution& distribution) {
      static_cast<Source*>(source)->report(key, distribution);
    },
    .loop_heads = [](void* source) -> LoopHeads* { return static_cast<Source*>(source)->loop_heads(); },
    .end_world = [](void* source) { static_cast<Source*>(source)->end_world(); },
};

}  // namespace detail

AnySource::AnySource(Sampler& sampler) : source_(&sampler), functions_(detail::functions_of<Sampler>) {}
AnySource::AnySource(DirectedDraws& draws) : source_(&draws), functions_(detail::functions_of<DirectedDraws>) {}

int Enumerator::choose(const double* weights, int count, double total) {
  if (is_world_) return of_world_.choose(weights, count, total);
  if (depth_ >= choices_.size()) {
    if (given_left_ > 0) return choose_given();
    if (depth_ == max_draws_of_path) throw NotEnumerable{"a step draws too often"};
    const bool by_chance = is_best_first_ || depth_ >= max_draws_depth_first;
    const int first = by_chance ? chance_.choose(weights, count, total) : detail::next_outcome(weights, count, -1, count);
    choices_.push_back({first, none, first, 0});
  }
  Choice& choice = choices_[depth_++];
  choice.following = detail::next_outcome(weights, count, choice.taken, choice.first);
  if (is_best_first_) {
    double following = 0;
    for (int i = choice.following; i != none; i = detail::next_outcome(weights, count, i, choice.first)) {
      following += weights[i];
    }
    choice.following_weight = probability_ * following / total;
  }
  probability_ *= weights[choice.taken] / total;
  return choice.taken;
}

double Enumerator::uniform() {
  if (is_world_) return of_world_.uniform();
  has_number_since_ = events_ > 0;
  if (luck_) return drawn_.uniform();
  meets_number_ = has_drawn_number_ = true;
  if (strata_.count == 0) throw NotEnumerable{"a draw is continuous"};
  return strata_.middles[choose(strata_.weights, strata_.count, 1.0)];
}

double Enumerator::walk(Run run, Run visit, int max_paths, std::size_t max_depth_first) {
  has_loops_ = has_number_between_ = has_number_since_ = false;
  events_ = 0;
  is_listing_ = is_cutting_ = true;
  visits_ = 1;
  paths_left_ = max_paths;
  const auto visit_end = [&] { visit(*this); };
  start_from(LoopChain::start);
  double left_out = walk_on(run, visit_end, max_depth_first);
  if (!has_loops_) return left_out;
  chain_.end(LoopChain::start, 0, 0);
  try {
    left_out += list_heads(run, max_depth_first);
  } catch (const TooManyHeads&) {
    return walk_without_cuts(run, visit, max_paths, max_depth_first);
  }
  is_listing_ = false;
  paths_left_ = max_paths;
  for (LoopChain::Number head = LoopChain::start + 1; head < chain_.size(); ++head) {
    if (!chain_.has_ends(head)) continue;
    visits_ = chain_.visits(head);
    start_from(head);
    walk_on(run, visit_end, max_depth_first);
  }
  return left_out;
}

double Enumerator::walk_without_cuts(Run run, Run visit, int max_paths, std::size_t max_depth_first) {
  is_cutting_ = false;
  paths_left_ = max_paths;
  start_from(LoopChain::start);
  const auto visit_end = [&] {
    if (has_arrived_) visit(*this);
  };
  return walk_on(run, visit_end, max_depth_first);
}

double Enumerator::list_heads(Run run, std::size_t max_depth_first) {
  const bool is_nearly = max_depth_first < std::numeric_limits<std::size_t>::max();
  while (chain_.is_waiting()) {
    if (is_nearly && chain_.waiting() <= negligible_paths && chain_.settle() <= negligible_paths) break;
    if (paths_left_ <= 0) {
      if (!is_nearly || chain_.settle() > max_left_out) throw TooManyHeads{};
      break;
    }
    const LoopChain::Number head = chain_.likeliest();
    start_from(head);
    chain_.begin(head);
    double ends = 0;
    const double lost = walk_on(run, [&] { ends += probability_; }, max_depth_first);
    chain_.end(head, ends, lost);
    if (chain_.is_too_large()) throw TooManyHeads{};
  }
  return chain_.settle();
}

double Enumerator::walk_on(Run run, End at_end, std::size_t max_depth_first) {
  choices_.clear();
  chance_ = Sampler{1};
  is_best_first_ = false;
  do {
    if (--paths_left_ < 0) give_up();
    run_once(run, at_end);
    if (depth_ > max_depth_first) return best_first(run, at_end);
  } while (advance());
  return 0;
}

void Enumerator::run_once(Run run, End at_end) {
  depth_ = 0;
  probability_ = 1;
  if (has_loops_) begin_run_with_loops();
  if (luck_) drawn_ = Sampler{*luck_};
  is_world_ = world_.has_value();
  if (is_world_) of_world_ = Sampler{*world_};
  has_drawn_number_ = false;
  begin_numbers();
  try {
    run(*this);
  } catch (const CutPath&) {
    return;
  } catch (const EndlessPath&) {
    throw NotEnumerable{"a loop may never end"};  // Only a step that never ends is an outcome.
  }
  at_end();
}

double Enumerator::best_first(Run run, End at_end) {
  if (!advance()) return 0;
  is_best_first_ = true;
  nodes_.clear();
  begun_.clear();
  shared_ = 0;
  last_ = no_node;
  waiting_ = dropped_ = 0;
  for (; paths_left_ > 0 && nodes_.size() < max_frontier; --paths_left_) {
    run_once(run, at_end);
    put_off();
    if (begun_.empty() || waiting_ + dropped_ <= negligible_paths) return waiting_ + dropped_;
    take_likeliest();
  }
  if (waiting_ + dropped_ > max_left_out) throw NotEnumerable{"loops that draw have more paths than can be walked"};
  return waiting_ + dropped_;
}

void Enumerator::start_from(LoopChain::Number head) {
  from_ = head;
  if (head == LoopChain::start) {
    given_.clear();
    stops_.clear();
  } else {
    chain_.write_way(head, given_, stops_);
  }
}

void Enumerator::give_up() const {
  if (from_ != LoopChain::start) throw TooManyHeads{};
  throw NotEnumerable{"there are more combinations of draws than can be walked"};
}

void Enumerator::begin_run_with_loops() {
  given_left_ = given_.size();
  if (given_left_ > 0) depth_ = on_the_way;
  at_ = LoopChain::start;
  next_stop_ = draws_at_ = 0;
  events_ = events_at_ = 0;
  has_arrived_ = has_number_since_ = false;
}

int Enumerator::choose_given() {
  const int taken = given_[given_.size() - given_left_];
  if (--given_left_ == 0) depth_ = 0;
  return taken;
}

std::uint32_t Enumerator::enter() {
  if (!is_cutting_) return 0;
  if (!has_loops_) {
    has_loops_ = true;
    begin_run_with_loops();
    chain_.clear();
    chain_.begin(LoopChain::start);
  }
  ++events_;
  way_.clear();
  detail::append_bytes(way_, at_);
  detail::append_bytes(way_, events_ - events_at_);
  const std::size_t given = given_.size() - given_left_;
  for (std::size_t draw = draws_at_; draw < given; ++draw) detail::append_bytes(way_, given_[draw]);
  for (std::size_t draw = 0; given_left_ == 0 && draw < depth_; ++draw) detail::append_bytes(way_, choices_[draw].taken);
  return chain_.entry(way_);
}

std::string* Enumerator::arrive(std::uint32_t loop, std::uint32_t entry) {
  ++events_;
  if (next_stop_ < stops_.size()) {
    const LoopChain::Stop& stop = stops_[next_stop_];
    if (stop.events == events_) {
      ++next_stop_;
      at_ = stop.head;
      draws_at_ = stop.draws;
      events_at_ = events_;
      has_number_since_ = false;
      if (!is_listing_ && stop.head == from_ && chain_.is_endless(from_)) leave_endless(loop);
    }
    return nullptr;
  }
  key_.clear();
  detail::append_bytes(key_, loop);
  detail::append_bytes(key_, entry);
  if (!write_numbers(key_)) return nullptr;
  has_arrived_ = true;
  return is_cutting_ ? &key_ : nullptr;
}

void Enumerator::leave_endless(std::uint32_t loop) const {
  if (has_number_between_) throw NotEnumerable{"a loop may never end"};
  throw EndlessPath{loop};
}

void Enumerator::cut() {
  has_number_between_ = has_number_between_ || has_number_since_;
  if (is_listing_) {
    List<int> choices;
    for (std::size_t draw = 0; draw < depth_; ++draw) choices.push_back(choices_[draw].taken);
    const LoopChain::Number head = chain_.find_or_add(key_, from_, std::move(choices), events_);
    chain_.add_edge(head, probability_);
  }
  throw CutPath{};
}

bool Enumerator::advance() {
  choices_.resize(depth_);
  while (!choices_.empty() && choices_.back().following < 0) choices_.pop_back();
  if (choices_.empty()) return false;
  choices_.back().taken = choices_.back().following;
  return true;
}

namespace detail {
inline constexpr auto is_less_likely = [](const auto& left, const auto& right) { return left.weight < right.weight; };
}  // namespace detail

void Enumerator::put_off() {
  constexpr double negligible = negligible_paths * 1e-6;
  for (std::size_t depth = shared_; depth < depth_; ++depth) {
    const Choice& choice = choices_[depth];
    if (choice.following != none && choice.following_weight > negligible) {
      begun_.push_back({choice.following_weight, last_, choice.following, choice.first});
      std::push_heap(begun_.begin(), begun_.end(), detail::is_less_likely);
      waiting_ += choice.following_weight;
    } else if (choice.following != none) {
      dropped_ += choice.following_weight;
    }
    nodes_.push_back({last_, choice.taken, choice.first});
    last_ = nodes_.size() - 1;
  }
}

void Enumerator::take_likeliest() {
  std::pop_heap(begun_.begin(), begun_.end(), detail::is_less_likely);
  const Begun begun = begun_.back();
  begun_.pop_back();
  waiting_ = std::max(waiting_ - begun.weight, 0.0);
  if (begun_.empty()) waiting_ = 0;
  choices_.clear();
  choices_.push_back({begun.taken, none, begun.first, 0});
  for (std::uint32_t node = begun.before; node != no_node; node = nodes_[node].before) {
    choices_.push_back({nodes_[node].taken, none, nodes_[node].first, 0});
  }
  std::reverse(choices_.begin(), choices_.end());
  shared_ = choices_.size() - 1;
  last_ = begun.before;
}

}  // namespace aos
