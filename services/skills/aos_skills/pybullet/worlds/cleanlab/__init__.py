"""A mobile arm looks for cups in a laboratory and takes them to bins."""

from aos_skills.pybullet.parts.world import WorldKind
from aos_skills.pybullet.worlds.cleanlab.file import CleanLabFile
from aos_skills.pybullet.worlds.cleanlab.skills import look, navigate, pick, release
from aos_skills.pybullet.worlds.cleanlab.world import CleanLab

__all__ = ["KIND"]

KIND = WorldKind(
    CleanLabFile, CleanLab, {"/navigate": navigate, "/look": look, "/pick": pick, "/release": release}
)
