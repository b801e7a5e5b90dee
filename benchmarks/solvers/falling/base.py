"""Solvers of falling bodies with contacts."""

from __future__ import annotations

from collections.abc import Callable

Run = Callable[[int], tuple[float, float]]
"""Steps → seconds of a step, and the maximum penetration [m]."""
