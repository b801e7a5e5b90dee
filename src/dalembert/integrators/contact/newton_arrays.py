"""Arrays of contact problems and of Newton's method in machine code, by their places."""

from __future__ import annotations

import numpy as np
import scipy

from dalembert.integrators.contact.block_ordering import BlockOrdering
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import Delassus
from dalembert.integrators.contact.places import Inputs, Outputs


def problem_inputs(problem: FrictionProblem, operator: Delassus) -> dict[int, np.ndarray]:
    """Contiguous inputs of a friction problem and its operator, without settings."""
    minimum = problem.minimum
    if not isinstance(minimum, np.ndarray):
        minimum = np.full(problem.shape[0], minimum)
    w, x = operator.compressed
    numbers = {
        Inputs.DIRECTIONS: w.data,
        Inputs.RESPONSES: x.data,
        Inputs.VELOCITY: problem.velocity,
        Inputs.FRICTION: problem.friction,
        Inputs.MINIMUM: minimum,
        Inputs.MOBILITY: problem.mobility,
        Inputs.WEIGHTS: problem.weights,
        Inputs.SHIFT: operator.shift,
    }
    indices = {
        Inputs.DIRECTION_ROWS: w.indptr,
        Inputs.DIRECTION_COLUMNS: w.indices,
        Inputs.RESPONSE_ROWS: x.indptr,
        Inputs.RESPONSE_COLUMNS: x.indices,
        Inputs.GROUP_STARTS: problem.starts,
    }
    return {
        **{place: np.ascontiguousarray(array, dtype=float) for place, array in numbers.items()},
        **{place: array.astype(np.int32, copy=False) for place, array in indices.items()},
    }


def block_inputs(operator: Delassus, order: BlockOrdering) -> dict[int, np.ndarray]:
    """Inputs of the inertia, compressed by rows, and of the order of elimination."""
    inertia = operator.inertia
    if not scipy.sparse.issparse(inertia) or inertia.format != "csr":
        inertia = scipy.sparse.csr_array(inertia)
    indices = {
        Inputs.INERTIA_ROWS: inertia.indptr,
        Inputs.INERTIA_COLUMNS: inertia.indices,
        Inputs.BLOCK_OF_SPEED: order.owner,
        Inputs.PLACE_IN_BLOCK: order.position,
        Inputs.FACTOR_STARTS: order.first,
        Inputs.FACTOR_ROWS: order.row,
        Inputs.BLOCK_MEMBERS: order.members,
    }
    return {
        Inputs.INERTIA: np.ascontiguousarray(inertia.data, dtype=float),
        **{place: np.ascontiguousarray(part, dtype=np.int32) for place, part in indices.items()},
    }


def newton_outputs(
    contacts: int, components: int, speeds: int, entries: int, unknowns: int
) -> dict[int, np.ndarray]:
    """Outputs of Newton's method.

    Parameters
    ----------
    contacts, components : number of contacts, and of components of each
    speeds : number of speeds of the bodies
    entries, unknowns : of the matrix of a step, and number of its equations
    """
    rows = contacts * components
    sizes = {
        Outputs.IMPULSE: rows,
        Outputs.SYSTEM: entries,
        Outputs.RIGHT_SIDE: unknowns,
        Outputs.FREE_STEP: rows,
        Outputs.GAIN: rows * components,
        Outputs.VELOCITY: rows,
        Outputs.STEP: rows,
        Outputs.CHANGE: rows,
        Outputs.TRIAL: rows,
        Outputs.TRIAL_VELOCITY: rows,
        Outputs.SPEED_CHANGES: speeds,
        Outputs.CONSTANT: entries,
        Outputs.SOLUTION: unknowns,
    }
    return {place: np.zeros(size) for place, size in sizes.items()}


def block_outputs(contacts: int, columns: int, entries: int, places: int) -> dict[int, np.ndarray]:
    """Places of the contacts in a matrix of blocks.

    Parameters
    ----------
    columns : sum of the numbers of speeds on which the contacts act
    entries : number of entries of W
    places : sum of the squares of the numbers of speeds
    """
    sizes = {
        Outputs.COLUMN_STARTS: contacts + 1,
        Outputs.COLUMNS: columns,
        Outputs.LOCAL_COLUMNS: entries,
        Outputs.ENTRY_STARTS: contacts,
        Outputs.ENTRIES: places,
    }
    return {place: np.zeros(size, dtype=np.int32) for place, size in sizes.items()}


def widest_contact(directions: scipy.sparse.csr_array, entries: np.ndarray) -> int:
    """The largest number of speeds on which a contact acts.

    Parameters
    ----------
    directions : (n k, n_v) directions of n contacts
    entries : (n,) number of entries of each contact
    """
    speeds = directions.shape[1]
    owner = np.repeat(np.arange(entries.size), entries)
    columns = np.unique(owner * speeds + directions.indices)
    return int(np.bincount(columns // speeds).max(initial=0))


def solution_memory(contacts: int, components: int) -> dict[int, np.ndarray]:
    """Memory of proximal problems and interior points."""
    rows = contacts * components
    sizes = {
        Outputs.PROXIMAL: 4 * rows,
        Outputs.BEST_IMPULSE: rows,
        Outputs.PRIMAL: rows,
        Outputs.SLACK: rows,
        Outputs.PRIMAL_STEP: rows,
        Outputs.SLACK_STEP: rows,
        Outputs.SCALED: rows,
        Outputs.SCALING_ROOT: rows,
        Outputs.SCALING_AXIS: rows,
        Outputs.SCALING: contacts,
        Outputs.CONTACT_INVERSE: rows * components,
    }
    return {place: np.zeros(size) for place, size in sizes.items()}
