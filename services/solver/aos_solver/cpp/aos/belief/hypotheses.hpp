// What is believed where skills ended and nobody observed what they did.
//
// Such a skill ran or did not. All such ends in a row of one skill have one cause: it ran every time, or never. So there
// is one belief for each combination of causes, with a weight, and each observation weighs them by Bayes' rule. An
// observed end of the skill closes its row: from then on, what its cause was makes no difference.
//
// Beside them is the cautious belief, in which nothing ran that was not observed. It is there from the first unobserved
// end on, until it is the belief itself again or observations refute it. An observation that the model excludes is no
// observed end for it: the remedy of the belief does not touch it.
#pragma once

#include <set>

#include "aos/base/mixed.hpp"
#include "aos/belief/belief_digest.hpp"
#include "aos/belief/posteriors.hpp"
#include "aos/belief/saved_history.hpp"
#include "aos/text/json.hpp"

namespace aos {

inline constexpr std::size_t max_hypotheses = 16;
inline constexpr std::size_t max_hypothetical_states = 4 * max_weighted_states;  // of all hypotheses together

template <class Model>
class Hypotheses {
 public:
  using Posteriors = aos::Posteriors<Model>;

  explicit Hypotheses(Belief<Model> belief) { all_.push_back({1, {}, std::move(belief)}); }

  // The mixture of all hypotheses.
  const Belief<Model>& belief() const { return mixture_ ? *mixture_ : all_.front().belief; }
  // The belief in which nothing ran that was not observed; null where that is the belief itself.
  const Belief<Model>* cautious() const { return cautious_ ? &*cautious_ : nullptr; }

  // `posterior_of(belief)` gives a belief and the logarithm of the observation's probability, as Posteriors have them.
  Posteriors posteriors(auto&& posterior_of) const {
    Posteriors found;
    for (const Hypothesis& hypothesis : all_) found.each.push_back(posterior_of(hypothesis.belief));
    if (cautious_) found.cautious = posterior_of(*cautious_);
    return found;
  }

  // The logarithm of the observation's probability.
  double log_probability(const Posteriors& found) const {
    if (found.hypotheses_are_empty()) return found.cautious->second;
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < all_.size(); ++i) {
      if (!found.each[i].first.particles().empty()) most = std::max(most, log_weight(i) + found.each[i].second);
    }
    double sum = 0;
    for (std::size_t i = 0; i < all_.size(); ++i) {
      if (!found.each[i].first.particles().empty()) sum += std::exp(log_weight(i) + found.each[i].second - most);
    }
    return most + std::log(sum);
  }

  // Whether the model excludes what was reported. A report that it excluded before tells nothing against the cautious
  // belief any more: it counts as excluded also where only the cautious belief excludes it.
  bool excludes(const Posteriors& found, const Report& report) const {
    return found.are_empty() || (found.cautious && !found.has_cautious() && discredited_.contains(report));
  }

  // Bayes' rule, for an observation that is possible. The cautious belief goes if it excludes the observation, or if the
  // observations since it began are less probable under it than `refuted_below` times their probability under the belief.
  // Where it is true, the latter happens with a probability of `refuted_below` at most (Ville's inequality).
  Hypotheses given(int skill, const Report& report, Posteriors found, double refuted_below) const {
    if (found.hypotheses_are_empty()) {
      Hypotheses after{std::move(found.cautious->first)};
      after.discredited_ = discredited_;
      return after;
    }
    const double total = log_probability(found);
    Hypotheses after = weighed(found, total, negligible_weight);
    after.close_row_of(skill);
    after.mix();
    if (cautious_) after.follow_cautiously(*cautious_, std::move(*found.cautious), total, refuted_below, discredited_.contains(report));
    return after;
  }

  // After a report that the model excludes: `belief` is the remedy.
  Hypotheses remedied(const Report& report, Belief<Model> belief) const {
    Hypotheses after{std::move(belief)};
    after.discredited_ = discredited_;
    after.discredited_.insert(report);
    after.log_ratio_ = log_ratio_;
    after.keep_cautious(cautious_ ? *cautious_ : this->belief());
    return after;
  }

  // After an observation that cannot be used, though the model may well explain it.
  Hypotheses unread(int action, Sampler& random) const {
    Hypotheses after = without_beliefs();
    for (const Hypothesis& each : all_) after.all_.push_back({each.weight, each.ran, each.belief.predicted(action, random)});
    after.close_row_of(Model::skill_of(action));
    after.mix();
    if (cautious_) after.keep_cautious(cautious_->predicted(action, random));
    return after;
  }

  // After the time of a step in which nothing was done: extrinsic changes alone.
  Hypotheses passed(Sampler& random) const {
    return changed([&](const Belief<Model>& belief) { return belief.predicted(no_action, random); });
  }

  // After an end that nobody observed, of an action that ran with this probability.
  Hypotheses unobserved(int action, double ran_probability, Sampler& random) const {
    Hypotheses after = without_beliefs();
    const int skill = Model::skill_of(action);
    const auto row = std::ranges::find(open_, skill);
    if (row != open_.end()) {
      for (const Hypothesis& each : all_) {
        const bool ran = each.ran[row - open_.begin()];
        after.all_.push_back({each.weight, each.ran, ran ? each.belief.predicted(action, random) : each.belief});
      }
    } else {
      after.open_.push_back(skill);
      bool makes_a_difference = false;
      for (const Hypothesis& each : all_) {
        Belief<Model> ran = each.belief.predicted(action, random);
        makes_a_difference = makes_a_difference || !are_alike(ran, each.belief);
        after.split(each, std::move(ran), ran_probability);
      }
      if (!makes_a_difference) return *this;
    }
    while (after.is_too_large()) after.close(0);
    after.mix();
    after.keep_cautious(cautious_ ? *cautious_ : belief());
    return after;
  }

  // At the start of the next mission: see Belief::begun.
  Hypotheses begun(int idle_steps, Sampler& random) const {
    return changed([&](const Belief<Model>& belief) { return belief.begun(idle_steps, random); });
  }

  // Given what somebody knows, which is possible: `found` are the posteriors by it. It closes no row. The cautious belief
  // goes as in `given`.
  Hypotheses known(Posteriors found, double refuted_below) const {
    const double total = log_probability(found);
    Hypotheses after = weighed(found, total, 0);
    after.mix();
    if (cautious_) after.follow_cautiously(*cautious_, std::move(*found.cautious), total, refuted_below, false);
    return after;
  }

  void write_summary(JsonWriter& json) const {
    json.begin_object();
    belief().write_members(json);
    json.member("digest", digest_text(digest()));
    if (cautious_) {
      cautious_->write_endings(json.key("cautious").begin_object());
      json.end_object();
    }
    json.end_object();
  }

  // How many of the newest observations in a row were impossible.
  int impossible_in_a_row() const { return impossible_in_a_row_; }
  void note_impossible(int in_a_row) { impossible_in_a_row_ = in_a_row; }

  // The digest of all that is believed: of each hypothesis with its weight, and of the cautious belief (belief_digest.hpp).
  std::uint64_t digest() const {
    std::uint64_t digest = all_.size();
    for (const Hypothesis& each : all_) {
      digest = mixed(mixed(digest, canonical_weight(each.weight)), belief_digest(each.belief));
      for (const bool ran : each.ran) digest = mixed(digest, ran ? 1 : 0);
    }
    return cautious_ ? mixed(digest, belief_digest(*cautious_)) : digest;
  }

  // The beliefs, the cautious one last, and all the rest as words, for `of`.
  List<const Belief<Model>*> beliefs() const {
    List<const Belief<Model>*> beliefs;
    for (const Hypothesis& each : all_) beliefs.push_back(&each.belief);
    if (cautious_) beliefs.push_back(&*cautious_);
    return beliefs;
  }
  Words words() const {
    Words words{cautious_ ? 1u : 0u, std::bit_cast<std::uint64_t>(log_ratio_), open_.size()};
    for (const int skill : open_) detail::add_text(words, Model::skill_name(skill));
    for (const Hypothesis& each : all_) {
      words.push_back(std::bit_cast<std::uint64_t>(each.weight));
      words.insert(words.end(), each.ran.begin(), each.ran.end());
    }
    words.push_back(discredited_.size());
    for (const auto& [skill, response] : discredited_) {
      detail::add_text(words, skill);
      detail::add_text(words, response);
    }
    words.push_back(impossible_in_a_row_);
    return words;
  }
  // Takes over what `beliefs` and `words` gave, in a model that may have other skills. There is at least one belief.
  // Without words the first one is the belief.
  static Hypotheses of(List<Belief<Model>> beliefs, const Words& words) {
    if (words.empty()) return Hypotheses{std::move(beliefs.front())};
    Hypotheses taken;
    detail::WordReader reader{words};
    const bool has_cautious = reader.next() != 0 && beliefs.size() > 1;
    taken.log_ratio_ = reader.real();
    for (std::size_t rows = std::min<std::size_t>(reader.next(), reader.left()); rows > 0; --rows) {
      taken.open_.push_back(skill_of_name(reader.text()));
    }
    const std::size_t count = beliefs.size() - (has_cautious ? 1 : 0);
    for (std::size_t i = 0; i < count; ++i) {
      Hypothesis each{reader.real(), {}, std::move(beliefs[i])};
      for (std::size_t row = 0; row < taken.open_.size(); ++row) each.ran.push_back(reader.next() != 0);
      taken.all_.push_back(std::move(each));
    }
    for (std::size_t left = reader.next(); left > 0 && reader.left() > 0; --left) {
      std::string skill = reader.text();
      taken.discredited_.emplace(std::move(skill), reader.text());
    }
    taken.impossible_in_a_row_ = static_cast<int>(reader.next());
    for (std::size_t row = taken.open_.size(); row-- > 0;) {
      if (taken.open_[row] < 0) taken.close(static_cast<std::ptrdiff_t>(row));
    }
    taken.mix();
    if (has_cautious) taken.cautious_ = std::move(beliefs.back());
    return taken;
  }

 private:
  struct Hypothesis {
    double weight;
    std::vector<bool> ran;  // for each row that is open
    Belief<Model> belief;
  };

  Hypotheses() = default;

  // What is known beside the beliefs.
  Hypotheses without_beliefs() const {
    Hypotheses after;
    after.discredited_ = discredited_;
    after.log_ratio_ = log_ratio_;
    after.open_ = open_;
    return after;
  }

  // After what changes each belief and tells nothing.
  Hypotheses changed(auto&& change) const {
    Hypotheses after = *this;
    for (Hypothesis& each : after.all_) each.belief = change(each.belief);
    after.mix();
    after.cautious_.reset();
    if (cautious_) after.keep_cautious(change(*cautious_));
    return after;
  }
  // The hypotheses after what was found, without those of less weight than `least`.
  Hypotheses weighed(Posteriors& found, double log_total, double least) const {
    Hypotheses after = without_beliefs();
    for (std::size_t i = 0; i < all_.size(); ++i) {
      auto& [posterior, log_likelihood] = found.each[i];
      const double weight = all_.size() == 1 ? 1 : std::exp(log_weight(i) + log_likelihood - log_total);
      if (!posterior.particles().empty() && weight >= least) after.all_.push_back({weight, all_[i].ran, std::move(posterior)});
    }
    return after;
  }

  double log_weight(std::size_t number) const { return std::log(all_[number].weight); }

  bool is_too_large() const {
    std::size_t states = 0;
    for (const Hypothesis& each : all_) states += each.belief.particles().size();
    return all_.size() > max_hypotheses || (states > max_hypothetical_states && all_.size() > 1);
  }

  // Adds the two hypotheses that a new row makes of one.
  void split(const Hypothesis& before, Belief<Model> ran, double ran_probability) {
    const auto add = [&](bool has_run, double probability, Belief<Model> belief) {
      if (probability <= 0) return;
      all_.push_back({before.weight * probability, before.ran, std::move(belief)});
      all_.back().ran.push_back(has_run);
    };
    add(true, ran_probability, std::move(ran));
    add(false, 1 - ran_probability, before.belief);
  }

  void close_row_of(int skill) {
    const auto row = std::ranges::find(open_, skill);
    if (row != open_.end()) close(row - open_.begin());
  }

  // Closes a row: hypotheses that differ in its cause alone become one.
  void close(std::ptrdiff_t row) {
    open_.erase(open_.begin() + row);
    List<Hypothesis> merged;
    for (Hypothesis& each : all_) {
      each.ran.erase(each.ran.begin() + row);
      const auto same = std::ranges::find(merged, each.ran, &Hypothesis::ran);
      if (same == merged.end()) {
        merged.push_back(std::move(each));
      } else {
        same->weight += each.weight;
        same->belief = same->belief.mixed_with(each.belief, each.weight / same->weight);
      }
    }
    all_ = std::move(merged);
  }

  void mix() {
    mixture_.reset();
    if (all_.size() < 2) return;
    mixture_ = all_.front().belief;
    double weight = all_.front().weight;
    for (std::size_t i = 1; i < all_.size(); ++i) {
      weight += all_[i].weight;
      mixture_ = mixture_->mixed_with(all_[i].belief, all_[i].weight / weight);
    }
  }

  void keep_cautious(Belief<Model> cautious) {
    if (!are_alike(cautious, belief())) cautious_ = std::move(cautious);
  }

  void follow_cautiously(const Belief<Model>& before, typename Posteriors::One found, double log_probability, double refuted_below,
                         bool is_discredited) {
    auto& [posterior, log_likelihood] = found;
    const bool is_possible = !posterior.particles().empty();
    if (is_discredited && !is_possible) return keep_cautious(before);
    const double change = log_likelihood - log_probability;
    if (is_possible) log_ratio_ += is_discredited ? std::max(change, 0.0) : change;
    if (is_possible && log_ratio_ >= std::log(refuted_below)) return keep_cautious(std::move(posterior));
    log_ratio_ = 0;
  }

  static int skill_of_name(const std::string& name) {
    for (int skill = 0; skill < Model::skill_count; ++skill) {
      if (name == Model::skill_name(skill)) return skill;
    }
    return -1;
  }

  List<Hypothesis> all_;
  List<int> open_;  // the skills whose rows of unobserved ends are open, the oldest first
  std::optional<Belief<Model>> mixture_;
  std::optional<Belief<Model>> cautious_;
  // Of all observations since the cautious belief began: log P under it - log P under the belief. It goes on while the
  // two are the same, so that the inequality holds for the mission and not for each time.
  double log_ratio_ = 0;
  std::set<Report> discredited_;
  int impossible_in_a_row_ = 0;
};

}
