"""The engine of one model: all questions that can be asked of its child process."""

from aos_solver.child.belief_questions import BeliefQuestions
from aos_solver.child.engine_child import ImpossiblePolicy
from aos_solver.child.listing_questions import ListingQuestions
from aos_solver.child.mission_questions import MissionQuestions, Planner, Restriction
from aos_solver.child.rate_questions import RateQuestions, Stepping
from aos_solver.child.study_questions import StudyQuestions
from aos_solver.child.takeover_questions import TakeoverQuestions
from aos_solver.child.world_questions import WorldQuestions

__all__ = ["Engine", "ImpossiblePolicy", "Planner", "Restriction", "Stepping"]


class Engine(
    MissionQuestions,
    BeliefQuestions,
    TakeoverQuestions,
    WorldQuestions,
    ListingQuestions,
    RateQuestions,
    StudyQuestions,
):
    """Asks the child process of one built model; `start` begins it, `close` ends it."""
