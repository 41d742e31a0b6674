// The history and the traces of a drawn belief as words, for an engine that takes the belief over.
//
// That engine checks them: each trace must lead to the state of its particle and give what was observed. If one does
// not, because the documents have changed, the belief is taken over alone, and a new history begins with it.
#pragma once

#include "aos/belief/belief.hpp"
#include "aos/belief/history.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/draws/replay.hpp"

namespace aos {

using Words = List<std::uint64_t>;

inline constexpr std::size_t max_history_words = std::size_t{1} << 20;

namespace detail {

inline void add_text(Words& words, std::string_view text) {
  words.push_back(text.size());
  const std::size_t first = words.size();
  words.resize(first + (text.size() + 7) / 8);
  std::memcpy(words.data() + first, text.data(), text.size());
}

// Reads words; 0 after the end.
class WordReader {
 public:
  explicit WordReader(const Words& words) : words_(words) {}
  std::uint64_t next() { return next_ < words_.size() ? words_[next_++] : 0; }
  double real() { return std::bit_cast<double>(next()); }
  std::string text() {
    const std::size_t size = next();
    if (size > 8 * left()) return {};
    std::string text(size, '\0');
    std::memcpy(text.data(), words_.data() + next_, size);
    next_ += (size + 7) / 8;
    return text;
  }
  std::size_t left() const { return words_.size() - next_; }

 private:
  const Words& words_;
  std::size_t next_ = 0;
};

inline void add_step(Words& words, const HistoryStep& step) {
  words.push_back(step.action);
  words.push_back(step.observation);
  words.push_back((step.is_observed ? 1 : 0) | (step.is_guided ? 2 : 0) | (step.guides_numbers ? 4 : 0));
  words.push_back(step.by_chance);
  add_text(words, observation_text(step.observation));
  words.push_back(std::bit_cast<std::uint64_t>(step.log_scale));
  words.push_back(step.numbers == nullptr ? 0 : step.numbers->size() + 1);
  if (step.numbers == nullptr) return;
  for (const auto& [key, value] : *step.numbers) {
    words.push_back(key);
    words.push_back(std::bit_cast<std::uint64_t>(value));
  }
}

// The step, and the text of what was observed, which each process numbers by itself.
inline std::pair<HistoryStep, std::string> next_step(WordReader& reader) {
  HistoryStep step{.action = static_cast<int>(reader.next())};
  step.observation = static_cast<Observation>(reader.next());
  const std::uint64_t flags = reader.next();
  step.is_observed = (flags & 1) != 0;
  step.is_guided = (flags & 2) != 0;
  step.guides_numbers = (flags & 4) != 0;
  step.by_chance = static_cast<std::uint32_t>(reader.next());
  std::string text = reader.text();
  step.log_scale = reader.real();
  if (const std::size_t count = reader.next(); count > 0) {
    ObservedNumbers numbers;
    for (std::size_t i = 1; i < count && reader.left() > 0; ++i) {
      const auto key = static_cast<NumberKey>(reader.next());
      numbers.add(key, reader.real());
    }
    step.numbers = std::make_shared<const ObservedNumbers>(std::move(numbers));
  }
  return {std::move(step), std::move(text)};
}

}  // namespace detail

// Empty if there is no history from the documents' initial belief on, or if it has too many words.
template <class Model>
Words saved_history(const Belief<Model>& belief) {
  Words words;
  if (!belief.has_traces() || !belief.history().begins_with_the_documents()) return words;
  words.push_back(belief.history().steps().size());
  for (const HistoryStep& step : belief.history().steps()) detail::add_step(words, step);
  for (const Lineage& lineage : belief.lineages()) {
    words.push_back(std::bit_cast<std::uint64_t>(lineage.squares));
    for (const Block* block : blocks_of(lineage.trace)) {
      words.push_back(block->seed);
      words.push_back(std::bit_cast<std::uint64_t>(block->likelihood));
      words.push_back(block->draws);
      words.push_back(block->values.size());
      for (const double value : block->values) words.push_back(std::bit_cast<std::uint64_t>(value));
    }
    if (words.size() > max_history_words) return {};
  }
  return words;
}

// The particles, with their lineages and their history if the words fit this model.
template <class Model>
Cloud<Model> with_history(List<Particle<Model>> particles, const Words& words) {
  Cloud<Model> alone{std::move(particles), {}, {}};
  if (words.empty()) return alone;
  detail::WordReader reader{words};
  Cloud<Model> cloud = alone;
  for (std::size_t steps = reader.next(); steps > 0 && reader.left() > 0; --steps) {
    const auto [step, text] = detail::next_step(reader);
    if (!text.empty() && text_observation(text) != step.observation) return alone;
    const int count = is_monitor(step.action) ? first_monitor + Model::monitor_count() : Model::action_count();
    if (step.action < no_action || step.action >= count) return alone;
    cloud.history.add(step);
  }
  Replay replay;
  for (const auto& particle : cloud.particles) {
    Lineage lineage{reader.real(), nullptr};
    typename Model::State state{};
    for (std::size_t place = 0; place <= cloud.history.steps().size(); ++place) {
      Block block;
      block.seed = reader.next();
      block.likelihood = reader.real();
      block.draws = static_cast<std::uint32_t>(reader.next());
      const std::size_t count = reader.next();
      if (count > reader.left()) return alone;
      for (std::size_t i = 0; i < count; ++i) block.values.push_back(reader.real());
      Sampler later{block.seed};
      replay.start(block.values, later);
      if (place == 0) {
        cloud.history.originate(state, replay);
      } else {
        const HistoryStep& step = cloud.history.steps()[place - 1];
        if (!step.agrees(Model::step(state, step.action, replay))) return alone;
      }
      lineage.trace = place == 0 ? begun_trace(std::move(block)) : longer(std::move(lineage.trace), std::move(block));
    }
    if (!(state == particle.state)) return alone;
    cloud.lineages.push_back(std::move(lineage));
  }
  return cloud;
}

}  // namespace aos
