"""Registry of gradient engines by analysis."""

from __future__ import annotations

from collections.abc import Sequence

from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.analysis.equilibrium.equilibrium import Equilibrium
from dalembert.analysis.equilibrium.load_path import ArcLength
from dalembert.analysis.equilibrium.statics import Statics
from dalembert.analysis.frequency.frequency_response import FrequencyResponse
from dalembert.analysis.kinematics.kinematics import Kinematics
from dalembert.analysis.modes.buckling import Buckling
from dalembert.analysis.modes.modal import Modal
from dalembert.analysis.nonsmooth.nonsmooth import Nonsmooth
from dalembert.errors import UnsupportedError
from dalembert.responses.base import Response
from dalembert.responses.evaluation import expanded
from dalembert.results.result import Result
from dalembert.sensitivity.eigenvalues import EigenvalueEngine
from dalembert.sensitivity.engine import CombinedEngine, Engine
from dalembert.sensitivity.events import EventEngine
from dalembert.sensitivity.harmonic import HarmonicEngine
from dalembert.sensitivity.marching.dynamics import DynamicsEngine
from dalembert.sensitivity.marching.stable_steps import with_stable_steps
from dalembert.sensitivity.nonsmooth.contact_march import ContactEngine
from dalembert.sensitivity.pointwise import PointwiseEngine
from dalembert.sensitivity.samples import take_sample
from dalembert.sensitivity.structural.eigenpairs import EigenpairEngine
from dalembert.sensitivity.structural.harmonic import StructuralHarmonicEngine
from dalembert.sensitivity.structural.load_path import LoadPathEngine
from dalembert.sensitivity.structural.statics import TwiceStaticsEngine
from dalembert.sensitivity.structural.transient import TransientEngine

ENGINES: dict[str, dict[type, type[Engine]]] = {
    "mechanism": {
        Dynamics: DynamicsEngine,
        Nonsmooth: ContactEngine,
        Kinematics: PointwiseEngine,
        Equilibrium: PointwiseEngine,
        Modal: EigenvalueEngine,
        FrequencyResponse: HarmonicEngine,
    },
    "structure": {
        Statics: TwiceStaticsEngine,
        Equilibrium: TwiceStaticsEngine,
        Modal: EigenpairEngine,
        Buckling: EigenpairEngine,
        ArcLength: LoadPathEngine,
        Dynamics: TransientEngine,
        FrequencyResponse: StructuralHarmonicEngine,
    },
}
"""Kind of model → analysis → engine; subclasses of an analysis use the same engine."""


def engine_of(motion: Result, responses: Sequence[Response]) -> Engine:
    """The engine for responses of a result.

    Raises
    ------
    UnsupportedError
        The analysis has no engine, or a part of the model no derivative.
    """
    kind = engine_for(motion)
    terms, weights = expanded(responses)
    if terms != list(responses):
        return CombinedEngine(engine_of(motion, terms), weights)
    motion = with_stable_steps(motion)
    samples = [take_sample(motion, r) for r in responses]
    if any(sample.final_event for sample in samples):
        return EventEngine(motion, kind, samples)
    return kind(samples)


def engine_for(motion: Result) -> type[Engine]:
    """The class of the engine for a result.

    Raises
    ------
    UnsupportedError
        The analysis has no engine.
    """
    if motion.model.gradient_obstacle:
        raise UnsupportedError(motion.model.gradient_obstacle)
    engines = ENGINES[motion.model.kind]
    for kind in type(motion.analysis).__mro__:
        if kind in engines:
            return engines[kind]
    raise UnsupportedError(
        f"gradients of {type(motion.analysis).__name__} are not available; use "
        "method='finite-difference'"
    )
