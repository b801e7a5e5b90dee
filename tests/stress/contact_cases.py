"""Contacts: rigid ones by their laws, compliant ones by SciPy, both in mechanisms by NumPy."""

from __future__ import annotations

import numpy as np
from random_mechanisms import chain, empty
from random_strategies import COORDINATES
from registry import FORMULATIONS
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar
from stress.agreement import apart
from stress.planar_cases import judge_mechanism

DURATION = 0.5
NEAR = 1e-7
"""Relative size of what may violate a law of contact."""


def judge(seed: int) -> tuple[str, str, str]:
    rng = np.random.default_rng([seed, 4])
    return (in_mechanism, rigid, compliant)[seed % 3](seed, rng)


def in_mechanism(seed: int, rng: np.random.Generator) -> tuple[str, str, str]:
    """A chain that touches and may bounce."""
    m = empty(np.random.default_rng(seed))
    chain(m, int(rng.integers(1, 4)))
    names = [name for name in m.bodies if name != "ground"]
    m.any_touch("ground", str(rng.choice(names)))
    if rng.random() < 0.6:
        m.unilateral(str(rng.choice(names)))
    return judge_mechanism(seed, "touching chain", m)


# rigid ----------------------------------------------------------------------------------------
def rigid(seed: int, rng: np.random.Generator) -> tuple[str, str, str]:
    """A bar or two on a hinge, thrown on the floor: no law of contact is violated."""
    system = da.System("thrown", gravity=(0.0, -9.81))
    law = {"restitution": float(rng.uniform(0, 0.8)), "friction": float(rng.uniform(0, 0.6))}
    bars, corners = [], []
    for k in range(int(rng.integers(1, 3))):
        at = {"angle": rng.uniform(-1, 1), "angular_velocity": rng.uniform(-3, 3)}
        if k == 0:
            at["position"] = (0.0, float(rng.uniform(0.5, 0.8)))
            at["velocity"] = (float(rng.uniform(-2, 2)), float(rng.uniform(-3, 0)))
        bar = planar.Bar(f"b{k}", length=0.4, mass=float(rng.uniform(0.5, 2)), **at)
        bars.append(system.add(bar))
        corners += [bar.end] if k else [bar.start, bar.end]
    if len(bars) > 1:
        system.add(planar.Revolute("hinge", bars[0].end, bars[1].start))
    for k, tip in enumerate(corners):
        system.add(planar.UnilateralConstraint(f"c{k}", tip.y, tip.velocity[0], **law))
    formulation = str(rng.choice([n for n in FORMULATIONS if n not in ("NullSpace svd", "DAE")]))
    choices = {
        "integrator": (da.DormandPrince(), da.DormandPrince(1e-9, 1e-11))[int(rng.integers(2))],
        "formulation": FORMULATIONS[formulation],
        "coordinates": COORDINATES[rng.integers(len(COORDINATES))],
    }
    case = f"{len(bars)} bars {law} {choices}"
    try:
        model = system.build()
        motion = da.solve_dynamics(model, DURATION, outputs=201, **choices)
    except da.DalembertError as error:
        return "refused", case, str(error)
    if not motion.status.success:
        return "ended", case, str(motion.status)
    wrong = "; ".join(violations(motion, len(corners), law["friction"]))
    return ("false success", case, wrong) if wrong else ("completed", case, "")


def violations(motion, count: int, friction: float) -> list[str]:
    """Signorini's and Coulomb's laws, and a balance of energy that only loses."""
    faults = []
    for k in range(count):
        gap, press, rub = (
            motion.values(f"c{k}.{name}") for name in ("gap", "normal_force", "friction_force")
        )
        scale = 1 + np.abs(press).max()
        laws = {
            "penetrates by": max(0.0, -gap.min()),
            "pulls by": max(0.0, -press.min()) / scale,
            "presses where it is open by": np.abs(press * np.maximum(gap, 0)).max() / scale,
            "leaves the cone of friction by": (np.abs(rub) - friction * press).max() / scale,
        }
        faults += [f"c{k} {law} {far:.2g}" for law, far in laws.items() if far > 100 * NEAR]
    energy = motion.values("kinetic_energy") + motion.values("potential_energy")
    if (gain := np.diff(energy).max()) > 1e-5 * np.abs(energy).max():
        faults.append(f"energy grows by {gain:.2g} J")
    return faults


# compliant ------------------------------------------------------------------------------------
def compliant(seed: int, rng: np.random.Generator) -> tuple[str, str, str]:
    """A ball on a floor by Hunt and Crossley, with friction: SciPy integrates it as well."""
    stiffness, damping = 10 ** rng.uniform(3, 6), rng.uniform(0, 0.5)
    mu, radius, mass = rng.uniform(0, 0.5), 0.1, rng.uniform(0.5, 2)
    inertia, slip_speed = 0.4 * mass * radius**2, 10 ** rng.uniform(-2, -1)
    height, start = 0.1 + rng.uniform(0, 0.3), rng.uniform((-2, -2, -20), (2, 0, 20))
    system = da.System("ball", gravity=(0.0, -9.81))
    speeds = {"velocity": tuple(start[:2]), "angular_velocity": start[2]}
    ball = planar.Body("ball", mass=mass, inertia=inertia, position=(0, height), **speeds)
    system.add(ball)
    contact = planar.contact
    shapes = contact.HalfPlane(system.ground.center), contact.Circle(ball.center, radius=radius)
    law = contact.HuntCrossley(stiffness=stiffness, damping=damping)
    rub = contact.Coulomb(mu, slip_speed=slip_speed)
    system.add(planar.Contact("floor", *shapes, law=law, friction=rub))

    def rate(t, x):
        arm = (x[1] + radius) / 2  # the force acts halfway between the two surfaces
        depth, speed, slip = radius - x[1], -x[4], x[3] + arm * x[5]
        press = 0.0
        if depth > 0:
            press = stiffness * depth**1.5 * max(0.0, 1 + damping * speed)
        drag = -mu * press * np.tanh(4 * slip / slip_speed)
        return [*x[3:], drag / mass, press / mass - 9.81, arm * drag / inertia]

    case = f"ball K={stiffness:.3g} c={damping:.2g} mu={mu:.2g} v_t={slip_speed:.2g}"
    twin = solve_ivp(rate, (0, 0.4), [0, height, 0, *start], "Radau", rtol=1e-9, atol=1e-11)
    try:
        model = system.build()
        runs = {
            "default": (da.solve_dynamics(model, 0.4), 2e-3),
            "Radau": (da.solve_dynamics(model, 0.4, integrator=da.Radau(1e-8, 1e-10)), 1e-4),
            "explicit": (da.solve_dynamics(model, 0.4, integrator=da.DormandPrince(1e-8)), 1e-4),
        }
    except da.DalembertError as error:
        return "refused", case, str(error)
    for name, (run, limit) in runs.items():
        if not run.status.success:
            return "ended", f"{case} {name}", str(run.status)
        far = apart(ends(run), twin.y[:, -1], np.repeat([1.0, np.abs(start).max()], 3))
        if far > limit and not run.warnings:
            return "false success", f"{case} {name}", f"{far:.2g} off the twin"
    return "completed", case, ""


def ends(run) -> np.ndarray:
    names = ("x", "y", "angle", "vx", "vy", "angular_velocity")
    return np.array([run.values(f"ball.{name}")[-1] for name in names])
