"""Stationary response to random inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from functools import cached_property
from typing import Annotated, Any

import casadi as ca
import numpy as np

from dalembert.analysis.frequency.cross_density import CrossDensity, cross_density_of, pair_of
from dalembert.analysis.frequency.frequency_response import FrequencyResponse
from dalembert.analysis.frequency.linear_analysis import checked_span
from dalembert.analysis.frequency.spectral_density import Density, density_of, quadrature
from dalembert.analysis.frequency.undamped import grows, undamped_frequencies
from dalembert.errors import AnalysisError
from dalembert.options import options
from dalembert.results.coherence import Pair
from dalembert.results.harmonic import HarmonicResponse
from dalembert.results.harmonic_measures import measures_of, with_densities
from dalembert.results.random_vibration import RandomVibration
from dalembert.symbolic.formulas.expression import Expression


@options
class RandomResponse(FrequencyResponse):
    """Response to stationary random inputs, ``S_y(f) = Σ_jk H_j(f)* S_jk(f) H_k(f)``.

    Inputs are independent, ``S_y(f) = Σ |H_j(f)|² S_j(f)``, unless ``psd`` has their cross density
    ``S_jk``, the one-sided density of ``X_j* X_k`` (Bendat & Piersol, Random Data, 2010, 5.2).

    Spectral densities are one-sided, per hertz. Mean squares are integrals of densities by
    Gauss–Legendre panels that are graded towards each resonance, with the tail of unbounded bands;
    for white noise they agree with the Lyapunov equation.

    Parameters
    ----------
    psd : input → spectral density [unit²/Hz]: a number, a formula of the frequency ``f``, a table
        ``{"frequency": [..], "density": [..]}`` with linear interpolation of logarithms, or in
        Python a function; with the key ``("a", "b")``, in files ``"a, b"``, the cross density of
        two inputs: a complex number, a formula, a function, ``{"real": .., "imag": ..}``, or
        ``{"coherence": γ², "delay": T}``, ``γ √(S_a S_b) exp(−i 2π f T)``, of b that follows a
    band : first and last frequency [Hz] of the mean squares; by default all of them

    Raises
    ------
    AnalysisError
        No densities, densities that are no numbers, unknown inputs, cross densities above
        ``√(S_a S_b)``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("oscillator")
    >>> push = system.input("push", unit="N")
    >>> body = system.add(planar.Particle("body", mass=1.0, position=(0.5, 0)))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    >>> ends = system.ground.center, body.center
    >>> spring = planar.Spring("spring", *ends, stiffness=100.0, damping=2.0, free_length=0.5)
    >>> parts = system.add(spring), system.add(planar.Force("force", body.center, (push, 0)))
    >>> white = da.RandomResponse(psd={"push": 8.0}, outputs=["body.x"])
    >>> round(white.run(system.build()).rms("body.x") ** 2, 9)  # S/(4 c k)
    0.01
    """

    display_name = "random vibration"
    random = True

    psd: Annotated[Any, dict[str, object]] = None
    band: Annotated[Any, tuple[float, float]] = None

    def __post_init__(self) -> None:
        FrequencyResponse.__post_init__(self)
        if self.psd is not None and not isinstance(self.psd, Mapping):
            raise AnalysisError(_missing(self.psd))
        if self.excitation is not None:
            raise AnalysisError("RandomResponse: excitation is for harmonic inputs; give psd=")
        self.densities, self.cross_densities  # noqa: B018  refuse wrong entries
        if self.band is not None:
            checked_span(self.band)
        late = [pair for pair, density in self.cross_densities.items() if density.delay]
        if late and not np.isfinite(self.limits[1]):
            raise AnalysisError(
                f"RandomResponse: psd[{', '.join(late[0])}] has a delay, whose density oscillates "
                "over all frequencies; give band=(first, last) in Hz"
            )

    @classmethod
    def expression(cls, model: Any, measure: str | Expression) -> Expression:
        def density(name: str, unit: str) -> Expression:
            return Expression(ca.SX.sym("density"), f"{name}.psd", unit)

        return with_densities(measures_of(model), model, density).expression(measure)

    @cached_property
    def densities(self) -> dict[str, Density]:
        """Input → spectral density."""
        psd = self.psd or {}
        return {str(k): density_of(str(k), e) for k, e in psd.items() if pair_of(k) is None}

    @cached_property
    def cross_densities(self) -> dict[Pair, CrossDensity]:
        """Two inputs → their cross spectral density."""
        cross: dict[Pair, CrossDensity] = {}
        for key, entry in (self.psd or {}).items():
            if (pair := pair_of(key)) is None:
                continue
            for name in pair:
                if name not in self.densities:
                    raise AnalysisError(
                        f"RandomResponse: psd[{', '.join(pair)}] needs psd.{name}, the density of "
                        f"{name} itself"
                    )
            if pair in cross or pair[::-1] in cross:
                raise AnalysisError(f"RandomResponse: psd has {', '.join(pair)} twice")
            cross[pair] = cross_density_of(pair, entry, self.densities)
        return cross

    def input_names(self, model: Any) -> list[str]:
        if not self.psd:
            raise AnalysisError(_missing(self.psd))
        inputs = list(self.densities) if self.inputs is None else self.inputs
        names = super(RandomResponse, replace(self, inputs=inputs)).input_names(model)
        if missing := [name for name in names if name not in self.densities]:
            raise AnalysisError(f"RandomResponse: psd has no density of the input {missing[0]}")
        if extra := [name for name in self.densities if name not in names]:
            raise AnalysisError(f"RandomResponse: psd.{extra[0]} is not among the inputs")
        return names

    def response(self, system: Any, frequencies: np.ndarray) -> RandomVibration:
        harmonic: HarmonicResponse = super().response(system, frequencies)
        parts = {f.name: getattr(harmonic, f.name) for f in fields(harmonic)}
        return RandomVibration(**parts, densities=self.densities, cross=self.cross_densities)

    @property
    def limits(self) -> tuple[float, float]:
        """First and last frequency of the mean squares [Hz]."""
        low, high = (0.0, np.inf) if self.band is None else checked_span(self.band)
        ends = [density.limits for density in self.densities.values()]
        return max(low, min(e[0] for e in ends)), min(high, max(e[1] for e in ends))

    def infinite_resonance(
        self, result: RandomVibration, measure: str | Expression
    ) -> float | None:
        """Undamped resonance [Hz] in the band at which a density is infinite, or None."""
        for place in undamped_frequencies(result.record, *self.limits):
            if grows(lambda x: result.at(x).values(measure), place):
                return float(place)
        return None

    def nodes(self, result: RandomVibration) -> tuple[np.ndarray, np.ndarray]:
        """Frequencies and weights of mean squares [Hz]."""
        record, (low, high) = result.record, self.limits
        finite = hasattr(record, "poles_up_to") and np.isfinite(high)
        poles = record.poles_up_to(high) if finite else record.poles
        breaks = [f for d in self.densities.values() for f in d.breaks if low < f < high]
        delay = max((abs(d.delay) for d in self.cross_densities.values()), default=0.0)
        return quadrature(poles, (low, high), breaks, 1 / delay if delay else np.inf)


def _missing(psd: Any) -> str:
    return f"RandomResponse: psd is {psd!r:.60}; give input → spectral density"
