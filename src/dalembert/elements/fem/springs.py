"""Springs between nodes (8.6)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.fem.energies import Named
from dalembert.elements.fem.lines import Line


@dataclass(eq=False)
class AxialSpring(Line):
    """Linear spring along the line of its nodes, ``s = k (u_j − u_i)`` (8.6).

    ``W = k e²/2`` with the elongation ``e``; in one dimension the nodes' places do not matter.

    Parameters
    ----------
    stiffness : [N/m]
    """

    stiffness: Scalar = quantity("N/m", "stiffness", above=0.0, keyword=True)

    @classmethod
    def energy(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        return q["stiffness"] * cls.elongation(u, x) ** 2 / 2

    @classmethod
    def recovered(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> Named:
        elongation = cls.elongation(u, x)
        return {"elongation": (elongation, "m"), "force": (q["stiffness"] * elongation, "N")}

    @classmethod
    def checks(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> list[tuple[ca.SX, str]]:
        return [] if x[0].numel() == 1 else super().checks(x, q)
