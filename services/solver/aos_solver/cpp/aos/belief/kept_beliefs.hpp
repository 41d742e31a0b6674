// Beliefs that outlive a process, in a file that its parent holds open. Each change of what is believed has a
// number, and the parent counts the changes that it was told of. The file has room for the state after two changes: if
// a process ends during a change, the state before the change is whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <optional>
#include <utility>
#include <vector>

#include "aos/belief/belief.hpp"
#include "aos/belief/hypotheses.hpp"
#include "aos/belief/saved_history.hpp"

namespace aos {

template <class Model>
class KeptBeliefs {
 public:
  // An empty path keeps nothing.
  explicit KeptBeliefs(const char* path) : file_(path, std::ios::in | std::ios::out | std::ios::binary) {}

  // Keeps what is believed after one more change. A file without room for it keeps nothing.
  void keep(const Hypotheses<Model>& hypotheses) {
    ++changes_;
    if (!file_.is_open()) return;
    const auto beliefs = hypotheses.beliefs();
    const Words words = hypotheses.words();
    file_.clear();
    put_head({});
    put(words.data(), words.size() * sizeof(Words::value_type));
    for (const Belief<Model>* belief : beliefs) put_belief(*belief);
    if (file_.flush()) put_head({changes_, beliefs.size(), words.size()});
    file_.flush();
  }

  // What was believed after this change, from which counting goes on; nothing if that was not kept.
  std::optional<Hypotheses<Model>> restore(std::uint64_t change) {
    changes_ = change;
    Head head{};
    file_.clear();
    file_.seekg(begin());
    get(&head, sizeof head);
    if (!file_ || head.change != change || head.beliefs == 0) return std::nullopt;
    Words words(head.words);
    get(words.data(), words.size() * sizeof(Words::value_type));
    std::vector<Belief<Model>> beliefs;
    while (file_ && beliefs.size() < head.beliefs) beliefs.push_back(next_belief());
    if (!file_) return std::nullopt;
    return Hypotheses<Model>::of(std::move(beliefs), words);
  }

 private:
  using Particle = aos::Particle<Model>;

  struct Head {
    std::uint64_t change;
    std::uint64_t beliefs;
    std::uint64_t words;
  };
  struct BeliefHead {
    std::uint64_t particles;
    std::uint64_t history_words;
    double error_bound;
    bool is_drawn;
  };

  // The two places are far apart; the file takes memory only for what is written.
  std::streamoff begin() const { return static_cast<std::streamoff>(changes_ % 2) << 36; }

  // The seek writes what was put before, so that the file has the same order.
  void put_head(const Head& head) {
    file_.seekp(begin());
    put(&head, sizeof head);
  }
  void put_belief(const Belief<Model>& belief) {
    const auto& particles = belief.particles();
    const Words history = saved_history(belief);
    const BeliefHead head{particles.size(), history.size(), belief.error_bound(), belief.is_drawn()};
    put(&head, sizeof head);
    for (const Particle& particle : particles) {
      put(&particle.weight, sizeof particle.weight);
      put(Model::bytes_of(particle.state), Model::state_bytes());
    }
    put(history.data(), history.size() * sizeof(Words::value_type));
  }
  Belief<Model> next_belief() {
    BeliefHead head{};
    get(&head, sizeof head);
    std::vector<Particle> particles(file_ ? head.particles : 0);
    Words history(file_ ? head.history_words : 0);
    for (Particle& particle : particles) {
      get(&particle.weight, sizeof particle.weight);
      get(Model::bytes_of(particle.state), Model::state_bytes());
    }
    get(history.data(), history.size() * sizeof(Words::value_type));
    return Belief<Model>::of(with_history<Model>(std::move(particles), history), head.error_bound, head.is_drawn);
  }
  void put(const void* from, std::size_t count) {
    file_.write(static_cast<const char*>(from), static_cast<std::streamsize>(count));
  }
  void get(void* to, std::size_t count) { file_.read(static_cast<char*>(to), static_cast<std::streamsize>(count)); }

  std::fstream file_;
  std::uint64_t changes_ = 0;
};

}  // namespace aos
