"""Linearised system about a state and its complete spectrum.

For ``J = ∂F/∂x`` of ``ẋ = F(x)``, ``G = ∂(Φ, Ψ)/∂x`` and an orthonormal basis ``B`` of the null
space of ``G`` the reduced matrix is ``A = Bᵀ J B``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.contact.gap_checks import ignored_contacts
from dalembert.analysis.elastic_range import elastic_warnings
from dalembert.analysis.modes.linearization_kernel import LinearizationKernel
from dalembert.elements.fem.base import ElasticElement
from dalembert.elements.flexible.nodes import Noded
from dalembert.model.graph.model import Model
from dalembert.model.graph.sampled_rates import sampled_blocks
from dalembert.results.recording import Trajectory
from dalembert.sparse.eigenvalues import coinciding, error_sizes, leading, residual
from dalembert.symbolic.equations.implicit import ImplicitFunction

RESTING = 1e-9
"""Threshold for a resting state: relative change within a natural time."""
SHORT = 1e-4
"""Step for the change of the matrix, relative to the natural time."""
STEADY = 1e-3
"""Upper limit of the relative change of the matrix of a steady motion within a natural time."""
UNSTEADY = (
    "the motion is not steady in these coordinates: eigenvalues hold for one instant and do "
    "not determine stability; "
)
USE_JOINTS = (
    "coordinates=JointCoordinates() helps if only cyclic angles change and "
    "non-spinning bodies carry the spinning ones; of symmetric rotors in space the A matrix of "
    "state_space(), with rotations in inertial axes, has the frequencies of whirl"
)
USE_SHAPES = (
    "the nodes of {} go round, which is not steady in any coordinates; use a FlexibleBody with "
    "stiffening=True, whose shapes are steady in a rotating frame"
)


@dataclass(frozen=True, eq=False)
class Linearized:
    """Linearised system about a state.

    Attributes
    ----------
    kernel : LinearizationKernel
    time, x, p : the state, (N,), and the parameters
    origin : ``(t, near, p) → x``, dependence of the state on the parameters; None if unavailable
    near : second argument of ``origin``
    residual : residual of the state
    stable : whether an equilibrium is stable, and so isolated
    """

    kernel: LinearizationKernel
    time: float
    x: np.ndarray
    p: np.ndarray
    origin: ImplicitFunction | None = None
    near: np.ndarray | None = None
    residual: float = 0.0
    stable: bool = True

    @property
    def model(self) -> Model:
        return self.kernel.model

    @cached_property
    def derivatives(self) -> tuple[np.ndarray, np.ndarray]:
        """``J`` (N, N) and ``G`` (m, N)."""
        jacobian, tangency = self.kernel.matrices(self.time, self.x, self.p)
        return jacobian, tangency

    @cached_property
    def sizes(self) -> tuple[np.ndarray, np.ndarray]:
        """Natural sizes of the state (N,) and of the equations (m,)."""
        return natural_sizes(self.kernel)

    @cached_property
    def scaled(self) -> tuple[np.ndarray, np.ndarray]:
        """``J`` and ``G`` with state and equations relative to their natural sizes."""
        (jacobian, tangency), (states, rows) = self.derivatives, self.sizes
        return jacobian * states / states[:, None], tangency * states / rows[:, None]

    @cached_property
    def unsteadiness(self) -> float:
        """Relative change of the matrix within a natural time along the motion."""
        inputs, time = (self.time, self.x, self.p), self.model.scales.time
        rate = self.kernel.system.function(*inputs)[0].full().ravel()
        if np.max(np.abs(rate) * time / self.sizes[0], initial=0.0) < RESTING:
            return 0.0
        step = SHORT * time
        later = replace(self, time=self.time + step, x=self.x + step * rate)
        matrix, later_matrix = self.scaled[0], later.scaled[0]
        largest = np.abs(matrix).max(initial=0.0)
        return float(np.abs(later_matrix - matrix).max() / (SHORT * largest)) if largest else 0.0

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about unsteady motion, and contacts that small motions open or close."""
        y, model = self.kernel.bodies(self.time, self.x, self.p)[:, None], self.model
        still, none = np.zeros((model.equations.speed_count, 1)), np.zeros((0, 1))
        instant = Trajectory(np.array([self.time]), y, still, still, none, np.zeros((2, 1)))
        unsteady = (UNSTEADY + self._cure,) if self.unsteadiness > STEADY else ()
        contacts = ignored_contacts(model, instant, self.p, forces=True)
        held = [block.name for block in sampled_blocks(model)]
        text = f"outputs of {', '.join(held)} are held; the poles of the sampled loop are those of "
        sampled = (f"{text}Stepper.state_space",) if held else ()
        return (*unsteady, *sampled, *contacts, *elastic_warnings(model, instant, self.p))

    @property
    def _cure(self) -> str:
        names = [
            element.name
            for element in self.model.forces
            if isinstance(element, (Noded, ElasticElement))
        ]
        return USE_SHAPES.format(", ".join(names[:3])) if names else USE_JOINTS

    @property
    def statistics(self) -> dict[str, int]:
        """Size of the matrix."""
        return {"states": len(self.matrix)}

    @cached_property
    def basis(self) -> np.ndarray:
        """``B`` (N, f): directions along the constraints, orthonormal by natural sizes."""
        tangency = self.scaled[1]
        rank = tangency.shape[0]
        return np.linalg.svd(tangency)[2][rank:].T if rank else np.eye(self.x.size)

    @cached_property
    def matrix(self) -> np.ndarray:
        """``A = Bᵀ J B`` (f, f)."""
        return self.basis.T @ self.scaled[0] @ self.basis

    @cached_property
    def _pairs(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Eigenvalues with their left and right vectors in the basis."""
        from scipy.linalg import eig

        if not self.matrix.size:
            return np.zeros(0, complex), *(np.zeros((0, 0), complex),) * 2
        values, left, right = eig(self.matrix, left=True)
        return values, left, right

    @cached_property
    def _spectrum(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        values, left, right = self._pairs
        states = self.sizes[0][:, None]
        return values, self.basis @ left / states, self.basis @ right * states

    @property
    def left(self) -> float:
        """Residual of the eigenvalue equation."""
        values, _, right = self._pairs
        size = np.abs(self.matrix).max(initial=0.0)  # vectors have the length one
        return residual(self.matrix, np.eye(values.size), values, right, size)

    @cached_property
    def groups(self) -> list[list[int]]:
        """Positions of eigenvalues in groups of coinciding ones."""
        values, left, right = self._pairs
        return coinciding(values, error_sizes(self.matrix, values, left, right))

    @property
    def eigenvalues(self) -> np.ndarray:
        """(f,) eigenvalues; conjugate pairs are neighbours, the positive imaginary part first."""
        return self._spectrum[0]

    def wanted(self) -> np.ndarray:
        """Positions of one eigenvalue of each conjugate pair, by increasing size."""
        values = self.eigenvalues
        unit = np.abs(values).max(initial=0.0) or 1.0
        order = np.lexsort((values.real, np.abs(values.imag), np.round(np.abs(values) / unit, 12)))
        positions = [i for i in order if values[i].imag >= -1e-12 * unit]
        return np.array(positions, dtype=int)

    def following(self, earlier: Linearized, positions: np.ndarray) -> np.ndarray:
        """Positions of the modes that correspond to modes of an earlier spectrum.

        Left vectors of a spectrum are orthogonal to the right vectors of all other modes, so the
        modes are paired for the largest ``Σ |wᵢᴴ vⱼ|``.
        """
        from scipy.optimize import linear_sum_assignment

        left, right = earlier._spectrum[1][:, positions], self._spectrum[2]
        return linear_sum_assignment(np.abs(left.conj().T @ right), maximize=True)[1]

    def displacements(self, positions: np.ndarray) -> np.ndarray:
        """(n, k) shapes by displacements with largest entries of one."""
        e = self.kernel.e
        shapes = self._spectrum[2][: e.coordinate_count, positions]
        if not e.manifold.flat:
            shapes = (
                ca.Function("reading", [e.y], [e.manifold.reading])(
                    self.x[: e.coordinate_count]
                ).full()
                @ shapes
            )
        return normalised(shapes)

    def oscillations(self, positions: np.ndarray) -> np.ndarray:
        """(6, n, k) coordinates of the bodies at rest and their oscillation in modes.

        The vectors are those of ``symbolic/formulas/oscillation.py``, with ``r + j i`` the mode
        whose largest entry is one. Those of second order close the joints. Without modes it has
        the coordinates at rest only, (1, n, 1).
        """
        n = self.kernel.e.coordinate_count
        return self.oscillations_of(self._spectrum[2][:n, positions])

    def oscillations_of(self, changes: np.ndarray) -> np.ndarray:
        """(6, n, k) oscillation with complex changes (n, k) of the coordinates, as above."""
        kernel, n = self.kernel, self.kernel.e.coordinate_count
        shapes = normalised(changes)
        if not shapes.size:
            return kernel.bodies(self.time, self.x, self.p)[None, :, None]
        real, imag, state = shapes.real, shapes.imag, (self.time, self.x[:n], self.p)
        pairs = np.hstack([real, real, imag]), np.hstack([real, imag, imag])
        curvature = kernel.curvature.map(pairs[0].shape[1])(*state, *pairs).full()
        (states, rows), count = self.sizes, len(curvature)
        tangency = self.scaled[1][:count, :n]
        squares = -np.linalg.pinv(tangency) @ (curvature / rows[:count, None]) * states[:n, None]
        vectors = (real, imag, *np.hsplit(squares, 3))
        return np.stack(
            [part.full() for part in kernel.placing.map(real.shape[1])(*state, *vectors)]
        )


def natural_sizes(kernel: LinearizationKernel) -> tuple[np.ndarray, np.ndarray]:
    """Natural sizes of a state (N,) and of the equations (m,)."""
    e, s = kernel.e, kernel.e.scales
    bounds = np.ones(e.manifold.bounds.numel())
    by_level = np.concatenate([s.rows[list(e.holds)], bounds, s.rows / s.time])
    return np.concatenate([s.coordinates, s.speeds]), by_level


def normalised(shapes: np.ndarray) -> np.ndarray:
    """(n, k) shapes with largest entries of one."""
    if not shapes.size:
        return shapes
    peak = shapes[leading(shapes), np.arange(shapes.shape[1])]
    return shapes / np.where(peak == 0, 1, peak)
