"""Units of pages: drawing, parameters, optima; traces by body; round-off; ellipsoids."""

from __future__ import annotations

import numpy as np
import pytest
from browser import visit

import dalembert as da
from dalembert import planar, spatial, structures


def test_units_reach_the_drawing_and_a_body_is_traced(browser, tmp_path) -> None:
    """Drawing and parameters in the units given; round-off is zero; a body is its origin."""
    system = da.System("pendulum", gravity=(0.0, -9.81))
    length = system.parameter("length", 0.5, "m", bounds=(0.1, 1.0))
    bar = system.add(planar.Bar("bar", length=length, mass=2.0, angle=-np.pi / 2))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    motion = da.solve_dynamics(system.build(), 0.1, step=0.01)
    page = motion.page(units=["mm", "kN"], trace=["bar"])
    assert page["units"] == {"N": (1e3, "kN"), "m": (1e-3, "mm")}
    assert page["parameters"][0] | {"description": ""} == {
        **{"name": "length", "value": 500.0, "unit": "mm"},
        **{"lower": 100.0, "upper": 1000.0, "description": ""},
    }
    assert {"name": "bar", "body": "bar", "point": [0.0, 0.0]} in page["scene"]["points"]
    sideways = next(s for s in page["series"] if s["name"] == "bar.x")
    assert np.abs(motion["bar.x"].values).max() > 0 and not np.any(sideways["values"])
    with visit(browser, motion.report(tmp_path / "page.html", units=["mm", "kN"])) as seen:
        assert not seen.errors
        assert "500" in seen.js('document.querySelector("#parameters tbody").textContent')


@pytest.mark.thorough
def test_ellipsoids_of_inertia_can_be_hidden(browser, tmp_path) -> None:
    system = da.System("free")
    system.add(spatial.Body("top", mass=1.0, inertia=(0.01, 0.02, 0.03)))
    motion = da.solve_dynamics(system.build(), 0.1, step=0.05)
    with visit(browser, motion.report(tmp_path / "page.html")) as seen:
        seen.frames(3)
        shown = seen.picture("#scene")
        seen.js('document.getElementById("inertia").click()')
        seen.frames(3)
        assert seen.picture("#scene") != shown and not seen.errors


@pytest.mark.thorough
def test_an_optimum_in_declared_units_marks_broken_limits(browser, tmp_path) -> None:
    """Without units of the page, parameters are in those of their declaration."""
    structure = da.Structure("spring")
    k = structure.parameter("k", 50.0, "N/cm", bounds=(1, 1e3))
    end = structure.node("end", 0.0)
    structure.add(structures.GroundSpring("spring", end, stiffness_x=k))
    structure.load(end, fx=1.0)
    satisfied, broken = (
        da.Limit(da.final("k").named(n), upper=b) for n, b in (("a", 1e6), ("b", 50.0))
    )
    limits = [satisfied, broken]
    best = da.optimize(
        structure.build(), da.final("end.ux"), subject_to=limits, analysis=da.Statics()
    )
    assert best.motion.page()["parameters"][0]["unit"] == "N/cm"
    (one,) = best.summary()["variables"]
    assert (one["unit"], one["upper"]) == ("N/cm", 1e3)
    assert one["value"] == pytest.approx(best.x["k"] / 100)
    assert "N/cm" in best._repr_html_()
    with visit(browser, best.report(tmp_path / "page.html")) as seen:
        rows = seen.js(
            '[...document.querySelectorAll("#optimum tbody th")].map(e => e.textContent)'
        )
    assert [row.split(" ")[0] for row in rows if "✗" in row] == ["b"]


@pytest.mark.thorough
def test_the_page_of_an_optimum_has_its_units_and_variables_first(browser, tmp_path) -> None:
    structure = da.Structure("spring")
    k = structure.parameter("k", 50.0, "N/m", bounds=(1, 1e3))
    end = structure.node("end", 0.0)
    structure.add(structures.GroundSpring("spring", end, stiffness_x=k))
    structure.load(end, fx=1.0)
    give = da.final("end.ux", name="give")
    limits = [da.Limit(da.final("k").named(f"stiffness {i}" * 6), upper=200.0) for i in range(3)]
    best = da.optimize(structure.build(), give, subject_to=limits, analysis=da.Statics())
    optimum = best.page(units=["mm", "N/mm"])["optimum"]
    assert optimum["unit"] == "mm" and optimum["value"] == pytest.approx(1e3 * best.fun)
    assert optimum["variables"][0]["unit"] == "N/mm" and optimum["variables"][0]["upper"] == 1.0
    assert optimum["limits"][0]["value"] == pytest.approx(0.2)
    price = best.limits[0].price * 1e3 * 1e3  # mm per N/mm
    assert optimum["limits"][0]["price"] == pytest.approx(price)
    assert "mm per N/mm" in optimum["prices"][0] if price else True
    with visit(browser, best.report(tmp_path / "page.html", units=["mm", "N/mm"])) as seen:
        first = 'document.querySelector("#optimum tbody th").textContent'
        assert seen.js(first).startswith("k")
        table = 'document.querySelector("#optimum .scroll")'
        assert seen.js(f"{table}.scrollWidth <= {table}.clientWidth + 1")
    assert "Convergence" in best._repr_html_() or "convergence" in best._repr_html_()
