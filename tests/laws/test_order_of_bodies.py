"""Impacts of two free bodies do not depend on the order in which these are added."""

from __future__ import annotations

import pytest

import dalembert as da
from dalembert import planar

contact = planar.contact
FORMS = {
    "disc": {"mass": 1.0, "inertia": 0.005, "position": (-0.3, 0.0), "velocity": (2.0, 0.0)},
    "crate": {"mass": 2.0, "inertia": 0.02, "position": (0.0, 0.0)},
}


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
@pytest.mark.parametrize("law", ["newton", "poisson", "energetic"])
@pytest.mark.parametrize("names", [("disc", "crate"), ("crate", "disc")])
def test_central_impact_of_a_disc_and_a_crate(names, law, scheme):
    """``(m₁ − e m₂) v/(m₁ + m₂)`` and ``(1 + e) m₁ v/(m₁ + m₂)``."""
    system = da.System("hit")
    bodies = {name: system.add(planar.Body(name, **FORMS[name])) for name in names}
    shapes = [contact.Circle(bodies["disc"], 0.1), contact.Rectangle(bodies["crate"], (0.2, 0.2))]
    system.add(planar.Collisions("hit", shapes, restitution=0.5, impact_law=law))
    motion = da.solve_nonsmooth(system.build(), 0.1, step=1e-3, integrator=scheme)
    assert motion["disc.vx"][-1].item() == pytest.approx(0.0, abs=1e-10)
    assert motion["crate.vx"][-1].item() == pytest.approx(1.0, abs=1e-10)
