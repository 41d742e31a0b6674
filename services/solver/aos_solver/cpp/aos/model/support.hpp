// The definitions of the functions that model_support.hpp declares and models call. Exactly one source of a
// program includes this file; in an executable it is the engine's.
#pragma once

#include <sstream>

#include "aos/base/fault.hpp"
#include "aos/base/reward_ledger.hpp"
#include "aos/draws/distribution_functions.hpp"
#include "aos/draws/draw_sources.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/model/containers.hpp"
#include "aos/model/endless_steps.hpp"
#include "aos/model/grounding.hpp"
#include "aos/model/named_array.hpp"
#include "aos/model/reporting.hpp"
#include "aos/model/rollout.hpp"
#include "aos/model/text.hpp"
#include "aos/model/transition.hpp"
#include "aos/model/value_text.hpp"
#include "aos/text/utf8.hpp"

namespace aos {

// Document code may catch what a std::vector throws.
struct OutOfRange : ModelFault, std::out_of_range {
  explicit OutOfRange(const std::string& text) : ModelFault{"AOS215", text}, std::out_of_range{text} {}
};
void out_of_range(std::ptrdiff_t index, std::size_t size) {
  throw OutOfRange{"element " + std::to_string(index) + " of a vector of " + std::to_string(size)};
}
void no_such_key(std::size_t size) {
  throw OutOfRange{"a map of " + std::to_string(size) + " keys has no such key"};
}
void over_capacity(std::size_t size, std::size_t max) {
  const std::string holds = "; its state variable holds " + std::to_string(max);
  const std::string hint = ". The default of the variable may say how many: `state.NAME.reserve(500);`";
  throw ModelFault{"AOS215", "a vector of " + std::to_string(size) + " elements" + holds + hint};
}
void wrong_length(std::size_t given, std::size_t size) {
  throw ModelFault{"AOS215", "a list of " + std::to_string(given) + " for an array over an enum of " + std::to_string(size) + " values"};
}
void bad_weights(const char* text) { throw ModelFault{"AOS215", text}; }
void bad_distribution(const char* text) { throw ModelFault{"AOS215", text}; }
void reported_twice(NumberKey key) {
  const std::string element = "element " + std::to_string(index_of_number(key));
  throw ModelFault{"AOS215", "a number of __observed is reported twice in one step (" + element + " if it is an array)"};
}
void no_such_element(std::ptrdiff_t index) {
  throw ModelFault{"AOS215", "__observed has no element " + std::to_string(index)};
}

void Text::no_character(std::ptrdiff_t index, std::size_t size) {
  throw ModelFault{"AOS215", "character " + std::to_string(index) + " of a text of " + std::to_string(size) + " characters"};
}
void Text::overflow(std::size_t size) {
  throw ModelFault{"AOS215", "a text of " + std::to_string(size) + " characters; a state variable of type string holds " +
                                 std::to_string(max_length)};
}

namespace detail {

void check_letters(std::string_view text) {
  const std::size_t byte = first_no_letter(text);
  if (byte == std::string_view::npos) return;
  throw ModelFault{"AOS215", "the response's text is no UTF-8 at its byte " + std::to_string(byte) +
                                 ", where a letter is cut or none is"};
}
void no_such_response(int response) {
  throw ModelFault{"AOS215", "__moduleResponse is " + std::to_string(response) + ", which is no response"};
}
void no_such_reward(double reward) {
  std::ostringstream text;
  text << "the reward is " << reward << ", and no number from " << -largest_reward << " to " << largest_reward;
  throw ModelFault{"AOS214", text.str()};
}

// Each thread has its own map, without a lock. Threads agree on the numbers, which depend on the texts alone.
std::unordered_map<Observation, std::string>& observed_texts() {
  thread_local std::unordered_map<Observation, std::string> texts;
  return texts;
}

}  // namespace detail

void let_paths_end() {
  try {
    throw;
  } catch (const CutPath&) {
    throw;
  } catch (const EndlessPath&) {
    throw;
  } catch (const LongLoop&) {
    throw;
  } catch (const NotEnumerable&) {
    throw;
  } catch (...) {
  }
}

void look_whether_it_ends(std::uint32_t loop, std::uint32_t rounds) {
  if (rounds > detail::rounds_before_a_look(loop)) throw LongLoop{loop};
}

std::uint32_t& detail::rounds_before_a_look(std::uint32_t loop) {
  thread_local std::unordered_map<std::uint32_t, std::uint32_t> rounds;
  return rounds.try_emplace(loop, long_loop).first->second;
}

EndlessSteps& endless_steps() {
  static EndlessSteps steps;
  return steps;
}
void EndlessSteps::add(std::uint32_t loop, AnyValue before) {
  const std::lock_guard guard{mutex_};
  Told& told = loops_[loop];
  if (told.steps++ == 0) told.state = leaves_text("state", before, {});
}

Observation text_observation(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char character : text) hash = (hash ^ static_cast<unsigned char>(character)) * 0x100000001b3u;
  auto number = static_cast<Observation>(hash | (std::uint64_t{1} << 63));
  if (number == default_observation) --number;
  if (number == no_observation) ++number;
  if (!remembers_texts) return number;
  // Most texts come again soon, so a small cache spares the map.
  thread_local std::array<Observation, 256> recent{};
  Observation& last = recent[static_cast<std::size_t>(number) % recent.size()];
  if (last != number) detail::observed_texts().try_emplace(last = number, text);
  return number;
}

std::string_view observation_text(Observation number) {
  const auto& texts = detail::observed_texts();
  const auto known = texts.find(number);
  return known == texts.end() ? std::string_view{} : std::string_view{known->second};
}

void RewardLedger::add(std::uint32_t place, double amount, const char* skill) {
  if (amount == 0) return;
  terms_.push_back({place, skill, amount});
  of_phase_ += amount;
}

double* memory_for_weights(std::size_t count) {
  thread_local std::vector<double> weights;
  weights.resize(count);
  return weights.data();
}

GroundedActions::GroundedActions() = default;
GroundedActions::~GroundedActions() = default;
void GroundedActions::clear() {
  actions.clear();
  words.clear();
}

void Groundings::add(std::initializer_list<Argument> arguments, const void* parameters) {
  ActionWords& words = all_.words.emplace_back();
  std::string list;
  for (const auto& [parameter, value] : arguments) {
    if (!list.empty()) list += ", ";
    ((list += parameter) += '=') += value;
    words.arguments.emplace_back(parameter, value);
  }
  words.name = list.empty() ? name_ : name_ + ("(" + list + ")");
  all_.actions.push_back({skill_, parameters, &words});
}

}  // namespace aos
