"""The engine of one model: all questions that can be asked of its child process."""

from aos_solver.child.process.engine_child import ImpossiblePolicy
from aos_solver.child.questions.beliefs import BeliefQuestions
from aos_solver.child.questions.missions import MissionQuestions, Planner, Restriction
from aos_solver.child.questions.models import ListingQuestions, RateQuestions, Stepping
from aos_solver.child.questions.studies import StudyQuestions
from aos_solver.child.questions.takeovers import TakeoverQuestions
from aos_solver.child.questions.worlds import WorldQuestions

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
