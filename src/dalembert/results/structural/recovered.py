"""A flexible body of a mechanism as the structure it is made of: its states over a motion."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.elements.coordinates import rate_of, second_rate_of
from dalembert.elements.flexible.floating import FloatingFrame
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.results.recording import Recording
from dalembert.results.result import Instants
from dalembert.results.structural.motion import StructuralMotion
from dalembert.structures.loads.load_case import Temperatures
from dalembert.symbolic.formulas.expression import Expression, t


@dataclass(eq=False, repr=False)
class RecoveredStates(StructuralMotion):
    """Displacements in the floating frame, and all measures of the structure that they make.

    Velocities and accelerations are those against the frame; stresses are those of the shapes.
    """

    large = lumped = False
    temperatures = Temperatures()

    def at(self, times: Instants) -> RecoveredStates:
        """Refused: sample the motion of the mechanism.

        Raises
        ------
        UnsupportedError
        """
        raise UnsupportedError("sample the motion, motion.at(times).structure(body)")


def recovered(motion: Recording, body: str) -> RecoveredStates:
    """The structure of a flexible body over a motion.

    Raises
    ------
    AnalysisError
        There is no flexible body of this name.
    """
    flexible = {b.name: b for b in motion.model.bodies if isinstance(b, FloatingFrame)}
    if body not in flexible:
        known = ", ".join(flexible) or "none"
        raise AnalysisError(f"no flexible body {body!r} (known: {known})")
    found = flexible[body]
    shapes = motion.model.shapes(found, motion.parameters)
    model = shapes.structure.linearized
    amplitudes = found.amplitudes
    rates = rate_of(amplitudes, [found], t.sx), second_rate_of(amplitudes, [found], t.sx)
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
