"""Linear systems in first-order form, of continuous and of discrete time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.packages import optional_package
from dalembert.text.wording import listed

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False, repr=False)
class StateSpace:
    """State-space model of small motions in minimal coordinates, with names and units.

    ``ẋ = A x + B u``, or ``x[k+1] = A x[k] + B u[k]`` with a sample time; ``y = C x + D u``.

    Attributes
    ----------
    A, B, C, D : (n, n), (n, inputs), (outputs, n), (outputs, inputs) in SI units
    states, inputs, outputs : names
    units : name → unit
    sizes : (n,) natural sizes of the states, by which measures of modes are scaled
    name : of the model
    dt : sample time [s]; zero for continuous time

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("oscillator")
    >>> push = system.input("push", unit="N")
    >>> body = system.add(planar.Particle("body", mass=2.0, position=(0.5, 0)))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    >>> ends = system.ground.center, body.center
    >>> spring = planar.Spring("spring", *ends, stiffness=100.0, damping=4.0, free_length=0.5)
    >>> parts = system.add(spring), system.add(planar.Force("force", body.center, (push, 0)))
    >>> model = da.linearize(system.build()).state_space(outputs=["body.x"])
    >>> isinstance(model, da.StateSpace), model.states
    (True, ['body.x', 'body.x rate'])
    >>> model.A.round(9).tolist(), model.B.round(9).tolist()
    ([[0.0, 1.0], [-50.0, -2.0]], [[0.0], [0.5]])
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    states: list[str]
    inputs: list[str]
    outputs: list[str]
    units: dict[str, str] = field(default_factory=dict)
    sizes: np.ndarray = field(default_factory=lambda: np.zeros(0))
    name: str = ""
    dt: float = 0.0

    @property
    def control(self) -> Any:
        """The same as ``StateSpace`` of python-control, with the names of its signals.

        Raises
        ------
        UnsupportedError
            python-control is not installed.
        """
        control = optional_package("control", "a StateSpace of python-control", "use A, B, C, D")
        names = {"states": self.states, "inputs": self.inputs, "outputs": self.outputs}
        plain = {key: [_plain(name) for name in listed] for key, listed in names.items()}
        return control.ss(
            self.A, self.B, self.C, self.D, **plain, name=_plain(self.name), dt=self.dt
        )

    @cached_property
    def poles(self) -> np.ndarray:
        """(n,) eigenvalues of ``A`` [1/s]; of discrete time the factors of a sample."""
        values: np.ndarray = np.linalg.eigvals(self.A)
        return values

    @property
    def stable(self) -> bool:
        """Whether no motion grows."""
        if self.dt:
            return bool(np.all(np.abs(self.poles) <= 1 + 1e-9))
        size = np.abs(self.poles).max(initial=0.0)
        return bool(np.all(self.poles.real <= 1e-9 * size))

    def at(self, frequencies: float | Sequence[float] | np.ndarray) -> xr.DataArray:
        """Transfer functions ``C (s − A)⁻¹ B + D`` at frequencies [Hz].

        ``s = iω``; of discrete time ``exp(iωT)``.
        """
        import xarray as xr

        f = np.atleast_1d(np.asarray(frequencies, dtype=float))
        along = 2j * np.pi * f
        points = np.exp(along * self.dt) if self.dt else along
        matrices = points[:, None, None] * np.eye(len(self.A)) - self.A
        right = np.broadcast_to(self.B, (f.size, *self.B.shape))
        values = self.C @ np.linalg.solve(matrices, right) + self.D
        coords = {"frequency": f, "output": self.outputs, "input": self.inputs}
        return xr.DataArray(values, coords, list(coords), "transfer")

    @cached_property
    def _modes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """One eigenvalue of each pair, with right and left vectors of scaled states."""
        from scipy.linalg import eig

        scale = self.sizes if self.sizes.size else np.ones(len(self.A))
        values, left, right = eig(self.A * scale / scale[:, None], left=True)
        order = np.lexsort((values.real, np.abs(values)))
        order = order[values[order].imag >= 0]
        return values[order], right[:, order], left[:, order]

    @property
    def controllability(self) -> xr.DataArray:
        """(mode, input) ``|lᴴ b|/(‖l‖ ‖b‖)``: zero if an input does not drive a mode.

        The cosine between a left eigenvector and a column of ``B`` (Hamdan and Nayfeh, Journal of
        Guidance 12, 1989), with states relative to their natural sizes. Its zeros are those of the
        test of Popov, Belevitch and Hautus.
        """
        scale = self.sizes if self.sizes.size else np.ones(len(self.A))
        _, _, left = self._modes
        return self._measure(np.abs(left.conj().T @ _unit(self.B / scale[:, None])), "input")

    @property
    def observability(self) -> xr.DataArray:
        """(mode, output) ``|c r|/(‖c‖ ‖r‖)``: zero if an output does not see a mode."""
        scale = self.sizes if self.sizes.size else np.ones(len(self.A))
        _, right, _ = self._modes
        return self._measure(np.abs(_unit((self.C * scale).T).T @ right).T, "output")

    def _measure(self, table: np.ndarray, along: str) -> xr.DataArray:
        import xarray as xr

        values = self._modes[0]
        coords = {
            "mode": np.arange(1, values.size + 1),
            along: self.inputs if along == "input" else self.outputs,
            "eigenvalue": ("mode", values),
        }
        name = "controllability" if along == "input" else "observability"
        return xr.DataArray(table, coords, ["mode", along], name)

    def __repr__(self) -> str:
        return (
            f"<StateSpace of {self.name!r}: {len(self.A)} states, {listed(self.outputs)} by "
            f"{listed(self.inputs)}{f', every {self.dt:g} s' if self.dt else ''}>"
        )


def _unit(columns: np.ndarray) -> np.ndarray:
    """Columns of length one; zero columns remain zero."""
    lengths = np.linalg.norm(columns, axis=0)
    return columns / np.where(lengths > 0, lengths, 1.0)


def _plain(name: str) -> str:
    """A name as python-control accepts it, without dots and blanks."""
    return name.replace(".", "_").replace(" ", "_")
