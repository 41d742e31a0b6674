"""Problem files of other planners, and the models of numbers that they describe: beside the solver."""
