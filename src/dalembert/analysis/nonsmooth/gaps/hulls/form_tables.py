"""Forms of convex hulls as integers, from which machine code reads edges and faces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.analysis.nonsmooth.gaps.hulls.polyhedra import Form
from dalembert.elements.contact.hull import Hull
from dalembert.integrators.contact.step_places import Forms


class FormTables:
    """Records of the forms of some hulls, and the places of corners and axes of each hull.

    Parameters
    ----------
    hulls : all hulls; cylinders and terrains have no record
    form : (h,) number of the first hull of equal form
    dimension : 2 or 3

    Attributes
    ----------
    records : all records
    places : (h, 3) int32 starts of the record, of the corners and of the axes; -1 without a record
    axes : number of axes of all hulls
    most : upper limit of the number of pairs of features of two hulls
    longest : largest number of corners of a face
    """

    def __init__(self, hulls: Sequence[Hull], form: np.ndarray, dimension: int):
        starts = np.cumsum([0, *(len(hull.corners) for hull in hulls)])
        self.places = np.full((len(hulls), 3), -1, dtype=np.int32)
        records: dict[int, int] = {}
        parts, size, self.axes, self.longest, self.most = list[list[int]](), 0, 0, 1, 1
        corners, edges = 1, 1
        for k, hull in enumerate(hulls):
            if hull.flat_ends or hull.grid:
                continue
            number = int(form[k])
            if number not in records:
                records[number] = size
                parts.append(record(hull, dimension))
                size += len(parts[-1])
                corners, edges = max(corners, len(hull.corners)), max(edges, len(hull.edges))
                self.longest = max(self.longest, *(len(face) for face in hull.faces), 2)
            self.places[k] = records[number], starts[k], self.axes
            faces_and_groups = len(hull.faces) + len(hull.parallel_edges)
            self.axes += len(hull.corners) if dimension == 2 else faces_and_groups
        self.records = np.array([n for part in parts for n in part], dtype=np.int32)
        crossing = self.longest * (self.longest + 2) + 2
        self.most = 2 * corners * edges + crossing


def record(hull: Hull, dimension: int) -> list[int]:
    """The record of a form, by ``Forms``."""
    if dimension == 2:
        return Forms.listed({Forms.CORNERS: len(hull.corners), Forms.EDGES: len(hull.edges)})
    form = Form(hull)
    loops = [row[:count].tolist() for row, count in zip(form.loops, form.counts, strict=True)]
    sides = [row[:count].tolist() for row, count in zip(form.sides, form.counts, strict=True)]
    groups = [group.tolist() for group in form.groups]
    tables: dict[int, list[int]] = {
        Forms.EDGE_CORNERS: form.edges.ravel().tolist(),
        Forms.GROUP_STARTS: _starts(groups),
        Forms.GROUP_EDGES: _joined(groups),
        Forms.LOOP_STARTS: _starts(loops),
        Forms.LOOP_CORNERS: _joined(loops),
        Forms.LOOP_EDGES: _joined(sides),
    }
    starts = Forms.size() + np.array(_starts(list(tables.values()))[:-1])
    head = {
        Forms.CORNERS: len(hull.corners),
        Forms.EDGES: len(form.edges),
        Forms.GROUPS: len(groups),
        Forms.LOOPS: len(loops),
        Forms.FACES: len(loops) if form.has_faces else 0,
        **dict(zip(tables, starts.tolist(), strict=True)),
    }
    return [*Forms.listed(head), *_joined(list(tables.values()))]


def _joined(lists: list[list[int]]) -> list[int]:
    return [number for part in lists for number in part]


def _starts(lists: list[list[int]]) -> list[int]:
    starts: list[int] = np.cumsum([0, *(len(part) for part in lists)]).tolist()
    return starts
