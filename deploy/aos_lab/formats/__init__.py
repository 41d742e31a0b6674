"""Problem files of other planners: read into models of numbers, and written from them."""

__all__ = ["PROBLEM_ENDINGS"]

PROBLEM_ENDINGS = (".pomdpx", ".pomdp")
