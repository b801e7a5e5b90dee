"""Warnings about beams whose chords are too long for the curvature of their contacts.

A chord that turns by ``θ`` against the next one presses with friction on one point, so that
tensions on both sides have the ratio ``(1 + μ tan(θ/2))/(1 − μ tan(θ/2))`` in place of ``e^(μθ)``,
and the ends of a wrap have no contacts: over drums with 3 to 8 chords on half a turn, tensions are
wrong by about ``θ²/6``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.gaps.gap_source import FormulaGaps
from dalembert.analysis.nonsmooth.gaps.model_gaps import APART
from dalembert.elements.contact.beam_line import BeamLine
from dalembert.elements.contact.beam_parts import BeamPart
from dalembert.elements.contact.contact import ShapeContact
from dalembert.elements.flexible.beam import Beam
from dalembert.results.nonsmooth_motion import ContactRecord

SAMPLES = 25
"""Upper limit of the number of steps that are checked."""
ALLOWED, TARGET = 0.02, 0.005
"""Relative error of tensions: threshold for a warning, and target of the proposed elements [-]."""
SMOOTH = 1e-6
"""Friction relative to the normal forces that counts as none [-]."""


def coarse_beam_warnings(step: ContactStep, record: ContactRecord) -> list[str]:
    """A warning for each beam whose chords turn too much where it presses with friction."""
    beams = _beams(step)
    if not (beams and record.step.size):
        return []
    e, pressing = step.model.equations, np.unique(record.step)
    chosen = np.linspace(0, pressing.size - 1, min(SAMPLES, pressing.size)).round().astype(int)
    worst = dict.fromkeys(beams.values(), (0.0, 0.0, 0.0))
    places = {beam: _node_places(step, beam) for beam in worst}
    stations = {
        k: _Stations(step, source)
        for k, source in enumerate(step.sources)
        if isinstance(source, FormulaGaps) and _lines(source)
    }
    for k in pressing[chosen]:
        t, y = float(record.t[k + 1]), record.ends.y[: e.coordinate_count, k + 1]
        for name, points, impulses in _contacts(step, stations, record, int(k), t, y):
            if name not in beams:
                continue
            nodes = places[beams[name]](t, y, step.p).full()
            squares = _turns(nodes, points) ** 2
            total = impulses[:, 0].sum()
            if not np.abs(impulses[:, 1:]).sum() > SMOOTH * total:
                continue
            error = float(squares @ impulses[:, 0] / total) / 6
            if error > worst[beams[name]][0]:
                worst[beams[name]] = error, math.sqrt(squares.max()), t
    return [_text(beam, *of) for beam, of in worst.items() if of[0] > ALLOWED]


def _text(beam: Beam, error: float, turn: float, t: float) -> str:
    count = math.ceil(beam.elements * math.sqrt(error / TARGET))
    return (
        f"{beam.name} is coarse for its contacts: its chords turn by up to {turn:.2g} rad at t = "
        f"{t:.6g} s, so that tensions by friction err by about {100 * error:.2g} %; give it about "
        f"{count} elements (at sharp edges no number suffices; round these)"
    )


def _beams(step: ContactStep) -> dict[str, Beam]:
    """Beams among the shapes of ``Collisions`` and of single contacts, by name."""
    elements = [element for source in step.sources for element in source.elements]
    hulls = [hull for element in elements for hull in getattr(element, "hulls", ())]
    parts = [solid.carrier for _, solid in hulls if isinstance(solid.carrier, BeamPart)]
    formulas = [source for source in step.sources if isinstance(source, FormulaGaps)]
    lines = [line for source in formulas for _, line in _lines(source)]
    return {part.name: part.beam for part in parts} | {line.beam.name: line.beam for line in lines}


def _lines(source: FormulaGaps) -> list[tuple[int, BeamLine]]:
    """Beams of single contacts, with the numbers of their elements."""
    contacts = [(k, c) for k, c in enumerate(source.elements) if isinstance(c, ShapeContact)]
    return [(k, s) for k, c in contacts for s in c.shapes if isinstance(s, BeamLine)]


class _Stations:
    """Contact points of beams in single contacts.

    Parameters
    ----------
    source : its gaps are those of the elements in their order
    """

    def __init__(self, step: ContactStep, source: FormulaGaps):
        e, points = step.model.all_equations, list[ca.SX]()
        for element, count in zip(source.elements, np.bincount(source.owner), strict=True):
            if isinstance(element, ShapeContact):
                points += [point.place for point in element.contact_points]
            else:
                points += [ca.SX.nan(2)] * int(count)
        rows = max(point.numel() for point in points)
        table = ca.horzcat(*(ca.vertcat(p, ca.SX.zeros(rows - p.numel())) for p in points))
        table = step.model.at_ground(ca.densify(table))
        self._places = ca.Function("stations", [e.t, e.y, e.p], [table])
        self._lines, self._owner = _lines(source), source.owner

    def contacts(
        self, at: tuple[float, np.ndarray, np.ndarray], keys: np.ndarray
    ) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
        """Names of beams, their points, and masks of the gaps with some keys of these."""
        points = self._places(*at).full().T[keys]
        points = np.hstack([points, np.zeros((keys.size, 3 - points.shape[1]))])
        for element, line in self._lines:
            own = self._owner[keys] == element
            yield line.beam.name, points[own], own


def _node_places(step: ContactStep, beam: Beam) -> ca.Function:
    """``(t, y, p) → (d, count)`` positions of the nodes."""
    e = step.model.all_equations
    places = ca.horzcat(*(section.place for section in beam.sections))
    return ca.Function("nodes", [e.t, e.y, e.p], [step.model.at_ground(ca.densify(places))])


def _contacts(
    step: ContactStep,
    stations: Mapping[int, _Stations],
    record: ContactRecord,
    k: int,
    t: float,
    y: np.ndarray,
) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Positions and impulses of the contacts of a step, by the names of their shapes."""
    rows = np.flatnonzero((record.step == k) & (record.impulse[:, 0] > 0))
    parts: list[tuple[str, np.ndarray, np.ndarray]] = []
    for number, source in enumerate(step.sources):
        own = rows[record.key[rows] // APART == number]
        if not own.size:
            continue
        keys = record.key[own] % APART
        if number in stations:
            pressed = stations[number].contacts((t, y, step.p), keys)
            parts += [(n, points, record.impulse[own[some]]) for n, points, some in pressed]
            continue
        points, _ = source.points(step.at(t, y), keys)
        bodies = source.bodies(keys)
        for name in np.unique(bodies):
            some = (bodies == name).any(axis=1) & np.isfinite(points).all(axis=1)
            if some.any():
                parts.append((str(name), points[some], record.impulse[own[some]]))
    return parts


def _turns(nodes: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(n,) larger angle of a chord with its neighbours, of the chords next to some points.

    Parameters
    ----------
    nodes : (d, count) positions
    points : (n, 3)
    """
    nodes, points = nodes.T, points[:, : len(nodes)]
    chords = np.diff(nodes, axis=0)
    lengths = np.linalg.norm(chords, axis=1)
    cosines = (chords[1:] * chords[:-1]).sum(axis=1) / (lengths[1:] * lengths[:-1])
    angles = np.concatenate([[0.0], np.arccos(np.clip(cosines, -1, 1)), [0.0]])
    beyond = points[:, None] - nodes[:-1]
    share = np.clip((beyond * chords).sum(axis=2) / lengths**2, 0, 1)
    nearest = np.linalg.norm(beyond - share[..., None] * chords, axis=2).argmin(axis=1)
    larger: np.ndarray = np.maximum(angles[nearest], angles[nearest + 1])
    return larger
