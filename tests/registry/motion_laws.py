"""Every motion law with its twin."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from twins import cubic, not_a_knot_cubic

from dalembert import sin, t
from dalembert.elements.laws import (
    CycloidalRise,
    Formula,
    Harmonic,
    HarmonicRise,
    Polynomial,
    Polynomial345Rise,
    Polynomial4567Rise,
    Product,
    Sum,
    Table,
)


@dataclass(frozen=True)
class LawCase:
    """A motion law, its twin, and where its pieces meet how smoothly.

    Attributes
    ----------
    make : builder → Law
    twin : (numbers, time) → value
    breaks : times at which pieces meet
    smooth : order of the highest continuous derivative there
    """

    kind: type
    make: Callable
    twin: Callable
    breaks: tuple[float, ...] = ()
    smooth: int = 2


def _rise_twin(profile: Callable, falls: bool):
    def clipped(x):
        return 0.0 if np.real(x) <= 0 else 1.0 if np.real(x) >= 1 else profile(x)

    def value(p, time):
        local = time - p.begin
        if not falls:
            return p.start + p.height * clipped(local / p.rise)
        local = local - p.period * np.floor(np.real(local) / np.real(p.period))
        up, down = clipped(local / p.rise), clipped((local - p.rise - p.dwell) / p.fall)
        return p.start + p.height * (up - down)

    return value


def _rise(kind: type, falls: bool):
    def make(q):
        values = {"height": 0.7, "start": -0.2, "begin": -0.05}
        arguments = {n: q.number(n, v) for n, v in values.items()}
        arguments["duration"] = q.number("rise", 0.5)
        if falls:
            arguments |= {
                n: q.number(n, v) for n, v in {"dwell": 0.1, "fall": 0.3, "period": 1.1}.items()
            }
        return kind(**arguments)

    return make


PROFILES = {
    HarmonicRise: (lambda x: np.sin(np.pi * x / 2) ** 2, 1),
    CycloidalRise: (lambda x: x - np.sin(2 * np.pi * x) / (2 * np.pi), 2),
    Polynomial345Rise: (lambda x: 10 * x**3 - 15 * x**4 + 6 * x**5, 2),
    Polynomial4567Rise: (lambda x: 35 * x**4 - 84 * x**5 + 70 * x**6 - 20 * x**7, 3),
}
TIMES = np.array([-0.5, 0.4, 0.9, 1.3, 2.0, 2.6])
VALUES = np.array([0.1, 0.7, -0.3, 0.2, 0.9, 0.1])

LAWS: dict[str, LawCase] = {
    "Polynomial": LawCase(
        Polynomial,
        lambda q: Polynomial(*q.numbers(phi0=0.3, omega=-1.2, alpha=2.5)),
        lambda p, s: p.phi0 + p.omega * s + p.alpha * s**2 / 2,
    ),
    "Harmonic": LawCase(
        Harmonic,
        lambda q: Harmonic(*q.numbers(amplitude=0.4, frequency=3.0, mean=0.2, phase=0.5)),
        lambda p, s: p.mean + p.amplitude * np.sin(p.frequency * s + p.phase),
    ),
    "Formula": LawCase(
        Formula,
        lambda q: Formula(q.number("k1", 0.3) * sin(q.number("k2", 2.0) * t) + 0.1 * t**3),
        lambda p, s: p.k1 * np.sin(p.k2 * s) + 0.1 * s**3,
    ),
    "Table": LawCase(
        Table,
        lambda q: Table(TIMES, VALUES),
        lambda p, s: cubic(s, TIMES, VALUES, "not-a-knot"),
        breaks=tuple(TIMES[1:-1]),
    ),
    "Sum": LawCase(
        Sum,
        lambda q: (
            Table(TIMES, VALUES, ends="natural")
            + Harmonic(q.number("amp", 0.4), q.number("w", 3.0))
            + t
        ),
        lambda p, s: cubic(s, TIMES, VALUES, "natural") + p.amp * np.sin(p.w * s) + s,
        breaks=tuple(TIMES[1:-1]),
    ),
    "Product": LawCase(
        Product,
        lambda q: (
            Polynomial(q.number("s0", 0.3)) * Harmonic(q.number("amp", 1.0), q.number("w", 2.0))
        ),
        lambda p, s: p.s0 * p.amp * np.sin(p.w * s),
    ),
    "Table of formulas": LawCase(
        Table,
        lambda q: Table(
            [x * q.number(f"stretch{k}", 1.0) for k, x in enumerate(TIMES)],
            [y * q.number(f"lift{k}", 1.0) for k, y in enumerate(VALUES)],
        ),
        lambda p, s: not_a_knot_cubic(
            s,
            [x * getattr(p, f"stretch{k}") for k, x in enumerate(TIMES)],
            [y * getattr(p, f"lift{k}") for k, y in enumerate(VALUES)],
        ),
        breaks=tuple(TIMES[1:-1]),
    ),
    "Table periodic": LawCase(
        Table,
        lambda q: Table(TIMES, VALUES, periodic=True),
        lambda p, s: cubic(s, TIMES, VALUES, "periodic"),
        breaks=tuple(TIMES),
    ),
}
for _kind, (_profile, _smooth) in PROFILES.items():
    LAWS[_kind.__name__] = LawCase(
        _kind, _rise(_kind, False), _rise_twin(_profile, False), (-0.05, 0.45), _smooth
    )
    LAWS[f"{_kind.__name__} repeated"] = LawCase(
        _kind,
        _rise(_kind, True),
        _rise_twin(_profile, True),
        (-0.05, 0.45, 0.55, 0.85, 1.05, 1.55),
        _smooth,
    )
