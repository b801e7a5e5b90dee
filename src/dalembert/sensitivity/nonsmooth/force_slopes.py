"""Derivatives of the impulses of contacts with force laws.

    P_N = h f̄(δ, δ⁺, δ̇; p),      δ = −g,   δ̇ = −(θ u_N⁺ + (1−θ) u_N⁻),   δ⁺ = δ + h δ̇

with the mean force of ``mean_force``, on its branch: a contact that begins or ends within the step
has the part of the mean in which it is compressed.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.force_laws import ForceLaws
from dalembert.elements.contact.laws import NormalLaw
from dalembert.integrators.contact.approach import Approach
from dalembert.integrators.contact.mean_force import NODES, WEIGHTS
from dalembert.integrators.contact.offset_slopes import OffsetSlopes, idle_components
from dalembert.integrators.contact.schemes import ContactScheme
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.once import once


@dataclass(frozen=True, eq=False)
class ForceSlopes:
    """Impulses of compliant contacts and their derivatives.

    Attributes
    ----------
    rows : (c,) numbers of the contacts among the pressing ones
    impulse : (c,) ``h f̄``
    after, before, gap : (c,) derivatives by ``u_N⁺``, ``u_N⁻`` and ``g``
    parameters : (c, np) derivatives by the parameters
    """

    rows: np.ndarray
    impulse: np.ndarray
    after: np.ndarray
    before: np.ndarray
    gap: np.ndarray
    parameters: np.ndarray

    @classmethod
    def of(
        cls,
        laws: ForceLaws,
        numbers: np.ndarray,
        model: Model,
        step: tuple[float, float],
        state: tuple[np.ndarray, np.ndarray, np.ndarray],
    ) -> ForceSlopes:
        """Contacts with some laws.

        Parameters
        ----------
        numbers : (n,) of the laws, negative for rigid contacts
        step : ``h``, ``θ``
        state : (n,) ``g``, ``u_N⁻``, ``u_N⁺``
        """
        (h, theta), rows = step, np.flatnonzero(numbers >= 0)
        distance, before, after = (values[rows] for values in state)
        start, rate = -distance, -(theta * after + (1 - theta) * before)
        values = np.zeros((4, rows.size))
        parameters = np.zeros((rows.size, laws.p.size))
        for i, number in enumerate(numbers[rows]):
            kernel = _mean_force(model, laws.laws[number])
            own, by_p = kernel(np.array([start[i], start[i] + h * rate[i], rate[i]]), laws.p)
            values[:, i], parameters[i] = own.ravel(), by_p.ravel()
        mean, by_start, by_end, by_rate = values
        speed = -h * (h * by_end + by_rate)
        gap = -h * (by_start + by_end)
        return cls(rows, h * mean, theta * speed, (1 - theta) * speed, gap, h * parameters)

    def slopes(
        self,
        scheme: ContactScheme,
        approach: Approach,
        offsets: np.ndarray,
        rounding: float | np.ndarray,
    ) -> OffsetSlopes:
        """Offsets of all contacts; of compliant ones those whose product with the derivative by
        ``u_N⁺`` are the derivatives by the gap and by ``u_N⁻``."""
        count = approach.before.shape[0]
        rigid = ~np.isin(np.arange(count), self.rows)
        contacts = approach.contacts.some(np.flatnonzero(rigid))
        longest = np.broadcast_to(approach.longest, rigid.shape)[rigid]
        state = approach.before[rigid], approach.free[rigid], approach.h, longest
        own = scheme.slopes(Approach(contacts, *state), offsets[rigid], rounding)
        values = {}
        for field in fields(OffsetSlopes):
            part = getattr(own, field.name)
            values[field.name] = np.zeros((count, *part.shape[1:]), dtype=part.dtype)
            values[field.name][rigid] = part
        after = np.where(self.after != 0, self.after, 1.0)
        values["gap"][self.rows] = self.gap / after
        values["speed"][self.rows] = self.before / after
        values["idle"][self.rows] = idle_components(approach, offsets)[self.rows]
        return OffsetSlopes(**values)


@once
def _mean_force(model: Model, law: NormalLaw) -> Kernel:
    """``(δ, δ⁺, δ̇; p) → f̄`` with its derivatives by the first three, and by ``p``."""
    start, end, rate = (ca.SX.sym(name) for name in ("start", "end", "rate"))
    first, last = _root(start), _root(end)
    value = ca.SX(0)
    for node, weight in zip(NODES, WEIGHTS, strict=True):
        root = first + node * (last - first)
        value += weight * 2 * root / (first + last) * law.force(root**2, rate)
    crosses = ca.fmin(start, end) < 0
    change = ca.if_else(crosses, end - start, 1)
    mean = value * ca.if_else(crosses, (last**2 - first**2) / change, 1)
    arguments, p = ca.vertcat(start, end, rate), model.all_equations.p
    slopes = ca.densify(ca.vertcat(mean, ca.jacobian(mean, arguments).T))
    outputs = [slopes, ca.densify(ca.jacobian(mean, p))]
    return Kernel(ca.Function("mean_force", [arguments, p], outputs, {"cse": True}))


def _root(depth: ca.SX) -> ca.SX:
    """Square root of a positive depth, else zero."""
    return ca.if_else(depth > 0, ca.sqrt(ca.if_else(depth > 0, depth, 1)), 0)
