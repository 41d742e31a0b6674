"""The laboratory: benchmarks, trials, experiments, calibration, problem files, and Gymnasium.

It runs AOS from outside. No mission needs it.
"""
