"""Shapes of ``Collisions`` that can touch, and bodies of a gap."""

from __future__ import annotations

from dataclasses import fields

import casadi as ca
import numpy as np

from dalembert.analysis.contact.gap_checks import ROUNDED
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.gaps.boundaries.boundary_gaps import BoundaryGaps
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.hulls.hull_gaps import HullGaps
from dalembert.analysis.nonsmooth.gaps.joined_gaps import JoinedGaps
from dalembert.analysis.nonsmooth.gaps.model_gaps import APART as OFFSET
from dalembert.analysis.nonsmooth.gaps.searched_gaps import SearchedGaps
from dalembert.analysis.nonsmooth.starts.overlapping_outlines import overlapping_outlines
from dalembert.analysis.nonsmooth.starts.overlapping_solids import Overlap, overlapping_solids
from dalembert.analysis.nonsmooth.starts.overlapping_terrain import solids_in_terrain
from dalembert.elements.base import Constraint, Element
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.contact.pairs import APART
from dalembert.elements.contact.shapes import Shape
from dalembert.elements.frame import Frame
from dalembert.elements.planar.contact.shapes import Bore, Circle
from dalembert.elements.point import Point
from dalembert.errors import AnalysisError
from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.model import Model
from dalembert.model.graph.natural_units import body_sizes
from dalembert.symbolic.formulas.expression import t

SAME_CENTRE = 1e-6
"""Distance of centres, relative to the radius of a bore, below which circles are concentric."""


def refuse_lonely_shapes(elements: list[Element]) -> None:
    """Refuse ``Collisions`` whose shapes are all on one body, or in groups that do not touch.

    Raises
    ------
    AnalysisError
        Names the element and its body.
    """
    for element in elements:
        if not isinstance(element, Collisions) or _can_touch(element):
            continue
        bodies = list(dict.fromkeys(shape.carrier.name for shape in element.members))
        count = len(element.members)
        if len(bodies) == 1:
            only = f"its only shape is on {bodies[0]}"
            text = only if count == 1 else f"all of its {count} shapes are on {bodies[0]}"
            example = "Circle(ball, 0.1)" if bodies[0] == "ground" else "HalfPlane(ground)"
            remedy = f"add a shape of another body, such as contact.{example}"
        else:
            text = "its pairs have touching=False between all groups of different bodies"
            remedy = "leave out touching=False of one of them"
        raise AnalysisError(f"{element.name}: nothing can touch: {text}; {remedy}")


def refuse_moving_places(elements: list[Element]) -> None:
    """Refuse shapes of ``Collisions`` whose place in their body is a formula of time.

    The velocities at their gaps are those of bodies.

    Raises
    ------
    AnalysisError
        Names the shape and its body.
    """
    for element in elements:
        for place, part in element.components.items() if isinstance(element, Collisions) else ():
            if isinstance(part, Shape) and any(ca.depends_on(f, t.sx) for f in _places(part)):
                name = part.carrier.name
                raise AnalysisError(
                    f"{place}: its place in {name} depends on the time, and contacts have "
                    "the velocities of bodies; give it a body that a driver moves"
                )


def _places(shape: Shape) -> list[ca.SX]:
    """Points and axes of a shape in its body."""
    values = [getattr(shape, field.name) for field in fields(shape)]
    points = [value.local.sx for value in values if isinstance(value, Point)]
    return points + [ca.SX(value.local_axes) for value in values if isinstance(value, Frame)]


def refuse_start(step: ContactStep, t: float, y: np.ndarray) -> None:
    """Refuse a start at which bodies overlap or a closed gap has no direction.

    Raises
    ------
    AnalysisError
        Names the element and both bodies.
    """
    refuse_concentric(step, t, y)
    refuse_filled_bores(step, t, y)
    if step.scheme.projection:  # otherwise initial gaps are never corrected
        refuse_overlaps(step, t, y)
        refuse_deep_overlaps(step, t, y)


def refuse_concentric(step: ContactStep, t: float, y: np.ndarray) -> None:
    """Refuse a start at which a closed gap has no direction, as of balls with one centre.

    Raises
    ------
    AnalysisError
        Names the element and both bodies.
    """
    none = np.zeros((step.model.equations.speed_count, 1))
    contacts = step.near(step.at(t, y), none)
    width = contacts.drift.shape[1]
    sums = np.asarray(abs(contacts.directions).sum(axis=1)).reshape(-1, width).sum(axis=1)
    rows = np.flatnonzero(~np.isfinite(sums))
    if rows.size:
        number, key = divmod(int(contacts.key[rows[0]]), OFFSET)
        source = step.sources[number]
        bodies = " and ".join(source.bodies(np.array([key]))[0]) or "two shapes"
        raise AnalysisError(
            f"{source.elements[0].name}: {bodies} have the same centre at the start, and their "
            "contact has no direction; move one of them"
        )


def refuse_overlaps(step: ContactStep, t: float, y: np.ndarray) -> None:
    """Refuse bodies that overlap at the start by more than rounded numbers explain.

    Raises
    ------
    AnalysisError
        Names the bodies that overlap most, their element and the depth.
    """
    none = np.zeros((step.model.equations.speed_count, 1))
    contacts = step.rigid(step.near(step.at(t, y), none))
    inside = np.flatnonzero(contacts.distance < -step.rounding)
    sizes = body_sizes(step.model.parts, step.model.equations, step.p) if inside.size else {}
    allowed = [_rounded_overlap(step, sizes, _moving(step.model, contacts, int(k))) for k in inside]
    inside = inside[contacts.distance[inside] < -np.array(allowed)]
    if not inside.size:
        return
    deepest = int(inside[np.argmin(contacts.distance[inside])])
    others = np.unique(step.pairs(contacts.key[inside])).size - 1
    more = f"; {others} other pair{'s' * (others > 1)} overlap{'s' * (others == 1)} by less"
    name, bodies = step.names[contacts.owner[deepest]], bodies_of(step.model, contacts, deepest)
    remedy = _remedy(step.model, _moving(step.model, contacts, deepest)) or (
        "move them apart by this depth along the normal of the contact"
    )
    raise AnalysisError(
        f"{name}: {bodies} overlap by {-contacts.distance[deepest]:.3g} m at the start; {remedy}"
        f"{more if others else ''}"
    )


def refuse_deep_overlaps(step: ContactStep, t: float, y: np.ndarray) -> None:
    """Refuse shapes that overlap so deeply at the start that no gap may be negative: curves and
    polygons with dents, cylinders, and solids in a terrain.

    Raises
    ------
    AnalysisError
        Names the bodies that overlap most, their element and a lower bound of the depth.
    """
    sources = [
        part
        for source in step.sources
        for part in (source.sources if isinstance(source, JoinedGaps) else [source])
    ]
    configuration = step.at(t, y)
    for source in (source for source in sources if isinstance(source, SearchedGaps)):
        deepest = None
        if isinstance(source, BoundaryGaps):
            deepest = overlapping_outlines(source, configuration)
        elif isinstance(source, HullGaps) and source.dimension == 3:
            deepest = _overlap_in_space(step, source, configuration)
        if deepest is not None:
            *shapes, depth = deepest
            names = [source.geometry.shapes[k].carrier.name for k in shapes]
            remedy = _remedy(step.model, names) or "move them apart"
            raise AnalysisError(
                f"{source.elements[0].name}: {' and '.join(names)} overlap by {depth:.2g} m or "
                f"more at the start; {remedy}"
            )


def _overlap_in_space(
    step: ContactStep, source: HullGaps, configuration: Configuration
) -> Overlap | None:
    """The deepest overlap of solids that rounded numbers do not explain."""
    shapes = source.geometry.shapes

    def deepest(tolerances: np.ndarray) -> Overlap | None:
        searches = overlapping_solids, solids_in_terrain
        overlaps = [search(source, configuration, tolerances) for search in searches]
        return max((o for o in overlaps if o), key=lambda o: o[2], default=None)

    if deepest(np.full(len(shapes), step.rounding)) is None:
        return None  # most starts, without the sizes of the bodies, which take longer
    sizes = body_sizes(step.model.parts, step.model.equations, step.p)
    return deepest(
        np.array([_rounded_overlap(step, sizes, [shape.carrier.name]) for shape in shapes])
    )


def _remedy(model: Model, bodies: list[str]) -> str:
    """Remedy for an overlap of bodies that a joint connects; empty without one."""
    joint = _joint_between(model, bodies)
    return joint and (
        f"the joint {joint} connects them: give their shapes two groups and "
        "contact.Pair(…, touching=False), or leave a clearance between them"
    )


def _rounded_overlap(step: ContactStep, sizes: dict[str, float], bodies: list[str]) -> float:
    """Overlap of bodies that counts as rounded input, by the size of the smallest one [m]."""
    size = min((sizes[name] for name in bodies if name in sizes), default=np.inf)
    return max(min(ROUNDED * size, step.rounded_overlap), step.rounding)


def _joint_between(model: Model, bodies: list[str]) -> str:
    """Name of a joint of bodies, or of a body and the ground; empty without one."""
    wanted = set(bodies) if len(bodies) > 1 else {*bodies, model.parts.ground.name}
    joints = (e for e in model.parts.elements.values() if isinstance(e, Constraint))
    return next((e.name for e in joints if wanted <= {part.name for part in e.parts()}), "")


def refuse_filled_bores(step: ContactStep, t: float, y: np.ndarray) -> None:
    """Refuse discs larger than a bore with the same centre at the start.

    All distances of the circles are equal there, so that no gap is a local minimum.

    Raises
    ------
    AnalysisError
        Names the element and both bodies.
    """
    for element in (element for source in step.sources for element in source.elements):
        if not isinstance(element, Collisions):
            continue
        bores = [shape for shape in element.members if isinstance(shape, Bore)]
        discs = [shape for shape in element.members if isinstance(shape, Circle) and bores]
        holes = [_place_and_size(bore, step, t, y) for bore in bores]
        sizes = [_place_and_size(disc, step, t, y) for disc in discs]
        laws = element.laws[element.group_of(bores)[:, None], element.group_of(discs)]
        for i, (bore, (middle, radius)) in enumerate(zip(bores, holes, strict=True)):
            for j, (disc, (centre, size)) in enumerate(zip(discs, sizes, strict=True)):
                near = np.linalg.norm(centre - middle) < SAME_CENTRE * radius
                near &= laws[i, j] != APART
                if near and size > radius and disc.carrier is not bore.carrier:
                    raise AnalysisError(
                        f"{element.name}: the disc of {disc.carrier.name} has the radius "
                        f"{size:.6g} m and is in a bore of {bore.carrier.name} with the radius "
                        f"{radius:.6g} m at the start; reduce the disc, or move it out of the bore"
                    )


def _place_and_size(
    shape: Bore | Circle, step: ContactStep, t: float, y: np.ndarray
) -> tuple[np.ndarray, float]:
    """Centre and radius of a circle [m]."""
    e = step.model.all_equations
    formulas = [step.model.at_ground(f) for f in (shape.point.position.sx, shape.radius.sx)]
    place, radius = ca.Function("circle", [e.t, e.y, e.p], formulas)(t, y, step.p)
    return place.full().ravel(), float(radius)


def _can_touch(element: Collisions) -> bool:
    """Whether two shapes of different bodies may touch, or one of several bodies touches itself."""
    groups = element.group_of(list(element.members))
    kinds = {
        (int(group), id(shape.carrier))
        for group, shape in zip(groups, element.members, strict=True)
    }
    if any(len(shape.bodies) > 1 for shape in element.members):
        return True
    return any(
        carrier != other and element.laws[group, second] != APART
        for group, carrier in kinds
        for second, other in kinds
    )


def bodies_of(model: Model, contacts: Contacts, row: int) -> str:
    """Names of the bodies that a gap moves with."""
    names = _moving(model, contacts, row)
    return " and ".join(names) if len(names) > 1 else f"{''.join(names)} and a fixed shape"


def _moving(model: Model, contacts: Contacts, row: int) -> list[str]:
    width = contacts.drift.shape[1]
    directions = contacts.directions[row * width : (row + 1) * width]
    used = np.asarray(abs(directions).sum(axis=0)).ravel() > 0
    names, first = [], 0
    for group in model.coordinates:
        count = group.twist.numel()
        if used[first : first + count].any():
            names.append(group.name)
        first += count
    return names
