"""A wing twisted by its lift, coupled with the aerodynamics in OpenMDAO, and its lightest spar.

Lift acts in front of the spar and twists it, which increases the lift. The statics of the spar are
an implicit component, aerodynamic strips are components of OpenMDAO, and its solvers compute the
twist in equilibrium; a uniform spar has a closed form. Then its driver minimises the mass over the
wall thicknesses of the spar, with the tip twist limited to a quarter of the angle of attack; the
mass is an explicit component.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import structures

SPAN, CHORD, AHEAD, SLOPE, ATTACK = 6.0, 1.0, 0.15, 2 * math.pi, math.radians(3)
RADIUS, E, G, DENSITY, WALL = 0.08, 70e9, 27e9, 2700.0, 2e-3
PARTS, MOST, SPEED = 6, 0.25, 60.0
SPEEDS = (30.0, 60.0, 80.0)


def pressure(speed: float) -> float:
    return 1.225 * speed**2 / 2


def build() -> da.Structure:
    """The spar, a tube along y, with lift and moment of the strips at its nodes."""
    wing = da.Structure("wing")
    nodes = [wing.node(f"n{k}", 0, SPAN * k / PARTS, 0) for k in range(PARTS + 1)]
    wing.support(nodes[0])
    for k in range(PARTS):
        wall = wing.parameter(f"wall{k}", WALL, "m", bounds=(0.2e-3, 6e-3))
        area, second = 2 * math.pi * RADIUS * wall, math.pi * RADIUS**3 * wall
        bending = {"second_moment_y": second, "second_moment_z": second}
        material = {"modulus": E, "shear_modulus": G, "density": DENSITY}
        ends = nodes[k], nodes[k + 1]
        tube = {"area": area, "torsion_constant": 2 * second, **bending, **material}
        wing.add(structures.SpaceFrame(f"part{k}", *ends, orientation=(0, 0, 1), **tube))
        lift = wing.parameter(f"lift{k + 1}", 0.0, "N")
        wing.load(nodes[k + 1], fz=lift, my=AHEAD * lift)
    return wing


def coupled(model, uniform: bool = False):
    """Spar and strips, and the mass beside; all parts have one wall, or each has its own."""
    import openmdao.api as om

    walls = [f"wall{k}" for k in range(PARTS)]
    promoted = [(wall, "wall") for wall in walls] if uniform else walls
    twists = {f"twist{k}": f"n{k}.ry" for k in range(1, PARTS + 1)}
    problem = om.Problem(reports=None)
    wing = problem.model.add_subsystem("wing", om.Group(), promotes=["*"])
    spar = da.openmdao_implicit_component(model, twists)
    wing.add_subsystem("spar", spar, promotes_inputs=[*promoted, "lift*"], promotes_outputs=["*"])
    for k in range(1, PARTS + 1):
        strip = SLOPE * CHORD * SPAN / PARTS * (0.5 if k == PARTS else 1.0)
        air = om.ExecComp(f"lift{k} = {strip}*q*({ATTACK} + twist{k})")
        wing.add_subsystem(f"strip{k}", air, promotes=["*"])
    wing.nonlinear_solver = om.NewtonSolver(solve_subsystems=False, iprint=-1)
    wing.linear_solver = om.DirectSolver(assemble_jac=False)
    mass = da.openmdao_component(
        model, da.final("mass", name="mass"), analysis=da.Statics(), vary=walls
    )
    problem.model.add_subsystem(
        "weight", mass, promotes_inputs=promoted, promotes_outputs=[("mass", "mass")]
    )
    if uniform:
        problem.model.set_input_defaults("wall", WALL)
    problem.model.set_input_defaults("q", pressure(SPEED))
    names = ["wall"] if uniform else walls
    for name in names:
        problem.model.add_design_var(name, lower=0.2e-3, upper=6e-3, ref=WALL)
    problem.model.add_objective("mass", ref=10.0)
    problem.model.add_constraint(f"twist{PARTS}", upper=MOST * ATTACK, ref=ATTACK)
    problem.driver = om.ScipyOptimizeDriver(optimizer="SLSQP", tol=1e-7, disp=False)
    problem.setup()
    return problem


def exact(y, q: float, wall: float = WALL):
    """Twist of a uniform spar, ``α (cos λ(l − y)/cos λl − 1)``."""
    stiffness = G * 2 * math.pi * RADIUS**3 * wall
    rate = math.sqrt(q * CHORD * AHEAD * SLOPE / stiffness)
    return ATTACK * (np.cos(rate * (SPAN - y)) / math.cos(rate * SPAN) - 1)


def twist(problem) -> np.ndarray:
    return np.array([0.0, *(problem[f"twist{k}"][0] for k in range(1, PARTS + 1))])


def main(folder=None) -> dict[str, float]:
    model, shown = build().build(), []
    problem = coupled(model, uniform=True)
    for speed in SPEEDS:
        problem["q"] = pressure(speed)
        problem.run_model()
        shown.append((speed, twist(problem)))
    problem["q"] = pressure(SPEED)
    problem.run_driver()
    uniform = float(problem["mass"][0]), float(problem["wall"][0])
    problem = coupled(model)
    problem.run_driver()
    walls = np.array([problem[f"wall{k}"][0] for k in range(PARTS)])
    found = {f"tip at {speed:g}": angles[-1] for speed, angles in shown}
    found |= {"uniform wall": uniform[1], "uniform mass": uniform[0]}
    found |= {"mass": float(problem["mass"][0]), "tip": twist(problem)[-1]}
    print(*(f"{name}: {value:.6g}" for name, value in found.items()), sep="\n")
    if folder:
        picture(folder, shown, walls, found)
    return found


def picture(folder, shown, walls: np.ndarray, found: dict[str, float]) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.6))
    places, fine = np.linspace(0, SPAN, PARTS + 1), np.linspace(0, SPAN, 200)
    for (speed, angles), colour in zip(shown, style.COLOURS, strict=False):
        curve = np.degrees(exact(fine, pressure(speed)))
        left.plot(fine, curve, color=colour, lw=1, label=f"{speed:g} m/s")
        left.plot(places, np.degrees(angles), "o", ms=4, color=colour)
    left.set(
        title="twist found together with the air, and closed form", xlabel="along the span [m]"
    )
    left.set(ylabel="twist [°]")
    left.legend()
    right.stairs(1e3 * walls, places, fill=True, color=style.SKY, label=f"{found['mass']:.2f} kg")
    right.axhline(
        1e3 * found["uniform wall"], color=style.ORANGE, label=f"{found['uniform mass']:.2f} kg"
    )
    title = f"wall of the lightest spars whose tip twists by {MOST * math.degrees(ATTACK):g}°"
    right.set(title=title, xlabel="along the span [m]", ylabel="wall [mm]", ylim=(0, None))
    right.legend()
    style.save(figure, folder, "twisting_wing")


if __name__ == "__main__":
    main(*sys.argv[1:])
