"""Functions of free bodies with balls, hulls and walls, whose steps run in machine code."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.free_bodies.step_shapes import StepShapes, step_shapes
from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.shape_velocities import TWIST
from dalembert.analysis.nonsmooth.smooth_motion import smooth_motion
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.elements.contact.pairs import COEFFICIENTS
from dalembert.integrators.contact.block_ordering import BlockOrderings
from dalembert.integrators.contact.contact_laws import ContactLaws
from dalembert.integrators.contact.schemes import AnticipatedImpacts, MoreauJean
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.kernel import Kernel, condensed
from dalembert.symbolic.formulas.expression import stack
from dalembert.symbolic.once import once


@dataclass(frozen=True, eq=False)
class FreeBodyMotion:
    """Functions of a step, and the bodies to which its speeds and shapes belong.

    Attributes
    ----------
    forces : ``(t, y, v, p, h) → F, A, v̄``, forces and entries of the matrix of a step by rows, and
        mean speeds of gyroscopic forces
    turned : ``(t, y, v, p, h, v̄) → F, A`` with other mean speeds
    places : ``(t, y, δ, p) → y ⊕ δ, corners, references, normals, J`` of shapes there
    ahead : ``(t, y, v, p, h) → corners, references, normals, J`` after ``lead`` of the step
    lead : share of the step by which these are ahead [-]
    mass : ``(y, p) → `` entries of the mass matrix with the pattern of ``A``
    shapes : StepShapes
    starts, columns : pattern of ``A`` by rows
    body : (shapes,) body of each shape, -1 for the ground
    first : (bodies + 1,) first speed of each body
    constants : ``p → `` radii of the balls and hulls, coefficients of the laws
    orderings : orders of elimination of the bodies
    """

    forces: ca.Function
    turned: ca.Function
    places: ca.Function
    ahead: ca.Function
    lead: float
    mass: ca.Function
    shapes: StepShapes
    starts: np.ndarray
    columns: np.ndarray
    body: np.ndarray
    first: np.ndarray
    constants: Kernel
    orderings: BlockOrderings

    def radii(self, p: np.ndarray) -> np.ndarray:
        """(h,) radii of the balls and hulls."""
        return self.constants(p)[0].ravel()[: self.shapes.hulls]

    def laws(self, p: np.ndarray) -> np.ndarray:
        """(c, l) coefficients of the laws."""
        coefficients = self.constants(p)[0].ravel()[self.shapes.hulls :]
        return coefficients.reshape(len(COEFFICIENTS), -1, order="F")

    @property
    def widest(self) -> int:
        """Largest number of speeds of a body."""
        return int(np.diff(self.first).max(initial=1))


def free_body_motion(step: ContactStep) -> FreeBodyMotion | None:
    """Functions of the steps if these run in machine code: free bodies, all of whose shapes are
    balls, rigid hulls and walls with Newton's law of impact, and one of the two schemes."""
    if type(step.scheme) not in (AnticipatedImpacts, MoreauJean) or step.force_laws.elements:
        return None
    motion = _functions(step.model, step.scheme.theta)
    if motion is None:
        return None
    laws = ContactLaws.of(motion.laws(step.p), step.groups)
    if laws.higher_at_rest.any() or not laws.follows(ImpactLaw.NEWTON).all():
        return None
    return motion


@once
def _functions(model: Model, theta: float) -> FreeBodyMotion | None:
    sources, e = gap_sources(model), model.equations
    bodies = [group.twist.numel() for group in model.coordinates]
    shapes = step_shapes(sources[0]) if len(sources) == 1 else None
    if shapes is None:
        return None
    if e.constraint_count or e.states or sum(bodies) != e.speed_count or not e.speed_count:
        return None
    n = e.speed_count
    first, body_of = np.cumsum([0, *bodies]), np.repeat(np.arange(len(bodies)), bodies)
    forces, turned, pattern = _step_formulas(model, theta)
    column, row = np.array(pattern.row(), dtype=np.int32), _columns(pattern)
    jacobian = ca.jacobian(shapes.twists, e.v)
    body, velocities = _shape_velocities(shapes, jacobian, body_of, first)
    if body is None or (body_of[row] != body_of[column]).any():
        return None
    if ca.depends_on(shapes.constants, ca.vertcat(e.t, e.y)):
        return None
    geometry = [shapes.corners, shapes.references, shapes.normals, velocities]
    moved = e.manifold.retract(e.y, e.manifold.delta)
    placed = ca.vertcat(moved, ca.substitute(ca.vertcat(*geometry), e.y, moved))
    cuts = np.cumsum([0, moved.numel(), *(part.numel() for part in geometry)])
    parts = [placed[i:j] for i, j in pairwise(cuts.tolist())]
    inputs = [e.t, e.y, e.manifold.delta, e.p]
    places = condensed("places", inputs, [ca.densify(part) for part in parts])
    h, share = ca.SX.sym("h"), 1 - theta if theta < 1 else 0.5
    half = e.manifold.halfway_formula(2 * share * h * e.v)
    ahead = places.call([e.t + share * h, e.y, half, e.p])[1:]
    mass = stack(ca.project(e.mass.T, pattern).nonzeros())  # type: ignore[arg-type]
    return FreeBodyMotion(
        forces=forces,
        turned=turned,
        places=places,
        ahead=condensed("ahead", [e.t, e.y, e.v, e.p, h], ahead),
        lead=share,
        mass=condensed("mass", [e.y, e.p], [ca.densify(mass)]),
        shapes=shapes,
        constants=Kernel(ca.Function("constants", [e.p], [ca.densify(shapes.constants)])),
        starts=np.searchsorted(row, np.arange(n + 1)).astype(np.int32),
        columns=column,
        body=body,
        first=first.astype(np.int32),
        orderings=BlockOrderings(np.array(bodies, dtype=int), np.zeros((2, 0), dtype=int)),
    )


def _step_formulas(model: Model, theta: float) -> tuple[ca.Function, ca.Function, ca.Sparsity]:
    """Functions ``forces`` and ``turned`` of a step by the θ-method, from its start, and the
    pattern of ``Aᵀ``."""
    e, smooth, h = model.equations, smooth_motion(model), ca.SX.sym("h")
    half, formulas = theta * h, smooth.forces
    inputs = [e.t, e.y, e.v, e.p, h]
    symbols = ca.vertcat(e.t, e.y, smooth.lead)
    middle = ca.vertcat(e.t + half, e.manifold.retract(e.y, half * e.v), half)
    functions, first = [], formulas.with_mean(formulas.predicted)
    for name, forces, means in (("forces", first, [first.mean]), ("turned", formulas, [])):
        matrix = ca.sparsify(e.mass - half * forces.damping - half**2 * forces.stiffness)
        entries = stack(matrix.T.nonzeros())  # type: ignore[arg-type]
        outputs = [ca.densify(part) for part in (forces.driving, entries, *means)]
        sizes = np.cumsum([part.numel() for part in outputs])[:-1].tolist()
        at = ca.substitute(ca.vertcat(*outputs), symbols, ca.densify(middle))
        own = inputs if means else [*inputs, formulas.mean]
        functions.append(condensed(name, own, ca.vertsplit(at, [0, *sizes, at.numel()])))
    return functions[0], functions[1], matrix.T.sparsity()


def _shape_velocities(
    shapes: StepShapes, jacobian: ca.SX, body_of: np.ndarray, first: np.ndarray
) -> tuple[np.ndarray | None, ca.SX]:
    """Body of each shape, -1 for the ground, and the derivatives of its twist by the speeds of the
    body, by rows, from those by all speeds; None if a shape moves with several bodies."""
    jacobian = ca.sparsify(jacobian)
    row, column = np.array(jacobian.sparsity().row(), dtype=int), _columns(jacobian.sparsity())
    count, widest = shapes.count, int(np.diff(first).max())
    velocities = ca.SX.zeros(TWIST * count * widest)
    place = row * widest + column - first[body_of[column]]
    if place.size:
        velocities[place.tolist()] = stack(jacobian.nonzeros())  # type: ignore[arg-type]
    body = np.full(count, -1, dtype=np.int32)
    body[row // TWIST] = body_of[column]
    same = (body[row // TWIST] == body_of[column]).all()
    return (body if same else None), velocities


def _columns(pattern: ca.Sparsity) -> np.ndarray:
    starts = np.array(pattern.colind(), dtype=int)
    return np.repeat(np.arange(pattern.size2(), dtype=np.int32), np.diff(starts))
