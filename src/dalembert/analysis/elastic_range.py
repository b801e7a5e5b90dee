"""Validity range of elastic bodies: linear shapes at small rotations, beams at small strains."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.equilibrium.linear_range import (
    QUIET,
    RELATIVE,
    SHORT,
    LinearRange,
    isostatic,
    percent,
)
from dalembert.elements.flexible.beam import Beam
from dalembert.elements.flexible.body import MEAN, Flexible
from dalembert.elements.flexible.shapes import FloatingShapes
from dalembert.model.assembled.evaluation.assembly import Assembly
from dalembert.model.assembled.evaluation.stiffness_solvers import factors_of, free_displacements
from dalembert.model.assembled.reduction.rigid import interfaces_of, node_positions
from dalembert.model.graph.model import Model
from dalembert.results.recording import Trajectory
from dalembert.symbolic.once import once

STRAIN = 0.1
"""Strain above which a linear elastic law is reported; nonlinear laws differ by half of it."""
MODERATE = 0.1
"""Upper limit of the rotation for which second-order displacements suffice [rad]."""
SPLIT = "split it into several flexible bodies welded in a row, or use planar.Beam or spatial.Beam"


def elastic_warnings(model: Model, s: Trajectory, p: np.ndarray) -> list[str]:
    """Warnings about flexible bodies and beams beyond the validity range of their equations.

    Parameters
    ----------
    model, s, p : states of the result and the parameters
    """
    finite = np.flatnonzero(np.all(np.isfinite(s.y), axis=0))
    if not finite.size:
        return []
    times, y = s.t[finite], s.y[:, finite]
    warnings = []
    bodies = [b for b in model.bodies if isinstance(b, Flexible) and b.shapes.count]
    for body, function in zip(bodies, coordinates_of(model), strict=True):
        q = function.map(times.size)(y).full()
        warnings += FlexibleRange(model, body, p).warnings(times, q)
    return warnings + _strain_warnings(model, times, y, p)


@once
def coordinates_of(model: Model) -> tuple[ca.Function, ...]:
    """``y → q`` of each flexible body."""
    y = model.all_equations.y
    bodies = [b for b in model.bodies if isinstance(b, Flexible) and b.shapes.count]
    return tuple(ca.Function("q", [y], [ca.densify(b.q)]) for b in bodies)


class FlexibleRange:
    """Displacements of a flexible body, compared with nonlinear statics of its structure.

    The applied forces are those balanced by the shapes, in the axes of the floating frame.

    Parameters
    ----------
    body : Flexible
    p : (np,) parameters of the mechanism
    """

    def __init__(self, model: Model, body: Flexible, p: np.ndarray):
        self.body, self.shapes = body, model.shapes(body, p)

    def warnings(self, times: np.ndarray, q: np.ndarray) -> list[str]:
        """Warning about the worst of a few instants if it is beyond the validity range.

        Parameters
        ----------
        q : (m, K) coordinates
        """
        worst, warning = RELATIVE, ""
        for k in self._largest(q):
            frame = ShapesInFrame(self.body, self.shapes, q[:, k])
            error, text = frame.error
            if error > worst:
                worst, warning = error, f"{self.body.name} at t = {times[k]:.6g} s: {text}"
        return [warning] if warning else []

    def _largest(self, q: np.ndarray) -> list[int]:
        """Instants of the largest strain energy and of the largest displacement."""
        energy = np.einsum("ik,ij,jk->k", q, self.shapes.stiffness, q)
        size = np.abs(self.shapes.displacements[:, : len(q)]).max(axis=0) @ np.abs(q)
        candidates = {int(np.argmax(energy)), int(np.argmax(size))}
        return sorted(k for k in candidates if energy[k] > 0)


class ShapesInFrame:
    """Displacements from the shapes of a body at one instant.

    Parameters
    ----------
    q : (m,) coordinates
    """

    def __init__(self, body: Flexible, shapes: FloatingShapes, q: np.ndarray):
        self.body, self.shapes, self.q = body, shapes, q
        assembly = _held_assembly(shapes, body)
        self.assembly, self.rest = assembly, np.zeros(assembly.size)
        a = np.append(q, [q[k] * q[l] for k, l in shapes.pairs])
        floating = body.reference == MEAN
        arguments = shapes.structure, shapes.p, shapes.displacements @ a, assembly.prescribed
        self.range = LinearRange(*arguments, self._solve, floating)

    @property
    def error(self) -> tuple[float, str]:
        """Error relative to the largest displacement, and the text of the warning."""
        linear_range = self.range
        if self.body.stiffening:
            if linear_range.largest_rotation[0] < MODERATE:
                return 0.0, ""
        elif self._in_range:
            return 0.0, ""
        error = linear_range.nonlinear_error(self.forces)
        turn, where = linear_range.largest_rotation
        size = linear_range.displacement / max(linear_range.extent, 1e-300)
        text = (
            f"its displacements against the frame reach {size:.2g} of its size (rotation or "
            f"strain of element {where}: {turn:.2g})"
        )
        if not np.isfinite(error):
            return error, (
                f"{text}; nonlinear statics of its elements has no stable equilibrium under these "
                f"forces (buckling), so that linear shapes do not hold; {self._cure}"
            )
        by = error * linear_range.displacement
        return error, (
            f"{text}; by nonlinear statics of its elements under the same forces they err by about "
            f"{by:.3g} m, {percent(error)} of the largest; {self._cure}"
        )

    @property
    def forces(self) -> np.ndarray:
        """(n,) forces on the elements, with the work of the linear stiffness on the shapes."""
        count = self.shapes.count
        linear = self.shapes.displacements[:, :count]
        rates = linear.copy()
        for column, (k, l) in enumerate(self.shapes.pairs, start=count):
            rates[:, k] += self.shapes.displacements[:, column] * self.q[l]
            rates[:, l] += self.shapes.displacements[:, column] * self.q[k]
        strained = self._stiffness @ linear
        work = rates.T @ strained
        return strained @ np.linalg.lstsq(work, self.shapes.stiffness @ self.q, rcond=None)[0]

    @property
    def _cure(self) -> str:
        small = self.range.largest_rotation[0] < 3 * MODERATE
        if small and not self.body.stiffening:
            return "use stiffening=True with reference= an interface, or " + SPLIT
        return SPLIT

    @property
    def _in_range(self) -> bool:
        """Whether linear shapes suffice: second-order error and buckling."""
        stiffening = self._stress_stiffening
        if self.range.largest_rotation[0] < QUIET and np.abs(stiffening).max(initial=0.0) < QUIET:
            return True
        return bool(self.range.estimate < RELATIVE and stiffening.min(initial=0.0) > -1.0)

    @property
    def _stress_stiffening(self) -> np.ndarray:
        """(m,) relative change of the stiffness of each shape by the stresses; −1 at buckling."""
        share = SHORT / max(self.range.largest_rotation[0], 1e-300)
        u, stiffness = share * self.range.u, self.range.model.assembly.stiffness
        shapes = self.shapes.displacements[:, : self.shapes.count]
        changed = (stiffness(u, self.shapes.p) - stiffness(-u, self.shapes.p)) / (2 * share)
        geometric = np.einsum("ik,ik->k", shapes, changed @ shapes)
        own = np.diag(self.shapes.stiffness)
        return np.divide(geometric, own, out=np.zeros_like(own), where=own > 0)

    def _solve(self, forces: np.ndarray) -> np.ndarray:
        free = self.assembly.free
        factor = factors_of(self.assembly.inner(self._stiffness), self._degrees, free)
        return free_displacements(factor, free, forces)

    @cached_property
    def _stiffness(self) -> Any:
        return self.assembly.stiffness(self.rest, self.shapes.p)

    @property
    def _degrees(self) -> Any:
        return self.shapes.structure.degrees


@once
def _held_assembly(shapes: FloatingShapes, body: Flexible) -> Assembly:
    """Assembly with the frame at rest: fixed in its interface, or isostatically."""
    structure = shapes.structure
    degrees, whole = structure.degrees, structure.assembly
    positions = node_positions(whole.blocks, degrees, shapes.p)
    interfaces = {i.name: i for i in interfaces_of(body.interface, degrees, positions)}
    if body.reference in interfaces:
        held = interfaces[body.reference].degrees
    else:
        nodes = np.unique(np.concatenate([i.nodes for i in interfaces.values()]))
        held = isostatic(structure, positions, nodes)
    return Assembly(whole.blocks, whole.size, held, whole.pattern)


def _strain_warnings(model: Model, times: np.ndarray, y: np.ndarray, p: np.ndarray) -> list[str]:
    """Warnings about beams whose strains exceed those of a linear elastic law."""
    warnings = []
    for beam, function in strains_of(model):
        parameters = np.tile(p[:, None], times.size)
        strains, turns = function.map(times.size)(times, y, parameters)
        values = strains.full().max(axis=0)
        k = int(np.argmax(values))
        if values[k] > STRAIN:
            cure = _full_turns(float(turns[k])) or (
                "use a stiffer or longer beam, or take its forces as estimates"
            )
            warnings.append(
                f"{beam.name} at t = {times[k]:.6g} s: strain {values[k]:.2g} (outer fibre of a "
                f"solid section with these rigidities); its linear law of small strains errs by "
                f"about {percent(values[k] / 2)} there; {cure}"
            )
    return warnings


def _full_turns(turn: float) -> str:
    """Cure for a planar beam whose second end is clamped by full turns away from its natural shape,
    as that of a closed belt, for the rotation between them [rad]; none within half a turn."""
    count = -round(turn / (2 * np.pi))
    if not count:
        return ""
    return (
        f"its second end is turned by {-count:+d} full turns against its natural shape, as planar "
        f"angles are not periodic; where these are not meant, add {count} times 2 pi to angle_j"
    )


@once
def strains_of(model: Model) -> list[tuple[Beam, ca.Function]]:
    """``(t, y, p) → (points,), ()`` magnitudes of strains at the outer fibre of each beam, and the
    rotation of its second end against its natural shape, of planar beams [rad]."""
    e, functions = model.all_equations, []
    for beam in (part for part in model.parts.elements.values() if isinstance(part, Beam)):
        sizes = [ca.norm_2(beam.fibre_strain(strain)) for strain, _ in beam.strains]
        turn = ca.SX(0)
        if beam.dimension == 2:
            turn = beam.sections[-1].turn - beam.natural_pose(beam.count - 1)[1]
        columns = [model.at_ground(ca.vertcat(*sizes)), model.at_ground(ca.densify(turn))]
        function = ca.Function("strain", [e.t, e.y, e.p], columns)
        functions.append((beam, function))
    return functions
