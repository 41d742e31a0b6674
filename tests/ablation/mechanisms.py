"""The mechanisms of the planners, and the ways to a decision on which each is met.

The names are those of `services/solver/aos_solver/cpp/aos/base/switches.hpp`.
"""

from typing import NamedTuple


class Route(NamedTuple):
    """A planner on random models, with some mechanisms off from the start so that others come into play."""

    name: str
    planner: str
    without: tuple[str, ...]
    mechanisms: tuple[str, ...]

    def variant(self, *mechanisms: str) -> str:
        """The name by which the exam's driver plays the planner without these mechanisms, too."""
        off = (*self.without, *mechanisms)
        return f"{self.planner}/{'+'.join(off)}" if off else self.planner


_UNLISTED = ("lists", "near_states", "wide_values")
_ROLLED_OUT = (*_UNLISTED, "options", "learned_values")
_OPTIONS = (
    "enough_ways",
    "tests_first",
    "plain_plans",
    "retries",
    "detours",
    "alike_states",
    "twins",
    "sequels",
    "past_ends",
    "wide_ways",
    "own_ways",
    "drifting",
    "later_costs",
    "moved_by_ways",
    "reported_worlds",
    "idle_income",
    "test_plans",
    "raked_states",
    "deadlines",
)
_SAVINGS = ("savings", "saving_lookahead", "saving_rollouts", "later_attention")
_SEARCH = ("own_spread", "max_backup", "turns", "sooner", "kept_tree", "no_idling")

ROUTES = (
    Route(
        "auto",
        "auto",
        (),
        (
            "exact",
            "endless",
            "certainty_equivalent",
            "region_plans",
            "repeated_trials",
            "lower_trials",
            "simple_policies",
        ),
    ),
    Route("pomcp", "pomcp", (), ("listed_values", "step_table", *_SEARCH)),
    Route(
        "auto, states unlisted",
        "auto",
        _UNLISTED,
        ("options", *_OPTIONS, "seek", *_SAVINGS, "learned_values"),
    ),
    Route(
        "pomcp with values of many states",
        "auto",
        ("lists", "near_states", "options"),
        ("wide_values", "first_state", "priced_information"),
    ),
    Route(
        "pomcp with learned values",
        "auto",
        (*_UNLISTED, "options"),
        ("learned_values", "prior", "prior_draw", "asked_leaves", "expected_rewards"),
    ),
    Route(
        "pomcp with rollouts",
        "auto",
        _ROLLED_OUT,
        (
            "expected_rewards",
            "rollout_repeats",
            "rollout_ends",
            "rollout_shares",
            "certain_actions",
            *_SEARCH,
        ),
    ),
)


class BundleRoute(NamedTuple):
    """Missions of a bundle: its name, the simulations of a decision, the steps, and what is switched off."""

    bundle: str
    simulations: int
    steps: int
    mechanisms: tuple[str, ...]
    without: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        return f"{self.bundle} without {'+'.join(self.without)}" if self.without else self.bundle


_WITHOUT_OPTIONS = ("learned_values", "prior", "prior_draw", "asked_leaves")

BUNDLES = (
    BundleRoute("survey", 1000, 60, ("plain_plans",)),
    BundleRoute("gauges", 10_000, 60, ("detours",)),
    BundleRoute("diagnosis200", 2000, 40, ("simple_policies", "repeated_trials", "lower_trials")),
    BundleRoute(
        "lightdark",
        2000,
        60,
        ("endless", "certainty_equivalent", "repeated_trials", "lower_trials", "simple_policies"),
    ),
    BundleRoute("inventory", 2000, 60, ("near_states", "endless", "certainty_equivalent", "repeated_trials")),
    BundleRoute("laser", 1000, 60, ("belief_tree",)),
    BundleRoute("laser", 1000, 60, ("prior", "prior_draw", "asked_leaves"), ("belief_tree",)),
    BundleRoute("ship10", 1000, 100, ("options", "learned_values")),
    BundleRoute("ship10", 1000, 100, _WITHOUT_OPTIONS, ("options",)),
    BundleRoute("kitchen12", 1000, 70, ("options",)),
    BundleRoute("kitchen12", 1000, 70, _WITHOUT_OPTIONS, ("options",)),
    BundleRoute("maint10", 1000, 60, ("wide_values", "first_state", "expected_rewards")),
    BundleRoute("maint10", 1000, 60, ("learned_values", "prior"), ("wide_values", "options")),
    BundleRoute("maint10", 1000, 60, _SAVINGS, ("wide_values",)),
    BundleRoute("greenhouse", 4000, 60, _SAVINGS),
    BundleRoute("cleaning", 4000, 60, _SAVINGS),
    BundleRoute("parcels", 1000, 60, ("options", "learned_values")),
    BundleRoute("clutter", 1000, 60, ("options", "learned_values")),
    BundleRoute("lock", 4000, 80, ("goal_conditions",)),
    BundleRoute("towers", 4000, 80, ("goal_conditions", "whole_lists", "retries", "kept_ways")),
    BundleRoute("open_field", 1000, 60, ("options", "learned_values", "observation_cells")),
    BundleRoute("rescue", 1000, 40, ("options", "tests_first")),
    BundleRoute("pipe", 1000, 80, ("seek",)),
    BundleRoute("photo", 1000, 80, ("priced_information", "wide_values", "first_state")),
    BundleRoute("shelf", 1000, 60, ("estimated_draws",)),
    BundleRoute(
        "pocman", 1000, 60, ("rollout_shares", "max_backup", "turns", "own_spread", "learned_values")
    ),
)
