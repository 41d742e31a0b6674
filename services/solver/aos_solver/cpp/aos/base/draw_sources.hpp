// The functions of the sources of draws that are not compiled with every model. Included by support.hpp alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "aos/base/enumerator.hpp"
#include "aos/base/random.hpp"

namespace aos {

namespace detail {

// The first outcome at or after `from` that can happen; -1 if there is none.
inline int next_outcome(const double* weights, int count, int from) {
  for (int i = from; i < count; ++i) {
    if (weights[i] > 0) return i;
  }
  return -1;
}

template <class Source>
inline constexpr AnySource::Functions functions_of{
    .flag = [](void* source, double probability) { return static_cast<Source*>(source)->flag(probability); },
    .choose =
        [](void* source, const double* weights, int count, double total) {
          return static_cast<Source*>(source)->choose(weights, count, total);
        },
    .uniform = [](void* source) { return static_cast<Source*>(source)->uniform(); },
    .report =
        [](void* source, std::uint32_t key, const Distribution& distribution) {
          static_cast<Source*>(source)->report(key, distribution);
        },
};

}  // namespace detail

AnySource::AnySource(Sampler& sampler) : source_(&sampler), functions_(detail::functions_of<Sampler>) {}
AnySource::AnySource(Enumerator& enumerator) : source_(&enumerator), functions_(detail::functions_of<Enumerator>) {}

int Enumerator::choose(const double* weights, int count, double total) {
  if (depth_ < by_chance_) return choose_by_chance(weights, count, total);
  if (depth_ == choices_.size()) choices_.push_back({detail::next_outcome(weights, count, 0), 0, 0});
  Choice& choice = choices_[depth_++];
  choice.following = detail::next_outcome(weights, count, choice.taken + 1);
  probability_ *= weights[choice.taken] / total;
  return choice.taken;
}

int Enumerator::choose_by_chance(const double* weights, int count, double total) {
  if (depth_ == choices_.size()) {
    int alternatives = 0;
    for (int i = 0; i < count; ++i) alternatives += weights[i] > 0 ? 1 : 0;
    choices_.push_back({chance_->choose(weights, count, total), none, alternatives});
  }
  return choices_[depth_++].taken;
}

double Enumerator::uniform() {
  if (chance_ == nullptr) throw NotEnumerable{"a draw is continuous"};
  if (depth_ == choices_.size()) choices_.push_back({0, none, no_alternatives, chance_->uniform()});
  return choices_[depth_++].value;
}

void Enumerator::report(std::uint32_t key, const Distribution& distribution) {
  if (sink_ == nullptr) throw NotEnumerable{numbers_are_observed};
  sink_->take(key, distribution);
}

double Enumerator::combinations() const {
  double product = 1;
  for (const Choice& choice : choices_) {
    if (choice.alternatives == no_alternatives) return std::numeric_limits<double>::infinity();
    product *= choice.alternatives;
  }
  return product;
}

std::size_t Enumerator::draws_before_last(int most) const {
  std::size_t first = choices_.size();
  for (long combinations = 1; first > 0; --first) {
    const int alternatives = choices_[first - 1].alternatives;
    if (alternatives == no_alternatives || (combinations *= alternatives) > most) break;
  }
  return first;
}

void Enumerator::start(Sampler* chance, std::size_t by_chance) {
  chance_ = chance;
  by_chance_ = by_chance;
  choices_.clear();
}

void Enumerator::keep(std::size_t choices) {
  if (choices_.size() > choices) choices_.resize(choices);
  by_chance_ = all_draws;
}

bool Enumerator::advance() {
  choices_.resize(depth_);
  while (!choices_.empty() && choices_.back().following < 0) choices_.pop_back();
  if (choices_.empty()) return false;
  choices_.back().taken = choices_.back().following;
  return true;
}

}  // namespace aos
