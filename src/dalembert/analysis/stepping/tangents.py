"""Minimal coordinates of the changes of a state: entries that are independent on its manifold."""

from __future__ import annotations

from functools import cached_property

import casadi as ca
import numpy as np
import scipy

from dalembert.errors import SingularityError
from dalembert.model.graph.coordinates import CoordinateView


class IndependentEntries:
    """Independent entries of ``x = [y; v]`` under ``G(t, x, p) dx = 0``; the others follow.

    ``G`` contains positions, speeds and unit lengths of Euler parameters. By column pivoting at a
    first state, so that the entries stay the same along a motion.

    Parameters
    ----------
    view : the model in the coordinates of the state
    size : of the whole state; entries after ``v`` are independent, if they change
    fixed : numbers of entries that do not enter, such as accumulated work
    """

    def __init__(self, view: CoordinateView, size: int, fixed: range):
        self.e = view.equations
        self.count = self.e.coordinate_count + self.e.speed_count
        self.rest = [k for k in range(self.count, size) if k not in fixed]
        self.size, self.view = size, view

    @property
    def _levels(self) -> ca.SX:
        e = self.e
        levels = e.constraints[list(e.holds), :], e.manifold.bounds, e.velocity_constraints
        return ca.densify(ca.vertcat(*levels))

    @cached_property
    def _tangency(self) -> ca.Function:
        x = ca.vertcat(self.e.y, self.e.v)
        slopes = ca.densify(ca.jacobian(self._levels, x))
        return ca.Function("tangency", [self.e.t, x, self.e.p], [slopes])

    @cached_property
    def _by_parameters(self) -> ca.Function:
        """``∂G/∂p`` of the equations that hold."""
        x = ca.vertcat(self.e.y, self.e.v)
        slopes = ca.densify(ca.jacobian(self._levels, self.e.p))
        return ca.Function("by_parameters", [self.e.t, x, self.e.p], [slopes])

    def choose(self, t: float, x: np.ndarray, p: np.ndarray) -> None:
        """Choose the independent entries at a state."""
        slopes = self._tangency(t, x[: self.count], p).full()
        rank = slopes.shape[0]
        _, _, order = scipy.linalg.qr(slopes, mode="economic", pivoting=True)
        self.dependent = sorted(int(k) for k in order[:rank])
        self.own = [k for k in range(self.count) if k not in set(self.dependent)]
        self.free = [*self.own, *self.rest]

    @cached_property
    def names(self) -> list[str]:
        """Names of all entries of ``x``."""
        speeds = [f"rate of {name}" for name in self.view.speed_names]
        return [*self.view.names, *speeds[: self.e.speed_count]]

    def name(self, entry: int) -> str:
        return self.names[entry] if entry < self.count else f"memory {entry - self.count + 1}"

    def basis(self, t: float, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        """(n, f) changes of the whole state by unit changes of the independent entries.

        Raises
        ------
        SingularityError
            The entries are not independent at this state.
        """
        basis = np.zeros((self.size, len(self.free)))
        basis[self.free, range(len(self.free))] = 1.0
        if self.dependent:
            own = self._tangency(t, x[: self.count], p).full()[:, self.own]
            basis[self.dependent, : len(self.own)] = self._following(t, x, p, own)
        return basis

    def shift(self, t: float, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        """(n, np) changes of the state by unit changes of parameters, if independent entries rest.

        Raises
        ------
        SingularityError
            As of ``basis``.
        """
        shift = np.zeros((self.size, p.size))
        if self.dependent:
            slopes = self._by_parameters(t, x[: self.count], p).full()
            shift[self.dependent] = self._following(t, x, p, slopes)
        return shift

    def _following(self, t: float, x: np.ndarray, p: np.ndarray, changes: np.ndarray) -> np.ndarray:
        """Changes of the dependent entries that close changes of the equations."""
        slopes = self._tangency(t, x[: self.count], p).full()
        try:
            return -np.linalg.solve(slopes[:, self.dependent], changes)
        except np.linalg.LinAlgError:
            names = ", ".join(self.name(k) for k in self.own)
            text = f"{names} do not determine the state at t = {t:.6g} s; reset the stepper"
            raise SingularityError(text) from None
