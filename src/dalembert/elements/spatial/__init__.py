"""Elements in space: one file per concept, listed once in ``registry``."""

from dalembert.elements.frame import Frame
from dalembert.elements.spatial.body import Body, Particle
from dalembert.elements.spatial.knife_edge import KnifeEdge
from dalembert.elements.spatial.revolute import Revolute
from dalembert.elements.spatial.rolling_disc import RollingDisc
from dalembert.elements.spatial.spherical import Spherical

__all__ = ["Body", "Frame", "KnifeEdge", "Particle", "Revolute", "RollingDisc", "Spherical"]
