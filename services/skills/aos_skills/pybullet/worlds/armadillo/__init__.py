"""A mobile arm brings a can from one of two tables to a person in the corridor."""

from aos_skills.pybullet.parts.world import WorldKind
from aos_skills.pybullet.worlds.armadillo.file import ArmadilloFile
from aos_skills.pybullet.worlds.armadillo.skills import navigate, pick, retract, sense, serve
from aos_skills.pybullet.worlds.armadillo.world import Armadillo

__all__ = ["KIND"]

KIND = WorldKind(
    ArmadilloFile,
    Armadillo,
    {"/navigate": navigate, "/pick": pick, "/sense": sense, "/serve": serve, "/retract": retract},
)
