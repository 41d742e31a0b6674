// Observations by number. If skills share the name of a response, it is the same observation to the robot.
#pragma once

#include <unordered_map>

#include "aos/base/list.hpp"
#include "aos/model/step.hpp"

namespace aos {

template <class Model>
class ObservationNumbers {
 public:
  ObservationNumbers() : of_responses_(static_cast<std::size_t>(Model::skill_count)) {}

  // The number of a skill's observation, which is `size()` if the observation is new.
  std::uint32_t add(int skill, Observation observation) {
    if (observation < 0) return known(of_others_.try_emplace(observation, unknown).first->second, skill, observation);
    auto& numbers = of_responses_[static_cast<std::size_t>(skill)];
    numbers.resize(static_cast<std::size_t>(Model::response_count(skill)), unknown);
    return known(numbers[static_cast<std::size_t>(observation)], skill, observation);
  }

  // The skill's observation with this number.
  Observation of(int skill, std::uint32_t number) const {
    const auto& responses = of_responses_[static_cast<std::size_t>(skill)];
    const auto response = std::find(responses.begin(), responses.end(), number);
    if (response != responses.end()) return response - responses.begin();
    const auto is_it = [&](const auto& other) { return other.second == number; };
    return std::find_if(of_others_.begin(), of_others_.end(), is_it)->first;
  }

  std::size_t size() const { return texts_.size(); }
  const std::string& operator[](std::uint32_t number) const { return texts_[number]; }
  const List<std::string>& texts() const { return texts_; }

 private:
  static constexpr std::uint32_t unknown = 0xffffffffu;

  std::uint32_t known(std::uint32_t& number, int skill, Observation observation) {
    if (number != unknown) return number;
    const auto next = static_cast<std::uint32_t>(texts_.size());
    const auto [named, is_new] = by_text_.try_emplace(name_of_observation<Model>(skill, observation), next);
    if (is_new) texts_.push_back(named->first);
    return number = named->second;
  }

  List<List<std::uint32_t>> of_responses_;      // by skill
  std::unordered_map<Observation, std::uint32_t> of_others_;  // texts, and no response
  std::unordered_map<std::string, std::uint32_t> by_text_;
  List<std::string> texts_;
};

}
