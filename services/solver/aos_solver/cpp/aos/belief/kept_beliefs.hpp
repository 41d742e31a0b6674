// Beliefs that outlive a process, in a file that its parent holds open. Each change of what is believed has a
// number, which the parent gives: it counts the changes that it was told of. The file has room for the state after two changes: if
// a process ends during a change, the state before the change is whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "aos/base/descriptor_file.hpp"
#include "aos/belief/belief.hpp"
#include "aos/belief/hypotheses.hpp"
#include "aos/belief/saved_history.hpp"

namespace aos {

template <class Model>
class KeptBeliefs {
 public:
  // A negative descriptor keeps nothing.
  explicit KeptBeliefs(int descriptor) : file_(descriptor) {}

  // Gives the next change its number, which is one more than that of the change before.
  void number_next(std::uint64_t change) { change_ = change; }

  // Keeps what is believed after that change. A file without room for it keeps nothing.
  void keep(const Hypotheses<Model>& hypotheses) {
    if (!file_.is_open()) return;
    const auto beliefs = hypotheses.beliefs();
    const Words words = hypotheses.words();
    put_head({});
    put(words.data(), words.size() * sizeof(Words::value_type));
    for (const Belief<Model>* belief : beliefs) put_belief(*belief);
    if (file_.flush()) put_head({change_, beliefs.size(), words.size()});
    file_.flush();
  }

  // What was believed after this change; nothing if that was not kept.
  std::optional<Hypotheses<Model>> restore(std::uint64_t change) {
    change_ = change;
    Head head{};
    file_.seek(begin());
    get(&head, sizeof head);
    if (!file_.is_good() || head.change != change || head.beliefs == 0) return std::nullopt;
    Words words(head.words);
    get(words.data(), words.size() * sizeof(Words::value_type));
    std::vector<Belief<Model>> beliefs;
    while (file_.is_good() && beliefs.size() < head.beliefs) beliefs.push_back(next_belief());
    if (!file_.is_good()) return std::nullopt;
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

  // The two places are far apart; the file takes memory only for what is written. It is limited to twice this, as
  // engine_child.py knows.
  off_t begin() const { return static_cast<off_t>(change_ % 2) << 32; }

  // The seek writes what was put before, so that the file has the same order.
  void put_head(const Head& head) {
    file_.seek(begin());
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
    std::vector<Particle> particles(file_.is_good() ? head.particles : 0);
    Words history(file_.is_good() ? head.history_words : 0);
    for (Particle& particle : particles) {
      get(&particle.weight, sizeof particle.weight);
      get(Model::bytes_of(particle.state), Model::state_bytes());
    }
    get(history.data(), history.size() * sizeof(Words::value_type));
    return Belief<Model>::of(with_history<Model>(std::move(particles), history), head.error_bound, head.is_drawn);
  }
  void put(const void* from, std::size_t count) { file_.write(from, count); }
  void get(void* to, std::size_t count) { file_.read(to, count); }

  DescriptorFile file_;
  std::uint64_t change_ = 0;
};

}  // namespace aos
