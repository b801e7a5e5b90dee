"""Ziegler's column: a load that follows loses its stability by flutter, at rest nothing shows it.

Two rigid links of length l on hinges of stiffness k, masses 2m at the middle hinge and m at the
top, where a force P pushes along the upper link. H. Ziegler (1952), Die Stabilitätskriterien der
Elastomechanik, Ing.-Arch. 20; G. Herrmann and R. W. Bungay (1964), On the stability of elastic
systems subjected to nonconservative forces, J. Appl. Mech. 31: flutter from ``P l/k = 7/2 − √2``.
"""

from __future__ import annotations

import math
from functools import cache

import pytest

import dalembert as da
from dalembert import planar

CRITICAL = 3.5 - math.sqrt(2.0)


@cache
def column() -> da.Model:
    system = da.System("Ziegler's column")
    load = system.parameter("P", 1.0, "N")
    below, at = None, system.ground.center
    for name, mass in (("lower", 2.0), ("upper", 1.0)):
        place = (float(name == "upper") + 1.0, 0.0)
        link = planar.Body(name, mass=mass, inertia=0.0, position=place, angle=0.0)
        system.add(link)
        system.add(planar.Revolute(f"hinge_{name}", at, link.point(-1.0, 0.0)))
        on = below or system.ground
        system.add(planar.TorsionSpring(f"spring_{name}", on, link, stiffness=1.0))
        below, at = link, link.center
    system.add(planar.Force("load", at, (-load, 0.0), following=True))
    return system.build()


@pytest.mark.parametrize("share", [0.99, 1.01])
def test_flutter(share):
    chosen = {"P": share * CRITICAL}
    rest = da.solve_equilibrium(column(), parameters=chosen)
    assert rest.statistics["stable"] and "check flutter by linearize" in str(rest.status)
    modes = da.linearize(column(), parameters=chosen)
    growth = max(modes.eigenvalues.real)
    assert abs(growth) < 1e-6 if share < 1 else growth > 0.01


def test_loads_with_a_potential_are_just_stable():
    rest = da.solve_equilibrium(column(), parameters={"P": 0.0})
    assert str(rest.status).endswith("stable") and "statically" not in str(rest.status)
