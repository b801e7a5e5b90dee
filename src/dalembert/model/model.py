"""The frozen model: symbolic equations, a consistent start and a diagnosis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from dalembert.elements.base import Coordinates, ForceElement, rate_of
from dalembert.elements.planar.drivers import Driver
from dalembert.elements.planar.loads import Gravity
from dalembert.errors import AssemblyError, ModelError, SingularityError
from dalembert.model.assembly import (
    POSITION_TOLERANCE,
    AssembledState,
    Assembler,
    Guesses,
    independent_rows,
)
from dalembert.model.diagnosis import Diagnosis, Redundancy
from dalembert.model.equations import Equations
from dalembert.model.topology import analyse_topology
from dalembert.symbolic.expression import Expression, free_symbols, stack, t

if TYPE_CHECKING:
    from dalembert.model.system import System

SYSTEM_MEASURES = {
    "time": "s",
    "kinetic_energy": "J",
    "potential_energy": "J",
    "dissipated_power": "W",
    "input_power": "W",
}


class Model:
    """A mechanism, checked, assembled and frozen; made by ``System.build``.

    Attributes
    ----------
    equations : Equations with the independent constraint rows
    parameters : name → Parameter
    diagnosis : Diagnosis
    start : AssembledState at the nominal parameters
    """

    def __init__(self, system: System, strict: bool = False):
        self.name, self.description = system.name, system.description
        self.system = system
        self.parameters = dict(system.parameters)
        self.derived_parameters = dict(system.derived_parameters)
        self.bodies, self.ground = system.bodies, system.ground
        self.constraints, self.forces = system.constraints, system.forces
        self.coordinates: list[Coordinates] = system.coordinates
        self.functions: dict = {}
        """Compiled functions, by the choices that made them."""
        self.all_equations = self._make_equations()
        self.nominal = np.array([p.value for p in self.parameters.values()], dtype=float)
        self._row_owner = [(c, k) for c in self.constraints for k in range(c.equations.numel())]
        self.guesses = Guesses.collect(self.coordinates)
        self._assembler = Assembler(
            self.all_equations,
            self.guesses,
            [c.name for c, _ in self._row_owner],
            [self.at_ground(m.sx - v.sx) for m, v in system.initial_conditions],
            self._curve_searches(),
        )
        mass = np.diag(self.mass_matrix(self.nominal))
        self.all_equations = replace(
            self.all_equations, massless=tuple(int(k) for k in np.flatnonzero(mass == 0))
        )
        self._assemble(strict)

    def mass_matrix(self, p: np.ndarray) -> np.ndarray:
        """``M`` at the guessed position for parameter values ``p``."""
        e = self.all_equations
        function = self.compiled("mass", lambda: ca.Function("M", [e.y, e.p], [ca.densify(e.mass)]))
        return function(np.zeros(e.coordinate_count), p).full()

    def _hold_positions(self, y: np.ndarray, p: np.ndarray) -> None:
        """Hold as many given coordinates as can be had, the first ones first."""
        free: set[int] = set()
        while True:
            self.held = self._assembler.choose_held(0.0, y, p, self.rows, free)
            self.functions.pop("square", None)
            wanted = [
                k for k, c in zip(self.held.indices, self.held.constants, strict=True) if c is None
            ]
            try:
                self._follow(p, y, p, 0.0)
            except AssemblyError:
                if not wanted:
                    raise
                free.add(wanted[0])
            else:
                return

    def _curve_searches(self) -> list[tuple[int, list[int], tuple[float, float]]]:
        """Curve parameters without a guess: coordinate, equations, range."""
        found = []
        for constraint in self.constraints:
            for part in constraint.own_coordinates():
                if part.guesses()[0][0] is None:
                    index = self.guesses.owners.index(part.name)
                    rows = [k for k, (c, _) in enumerate(self._row_owner) if c is constraint]
                    found.append((index, rows, part.interval))
        return found

    # equations -----------------------------------------------------------------
    def at_ground(self, expression: ca.SX) -> ca.SX:
        """The expression with the ground at rest in the origin."""
        g = self.ground
        symbols = ca.vertcat(g.pose, g.twist, g.acceleration_symbols)
        return ca.substitute(expression, symbols, ca.SX.zeros(symbols.numel()))

    def _make_equations(self) -> Equations:
        groups = self.coordinates
        y = stack(c.pose for c in groups)
        v = stack(c.twist for c in groups)
        fixed = self.at_ground
        constraints = fixed(stack(c.equations for c in self.constraints))
        multiplier = stack(c.multiplier for c in self.constraints)
        coordinates, efforts, losses = [], [], ca.SX(0)
        potential, released = ca.SX(0), ca.SX(0)  # released: power that is not from storage
        for element in self.forces:
            owners = element.parts() or groups

            def rate(s: ca.SX, owners=owners) -> ca.SX:
                return rate_of(s, owners, t.sx)

            works = element.works(rate)
            coordinates += [s for s, _ in works]
            efforts += [q for _, q in works]
            for s, q in element.dissipation(rate):
                losses -= q * rate(s)
            stored = element.potential()
            if stored is not None:
                potential += stored
            if not isinstance(element, Gravity):  # whose work is its potential's, exactly
                released += sum((q * rate(s) for s, q in works), ca.SX(0))
                released += 0 if stored is None else rate(stored)
        effort, losses = fixed(stack(efforts)), fixed(losses)
        self.potential = fixed(potential)
        rates = rate_of(fixed(stack(coordinates)), groups, t.sx)
        delivered = ca.dot(multiplier, ca.jacobian(constraints, t.sx))  # by drivers: C v = −Φ_t
        applied = fixed(released)
        return Equations(
            t=t.sx,
            y=y,
            v=v,
            p=stack(p.sx for p in self.parameters.values()),
            a=stack(c.acceleration_symbols for c in groups),
            multiplier=multiplier,
            pose_rate=stack(c.pose_rate for c in groups),
            mass=ca.sparsify(ca.diagcat(*(c.mass_matrix() for c in groups))),
            bias=ca.SX.zeros(v.numel()),
            force=ca.jtimes(rates, v, effort, True) if effort.numel() else ca.SX.zeros(v.numel()),
            constraints=constraints,
            powers=ca.vertcat(losses, applied + losses + delivered),
        )

    # assembly and diagnosis ------------------------------------------------------
    def _assemble(self, strict: bool) -> None:
        assembler, p = self._assembler, self.nominal
        y_size = self.all_equations.coordinate_count
        try:
            y = assembler.project(0.0, p)
        except AssemblyError:  # too many drivers is the better explanation, if it is one
            drivers = [k for k, (c, _) in enumerate(self._row_owner) if isinstance(c, Driver)]
            freedom = y_size - (len(self._row_owner) - len(drivers))
            if 1 <= freedom < len(drivers):
                self._refuse_over_driving(sorted(set(range(len(self._row_owner))) - {drivers[-1]}))
            raise
        self._refuse_undefined(y, p)
        jacobian = self._joint_jacobian(0.0, y)
        rows = independent_rows(jacobian)
        if len(rows) < jacobian.shape[0]:
            rows = self._rows_nearby(y, p, rows)
        self.rows = rows
        self._refuse_over_driving(rows)
        self.equations = self.all_equations.with_rows(rows)
        self._anchor = (p.copy(), y)
        self._hold_positions(y, p)
        y = self._follow(p, y, p, 0.0)
        self._anchor = (p.copy(), y)
        self.held_speeds, miss = assembler.choose_held_speeds(0.0, y, p, rows)
        if miss and strict:
            name, value = max(miss.items(), key=lambda item: abs(item[1]))
            raise AssemblyError(
                f"initial speeds are inconsistent with the joints: {name} would have to change by "
                f"{value:.3g}; correct them, or build without strict",
                abs(value),
            )
        self.projected_speeds = bool(miss)
        self.start = self.assemble(p)
        self.diagnosis = self._diagnose(jacobian)

    def _joint_jacobian(self, time: float, y: np.ndarray) -> np.ndarray:
        e = self.all_equations
        return self.compiled("jacobian", lambda: ca.Function("C", [e.t, e.y, e.p], [e.jacobian]))(
            time, y, self.nominal
        ).full()

    def _rows_nearby(self, y: np.ndarray, p: np.ndarray, rows: list[int]) -> list[int]:
        """Tell redundancy, which stays, from a singular position, which a small motion leaves.

        Raises
        ------
        SingularityError
            The start is a singular position: the motion from there is not determined.
        """
        joints = [k for k, (c, _) in enumerate(self._row_owner) if not isinstance(c, Driver)]
        jacobian = self._joint_jacobian(0.0, y)[joints]
        rank = len(independent_rows(jacobian))
        kernel = np.linalg.svd(jacobian)[2][rank:]
        rng = np.random.default_rng(1)
        for size in (1e-2, 1e-3) if kernel.size else ():
            moved = y + size * kernel.T @ rng.standard_normal(kernel.shape[0])
            moved, residual = self._assembler.close(0.0, moved, p, joints)
            if residual < 1e-10:
                generic = independent_rows(self._joint_jacobian(0.0, moved), 1e-7)
                if len(generic) > len(rows):
                    extra = ", ".join(
                        dict.fromkeys(self._row_owner[k][0].name for k in set(generic) - set(rows))
                    )
                    raise SingularityError(
                        "the start is a singular position (dead centre or branch point): "
                        f"{extra} lose their independence there; start a little beside it"
                    )
        return rows

    def _refuse_undefined(self, y: np.ndarray, p: np.ndarray) -> None:
        """Every element must have a value and a direction where the mechanism is assembled."""
        e = self.all_equations
        whole = stack([ca.vec(e.jacobian.nz[:]), e.force])
        if self._is_finite(whole, y, p):
            return
        for element in (*self.constraints, *self.forces):
            if not self._is_finite(self._definition(element), y, p):
                raise ModelError(
                    "has no defined direction or value at the assembled position (two points that "
                    "coincide, a root or a division by zero?); move its points or mend its formula",
                    element.name,
                )

    def _definition(self, element) -> ca.SX:
        """Directions and values an element is made of."""
        y = self.all_equations.y
        if not isinstance(element, ForceElement):
            return ca.vec(ca.jacobian(self.at_ground(element.equations), y))
        owners = element.parts() or self.coordinates
        works = element.works(lambda s: rate_of(s, owners, t.sx))
        parts = [ca.vec(ca.jacobian(self.at_ground(s), y)) for s, _ in works]
        return stack(parts + [self.at_ground(q) for _, q in works])

    def _is_finite(self, column: ca.SX, y: np.ndarray, p: np.ndarray) -> bool:
        e = self.all_equations
        inputs = [e.t, e.y, e.v, e.p]
        if free_symbols(column) - free_symbols(ca.vertcat(*inputs)):
            return True  # accelerations or multipliers: nothing can be said before a run
        values = ca.Function("defined", inputs, [column])(0.0, y, np.zeros(y.size), p)
        return bool(np.all(np.isfinite(values.full())))

    def _refuse_over_driving(self, rows: list[int]) -> None:
        kept = set(rows)
        for k, (constraint, _) in enumerate(self._row_owner):
            if isinstance(constraint, Driver) and k not in kept:
                raise ModelError(
                    "drives a coordinate that the joints and other drivers already determine "
                    "(over-driven mechanism); remove this driver or another one",
                    constraint.name,
                )

    def assemble(self, p: np.ndarray, time: float = 0.0) -> AssembledState:
        """Consistent initial state for parameter values ``p``, on the branch of the nominal one.

        Raises
        ------
        AssemblyError
            Names the worst joint and its residual.
        """
        anchor_p, anchor_y = self._anchor
        y = self._follow(anchor_p, anchor_y, p, time)
        state = self.initial_state.function(time, y, p)
        v = state[1].full().ravel()
        residual = np.abs(self._square(time, y, p)[0].full()).max(initial=0.0)
        guess_y, guess_v = (g.full().ravel() for g in self._assembler._guess(p))
        corrections = {
            name: float(y[k] - guess_y[k])
            for k, name in enumerate(self.guesses.names)
            if self.guesses.pose[k] is not None
        }
        changes = {
            name: float(v[k] - guess_v[k])
            for k, name in enumerate(self.guesses.names)
            if self.guesses.twist[k] is not None and self.projected_speeds
        }
        return AssembledState(y, v, float(residual), corrections, changes, self.projected_speeds)

    @property
    def initial_state(self):
        """``(t, y_start, p) → (y0, v0)`` as an implicit function of the parameters."""
        return self.compiled(
            "initial_state",
            lambda: self._assembler.initial_state(
                self.rows, self.held, self.held_speeds, self.projected_speeds
            ),
        )

    @property
    def _square(self) -> ca.Function:
        e = self.all_equations

        def make() -> ca.Function:
            residual = self._assembler.position_residual(self.rows, self.held)
            return ca.Function("square", [e.t, e.y, e.p], [residual, ca.jacobian(residual, e.y)])

        return self.compiled("square", make)

    def _follow(self, p0: np.ndarray, y0: np.ndarray, p1: np.ndarray, time: float) -> np.ndarray:
        """Newton from the nominal assembly; in smaller steps of time and parameters if need be."""
        reached, y, step = 0.0, y0, 1.0
        while reached < 1.0:
            target = min(1.0, reached + step)
            trial, residual = self._newton(target * time, y, p0 + target * (p1 - p0))
            if residual < POSITION_TOLERANCE:
                reached, y, step = target, trial, 2 * step
                continue
            step /= 2
            if step < 1e-3 / (1.0 + abs(time)):
                raise self._assembler.failure(target * time, trial, p0 + target * (p1 - p0))
        return y

    def _newton(self, time: float, y: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, float]:
        norm = np.inf
        for _ in range(25):
            r, jacobian = (a.full() for a in self._square(time, y, p))
            new = np.abs(r).max(initial=0.0)
            if not np.isfinite(new) or (new >= norm * 0.9 and norm < POSITION_TOLERANCE):
                break
            if new > 4 * norm:
                return y, float(norm)
            norm, best = new, y
            if norm < 1e-15:
                break
            try:
                delta = np.linalg.solve(jacobian, r.ravel())
            except np.linalg.LinAlgError:
                return y, float(norm)
            y = y - delta * min(1.0, 1.0 / max(np.abs(delta).max(initial=0.0), 1e-300))
        return best if np.isfinite(norm) else y, float(norm)

    def _diagnose(self, jacobian: np.ndarray) -> Diagnosis:
        is_driver = np.array([isinstance(c, Driver) for c, _ in self._row_owner], dtype=bool)
        kept = np.zeros(len(self._row_owner), dtype=bool)
        kept[self.rows] = True
        n = self.equations.coordinate_count
        own = sum(c.pose.numel() for k in self.constraints for c in k.own_coordinates())
        joint_rows = int(np.sum(~is_driver))
        independent_joint_rows = int(np.sum(kept & ~is_driver))
        redundancies = tuple(
            self._redundancy(k, jacobian) for k in range(len(self._row_owner)) if not kept[k]
        )
        touched = {b.name for c in self.constraints for b in c.parts()}
        touched |= {b.name for f in self.forces if f.name != "gravity" for b in f.parts()}
        return Diagnosis(
            coordinates=n - own,
            joint_equations=joint_rows - own,
            driver_equations=int(np.sum(is_driver)),
            degrees_of_freedom=n - independent_joint_rows,
            gruebler=n - joint_rows,
            free=n - len(self.rows),
            redundancies=redundancies,
            topology=analyse_topology(self.bodies, self.constraints, touched),
            massless=self._massless(jacobian),
            bodies=tuple(b.name for b in self.bodies),
            joints=tuple(c.name for c in self.constraints if not isinstance(c, Driver)),
            drivers=tuple(c.name for c in self.constraints if isinstance(c, Driver)),
            forces=tuple(f.name for f in self.forces),
            corrections=self.start.corrections,
            velocity_corrections=self.start.velocity_corrections,
        )

    def _redundancy(self, row: int, jacobian: np.ndarray) -> Redundancy:
        constraint, component = self._row_owner[row]
        weights, *_ = np.linalg.lstsq(jacobian[self.rows].T, jacobian[row], rcond=None)
        shared = [
            self._row_owner[k][0].name
            for k, w in zip(self.rows, weights, strict=True)
            if abs(w) > 1e-9 and self._row_owner[k][0] is not constraint
        ]
        return Redundancy(constraint.name, component, tuple(dict.fromkeys(shared)))

    def _massless(self, jacobian: np.ndarray) -> tuple[str, ...]:
        """Bodies that take part in a free motion without kinetic energy."""
        mass = self.mass_matrix(self.nominal)
        basis = np.linalg.svd(jacobian[self.rows])[2][len(self.rows) :].T
        if not basis.size:
            return ()
        values, vectors = np.linalg.eigh(basis.T @ mass @ basis)
        scale = max(np.abs(mass).max(), 1e-300)
        lost = basis @ vectors[:, values < 1e-12 * scale]
        moving = np.abs(lost).max(axis=1, initial=0.0) > 1e-6
        return tuple(
            dict.fromkeys(o for o, m in zip(self.guesses.owners, moving, strict=True) if m)
        )

    # access ------------------------------------------------------------------------
    def compiled(self, key, make):
        """The function made once for these choices."""
        if key not in self.functions:
            self.functions[key] = make()
        return self.functions[key]

    def values(self, parameters: Mapping[str, float] | None = None) -> np.ndarray:
        """Parameter vector with some values replaced.

        Raises
        ------
        ModelError
            Unknown parameter or a value that is not finite.
        """
        p = self.nominal.copy()
        names = list(self.parameters)
        for name, value in (parameters or {}).items():
            if name not in self.parameters:
                known = ", ".join(names) or "none"
                raise ModelError(f"unknown parameter {name!r} (known: {known})", self.name)
            number = float(value)
            if not np.isfinite(number):
                raise ModelError(f"value {value} is not a finite number", name)
            p[names.index(name)] = number
        return p

    def __getitem__(self, name: str) -> Expression:
        """A measure or parameter by name, e.g. ``model["crank.end.x"]``.

        Raises
        ------
        KeyError
            Unknown name, with the nearest known ones.
        """
        return self.compiled(("measure", name), lambda: self._named_measure(name))

    def _named_measure(self, name: str) -> Expression:
        found = self._system_measure(name)
        if found is None:
            found = self.system.lookup(name)
        if found is None:
            import difflib

            close = difflib.get_close_matches(name, self.measure_names, 3, 0.4)
            raise KeyError(f"no measure {name!r}; nearest: {', '.join(close) or 'none'}")
        return Expression(self.measurable(found.sx), found.name or name, found.unit)

    def measurable(self, expression: ca.SX) -> ca.SX:
        """Ground at rest, multipliers of redundant equations zero."""
        fixed = self.at_ground(expression)
        gone = self._redundant_multipliers
        return ca.substitute(fixed, gone, ca.SX.zeros(gone.numel())) if gone.numel() else fixed

    @cached_property
    def _redundant_multipliers(self) -> ca.SX:
        rows = sorted(set(range(len(self._row_owner))) - set(self.rows))
        return self.all_equations.multiplier[rows] if rows else ca.SX(0, 1)

    def _system_measure(self, name: str) -> Expression | None:
        e = self.equations
        if name not in SYSTEM_MEASURES:
            return None
        sx = {
            "time": lambda: e.t,
            "kinetic_energy": lambda: ca.mtimes([e.v.T, e.mass, e.v]) / 2,
            "potential_energy": lambda: self.potential,
            "dissipated_power": lambda: e.powers[0],
            "input_power": lambda: e.powers[1],
        }[name]()
        return Expression(sx, name, SYSTEM_MEASURES[name])

    @cached_property
    def measure_names(self) -> list[str]:
        """Names of all measures."""
        return [*SYSTEM_MEASURES, *self.system.measure_names()]

    def formula(self, text: str) -> Expression:
        """A formula of measures, parameters and ``t``."""
        return self.compiled(("formula", text), lambda: self._parsed(text))

    def _parsed(self, text: str) -> Expression:
        made = self.system.formula(text)
        return Expression(self.measurable(made.sx), text, made.unit)

    def __repr__(self) -> str:
        return f"<Model {self.name!r}: {self.diagnosis.summary}>"
