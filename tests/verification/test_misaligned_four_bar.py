"""A four-bar whose last but one hinge is tilted: rigid bars lock, flexible ones give way.

Data of the benchmark of Bauchau, Betsch, Cardona, Gerstmayr, Jonker, Masarati and Sonneville
(Validation of flexible multibody dynamics beam formulations using benchmark problems, Multibody
System Dynamics 37, 2016; its histories are curves): bars of 0.12, 0.24 and 0.12 m in a plane,
hinges across it at A, B and D, that at C tilted by 5° towards the bar BC. With parallel axes rigid
bars have one freedom and three equations too many; with the tilt they have none.
"""

import numpy as np
import pytest

import dalembert as da
from dalembert import spatial

A, B, C, D = (0, 0, 0), (0, 0, 0.12), (0.24, 0, 0.12), (0.24, 0, 0)
TILTED = (np.sin(np.radians(5.0)), np.cos(np.radians(5.0)), 0.0)
ACROSS = (0.0, 1.0, 0.0)
BARS = {
    "first": (A, B, (5.2992e7, 1.68803e7, 733.488, 1130.5, 1.9968)),
    "second": (B, C, (5.2992e7, 1.68803e7, 733.488, 1130.5, 1.9968)),
    "third": (C, D, (1.3248e7, 4.22008e6, 45.843, 70.656, 0.4992)),
}


def hinges(system: da.System, ends: dict, tilt: tuple) -> None:
    """At A, B, C and D; ``ends`` gives a frame at either end of a bar with an axis."""
    ground = system.ground
    ties = {
        "A": (ground.frame(A, axis=ACROSS), ends["first"](0, ACROSS)),
        "B": (ends["first"](1, ACROSS), ends["second"](0, ACROSS)),
        "C": (ends["second"](1, tilt), ends["third"](0, tilt)),
        "D": (ends["third"](1, ACROSS), ground.frame(D, axis=ACROSS)),
    }
    for name, (i, j) in ties.items():
        system.add(spatial.Revolute(name, i, j))


def rigid(tilt: tuple) -> da.Model:
    system = da.System("rigid four-bar", gravity=(0, 0, 0))
    ends = {}
    for name, (start, end, _) in BARS.items():
        middle = (np.array(start) + end) / 2
        bar = spatial.Body(name, mass=0.2, inertia=(1e-4,) * 3, position=middle, rotation=np.eye(3))
        system.add(bar)
        places = [np.array(start) - middle, np.array(end) - middle]
        ends[name] = lambda k, axis, bar=bar, places=places: bar.frame(places[k], axis=axis)
    hinges(system, ends, tilt)
    return system.build()


def test_parallel_hinges_leave_one_freedom():
    diagnosis = rigid(ACROSS).diagnosis
    assert diagnosis.degrees_of_freedom == 1
    assert len(diagnosis.redundancies) == 3


def test_a_tilted_hinge_locks_rigid_bars():
    assert rigid(TILTED).diagnosis.degrees_of_freedom == 0


def flexible(relaxed: tuple[str, ...] = ("first",)) -> da.Model:
    system = da.System("flexible four-bar", gravity=(0, 0, 0))
    angle, ends = system.parameter("angle", 0.0, "rad"), {}
    for name, (start, end, (axial, shear, twist, bend, mass)) in BARS.items():
        along = (np.array(end) - start) / np.linalg.norm(np.array(end) - start)
        axes = np.column_stack([along, ACROSS, np.cross(along, ACROSS)])
        bar = spatial.Beam(
            name,
            length=float(np.linalg.norm(np.array(end) - start)),
            position=start,
            rotation=axes,
            axial_rigidity=axial,
            shear_rigidity=shear,
            torsional_rigidity=twist,
            bending_rigidity_y=bend,
            bending_rigidity_z=bend,
            mass_per_length=mass,
            elements=1,
            order=2,
            relaxed=name in relaxed,
        )
        system.add(bar)
        nodes = bar.start, bar.end
        ends[name] = lambda k, axis, nodes=nodes, axes=axes: nodes[k].frame(
            (0, 0, 0), axis=axes.T @ axis
        )
    hinges(system, ends, TILTED)
    system.add(spatial.RotationalDriver("motor", system.elements["A"], angle))
    return system.build()


@pytest.mark.thorough
def test_flexible_bars_give_way():
    """Turned slowly they strain, and the motor's moment is the slope of their energy."""
    model = flexible()

    def turned(angle: float) -> da.Motion:
        equilibrium = da.solve_equilibrium(model, parameters={"angle": angle})
        assert equilibrium.status.success
        return equilibrium

    def energy(angle: float) -> float:
        computed = turned(angle)
        return sum(float(computed[f"{name}.strain_energy"][0]) for name in BARS)

    assert energy(0.0) < 1e-12
    slope = (energy(0.601) - energy(0.599)) / 0.002
    assert slope > 1.0
    assert float(turned(0.6)["motor.moment.y"][0]) == pytest.approx(slope, rel=1e-4)


def test_all_bars_cannot_start_free_of_strain():
    with pytest.raises(da.ModelError, match=r"prescribed at the start, .* relaxed=False"):
        flexible(relaxed=tuple(BARS))
