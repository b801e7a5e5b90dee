"""Checks of rigid gaps: overlaps at the start, and gaps ignored by an analysis."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import casadi as ca
import numpy as np

from dalembert.analysis.contact.located_pairs import collisions_of, with_located_pairs
from dalembert.errors import AnalysisError, DalembertError, UnsupportedError
from dalembert.model.graph.model import Model
from dalembert.model.graph.rigid_gaps import RigidGap
from dalembert.results.recording import Trajectory
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once

TOUCHING = 1e-9
"""Threshold for a touching gap, by the size of the bodies [-]."""
ROUNDED = 1e-4
"""Upper limit of overlaps from rounded numbers at the start, by the size of the bodies [-]."""
INSIDE, CLOSED = 1e-9, 1e-6
"""In natural lengths: threshold for a warning about an overlap, and for a closed gap."""


def refuse_overlap(model: Model, start: float) -> None:
    """Refuse overlaps at the start with the nominal parameters.

    Raises
    ------
    AnalysisError
        As in ``refuse_negative``.
    """
    touching_model(model, model.nominal, start)


def contact_start(model: Model, p: np.ndarray, start: float, contacts: bool) -> tuple[Model, str]:
    """``touching_model`` with contacts of all pairs of shapes.

    Parameters
    ----------
    contacts : whether rigid contacts take part; otherwise the model itself is returned

    Raises
    ------
    AnalysisError
        As of ``touching_model``.
    UnsupportedError
        There are gaps among many shapes whose impacts cannot be located.
    """
    if not contacts:
        return model, ""
    return touching_model(with_located_pairs(model), p, start)


def touching_model(model: Model, p: np.ndarray, start: float) -> tuple[Model, str]:
    """The model whose start closes gaps that overlap within the tolerance, and their names.

    The initial positions satisfy ``g = 0`` of these gaps exactly, so positions and gradients are
    those of touching bodies.

    Raises
    ------
    AnalysisError
        Bodies overlap by more, or the start cannot be moved.
    """
    e = model.all_equations
    if not e.contacts:
        return model, ""
    nominal = start == 0 and p is model.nominal
    y = model.start.y if nominal else model.assemble(p, start).y
    distances = _distances(model)(start, y, p).full().ravel()
    rounded, near = e.scales.gap_threshold(ROUNDED), e.scales.gap_threshold(TOUCHING)
    refuse_negative(e.contacts, distances, rounded)
    closed = tuple(map(int, np.flatnonzero(distances < -near)))
    if not closed:
        return model, ""
    try:
        moved = _closed(model, closed)
        moved.assemble(p, start)
    except DalembertError:  # the start is prescribed
        refuse_negative(e.contacts, distances, near)
        raise
    overlaps = [f"{e.contacts[k].name} by {-distances[k]:.3g} m" for k in closed]
    return moved, f"{', '.join(overlaps)} (at most {rounded:.3g} m)"


@once
def _distances(model: Model) -> ca.Function:
    e = model.all_equations
    distances = ca.vertcat(*(gap.distance for gap in e.contacts))
    return ca.Function("gaps", [e.t, e.y, e.p], [ca.densify(distances)])


@once
def _closed(model: Model, gaps: tuple[int, ...]) -> Model:
    """The model with some gaps closed at the start."""
    contacts = model.all_equations.contacts
    distances = (Expression(contacts[k].distance) for k in gaps)
    return Model.assembled(model.parts.with_conditions([(d, Expression(0.0)) for d in distances]))


def gap_violation(model: Model, s: Trajectory, p: np.ndarray) -> str:
    """Message where a gap overlaps, or transmits a force although it is open; else empty.

    Distances are those of the model, whatever branches of them a run has followed.
    """
    e = model.all_equations
    if not (e.contacts and s.t.size):
        return ""
    function, count = _distances(model).map(s.t.size), s.t.size
    distances = function(s.t, s.y, np.tile(p[:, None], count)).full()
    sizes = [gap.forces().numel() for gap in e.contacts]
    rows = e.constraint_count + np.cumsum([0, *sizes[:-1]])
    presses = s.forces(e.transmitted.numel())[rows] != 0
    wrong = (distances < -(near := e.scales.gap_threshold(ROUNDED))) | (
        presses & (distances > near)
    )
    if not wrong.any():
        return ""
    row, k = (int(index[0]) for index in np.nonzero(wrong))
    state = "presses at" if presses[row, k] else "has"
    return (
        f"{e.contacts[row].name} {state} a gap of {distances[row, k]:.3g} m at t = {s.t[k]:.9g} s; "
        "use solve_nonsmooth, or a shorter step"
    )


def refuse_negative(gaps: Sequence[RigidGap], distances: np.ndarray, near: float) -> None:
    """Refuse overlapping bodies at the start of a run.

    Raises
    ------
    AnalysisError
        Names the first overlap.
    """
    for k in map(int, np.flatnonzero(distances < -near)):
        raise AnalysisError(
            f"{gaps[k].name}: its gap is {distances[k]:.6g} m at the start, and at most {near:.3g} "
            "m of overlap are taken for rounding; it must not be negative, so move the bodies apart"
        )


def ignored_contacts(model: Model, s: Trajectory, p: np.ndarray, forces: bool = False) -> list[str]:
    """Warnings about negative gaps in results of analyses that ignore rigid contacts.

    Parameters
    ----------
    model, s, p : model, states of the result and parameters
    forces : the result depends on forces, so closed gaps count as well
    """
    if not s.t.size:
        return []
    length, warnings = model.scales.length, []
    limit = CLOSED * length if forces else -INSIDE * length
    for name, k, gap, analysis in [*_single_gaps(model, s, p), *_collisions(model, s, p)]:
        if gap < limit:
            size = f"{gap:.3g}" if gap < -INSIDE * length else "closed"
            warnings.append(
                f"the gap of {name} is {size} at t = {s.t[k]:.6g} s: this analysis ignores "
                f"rigid contacts; use {analysis}"
            )
    return warnings


def refuse_collisions(model: Model) -> None:
    """Refuse elements with gaps among many shapes.

    Raises
    ------
    UnsupportedError
        The model has such elements.
    """
    if names := [element.name for element in collisions_of(model)]:
        raise UnsupportedError(
            f"{', '.join(names)}: gaps among many shapes need solve_nonsmooth, which treats all "
            "rigid contacts of the model together; to locate the impacts of a few bodies, give a "
            "Contact with law=contact.Restitution(…) for each pair"
        )


Smallest = tuple[str, int, float, str]
"""Element, number of the instant, smallest gap, and the analysis that includes it."""


def _single_gaps(model: Model, s: Trajectory, p: np.ndarray) -> Iterator[Smallest]:
    """Smallest gaps of elements with one gap each."""
    e = model.all_equations
    if not e.contacts:
        return
    gaps = ca.densify(ca.vertcat(*(gap.distance for gap in e.contacts)))
    function = ca.Function("gaps", [e.t, e.y, e.p], [gaps]).map(s.t.size)
    values = function(s.t, s.y, np.tile(p[:, None], s.t.size)).full()
    for gap, row in zip(e.contacts, values, strict=True):
        k = int(np.argmin(row))
        yield gap.name, k, float(row[k]), "solve_dynamics"


def _collisions(model: Model, s: Trajectory, p: np.ndarray) -> Iterator[Smallest]:
    """Smallest gaps among many shapes that are closed or nearly closed."""
    if not collisions_of(model):
        return
    from dalembert.analysis.nonsmooth.gaps.collision_gaps import collision_gaps
    from dalembert.analysis.nonsmooth.gaps.configuration import Configuration

    travels = CLOSED * model.equations.scales.displacements[:, None]
    for source in collision_gaps(model):
        smallest = np.full(s.t.size, np.inf)
        for k, t in enumerate(s.t):
            gaps = source.near(Configuration(float(t), s.y[:, k], p), travels)
            smallest[k] = gaps.distance.min(initial=np.inf)
        k = int(np.argmin(smallest))
        yield source.elements[0].name, k, float(smallest[k]), "solve_nonsmooth"
