"""A Panda arm that stands still and holds a pen."""

from aos_skills.pybullet.robots.panda.robot import PandaWithPen

__all__ = ["PandaWithPen"]
