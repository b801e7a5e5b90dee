"""New speeds, new coordinates, and some speeds by others: the transformations of the book."""

from __future__ import annotations

import casadi as ca

from dalembert.errors import ModelError
from dalembert.model.equations import Equations
from dalembert.model.transformation import Transformation
from dalembert.symbolic.equations.factor import LdlFactor, QrFactor
from dalembert.symbolic.equations.null_space import PartitionBasis


def change_speeds(
    equations: Equations, basis: ca.SX, new_speeds: ca.SX, drift: ca.SX | None = None
) -> Equations:
    """Equations in new speeds, ``v = B v' + b`` (4.8), (6.9); arguments as ``speeds_by_basis``."""
    return speeds_by_basis(equations, basis, new_speeds, drift).apply(equations)


def change_coordinates(
    equations: Equations,
    coordinates: ca.SX,
    new_coordinates: ca.SX,
    new_speeds: ca.SX | None = None,
) -> Equations:
    """Equations in new coordinates, ``y = g(y', t)`` (4.10)–(4.11), (6.2).

    Arguments as ``coordinates_by``.
    """
    return coordinates_by(equations, coordinates, new_coordinates, new_speeds).apply(equations)


def speeds_by_basis(
    equations: Equations, basis: ca.SX, new_speeds: ca.SX, drift: ca.SX | None = None
) -> Transformation:
    """``v = B v' + b`` in unchanged coordinates (4.5).

    Parameters
    ----------
    basis, drift : SX ``B`` (n, k) and ``b`` (n,) of ``t, y, p``; no drift by default
    new_speeds : SX symbols ``v'`` (k,), k ≤ n; may be quasi-velocities

    Raises
    ------
    ModelError
        Wrong shape, or a basis that depends on speeds.
    """
    e, basis = equations, ca.SX(basis)
    offset = ca.SX.zeros(e.speed_count) if drift is None else ca.SX(drift)
    _check("basis", basis, (e.speed_count, new_speeds.numel()))
    _check("drift", offset, (e.speed_count, 1))
    if ca.depends_on(ca.vertcat(ca.vec(basis), offset), ca.vertcat(e.v, new_speeds)):
        raise ModelError("depends on speeds; write basis and drift in t, y and p", "basis")
    speeds = ca.mtimes(basis, new_speeds) + offset
    rate = ca.substitute(e.pose_rate, e.v, speeds)
    return Transformation(e.t, e.y, new_speeds, _rates(new_speeds), rate, e.y, speeds)


def coordinates_by(
    equations: Equations,
    coordinates: ca.SX,
    new_coordinates: ca.SX,
    new_speeds: ca.SX | None = None,
) -> Transformation:
    """``y = g(y', t)``, ``v' = ẏ'``, so that ``B = A⁻¹ ∂g/∂y'`` (4.11), (4.16).

    Parameters
    ----------
    coordinates : SX ``g`` (n_y,) of ``t, y', p``
    new_coordinates : SX symbols ``y'``, as many as ``y`` or fewer
    new_speeds : SX symbols for ``ẏ'``; new ones by default

    Raises
    ------
    ModelError
        Wrong shape, or coordinates that still depend on the old ones.
    """
    e, y = equations, new_coordinates
    _check("coordinates", coordinates, (e.coordinate_count, 1))
    if ca.depends_on(coordinates, ca.vertcat(e.y, e.v)):
        raise ModelError("depend on the old ones; write them in t, y' and p", "coordinates")
    v = _rates(y) if new_speeds is None else new_speeds
    _check("new_speeds", v, (y.numel(), 1))
    carried = ca.substitute(e.pose_rate, e.v, ca.SX.zeros(e.speed_count))  # by an earlier drift
    lift, carried = ca.substitute([e.lift, carried], [e.y], [coordinates])
    rate = ca.jtimes(coordinates, ca.vertcat(e.t, y), ca.vertcat(1, v))
    return Transformation(e.t, y, v, _rates(v), v, coordinates, _speeds_of(lift, rate - carried))


def speeds_by_partition(equations: Equations, independent: list[int]) -> Transformation:
    """Independent speeds ``u`` determine the rest: ``w = −W⁻¹ (U u + Φ_t)``, ``C = [U W]`` (6.4).

    Parameters
    ----------
    independent : indices in ``v`` of the ``u``; W, the columns of the dependent speeds, is regular

    Raises
    ------
    ModelError
        Not as many dependent speeds as constraint equations.
    """
    e, n = equations, equations.speed_count
    if n - len(independent) != e.constraint_count:
        raise ModelError(
            f"{e.constraint_count} equations determine as many speeds, not "
            f"{n - len(independent)}; name {n - e.constraint_count} independent ones",
            "partition",
        )
    basis = PartitionBasis(e.jacobian, tuple(independent))
    imposed = ca.substitute(e.velocity_constraints, e.v, ca.SX.zeros(n))  # Φ_t
    speeds = ca.SX.sym("u", len(independent))
    return speeds_by_basis(e, basis.matrix, speeds, basis.particular(-imposed))


def _check(name: str, argument: ca.SX, shape: tuple[int, int]) -> None:
    if argument.shape != shape:
        raise ModelError(f"shape {argument.shape} does not fit, {shape} is needed", name)


def _rates(symbols: ca.SX) -> ca.SX:
    """Symbols of the time derivatives of symbols."""
    return ca.vertcat(*(ca.SX.sym(f"d{s.name()}") for s in ca.vertsplit(symbols)))


def _speeds_of(lift: ca.SX, rate: ca.SX) -> ca.SX:
    """``v`` with ``A v = ẏ``; A has more rows than columns where ``y`` are Euler parameters."""
    if lift.is_eye():
        return rate
    if lift.shape[0] == lift.shape[1]:
        return QrFactor(lift).solve(rate)
    return LdlFactor(ca.mtimes(lift.T, lift)).solve(ca.mtimes(lift.T, rate))
