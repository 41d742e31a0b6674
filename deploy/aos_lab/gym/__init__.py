"""Bundles as Gymnasium environments, for people who train policies.

The observation is what the robot is told: a response, by its number, or a text as bytes. The hidden state
stays hidden. Needs the package gymnasium: pip install 'aos-autonomy[gym]'.
"""

from aos_lab.gym.environment import AosEnv
from aos_lab.gym.vector_environment import AosVectorEnv

__all__ = ["AosEnv", "AosVectorEnv"]
