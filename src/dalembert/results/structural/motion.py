"""Motion of a structure, from a transient analysis or recovered from a flexible body."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np
import scipy

from dalembert.elements.coordinates import rate_of, second_rate_of
from dalembert.elements.flexible.floating import FloatingFrame
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.model.assembled.load_case import Temperatures
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.assembled.named_measures import MovingState, MovingWeights
from dalembert.results.files.contents import Contents
from dalembert.results.recording import Recording
from dalembert.results.result import Instants
from dalembert.results.sampling import checked_instants
from dalembert.results.status import Status
from dalembert.results.structural.measured_states import MeasuredStates
from dalembert.results.structural.outputs import StructuralOutputs
from dalembert.symbolic.formulas.expression import Expression, t

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


@dataclass(eq=False, repr=False)
class StructuralMotion(MeasuredStates, StructuralOutputs):
    """Motion of a structure at the output times.

    Measures are those of statics, velocities (``"n2.vx"``, of rotations ``"n2.vrz"``),
    accelerations (``"n2.ax"``), ``"kinetic_energy"``, and formulas of them.

    Attributes
    ----------
    model : StructuralModel that was solved
    analysis : analysis that computed it
    parameters : (np,) values used
    time : (K,) [s]
    displacements, velocities, accelerations : (n, K)
    forces : (n, K) applied forces, and reactions at prescribed displacements
    mass : (n, n) mass matrix
    status : Status
    statistics : name → number
    record : data of the run for gradients
    """

    model: StructuralModel
    analysis: Any
    parameters: np.ndarray
    time: np.ndarray
    displacements: np.ndarray
    velocities: np.ndarray
    accelerations: np.ndarray
    forces: np.ndarray
    mass: scipy.sparse.csc_matrix
    status: Status
    statistics: dict[str, Any] = field(default_factory=dict)
    record: Any = None

    kind_of_state = "instant"
    totals = ("mass",)
    in_sequence = True

    @property
    def cases(self) -> list[str]:  # type: ignore[override]
        """Names of the instants."""
        return [f"{time:.6g} s" for time in self.time]

    @property
    def large(self) -> bool:
        return bool(self.analysis.nonlinear)

    @property
    def lumped(self) -> bool:
        """Whether the mass matrix is diagonal."""
        return bool(self.analysis.lumped)

    @property
    def temperatures(self) -> Temperatures:
        """Temperatures of the load case."""
        return self.model.loads[self.analysis.case_of(self.model)].temperatures

    def at(self, times: Instants) -> StructuralMotion:
        """The motion at other times, from the steps of the run."""
        return self.analysis.resample(self, checked_instants(times))

    def state(self, k: int) -> MovingState:
        return MovingState(
            u=self.displacements[:, k],
            forces=self.forces[:, k],
            p=self.parameters,
            v=self.velocities[:, k],
            a=self.accelerations[:, k],
            mass=self.mass,
            lumped=self.lumped,
            temperatures=self.temperatures,
            time=float(self.time[k]),
        )

    def no_weights(self) -> MovingWeights:
        return MovingWeights.zero(len(self.model.degrees), self.parameters.size)

    def __getitem__(self, measure: str | Expression) -> xr.DataArray:
        """A measure by name, or a formula of measures, as a labelled array over time.

        Raises
        ------
        KeyError
            Unknown name; suggests the nearest ones.
        """
        return self.labelled(measure, {"time": ("time", self.time, {"units": "s"})})

    def plot(self, *measures: str | Expression, ax: Axes | None = None) -> Axes:
        """Draw measures over time with Matplotlib; returns the axes."""
        from dalembert.results.pictures.plot import plot_measures

        return plot_measures(self, measures, ax)

    @cached_property
    def contents(self) -> Contents:
        """Displacements, velocities, accelerations, forces and energies."""
        tables = {
            "displacement": (self.displacements, "m or rad"),
            "velocity": (self.velocities, "m/s or rad/s"),
            "acceleration": (self.accelerations, "m/s^2 or rad/s^2"),
            "external_force": (self.forces, "N or N m"),
        }
        variables: dict[str, Any] = {
            name: (("degree", "time"), table, {"units": unit})
            for name, (table, unit) in tables.items()
        }
        for name in ("kinetic_energy", "strain_energy"):
            variables[name] = ("time", self.values(name), {"units": "J"})
        coords = {"degree": self.model.degrees.names, "time": ("time", self.time, {"units": "s"})}
        return Contents.from_arrays(variables, coords, self.attributes)

    def __repr__(self) -> str:
        span = f"{self.time.size} times to {self.status.time:g} s"
        return f"<StructuralMotion of {self.model.name!r}: {span}, {self.status}>"


@dataclass(eq=False, repr=False)
class RecoveredStates(StructuralMotion):
    """Displacements in the floating frame and all measures of the structure.

    Velocities and accelerations are relative to the frame; stresses are those of the shapes.
    """

    large = lumped = False
    temperatures = Temperatures()

    def at(self, times: Instants) -> RecoveredStates:
        """Not supported; sample the motion of the mechanism instead.

        Raises
        ------
        UnsupportedError
        """
        raise UnsupportedError("sample the motion, motion.at(times).structure(body)")


def recover_structure(motion: Recording, body: str) -> RecoveredStates:
    """The structure of a flexible body over a motion.

    Raises
    ------
    AnalysisError
        There is no flexible body of this name.
    """
    flexible = {b.name: b for b in motion.model.bodies if isinstance(b, FloatingFrame)}
    if body not in flexible:
        names = ", ".join(flexible) or "none"
        raise AnalysisError(f"no flexible body {body!r} (known: {names})")
    element = flexible[body]
    shapes = motion.model.shapes(element, motion.parameters)
    model = shapes.structure.linearized
    amplitudes = element.amplitudes
    rates = rate_of(amplitudes, [element], t.sx), second_rate_of(amplitudes, [element], t.sx)
    columns = motion.columns([Expression(ca.densify(x)) for x in (amplitudes, *rates)])
    u, v, a = (shapes.displacements @ x.reshape(motion.time.size, -1).T for x in columns)
    return RecoveredStates(
        model,
        motion.analysis,
        shapes.p,
        motion.time,
        u,
        v,
        a,
        np.zeros_like(u),
        model.assembly.mass(shapes.p),
        motion.status,
    )
