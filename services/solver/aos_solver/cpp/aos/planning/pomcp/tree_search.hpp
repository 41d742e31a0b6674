// POMCP's simulations (Silver and Veness, 2010) in the tree of one thread. Read this file from `simulate` down.
//
// A simulation goes down from the root by upper confidence bounds (`choose`). The first new history is valued by a rollout or by
// values of states (`SimulatedState::leaf`), and the return is backed up along the path (`back_up`). Files that are called give
// the reasons for departures from the paper. Letters: n visits, q value of an action, v value of a history.
#pragma once

#include "aos/base/switches.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/pomcp/best_action.hpp"
#include "aos/planning/pomcp/exploration.hpp"
#include "aos/planning/pomcp/observation_cells.hpp"
#include "aos/planning/pomcp/observation_doubts.hpp"
#include "aos/planning/pomcp/pomcp_constants.hpp"
#include "aos/planning/pomcp/root_record.hpp"
#include "aos/planning/pomcp/search_tree.hpp"
#include "aos/planning/values/few_outcomes.hpp"

namespace aos {

template <class Model>
class TreeSearch {
 public:
  // The tree takes at most `bytes`, with a copy of what is kept of it after a step.
  explicit TreeSearch(std::size_t bytes)
      : tree_(Model::action_count(), bytes / 2), spare_(Model::action_count(), bytes / 2) {
    forget();
  }

  // Begins a decision. `prior` is how much less each action is worth than the best one; empty if nothing is
  // known before the search. With `first_state_tells`, the first state of a history tells what its actions are worth.
  // The `barred` actions are not tried at the root. A step of the model costs `step_cost`, and
  // what an action is worth in a state `worth_cost`. At a `price` for each nat, actions count by what they tell, too.
  void begin(int horizon, const List<double>& prior, bool first_state_tells, const BarredActions& barred,
             Operations step_cost, Operations worth_cost, double price) {
    step_cost_ = step_cost + (reports_numbers_ ? per_numbers : 0);
    worth_cost_ = worth_cost;
    price_ = price;
    horizon_ = horizon;
    barred_ = barred;
    prior_ = prior;
    first_state_tells_ = first_state_tells;
    record_ = RootRecord{action_count()};
    work_ = 0;
  }

  // The work of all simulations since `begin`, without that of rollouts.
  Operations work() const { return work_; }

  // Runs one simulation from a running state (simulated_state.hpp), which the simulation changes. `first` is
  // the first action; -1 leaves the choice to the search.
  template <class SimulatedState>
  void simulate(SimulatedState& state, int first, Sampler& random) {
    if (!give_actions(0, state, random)) return;
    const HistoryNode& root = tree_.history(0);
    spread_.count(tree_.actions(root)[root.best]);
    if (first < 0) first = turn();
    work_ += per_descent;
    const double seen = descend(state, first < 0 ? choose(0) : static_cast<std::uint32_t>(first), random);
    record_.add_return(seen);
    spread_.add(seen);
  }

  // What is known about a root action: its value, its simulations, and the variance of one simulation. Values
  // are relative to those of the states, if these are known.
  struct Known {
    double q = 0;
    std::uint32_t n = 0;
    double variance = 0;
    double reward = 0;  // mean immediate reward in this decision's simulations
  };
  Known known(int action) const {
    if (!has_actions()) return {};
    const ActionNode& node = tree_.actions(tree_.history(0))[action];
    const double variance = node.n > 1 ? std::max(node.squares / (node.n - 1), 0.0) : 0;
    return {node.n > 0 ? node.q : 0, node.n, variance, record_.mean_reward(action)};
  }
  std::uint32_t known_simulations() const { return tree_.history(0).n; }
  // The discounted probability that a mission that begins with a root action comes to where the tree ends, if it goes on
  // by the best actions; 1 before the first visit.
  double beyond(int action) const {
    return has_actions() ? beyond_action(tree_.actions(tree_.history(0))[action]) : 1;
  }
  // Whether `more` simulations could not change the choice.
  bool is_decided(double more) const {
    const HistoryNode& root = tree_.history(0);
    return has_actions() && record_.is_decided(root, tree_.actions(root), barred_, more);
  }

  // Keeps the part of the tree below an action and an observation. Nothing is kept if these were never
  // simulated, or if numbers were observed: a cell says less than its numbers.
  void move_to(int action, Observation observation) {
    if (!switches::kept_tree || reports_numbers_ || !has_actions()) return forget();
    const std::uint32_t taken = tree_.history(0).first_action + static_cast<std::uint32_t>(action);
    const std::uint32_t kept = tree_.find_child(taken, observation);
    if (kept == no_node) return forget();
    spare_.copy_subtree(tree_, kept);
    std::swap(tree_, spare_);
    spare_.clear();
    spread_ = {};
  }
  void forget() {
    tree_.clear();
    cells_.clear();
    spread_ = {};
  }

 private:
  // Of a simulation, of each of its steps through the tree, and of each action that a step chooses from.
  static constexpr Operations per_descent = 50;
  static constexpr Operations per_visit = 80;
  static constexpr Operations per_history = 150;  // a new one
  static constexpr Operations per_action = 2;
  static constexpr Operations per_numbers = 250;  // that a step reports
  static constexpr Operations few_paths = 4;  // of a step whose expected reward is computed

  struct Visit {
    std::uint32_t history;
    std::uint32_t action;
    double reward;
    std::optional<double> doubt;  // see SearchTree::Told; none if what is observed does not count
  };

  static std::uint32_t action_count() { return static_cast<std::uint32_t>(Model::action_count()); }
  bool has_actions() const { return tree_.history(0).first_action != no_node; }

  // Goes down to a new history or to an end, and backs up. Returns the discounted return. The engine is compiled by -O1,
  // where this would be a tenth slower.
  template <class SimulatedState>
  [[gnu::optimize("O2")]] double descend(SimulatedState& state, std::uint32_t a, Sampler& random) {
    std::size_t depth = 0;
    std::uint32_t history = 0;
    int left = horizon_;
    double value = state.value(left);
    double later = 0;
    double change = 0;  // of n * v of the history that the last action led to
    std::optional<ObservationCells::Drawn> drawn;
    if (reports_numbers_) drawn.emplace(random);
    while (true) {
      const std::optional<double> expected =
          switches::expected_rewards && depth < expected_steps ? state.expected_reward(a, rewards_) : std::nullopt;
      const std::optional<double> doubt = price_ > 0 ? state.doubt(a, doubts_) : std::nullopt;
      Step step = step_of(state, a, random, drawn);
      if (expected) step.reward = *expected;
      work_ += step_cost_ + per_visit + per_action * action_count() + ((expected ? few_paths : 0) + (doubt ? few_paths : 0)) * step_cost_;
      if (depth == 0) record_.add_reward(a, step.reward);
      const bool goes_on = --left > 0 && !state.has_ended();
      const double before = value;
      value = goes_on ? state.value(left) : 0;
      if (depth == visits_.size()) visits_.resize(2 * depth + 64);
      visits_[depth++] = {history, a, step.reward + Model::discount * value - before, doubt};
      if (!goes_on) break;

      const std::uint32_t action = tree_.history(history).first_action + a;
      const Observation seen = switches::observation_cells && reports_numbers_ ? cells_.cell(action, step.observation, *drawn) : step.observation;
      std::uint32_t child = tree_.find_child(action, seen);
      const bool is_new = child == no_node;
      if (is_new) {
        child = tree_.add_child(action, seen);
        work_ += per_history;
      }
      if (is_new || stays_leaf(child) || !give_actions(child, state, random)) {
        if (switches::asked_leaves && child != no_node && !prior_.empty()) ask(child, state, random);
        later = state.leaf(left, random);
        change = child == no_node ? later : add_return(tree_.history(child), later);
        break;
      }
      history = child;
      a = choose(history);
    }
    for (std::size_t i = depth; i-- > 0;) {
      later = visits_[i].reward + Model::discount * later;
      change = back_up(visits_[i], change, later);
    }
    return later;
  }

  double beyond_action(const ActionNode& action) const {
    if (action.n == 0) return 1;
    double sum = 0;
    for (std::uint32_t child = action.first_child; child != no_node; child = tree_.history(child).sibling) {
      const HistoryNode& history = tree_.history(child);
      const bool has_settled = history.first_action != no_node && history.n >= settled_visits;
      sum += history.n * (has_settled ? beyond_action(tree_.actions(history)[history.best]) : 1);
    }
    return std::min(Model::discount * sum / action.n, 1.0);
  }

  // The action with the highest upper confidence bound.
  [[gnu::always_inline]] std::uint32_t choose(std::uint32_t number) const {
    const HistoryNode& history = tree_.history(number);
    const ActionNode* const actions = tree_.actions(history);
    const ExplorationBonus bonus{history, spread_.variance()};
    std::uint32_t best = 0;
    double best_bound = -std::numeric_limits<double>::infinity();
    for (std::uint32_t a = 0; a < action_count(); ++a) {
      if (number == 0 && barred_.contains(a)) continue;
      if (comes_first(actions[a], number == 0)) return a;
      const double bound = value_of(actions[a], a, history) + bonus.of(actions[a]);
      if (bound > best_bound) {
        best_bound = bound;
        best = a;
      }
    }
    return best;
  }

  // Adds a return to a history without actions. Returns the change of its n * v.
  static double add_return(HistoryNode& node, double seen) {
    ++node.n;
    node.v += (seen - node.v) / node.n;
    return seen;
  }

  // Backs up a visit. Returns the change of the history's n * v. It is inlined, as `choose` is, since it runs
  // at each step.
  [[gnu::always_inline]] double back_up(const Visit& visit, double change, double seen) {
    HistoryNode& parent = tree_.history(visit.history);
    ActionNode* const actions = tree_.actions(parent);
    ActionNode& node = actions[visit.action];
    const double before = node.n > 0 ? node.q : -std::numeric_limits<double>::infinity();
    ++node.n;
    node.rewards += visit.reward;
    node.continuations += change;
    node.q = (node.rewards + Model::discount * node.continuations) / node.n;
    if (visit.doubt) add_information(node, *visit.doubt);
    const double deviation = seen - node.mean;
    node.mean += deviation / node.n;
    const double square = deviation * (seen - node.mean);
    node.squares += square;
    parent.squares += square;
    parent.max_visits = std::max(parent.max_visits, node.n);
    renew_best(parent, actions, action_count(), visit.action, node.q < before);

    const double sum = parent.n * parent.v;
    ++parent.n;
    parent.v = !switches::max_backup || parent.n < settled_visits ? parent.v + (seen - parent.v) / parent.n : actions[parent.best].q;
    return parent.n * parent.v - sum;
  }

  // Adds the worth of what an action tells to its value.
  void add_information(ActionNode& node, double doubt) {
    SearchTree::Told& told = tree_.told(node);
    told.doubt += doubt;
    if (node.n < settled_visits || node.n % settled_visits == 0) told.information = information_of(tree_, node, told.doubt);
    node.q += Model::discount * price_ * told.information;
  }

  // At the root the bounds decide only after every action was tried. Below it, they decide at once where something
  // is known of the actions, else after each action with a usual share.
  [[gnu::always_inline]] bool comes_first(const ActionNode& action, bool is_root) const {
    return action.n == 0 && prior_.empty() && (is_root || (action.share >= usual_share && !first_state_tells_));
  }
  // An action that was never tried has the value of its history, less what the prior or the history's states say.
  [[gnu::always_inline]] double value_of(const ActionNode& action, std::uint32_t a, const HistoryNode& history) const {
    if (action.n > 0) return action.q;
    const bool has_prior = !prior_.empty() && history.parent == no_node;
    return history.v + (has_prior ? -prior_[a] : action.advantage);
  }

  // Every eighth simulation begins with the next of the root's actions in turn, so that all their values can be read.
  int turn() const {
    if (!switches::turns || spread_.simulations() % turns != 0) return -1;
    const auto next = static_cast<int>(spread_.simulations() / turns % action_count());
    return barred_.contains(next) ? -1 : next;
  }

  // Takes a step and draws what it reports.
  template <class SimulatedState>
  [[gnu::always_inline]] Step step_of(SimulatedState& state, int action, Sampler& random, std::optional<ObservationCells::Drawn>& drawn) const {
    if (!reports_numbers_) return state.step(action, random);
    drawn->numbers.clear();
    const ReportingTo reporting{random, &*drawn};
    return state.step(action, random);
  }

  // With a prior, a history stays a leaf until it has as many visits as there are actions. Fully observable
  // values are too high, and less so the deeper the tree. With few visits below each of many actions, the
  // values would tell apart how deep these visits went, and not the actions.
  [[gnu::always_inline]] bool stays_leaf(std::uint32_t number) const { return switches::asked_leaves && !prior_.empty() && tree_.history(number).n < visits_of_leaf(); }
  static std::uint32_t visits_of_leaf() { return std::max(action_count(), asked_states); }

  // With a prior, the states of a leaf's last visits tell what its actions are worth (QMDP). The prior itself is that of
  // the root, and knows nothing of what was observed since.
  template <class SimulatedState>
  void ask(std::uint32_t number, const SimulatedState& state, Sampler& random) {
    const HistoryNode& history = tree_.history(number);
    if (history.n + asked_states < visits_of_leaf() || !tree_.give_actions(number)) return;
    odds_.resize(action_count());
    work_ += action_count() * worth_cost_;
    state.advantages(odds_.data(), random);
    ActionNode* const actions = tree_.actions(tree_.history(number));
    for (std::uint32_t a = 0; a < action_count(); ++a) actions[a].advantage += odds_[a] / asked_states;
    if (history.n + 1 < visits_of_leaf()) return;
    const auto has_less = [](const ActionNode& left, const ActionNode& right) { return left.advantage < right.advantage; };
    const double best = std::max_element(actions, actions + action_count(), has_less)->advantage;
    for (std::uint32_t a = 0; a < action_count(); ++a) actions[a].advantage -= best;
  }

  // Gives a history its actions. Returns false if there is no room for them.
  template <class SimulatedState>
  [[gnu::always_inline]] bool give_actions(std::uint32_t number, const SimulatedState& state, Sampler& random) {
    return tree_.history(number).first_action != no_node || give_new_actions(number, state, random);
  }
  template <class SimulatedState>
  bool give_new_actions(std::uint32_t number, const SimulatedState& state, Sampler& random) {
    if (!tree_.give_actions(number)) return false;
    odds_.resize(action_count());
    ActionNode* const actions = tree_.actions(tree_.history(number));
    if (state.rollout_odds(odds_.data(), random)) {
      if (switches::rollout_shares) share_exploration(actions, odds_);
    } else if (first_state_tells_ && number != 0) {
      work_ += action_count() * worth_cost_;
      state.advantages(odds_.data(), random);
      for (std::uint32_t a = 0; a < action_count(); ++a) actions[a].advantage = odds_[a];
    }
    return true;
  }

  SearchTree tree_;
  SearchTree spare_;
  bool first_state_tells_ = false;
  bool reports_numbers_ = Model::reports_numbers();
  ObservationCells cells_;
  int horizon_ = 0;
  Operations step_cost_ = 0;
  Operations worth_cost_ = 0;
  Operations work_ = 0;
  double price_ = 0;  // of a nat
  BarredActions barred_;
  List<double> prior_;
  ExpectedRewards<Model> rewards_;
  ObservationDoubts<Model> doubts_;
  RootRecord record_;
  RootSpread spread_;
  List<Visit> visits_;  // the first ones are of the simulation that runs
  List<double> odds_;
};

}
