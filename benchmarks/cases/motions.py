"""Motions of rigid mechanisms: time to the same error, and time of a step."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from benchmarks import mechanisms
from benchmarks.cases.base import Case, Effort
from benchmarks.mechanism import Mechanism
from benchmarks.picture import draw
from benchmarks.precision import compare, per_step
from benchmarks.sample import Row
from benchmarks.solvers import derived, exudyn, ours, trees
from benchmarks.solvers.base import Contestant, installed

ERROR = 1e-6
"""Of the observed place [m]."""
COUNTS = (1, 3, 10, 40, 200, 1000)
"""Four-bars in a row."""
Made = Callable[[], tuple[Mechanism, np.ndarray]]


def contestants(mechanism: Mechanism, duration: float, effort: Effort) -> list[Contestant]:
    """Everyone installed who can do it."""
    found = ours.contestants(mechanism, duration, 20, effort.backends)
    if installed("exudyn"):
        found += exudyn.contestants(mechanism, duration, 100)
    return [
        *found,
        *trees.contestants(mechanism, duration, 20),
        *derived.contestants(mechanism, duration, 20),
    ]


def measured(
    mechanism: Mechanism, reference: np.ndarray, duration: float, effort: Effort
) -> Iterator[Row]:
    """Two rows: to the error, and a step."""
    error = 1e-4 if effort.quick else ERROR
    everyone = contestants(mechanism, duration, effort)
    curves = compare(everyone, reference, error, effort.rounds, effort.limit)
    if effort.pictures is not None:
        draw(mechanism.name, curves, effort.pictures)
    named = {curve.contestant.name: curve for curve in curves}
    yield Row(
        mechanism.name,
        f"time to an error of {error:.0e} m",
        {name: curve.time for name, curve in named.items()},
    )
    if not effort.quick:
        steps = {name: per_step(curve, effort.rounds) for name, curve in named.items()}
        yield Row(mechanism.name, "one step", steps)


def known(make: Made, duration: float) -> Callable[[Effort], Iterator[Row]]:
    """A case whose reference is given."""
    return lambda effort: measured(*make(), duration, effort)


def found(make: Callable[[], Mechanism], duration: float) -> Callable[[Effort], Iterator[Row]]:
    """A case whose reference is computed with tight tolerances, and confirmed by who reaches it."""

    def measure(effort: Effort) -> Iterator[Row]:
        mechanism = make()
        return measured(mechanism, ours.reference(mechanism, duration), duration, effort)

    return measure


def four_bars(effort: Effort) -> Iterator[Row]:
    """Rows of N = 1, 3, 10 …"""
    for count in COUNTS:
        if count <= min(effort.sizes, 3 if effort.quick else effort.sizes):
            yield from measured(*mechanisms.four_bars(count), 1.0, effort)


CASES = [
    Case("pendulum", "a rod on a pin, 2 s", known(mechanisms.pendulum, 2.0)),
    Case("four-bars", "chains of N four-bars, 1 s", four_bars),
    Case("slider-crank", "spatial, four kinds of joints, 1 s", known(mechanisms.slider_crank, 1.0)),
    Case("bricard", "overconstrained, 1 s", known(mechanisms.bricard, 1.0)),
    Case("arm", "seven links on hinges, 0.5 s", found(lambda: mechanisms.chain(7), 0.5)),
    Case("chain", "forty links on hinges, 0.2 s", found(lambda: mechanisms.chain(40), 0.2)),
    Case("loop", "twenty rods on ball joints, 0.2 s", found(lambda: mechanisms.loop(20), 0.2)),
]
