"""Functions of a frequency response of a small structure for other parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.frequency.linear_analysis import ABOVE
from dalembert.analysis.frequency.linear_structure import GRID_MODES, LinearStructure
from dalembert.analysis.live.frequency_rows import Transfers, frequency_data
from dalembert.analysis.live.structure_graph import StructureGraph
from dalembert.analysis.live.structure_module import LARGEST, measure_rows, structural_obstacle
from dalembert.results.live import LiveFunctions
from dalembert.results.sources import Row
from dalembert.results.structural.deflection import deflection_shapes

Complex = tuple[ca.MX, ca.MX]
"""Real and imaginary part."""


def structure_obstacle(analysis: Any, system: LinearStructure) -> str:
    """Reason why a response cannot be computed outside of Python; empty if it can."""
    if analysis.method == "modal":
        return "the modal superposition is truncated"
    if analysis.about is not None:
        return "the response is about a loaded state"
    if analysis.lumped:
        return "the masses are lumped"
    if system.model.assembly.size > LARGEST:
        return f"the structure has {system.model.assembly.size} displacements, more than {LARGEST}"
    return structural_obstacle(system.model)


def structure_functions(response: Any, rows: Sequence[Row], times: np.ndarray) -> LiveFunctions:
    """Functions and constants of a frequency response.

    Parameters
    ----------
    response : without an obstacle
    rows : outputs, formulas of amplitudes, the frequency and parameters; those of pictures last
    times : (K,) frequencies [Hz] that the page always evaluates, besides the default ones
    """
    system: LinearStructure = response.record
    model, drawn = system.model.linearized, [row for row in rows if row.drawn]
    transfers = Transfers(response, [row for row in rows if not row.drawn])
    p, free = ca.MX.sym("p", model.p.numel()), model.assembly.free
    linear = _Linear(response, transfers, p)
    functions = {
        "system": ca.Function("system", [p], [ca.densify(part) for part in linear.parts]),
        "pull": linear.pull(),
        **transfers.functions(model.p),
    }
    if drawn:
        shapes = deflection_shapes(response, np.zeros(1, dtype=int))
        number, square = ca.MX.sym("number"), ca.MX.sym("square")
        u = ca.MX.sym("u", linear.size)
        column = measure_rows(shapes, linear.graph, drawn, (u, 0 * u), number, square)
        functions["pictures"] = ca.Function(
            "pictures", [number, square, u, p], [ca.densify(column)]
        )
    data = frequency_data(response, times, transfers)
    data["grid"] |= {"modes": GRID_MODES, "above": ABOVE}
    return LiveFunctions(
        functions,
        {
            **data,
            "kind": "structure frequency",
            "start": 0.0,
            "anchor": {"p": response.parameters, "y": np.zeros(0)},
            "free_numbers": free,
            "held_numbers": model.assembly.prescribed,
            "loss": float(response.analysis.loss_factor),
            "mix": np.stack([system.mix.real, system.mix.imag], axis=-1),
        },
    )


class _Linear:
    """Matrices of all displacements, forces and motions of supports, derivatives of measures.

    Parameters
    ----------
    response : frequency response of a structure
    transfers : of its rows
    p : symbols of the parameters
    """

    def __init__(self, response: Any, transfers: Transfers, p: ca.MX):
        self.system: LinearStructure = response.record
        model = self.model = self.system.model.linearized
        self.p, self.graph = p, StructureGraph(model, p)
        self.size, self.measures = self.graph.size, transfers.measures
        whole = StructureGraph(model, p)
        whole.free, whole.count = np.arange(self.size), self.size
        shape = self.size, self.size
        self.stiffness = ca.reshape(whole.stiffness(), *shape)
        self.mass = ca.reshape(whole.mass(), *shape)
        self.damping = self.system.analysis.damping.coefficients(model).graph(p)
        self.forces, self.supports = self._inputs()
        self.u, self.f = ca.MX.sym("u", self.size), ca.MX.sym("f", self.size)
        rows = [Row(measure.sx) for measure in self.measures]
        state = self.u, self.f
        self.outputs = measure_rows(self.system.state, self.graph, rows, state, ca.MX(0))

    def _inputs(self) -> tuple[ca.MX, ca.MX]:
        """(n, inputs) forces and (prescribed, inputs) motions of supports for unit inputs."""
        loads, names = self.model.loads, list(self.model.parameters)
        prescribed = self.model.prescribed.graph(self.p)
        forces, supports = [], []
        for name in self.system.inputs:
            if name in loads:
                forces.append(self.graph.applied(loads[name]))
                supports.append(ca.MX.zeros(prescribed.numel()))
                continue
            unit = ca.MX(ca.DM(np.eye(len(names))[names.index(name)]))
            total = sum(
                (self.graph.applied(load) for load in loads.values()), ca.MX.zeros(self.size)
            )
            forces.append(ca.jtimes(total, self.p, unit))
            supports.append(ca.jtimes(prescribed, self.p, unit))
        return ca.horzcat(*forces), ca.horzcat(*supports)

    @property
    def parts(self) -> list[ca.MX]:
        """``K``, ``M``, forces, motions of supports, ``α`` and ``β``, derivatives of measures by
        displacements, by forces and by the inputs."""
        rest = [ca.MX.zeros(self.size)] * 2
        names = list(self.model.parameters)
        slopes = [ca.jacobian(self.outputs, by) for by in (self.u, self.f, self.p)]
        at_rest = ca.substitute(slopes, [self.u, self.f], rest)
        direct = [
            at_rest[2][:, names.index(name)]
            if name in names and name not in self.model.loads
            else ca.MX.zeros(len(self.measures))
            for name in self.system.inputs
        ]
        matrices = self.stiffness, self.mass, self.forces, self.supports, self.damping
        return [*matrices, at_rest[0].T, at_rest[1].T, ca.horzcat(*direct).T]

    def pull(self) -> ca.Function:
        """Weights of the parameters in ``Re (s·h − λᵀ (Z û − f̂))`` with given ``û`` and ``λ``.

        Arguments are ``p``, ``ω``, the mix of the inputs, the free displacements, ``λ`` (zero at
        prescribed displacements) and ``s``, each as real and imaginary part.
        """
        n, held = self.size, self.model.assembly.prescribed
        omega, count = ca.MX.sym("omega"), len(self.system.inputs)
        mix, free, adjoint, seeds = (
            (ca.MX.sym(f"{name}_re", size), ca.MX.sym(f"{name}_im", size))
            for name, size in (("m", count), ("u", n), ("l", n), ("s", len(self.measures)))
        )
        places = ca.DM.triplet(
            held.tolist(), list(range(held.size)), [1.0] * held.size, n, held.size
        )
        motion = tuple(
            part + ca.mtimes(places, ca.mtimes(self.supports, share)) if held.size else part
            for part, share in zip(free, mix, strict=True)
        )
        alpha, beta = self.damping[0], self.damping[1]
        kappa: Complex = (ca.MX(1), self.system.analysis.loss_factor + omega * beta)
        mu: Complex = (-(omega**2), omega * alpha)
        stiff = [ca.mtimes(self.stiffness, part) for part in motion]
        heavy = [ca.mtimes(self.mass, part) for part in motion]
        force: Complex = tuple(  # type: ignore[assignment]
            a + b for a, b in zip(_times(kappa, stiff), _times(mu, heavy), strict=True)
        )
        open_forces = [
            part - ca.mtimes(self.forces, share) for part, share in zip(force, mix, strict=True)
        ]
        value = ca.dot(adjoint[1], open_forces[1]) - ca.dot(adjoint[0], open_forces[0])
        names = list(self.model.parameters)
        unit = np.zeros((len(names), count))
        for k, name in enumerate(self.system.inputs):
            if name not in self.model.loads:
                unit[names.index(name), k] = 1.0
        for part, (turn, seed) in enumerate(zip((1, -1), seeds, strict=True)):
            along = motion[part], force[part], ca.mtimes(ca.DM(unit), mix[part])
            change = sum(
                (
                    ca.jtimes(self.outputs, by, to)
                    for by, to in zip((self.u, self.f, self.p), along, strict=True)
                ),
                ca.MX.zeros(len(self.measures)),
            )
            (at_rest,) = ca.substitute([change], [self.u, self.f], [ca.MX.zeros(n)] * 2)
            value += turn * ca.dot(seed, at_rest)
        inputs = [self.p, omega, *mix, *free, *adjoint, *seeds]
        return ca.Function("pull", inputs, [ca.densify(ca.gradient(value, self.p))])


def _times(factor: Complex, vector: Sequence[ca.MX]) -> list[ca.MX]:
    """Product of a complex number and a complex vector."""
    (a, b), (x, y) = factor, vector
    return [a * x - b * y, a * y + b * x]
