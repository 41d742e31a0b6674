#include "numbers/compact_model.hpp"

#include "aos/base/add_up.hpp"
#include "aos/base/progress.hpp"
#include "aos/draws/enumerator.hpp"
#include "numbers/observable_values.hpp"

namespace aos {

void CompactModel::add_row(List<Outcome>& outcomes, float reward) {
  constexpr double certain = 1 - 1e-9;
  std::ranges::sort(outcomes, {}, &Outcome::next);
  add_up_neighbours(outcomes, &Outcome::next, &Outcome::probability);
  const bool is_certain = outcomes.size() == 1 && outcomes[0].probability > certain;
  if (outcomes.size() > max_outcomes) throw NotEnumerable{"a step has too many outcomes"};
  row_.clear();
  row_.push_back(static_cast<std::uint32_t>(outcomes.size() << 1 | (is_certain ? 1 : 0)));
  for (const Outcome& outcome : outcomes) {
    row_.push_back(outcome.next);
    if (!is_certain) row_.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(outcome.probability)));
  }
  for (std::size_t at = first_.back(); at < words_.size(); at += length_at(at)) {
    if (!has_outcomes_of_row(at)) continue;
    if (rewards_[words_[at] >> outcome_bits] < reward) words_[at] = number_of_reward(reward) << outcome_bits | row_[0];
    return;
  }
  row_[0] |= number_of_reward(reward) << outcome_bits;
  words_.insert(words_.end(), row_.begin(), row_.end());
}

bool CompactModel::has_outcomes_of_row(std::size_t at) const {
  constexpr std::uint32_t kind = (1u << outcome_bits) - 1;
  return (words_[at] & kind) == row_[0] && std::equal(row_.begin() + 1, row_.end(), &words_[at] + 1);
}

std::uint32_t CompactModel::number_of_reward(float reward) {
  const auto [entry, is_new] = reward_numbers_.try_emplace(reward, static_cast<std::uint32_t>(rewards_.size()));
  if (is_new) rewards_.push_back(reward);
  if (rewards_.size() > max_rewards) throw NotEnumerable{"there are too many rewards"};
  return entry->second;
}

List<float> CompactModel::values(double discount, int horizon) const {
  const std::size_t count = first_.size();
  List<float> values(count, 0);
  for (int sweep = 0; sweep < horizon; ++sweep) {
    progress::tell("computing values of states", sweep, horizon);
    float change = 0;
    float scale = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t state = sweep % 2 == 0 ? count - 1 - i : i;
      const std::size_t last = state + 1 < count ? first_[state + 1] : words_.size();
      const float value = best_at(first_[state], last, static_cast<float>(discount), values);
      change = std::max(change, std::abs(value - values[state]));
      scale = std::max(scale, std::abs(value));
      values[state] = value;
    }
    if (change <= settled_share * scale) return values;
  }
  return {};
}

[[gnu::optimize("O3")]] float CompactModel::best_at(std::size_t first, std::size_t last, float discount, const List<float>& values) const {
  float best = -std::numeric_limits<float>::infinity();
  for (std::size_t at = first; at < last; at += length_at(at)) {
    float later = 0;
    if ((words_[at] & 1) != 0) {
      later = values[words_[at + 1]];
    } else {
      for (std::size_t i = at + 1; i < at + length_at(at); i += 2) later += std::bit_cast<float>(words_[i + 1]) * values[words_[i]];
    }
    best = std::max(best, rewards_[words_[at] >> outcome_bits] + discount * later);
  }
  return best;
}

}  // namespace aos
