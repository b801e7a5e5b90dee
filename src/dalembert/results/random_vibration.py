"""Stationary random vibration: spectral densities and root mean squares."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from dalembert.results.coherence import check_coherence
from dalembert.results.files.contents import Contents
from dalembert.results.harmonic import HarmonicResponse
from dalembert.results.harmonic_measures import Transfer, part_name, with_densities
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.parser import Names
from dalembert.units.powers import density_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DECAY = 1e-3
"""Share of the integral in its last node that counts as infinite [-]."""
FAR = 3.0
"""Ratio of the last two nodes of an unbounded band, at least [-]."""


@dataclass(frozen=True, eq=False, repr=False)
class RandomVibration(HarmonicResponse):
    """Stationary response to random inputs with one-sided spectral densities.

        S_y(f) = Σ_j |H_j|² S_j + 2 Re Σ_{j<k} H_j* S_jk H_k,      σ_y² = ∫ S_y df

    Measures are those of a frequency response, and ``X.psd`` of any scalar measure ``X`` of the
    model. ``da.random_rms("X")`` is the root mean square as a response with gradients.

    Attributes
    ----------
    densities : input → spectral density, as function of the frequency [Hz]
    cross : two inputs → cross spectral density, likewise

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
    >>> vibration = da.RandomResponse(psd={"push": 8.0}, outputs=["body.x"]).run(system.build())
    >>> isinstance(vibration, da.RandomVibration), round(vibration.rms("body.x"), 9)
    (True, 0.1)
    """

    densities: Mapping[str, Any] = field(default_factory=dict)
    cross: Mapping[tuple[str, str], Any] = field(default_factory=dict)

    @cached_property
    def names(self) -> Names:
        return with_densities(super().names, self.model, self._density, self.outputs)

    def _density(self, base: str, unit: str) -> Expression:
        if base not in self._symbols:
            total = ca.SX(0)
            parts = {
                source: [Transfer(base, source, part).symbol for part in ("real", "imag")]
                for source in self.inputs
            }
            for source, (real, imag) in parts.items():
                total += (real**2 + imag**2) * self.spectra_symbols[source]
            for (one, other), (p, q) in self.cross_symbols.items():
                (a, b), (c, d) = parts[one], parts[other]
                total += 2 * ((a * c + b * d) * p - (a * d - b * c) * q)
            self._symbols[base] = Expression(total, part_name(base, "psd"), unit)
        return self._symbols[base]

    @cached_property
    def _symbols(self) -> dict[str, Expression]:
        return {}

    @cached_property
    def spectra_symbols(self) -> dict[str, ca.SX]:
        """Input → symbol of its spectral density."""
        return {name: ca.SX.sym(f"density of {name}") for name in self.inputs}

    @cached_property
    def cross_symbols(self) -> dict[tuple[str, str], tuple[ca.SX, ca.SX]]:
        """Two inputs → symbols of the parts of their cross spectral density."""
        return {
            pair: tuple(ca.SX.sym(f"{part} of {', '.join(pair)}") for part in ("real", "imag"))  # type: ignore[misc]
            for pair in self.cross
        }

    @property
    def spectra(self) -> list[tuple[ca.SX, np.ndarray]]:
        """Symbols of spectral densities and their values (K,)."""
        own = {name: self.densities[name](self.frequencies) for name in self.inputs}
        cross = {pair: density(self.frequencies) for pair, density in self.cross.items()}
        check_coherence(self.inputs, own, cross, self.frequencies)
        spectra = [(self.spectra_symbols[name], values) for name, values in own.items()]
        for pair, (p, q) in self.cross_symbols.items():
            spectra += [(p, cross[pair].real), (q, cross[pair].imag)]
        return spectra

    @property
    def density_curves(self) -> list[dict[str, Any]]:
        return [
            {
                "name": f"{name}, σ = {self.rms(name):.4g} {measure.unit}".rstrip(),
                "unit": density_unit(measure.unit),
                "values": self.psd(name),
            }
            for name, measure in self.outputs.items()
        ]

    def psd(self, output: str) -> np.ndarray:
        """(K,) one-sided spectral density of an output."""
        return self.values(part_name(output, "psd"))

    def rms(self, output: str) -> float:
        """Root mean square of an output over the band of the analysis; may be infinite."""
        if output not in self._mean_squares:
            self._mean_squares[output] = self._mean_square(output)
        return float(np.sqrt(self._mean_squares[output]))

    def _mean_square(self, output: str) -> float:
        measure = part_name(output, "psd")
        if self.divergence(measure):
            return float("inf")
        nodes, weights = self.quadrature
        return float(weights @ nodes.values(measure))

    def divergence(self, measure: str | Expression) -> str:
        """Reason why the integral of a density is infinite; empty if it is finite.

        The last nodes of an unbounded band are far beyond all resonances.
        """
        analysis: Any = self.analysis
        if (place := analysis.infinite_resonance(self, measure)) is not None:
            return f"no damping acts on the resonance at {place:.6g} Hz; add damping"
        nodes, weights = self.quadrature
        f, densities = nodes.frequencies, nodes.values(measure)
        far = f[-1] > FAR * f[-2]
        flat = densities[-1] * f[-1] > densities[-2] * f[-2] * (1 - 1e-9)
        if far and flat and weights[-1] * densities[-1] > DECAY * (weights @ densities):
            return (
                "white noise passes through at all frequencies; give band=(first, last) in Hz, or "
                "a decaying density"
            )
        return ""

    @cached_property
    def _mean_squares(self) -> dict[str, float]:
        return {}

    @cached_property
    def quadrature(self) -> tuple[RandomVibration, np.ndarray]:
        """The response at the nodes of the quadrature, and their weights [Hz]."""
        analysis: Any = self.analysis
        frequencies, weights = analysis.nodes(self)
        return self.at(frequencies), weights

    def at(self, frequencies: Any) -> RandomVibration:
        harmonic = super().at(frequencies)
        copied = replace(harmonic)
        vars(copied)["spectra_symbols"] = self.spectra_symbols
        vars(copied)["cross_symbols"] = self.cross_symbols
        vars(copied)["_symbols"] = self._symbols
        return copied  # type: ignore[return-value]

    @cached_property
    def contents(self) -> Contents:
        """Spectral densities and root mean squares of the outputs, and amplitudes."""
        units = ", ".join(density_unit(m.unit) for m in self.outputs.values())
        table = np.array([self.psd(name) for name in self.outputs]).T
        variables = {
            "psd": (("frequency", "output"), table, {"units": units, "long_name": "density"}),
            "rms": (
                ("output",),
                np.array([self.rms(name) for name in self.outputs]),
                {"units": ", ".join(m.unit for m in self.outputs.values())},
            ),
        }
        return super().contents.plus(variables)

    def to_dataframe(self) -> Any:
        """Amplitudes, phases and spectral densities over the frequency."""
        frame = super().to_dataframe()
        for name, measure in self.outputs.items():
            frame[f"{name}.psd"] = self.psd(name)
            frame.attrs["units"][f"{name}.psd"] = density_unit(measure.unit)
        return frame

    def summary(self) -> dict[str, Any]:
        """Status, and the root mean square of each output."""
        rows = [
            {"output": name, "root mean square": self.rms(name), "unit": measure.unit}
            for name, measure in self.outputs.items()
        ]
        return super().summary() | {"states": rows}

    def plot(self, *outputs: str, kind: str = "psd", **options: Any) -> Figure:
        """Plot of spectral densities, or ``kind="bode"`` and ``"nyquist"`` of the transfers."""
        from dalembert.results.pictures.frequency_plot import plot_densities

        if kind != "psd":
            return super().plot(*outputs, kind=kind, **options)
        return plot_densities(self, outputs or tuple(self.outputs), **options)
