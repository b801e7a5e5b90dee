"""Gradients of eigenvalues and shapes of structures, ``A φ = λ B φ`` with ``φᵀ B φ = 1``.

Differentiated, with the shapes ``Φ`` of an eigenvalue and of all that coincide with it,

    dλ̂ = Φᵀ (dA − λ dB) Φ,   (A − λ B) dΦ = −(dA − λ dB) Φ + B Φ dλ̂,   Φᵀ B dΦ = −Φᵀ dB Φ / 2

(Nelson, AIAA Journal 14, 1976; Dailey, AIAA Journal 27, 1989). The shapes of a repeated eigenvalue
may be turned among themselves, and single ones of it have no derivative; what does not notice the
turning has one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dalembert.analysis.structural.spectrum import Spectrum
from dalembert.errors import SingularityError
from dalembert.sensitivity.engine import RowEngine
from dalembert.sensitivity.samples import Sample
from dalembert.sensitivity.structural.loaded_pencil import PencilTangent
from dalembert.sparse.eigenvalues import ALIKE, coincidence, told_apart


@dataclass(frozen=True)
class Group:
    """Coinciding eigenvalues, and what a response weighs them.

    Attributes
    ----------
    places : (m,) in the spectrum
    value : weight of each eigenvalue
    shapes : (n, m) weights of the shapes
    """

    spectrum: Spectrum
    places: list[int]
    value: float
    shapes: np.ndarray

    @property
    def eigenvalues(self) -> np.ndarray:
        """(m,) ``λ``."""
        return self.spectrum.eigenvalues[self.places]

    @property
    def phi(self) -> np.ndarray:
        """(n, m) ``Φ``."""
        return self.spectrum.shapes[:, self.places]

    @cached_property
    def scaled(self) -> np.ndarray:
        """(n, m) ``B Φ``."""
        return self.spectrum.scaled(self.phi)

    @cached_property
    def turning(self) -> np.ndarray:
        """(m, m) ``H = Φᵀ Φ̄``; symmetric where the response does not see turns of the shapes."""
        return self.phi.T @ self.shapes

    def apart(self, rhs: np.ndarray) -> np.ndarray:
        """(n, m) ``V`` with ``(A − λ B) V = R − B Φ Φᵀ R`` and ``Φᵀ B V = 0``."""
        found = self.spectrum.solve(self.places, rhs - self.scaled @ (self.phi.T @ rhs))
        return found - self.phi @ (self.scaled.T @ found)

    def pulled(self) -> tuple[np.ndarray, np.ndarray]:
        """(n, m) ``a`` and ``b``: the derivative is ``Σ aᵀ dA φ + bᵀ dB φ``."""
        a, b = self.value * self.phi, np.zeros_like(self.phi)
        if self.shapes.any():
            a -= self.apart(self.shapes)
            b -= self.phi @ self.turning / 2
        return a, b - a * self.eigenvalues

    def pushed(self, da: np.ndarray, db: np.ndarray) -> float:
        """The derivative from ``dA Φ`` and ``dB Φ``, both (n, m)."""
        opened = da - db * self.eigenvalues
        change = self.value * float(np.einsum("nm,nm->", self.phi, opened))
        if self.shapes.any():
            moved = -self.apart(opened) - self.phi @ (self.phi.T @ db) / 2
            change += float(np.einsum("nm,nm->", self.shapes, moved))
        return change


class EigenpairGradient:
    """Rows of the gradient for one sampled response, which weighs eigenpairs group by group.

    Parameters
    ----------
    sample : Sample
    shared : what responses of the same modes have in common

    Raises
    ------
    SingularityError
        Modes coincide that the response tells apart, or the measure has a kink at an eigenvalue.
    """

    def __init__(self, sample: Sample, shared: dict):
        self.sample, self.modes = sample, sample.motion
        self.spectrum: Spectrum = self.modes.record
        self.shared = shared
        if not shared:
            shared["tangent"] = PencilTangent(self.spectrum.pencil)
        self.tangent: PencilTangent = shared["tangent"]
        self.own = np.zeros(self.modes.parameters.size)
        self.groups = self._groups()

    def _groups(self) -> list[Group]:
        values, shapes = (
            np.zeros(self.spectrum.eigenvalues.size),
            np.zeros_like(self.spectrum.shapes),
        )
        for k in np.flatnonzero(self.sample.weights):
            share = float(self.sample.weights[k])
            seen = self.modes.weights(self.sample.measure.sx, int(k))
            if not np.isfinite(seen.eigenvalue):
                raise SingularityError(
                    f"{self.sample.response.label}: the eigenvalue of mode {self.modes.numbers[k]} "
                    "is zero, where the measure has a kink; use eigenvalue"
                )
            place = int(self.modes.positions[k])
            values[place] += share * seen.eigenvalue
            shapes[self.spectrum.pencil.free, place] += share * seen.u[self.spectrum.pencil.free]
            self.own += share * seen.p
        found = []
        for places in self.spectrum.groups:
            if values[places].any() or shapes[:, places].any():
                mean = float(values[places].mean())
                group = Group(self.spectrum, places, mean, shapes[:, places])
                self._check(group, values[places])
                found.append(group)
        return found

    def _check(self, group: Group, values: np.ndarray) -> None:
        """A response must not tell coinciding modes apart."""
        if len(group.places) == 1:
            return
        h = group.turning
        size = np.linalg.norm(group.phi) * np.linalg.norm(group.shapes)
        turned = np.abs(h - h.T).max() > ALIKE * size
        if turned or told_apart(values, float(np.abs(values).max())):
            numbers = [k + 1 for k in group.places]
            said = coincidence(numbers, self._value(group))
            raise SingularityError(
                f"{self.sample.response.label}: {said}; take a response that does not tell them "
                "apart, such as the mean over these modes (solve for all of them), or "
                "eigenvalue_slopes for their one-sided derivatives"
            )

    def _value(self, group: Group) -> str:
        """The main measure of these modes, such as a frequency or a load factor, with its unit."""
        main = self.modes.named[self.modes.main]
        k = int(np.flatnonzero(np.isin(self.modes.positions, group.places))[0])
        value = f"{self.modes.values(self.modes.main)[k]:.9g}"
        return " ".join([self.modes.main.replace("_", " "), value, main.unit]).strip()

    def adjoint(self) -> np.ndarray:
        """(np,) gradient by one solution for each group of modes whose shapes count."""
        pulled = (self.tangent.pulled(*group.pulled(), group.phi) for group in self.groups)
        return sum(pulled, self.own)

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        """(columns,) derivatives along one parameter after the other."""
        found = self.own[list(columns)]
        for i, column in enumerate(columns):
            found[i] += sum(group.pushed(*self._change(group, column)) for group in self.groups)
        return found

    def _change(self, group: Group, column: int) -> tuple[np.ndarray, np.ndarray]:
        """``dA Φ`` and ``dB Φ`` with one parameter, once for all responses."""
        key = (column, *group.places)
        if key not in self.shared:
            self.shared[key] = self.tangent.along(column).of(group.phi)
        return self.shared[key]  # type: ignore[no-any-return]


class EigenpairEngine(RowEngine):
    """All responses with the same factors, one for each group of modes."""

    row = EigenpairGradient
