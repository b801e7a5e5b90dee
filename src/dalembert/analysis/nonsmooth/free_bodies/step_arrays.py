"""Memory of steps in machine code for numbers of contacts, by its places."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.free_bodies.step_shapes import StepShapes
from dalembert.integrators.contact.newton_arrays import (
    block_outputs,
    newton_outputs,
    solution_memory,
)
from dalembert.integrators.contact.places import Inputs, Outputs
from dalembert.integrators.contact.step_places import Descriptions


def integers(size: int) -> np.ndarray:
    """(size,) zeros of 32 bits."""
    return np.zeros(size, dtype=np.int32)


def contact_arrays(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Keys, descriptions and gaps of contacts."""
    described = np.zeros((count, Descriptions.size()), np.int32)
    return np.zeros(count, np.int64), described, np.zeros(count)


def contact_inputs(
    contacts: int, components: int, groups: int, widest: int
) -> dict[int, np.ndarray]:
    """Inputs that a step fills for its contacts.

    Parameters
    ----------
    components, groups : numbers of components, and of tangential groups, of a contact
    widest : largest number of speeds of a body
    """
    rows = contacts * components
    row, column = integers(rows + 1), integers(rows * 2 * widest)
    numbers = {
        Inputs.DIRECTIONS: column.size,
        Inputs.RESPONSES: column.size,
        Inputs.VELOCITY: rows,
        Inputs.FRICTION: contacts * groups,
        Inputs.MINIMUM: contacts,
        Inputs.MOBILITY: rows,
        Inputs.WEIGHTS: rows,
        Inputs.SHIFT: rows,
    }
    return {
        **{place: np.zeros(size) for place, size in numbers.items()},
        Inputs.DIRECTION_ROWS: row,
        Inputs.DIRECTION_COLUMNS: column,
        Inputs.RESPONSE_ROWS: row,
        Inputs.RESPONSE_COLUMNS: column,
        Inputs.KEY_TABLE: integers(2 * contacts + 1),
    }


def shape_inputs(shapes: StepShapes) -> dict[int, np.ndarray]:
    """Tables of the shapes, and memory of the search for their features."""
    return {
        Inputs.PLACES: shapes.places,
        Inputs.FORMS: shapes.records,
        Inputs.AXES: np.zeros(3 * shapes.axes),
        Inputs.AXES_AHEAD: np.zeros(3 * shapes.axes),
        Inputs.FEATURES: integers(4 * shapes.most),
        Inputs.HULL_WORK: np.zeros(3 * shapes.longest),
    }


def step_outputs(
    contacts: int, components: int, widest: int, speeds: int, entries: int
) -> dict[int, np.ndarray]:
    """Outputs of all schemes for a number of contacts.

    Parameters
    ----------
    components, widest : as in ``contact_inputs``
    speeds, entries : number of all speeds, and of the entries of the matrix
    """
    rows, most = contacts * components, 2 * widest
    numbers = {
        Outputs.FREE_SPEEDS: speeds,
        Outputs.GAPS: contacts,
        Outputs.VELOCITY_BEFORE: rows,
        Outputs.VELOCITY_FREE: rows,
        Outputs.OFFSETS: rows,
        Outputs.NEXT_OFFSETS: rows,
        Outputs.BODY_CHANGES: speeds,
        Outputs.VELOCITY_APPLIED: rows,
        Outputs.FIRST_SPEEDS: speeds,
    }
    return {
        **newton_outputs(contacts, components, speeds, entries, speeds),
        **block_outputs(contacts, contacts * most, rows * most, contacts * most**2),
        **solution_memory(contacts, components),
        **{place: np.zeros(size) for place, size in numbers.items()},
        Outputs.PAIRS: integers(contacts),
        Outputs.START_DIRECTIONS: integers(contacts),
        Outputs.LEAVING: integers(contacts),
        Outputs.SLIDING: integers(contacts),
    }


def stored_outputs(contacts: int, components: int, widest: int) -> dict[int, np.ndarray]:
    """Memory of the scheme of Moreau and Jean for contacts near each other, arguments as in
    ``contact_inputs``."""
    rows, most = contacts * components, 2 * widest
    return {
        Outputs.STORED_DIRECTIONS: np.zeros(rows * most),
        Outputs.STORED_ROWS: integers(rows + 1),
        Outputs.STORED_COLUMNS: integers(rows * most),
        Outputs.STORED_BEFORE: np.zeros(rows),
        Outputs.STORED_FREE: np.zeros(rows),
        Outputs.STORED_GAPS: np.zeros(contacts),
        Outputs.STORED_KEYS: np.zeros(contacts, dtype=np.int64),
        Outputs.STORED_DESCRIPTIONS: contact_arrays(contacts)[1],
        Outputs.STORED_START: integers(contacts),
        Outputs.STORED_NORMALS: np.zeros(3 * contacts),
        Outputs.STATES: integers(contacts),
        Outputs.OTHER_KEYS: np.zeros(contacts, dtype=np.int64),
        Outputs.OTHER_DESCRIPTIONS: contact_arrays(contacts)[1],
    }
