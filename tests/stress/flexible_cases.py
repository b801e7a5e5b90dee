"""Flexible models: Reissner's beam in NumPy, frames by direct stiffness, bodies made of them."""

from __future__ import annotations

import numpy as np
import scipy.linalg
from random_mechanisms import chain, empty

import dalembert as da
from dalembert import planar, structures
from stress.agreement import difference
from stress.planar_cases import judge_mechanism

EXACT, SMALL = 1e-7, 2e-3
"""Relative differences: of one linear problem; of small displacements by nonlinear equations."""


def judge(seed: int) -> tuple[str, str, str]:
    rng = np.random.default_rng([seed, 5])
    return (in_mechanism, frame, body)[seed % 3](seed, rng)


def in_mechanism(seed: int, rng: np.random.Generator) -> tuple[str, str, str]:
    """A chain with a beam."""
    m = empty(np.random.default_rng(seed))
    chain(m, int(rng.integers(1, 3)))
    names = [name for name in m.bodies if name == "ground" or m.turns(name)]
    i, j = (str(name) for name in rng.choice([*names, "ground"], 2, replace=False))
    m.beam("ground" if j == "ground" else i, i if j == "ground" else j)
    return judge_mechanism(seed, f"{i}-{j} beam", m)


class Frame:
    """A random chain of frame elements, clamped at its first node, by direct stiffness."""

    def __init__(self, rng: np.random.Generator):
        self.count = int(rng.integers(2, 7))
        steps = rng.uniform((0.2, -0.3), (0.5, 0.3), (self.count, 2))
        self.places = np.vstack([[0.0, 0.0], np.cumsum(steps, axis=0)])
        self.modulus, self.density = rng.uniform(1e9, 2e11), rng.uniform(1e3, 8e3)
        self.area = rng.uniform(1e-4, 1e-3, self.count)
        self.inertia = self.area**2 / 12
        self.load = rng.uniform(-1, 1, 3) * (1.0, 1.0, 0.1)

    def model(self, clamped: bool = True):
        structure = da.Structure("frame")
        nodes = [structure.node(f"n{k}", *map(float, at)) for k, at in enumerate(self.places)]
        for k in range(self.count):
            section = {"area": float(self.area[k]), "second_moment": float(self.inertia[k])}
            material = {"modulus": float(self.modulus), "density": float(self.density)}
            ends = nodes[k : k + 2]
            structure.add(structures.Frame(f"e{k}", *ends, **section, **material))
        if clamped:
            structure.support(nodes[0])
            fx, fy, mz = map(float, self.load)
            structure.load(nodes[-1], fx=fx, fy=fy, mz=mz)
        return structure.build()

    def matrices(self) -> tuple[np.ndarray, np.ndarray]:
        """Stiffness and consistent mass of Euler and Bernoulli, the clamped node left out."""
        size = 3 * (self.count + 1)
        stiffness, mass = np.zeros((size, size)), np.zeros((size, size))
        for k in range(self.count):
            along = self.places[k + 1] - self.places[k]
            length = np.hypot(*along)
            c, s = along / length
            turn = np.kron(np.eye(2), [[c, s, 0], [-s, c, 0], [0, 0, 1]])
            ea, ei = self.modulus * self.area[k], self.modulus * self.inertia[k]
            own, inert = bending(length)
            full, heavy = np.zeros((6, 6)), np.zeros((6, 6))
            full[np.ix_([0, 3], [0, 3])] = ea / length * np.array([[1, -1], [-1, 1]])
            heavy[np.ix_([0, 3], [0, 3])] = length / 6 * np.array([[2, 1], [1, 2]])
            full[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = ei * own
            heavy[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = inert
            here = slice(3 * k, 3 * k + 6)
            stiffness[here, here] += turn.T @ full @ turn
            mass[here, here] += self.density * self.area[k] * turn.T @ heavy @ turn
        return stiffness[3:, 3:], mass[3:, 3:]

    def tip(self) -> np.ndarray:
        """Displacement and rotation of the last node under the load."""
        force = np.zeros(3 * self.count)
        force[-3:] = self.load
        return np.linalg.solve(self.matrices()[0], force)[-3:]


def bending(length: float) -> tuple[np.ndarray, np.ndarray]:
    """Cubic shapes: stiffness for EI = 1 and mass for ρA = 1."""
    a = length
    stiffness = [[12, 6 * a, -12, 6 * a], [6 * a, 4 * a * a, -6 * a, 2 * a * a]]
    stiffness += [[-12, -6 * a, 12, -6 * a], [6 * a, 2 * a * a, -6 * a, 4 * a * a]]
    mass = [[156, 22 * a, 54, -13 * a], [22 * a, 4 * a * a, 13 * a, -3 * a * a]]
    mass += [[54, 13 * a, 156, -22 * a], [-13 * a, -3 * a * a, -22 * a, 4 * a * a]]
    return np.array(stiffness) / a**3, a / 420 * np.array(mass)


def frame(seed: int, rng: np.random.Generator) -> tuple[str, str, str]:
    """Statics, large displacements under a small load, and the lowest frequencies."""
    twin = Frame(rng)
    case, last = f"frame of {twin.count}", f"n{twin.count}"
    twin.load *= 1e-5 / np.abs(twin.tip()[:2]).max()
    try:
        model = twin.model()
        results = {
            "linear": da.solve_statics(model),
            "large": da.solve_statics(model, nonlinear=True),
        }
        modes = da.solve_modes(model, 3)
    except da.DalembertError as error:
        return "refused", case, str(error)
    for name, result in results.items():
        if not result.status.success:
            return "ended", case, str(result.status)
        computed = np.array([result.values(f"{last}.{u}")[-1] for u in ("ux", "uy", "rz")])
        limit = EXACT if name == "linear" else SMALL
        far = np.abs(computed - twin.tip()).max() / np.abs(twin.tip()).max()
        if not far <= limit:
            return "false success", case, f"{name} statics: {far:.2g} off direct stiffness"
    squares = scipy.linalg.eigh(*twin.matrices(), eigvals_only=True)[:3]
    far = np.abs(np.asarray(modes.frequencies) * 2 * np.pi / np.sqrt(squares) - 1).max()
    if not far <= EXACT:
        return "false success", case, f"frequencies are {far:.2g} off"
    return "completed", case, ""


def body(seed: int, rng: np.random.Generator) -> tuple[str, str, str]:
    """A flexible body clamped to the ground bends as the structure does, and keeps its energy."""
    twin = Frame(rng)
    twin.load = np.array([0.0, -1.0, 0.0])
    twin.load *= 1e-4 / np.abs(twin.tip()[:2]).max()
    last = f"n{twin.count}"
    case = f"flexible body of {twin.count}"
    system = da.System("flexible")
    try:
        rod = planar.FlexibleBody(
            "rod",
            twin.model(clamped=False),
            interface={"root": "n0", "tip": last},
            modes=int(rng.integers(0, 3)),
            reference="root",
        )
        system.add(rod)
        root, tip = rod.section("root"), rod.section("tip")
        system.add(planar.Weld("clamp", system.ground.center, root.center))
        push = tuple(map(float, twin.load[:2]))
        system.add(planar.Force("push", tip.center, push))
        model = system.build()
        rest = da.solve_equilibrium(model)
        runs = [
            da.solve_dynamics(model, 0.01, outputs=2, integrator=integrator)
            for integrator in (da.Radau(1e-9, 1e-13), da.Radau(1e-8, 1e-12))
        ]
    except da.DalembertError as error:
        return "refused", case, str(error)
    if not (rest.status.success and all(run.status.success for run in runs)):
        return "ended", case, str(rest.status if not rest.status.success else runs[0].status)
    computed = [float(rest.values(f"rod.tip.{x}")[-1]) for x in "xy"] - twin.places[-1]
    far = np.abs(computed - twin.tip()[:2]).max() / np.abs(twin.tip()[:2]).max()
    if not far <= SMALL:
        return "false success", case, f"the tip is {far:.2g} off direct stiffness"
    if (gap := difference(*runs)) > 1e-4:
        return "false success", case, f"two tolerances differ by {gap:.2g}"
    return "completed", case, ""
