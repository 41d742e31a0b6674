"""A TurtleBot3 visits places in an arena with obstacles, some of which are on no map."""

from aos_skills.pybullet.parts.world import WorldKind
from aos_skills.pybullet.worlds.turtlebot.file import TurtlebotFile
from aos_skills.pybullet.worlds.turtlebot.navigate import navigate
from aos_skills.pybullet.worlds.turtlebot.world import Turtlebot

__all__ = ["KIND"]

KIND = WorldKind(TurtlebotFile, Turtlebot, {"/navigate": navigate})
