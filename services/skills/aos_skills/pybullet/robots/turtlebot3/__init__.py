"""A TurtleBot3 Burger: two driven wheels, a caster, a lidar, and what it needs to find its way."""

from aos_skills.pybullet.robots.turtlebot3.robot import TurtleBot3

__all__ = ["TurtleBot3"]
