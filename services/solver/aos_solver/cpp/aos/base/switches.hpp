// Mechanisms of the planners that can be switched off in builds for tests (AOS_ABLATION), so that what each is worth can
// be measured: `python -m tests.ablation`. In all other builds they are constants.
#pragma once

#ifdef AOS_ABLATION
#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <string_view>
#endif

#define AOS_MECHANISMS(of) \
  /* which planner decides */ \
  of(lists) of(estimated_draws) of(exact) of(near_states) of(belief_tree) of(options) of(savings) of(seek) \
  /* options */ \
  of(enough_ways) of(tests_first) of(goal_conditions) of(plain_plans) of(whole_lists) of(retries) of(kept_ways) of(detours) of(alike_states) of(twins) of(sequels) of(past_ends) of(wide_ways) of(own_ways) of(drifting) of(later_costs) of(moved_by_ways) of(reported_worlds) of(idle_income) of(test_plans) of(raked_states) of(deadlines) \
  /* savings */ \
  of(saving_lookahead) of(saving_rollouts) of(later_attention) \
  /* SARSOP */ \
  of(endless) of(certainty_equivalent) of(region_plans) of(repeated_trials) of(lower_trials) of(simple_policies) \
  /* POMCP's values of states, and its prior */ \
  of(listed_values) of(wide_values) of(learned_values) of(prior) of(prior_draw) of(asked_leaves) of(first_state) of(priced_information) \
  /* POMCP's search */ \
  of(step_table) of(expected_rewards) of(rollout_repeats) of(rollout_ends) of(rollout_shares) of(own_spread) of(max_backup) of(turns) of(no_idling) \
  of(certain_actions) of(sooner) of(observation_cells) of(kept_tree)

namespace aos::switches {

#ifdef AOS_ABLATION

#define AOS_SWITCH(name) inline bool name = true;
AOS_MECHANISMS(AOS_SWITCH)
#undef AOS_SWITCH

// Whether a text of names between `+` has this one.
inline bool has_name(std::string_view names, std::string_view name) {
  for (std::size_t first = 0; first < names.size();) {
    const std::size_t last = std::min(names.find('+', first), names.size());
    if (names.substr(first, last - first) == name) return true;
    first = last + 1;
  }
  return false;
}

// Switches these off, and all others on.
inline void leave_out(std::string_view names) {
#define AOS_SWITCH(name) name = !has_name(names, #name);
  AOS_MECHANISMS(AOS_SWITCH)
#undef AOS_SWITCH
}

inline const bool was_environment_read = [] {
  const char* const names = std::getenv("AOS_WITHOUT");
  if (names != nullptr) leave_out(names);
  return names != nullptr;
}();

#else

#define AOS_SWITCH(name) inline constexpr bool name = true;
AOS_MECHANISMS(AOS_SWITCH)
#undef AOS_SWITCH

#endif

}
