"""The simulated robot: a pybullet world and the skills that act in it. Only this package imports pybullet."""
