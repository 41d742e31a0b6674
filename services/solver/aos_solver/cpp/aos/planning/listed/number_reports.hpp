// The reports of steps, by number. A report is a response with the distributions of the numbers observed with it.
//
// The robot observes less than a report: a draw from each distribution. number_cells.hpp makes observations of it.
#pragma once

#include <unordered_map>

#include "aos/base/mixed.hpp"
#include "aos/draws/described_distribution.hpp"
#include "aos/draws/distributions.hpp"
#include "aos/draws/observed_numbers.hpp"

namespace aos {

class NumberReports final : public NumberSink {
 public:
  // A number of a skill with one of the distributions that it is reported from.
  struct Part {
    std::uint32_t gauge;  // which number of which skill
    DescribedDistribution distribution;
  };
  struct Report {
    std::uint32_t response;
    List<std::uint32_t> parts;  // by gauge, ascending
  };

  void begin() override { taken_.clear(); }
  void take(NumberKey key, const Distribution& distribution) override {
    if (!is_full_) taken_.emplace_back(key, distribution.described());
  }
  bool write_taken(std::string& key) const override {
    const auto append = [&](const auto& value) { key.append(reinterpret_cast<const char*>(&value), sizeof value); };
    append(taken_.size());
    for (const auto& [number, distribution] : taken_) {
      append(number);
      append(distribution.kind);
      append(distribution.numbers.size());
      for (const double each : distribution.numbers) append(each);
    }
    return true;
  }

  // The number of the report of the step that began last, given the skill and the number of its response.
  std::uint32_t add(int skill, std::uint32_t response) {
    std::sort(taken_.begin(), taken_.end(), [](const auto& one, const auto& other) { return one.first < other.first; });
    Key key{response};
    for (std::size_t i = 0; i < taken_.size(); ++i) {
      if (i > 0 && taken_[i].first == taken_[i - 1].first) reported_twice(taken_[i].first);
      key.push_back(part_of(skill, taken_[i].first, taken_[i].second));
    }
    const auto [entry, is_new] = by_key_.try_emplace(std::move(key), static_cast<std::uint32_t>(reports_.size()));
    if (is_new) {
      reports_.push_back({response, {entry->first.begin() + 1, entry->first.end()}});
      const auto gauge_of = [&](std::uint32_t part) { return parts_[part].gauge; };
      std::ranges::sort(reports_.back().parts, {}, gauge_of);
      size_ += taken_.size();
      is_full_ = size_ > max_size;
    }
    return entry->second;
  }

  const List<Report>& reports() const { return reports_; }
  const List<Part>& parts() const { return parts_; }
  std::size_t gauges() const { return gauges_.size(); }
  // Whether there are too many reports to tell all of them apart.
  bool is_full() const { return is_full_; }

 private:
  using Key = List<std::uint64_t>;
  static constexpr std::size_t max_size = 2'000'000;  // of numbers in all reports

  std::uint64_t part_of(int skill, NumberKey number, DescribedDistribution& distribution) {
    const std::uint64_t name = std::uint64_t{static_cast<std::uint32_t>(skill)} << 32 | number;
    const std::uint32_t gauge = gauges_.try_emplace(name, static_cast<std::uint32_t>(gauges_.size())).first->second;
    Key key{gauge, static_cast<std::uint64_t>(distribution.kind)};
    for (const double each : distribution.numbers) key.push_back(std::bit_cast<std::uint64_t>(each));
    const auto [entry, is_new] = by_distribution_.try_emplace(std::move(key), parts_.size());
    if (is_new) parts_.push_back({gauge, std::move(distribution)});
    return entry->second;
  }

  List<std::pair<NumberKey, DescribedDistribution>> taken_;  // since the step began
  List<Report> reports_;
  List<Part> parts_;
  std::unordered_map<std::uint64_t, std::uint32_t> gauges_;
  std::unordered_map<Key, std::uint64_t, NumbersHash> by_distribution_;
  std::unordered_map<Key, std::uint32_t, NumbersHash> by_key_;
  std::size_t size_ = 0;
  bool is_full_ = false;
};

}
