"""Linearisation about a state: eigenfrequencies, damping ratios, mode shapes.

The first-order system ``ẋ = F(x)`` with accelerations from (5.7) is linearised on the tangent
space of ``Φ = 0, Ψ = 0``: with a basis ``T`` of it, ``A = T⁺ (∂F/∂x) T``. At rest this gives the
usual modes of ``(ZᵀMZ, ZᵀDZ, ZᵀKZ)``; it holds in motion too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from dalembert.analysis.equilibrium import Equilibrium
from dalembert.errors import AnalysisError, SingularityError
from dalembert.formulations.base import state_rate
from dalembert.formulations.kkt import Kkt
from dalembert.model.model import Model
from dalembert.results.motion import Motion

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False)
class Modes:
    """Eigenvalues and modes of the linearised mechanism.

    Attributes
    ----------
    eigenvalues : (k,) complex [1/s]; one of each conjugate pair
    frequencies : (k,) undamped ``|s|/2π`` [Hz]
    damping_ratios : (k,) ``−Re s/|s|``
    shapes : (n, k) complex displacements, largest entry one
    matrix : reduced state matrix
    """

    model: Model
    eigenvalues: np.ndarray
    frequencies: np.ndarray
    damping_ratios: np.ndarray
    shapes: np.ndarray
    matrix: np.ndarray

    @property
    def stable(self) -> bool:
        """No eigenvalue has a positive real part."""
        return bool(np.all(self.eigenvalues.real <= 1e-9 * (1 + np.abs(self.eigenvalues))))

    @property
    def data(self) -> xr.Dataset:
        """Labelled modes."""
        import xarray as xr

        names = list(self.model.guesses.names)
        mode = np.arange(1, self.eigenvalues.size + 1)
        return xr.Dataset(
            {
                "frequency": ("mode", self.frequencies, {"units": "Hz"}),
                "damping_ratio": ("mode", self.damping_ratios, {"units": "1"}),
                "eigenvalue_real": ("mode", self.eigenvalues.real, {"units": "1/s"}),
                "eigenvalue_imag": ("mode", self.eigenvalues.imag, {"units": "rad/s"}),
                "shape_real": (("coordinate", "mode"), self.shapes.real),
                "shape_imag": (("coordinate", "mode"), self.shapes.imag),
            },
            {"mode": mode, "coordinate": names},
            attrs={"model": self.model.name},
        )

    def __repr__(self) -> str:
        rows = ", ".join(
            f"{f:.6g} Hz (ζ {z:+.3g})"
            for f, z in zip(self.frequencies, self.damping_ratios, strict=True)
        )
        return f"<Modes of {self.model.name!r}: {rows}>"


@dataclass(frozen=True)
class Linearization:
    """Linearisation as a strategy object.

    Parameters
    ----------
    time : instant at which laws and forces are taken [s]
    equilibrium : first find the static equilibrium; otherwise take the assembled state
    """

    time: float = 0.0
    equilibrium: bool = True

    def run(
        self,
        model: Model,
        parameters: Mapping[str, float] | np.ndarray | None = None,
        progress: Any = False,
    ) -> Modes:
        """Linearise about the equilibrium or the assembled state.

        Raises
        ------
        AnalysisError
            No equilibrium was found.
        """
        p = parameters if isinstance(parameters, np.ndarray) else model.values(parameters)
        if not self.equilibrium:
            state = model.assemble(p, self.time)
            return modes_at(model, self.time, state.y, state.v, p)
        found = Equilibrium(time=self.time).run(model, p)
        if not found.status.success:
            raise AnalysisError(f"linearize: no equilibrium, {found.status}", found.status.residual)
        s = found.trajectory
        return modes_at(model, self.time, s.y[:, 0], s.v[:, 0], p)


def modes_at(model: Model, time: float, y: np.ndarray, v: np.ndarray, p: np.ndarray) -> Modes:
    """Modes about a given state."""
    if model.diagnosis.massless:
        raise SingularityError(
            f"{', '.join(model.diagnosis.massless)}: can move without any mass moving; no modes"
        )
    e = model.equations
    n, k = e.coordinate_count, e.speed_count

    def make() -> ca.Function:
        x = ca.vertcat(e.y, e.v)
        level = ca.vertcat(e.constraints, e.velocity_constraints)
        rate = Kkt().acceleration(e, e.constraint_acceleration, [state_rate(e)[: n + k]])
        out = rate.function(e.t, ca.vertcat(x, ca.SX.zeros(2)), e.p)
        return ca.Function("linear", [e.t, x, e.p], [ca.jacobian(out, x), ca.jacobian(level, x)])

    jacobian, tangency = (
        a.full() for a in model.compiled("linearization", make)(time, np.r_[y, v], p)
    )
    rank = tangency.shape[0]
    basis = np.linalg.svd(tangency)[2][rank:].T if rank else np.eye(n + k)
    matrix = basis.T @ jacobian @ basis
    values, vectors = np.linalg.eig(matrix) if matrix.size else (np.array([]), np.zeros((0, 0)))
    order = np.lexsort((np.abs(values.imag), np.round(np.abs(values), 12)))
    keep = [i for i in order if values[i].imag >= -1e-12 * (1 + abs(values[i]))]
    values, shapes = values[keep], (basis @ vectors[:, keep])[:n]
    peak = np.array([s[np.argmax(np.abs(s))] if s.size else 1 for s in shapes.T])
    size = np.abs(values)
    with np.errstate(invalid="ignore", divide="ignore"):
        ratios = np.where(size > 0, -values.real / size, 0.0)
    return Modes(
        model, values, size / (2 * np.pi), ratios, shapes / np.where(peak == 0, 1, peak), matrix
    )


def linearize(
    model: Model,
    at: Motion | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    **options: Any,
) -> Modes:
    """Eigenfrequencies, damping ratios and mode shapes on the constraint tangent space.

    Parameters
    ----------
    model : Model
    at : a motion or equilibrium whose last instant is the state; default: search the equilibrium
    parameters : new values of parameters, without rebuilding
    **options : fields of ``Linearization``: time, equilibrium

    Raises
    ------
    AnalysisError
        No equilibrium was found, or wrong options; ``SingularityError`` where a free motion has no
        mass.
    """
    if at is not None:
        s = at.trajectory
        return modes_at(model, float(s.t[-1]), s.y[:, -1], s.v[:, -1], at.parameters)
    try:
        analysis = Linearization(**options)
    except TypeError as error:
        raise AnalysisError(f"linearize: {error}") from None
    return analysis.run(model, parameters)
