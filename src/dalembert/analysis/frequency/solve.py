"""``frequency_response`` of mechanisms and structures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Unpack, overload

import numpy as np

from dalembert.analysis.batch.solve import run_analysis
from dalembert.analysis.frequency.frequency_response import FrequencyResponse
from dalembert.analysis.keywords import FrequencyResponseKeywords
from dalembert.analysis.times import analysis_of
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.graph.model import Model
from dalembert.results.analysis import ParameterValues
from dalembert.results.harmonic import HarmonicResponse
from dalembert.text.arguments import check_arguments

if TYPE_CHECKING:
    from dalembert.results.batch.batch import Batch
    from dalembert.results.batch.designs import ManyDesigns


@overload
def frequency_response(
    model: Model | StructuralModel,
    frequencies: Sequence[float] | np.ndarray | None = None,
    *,
    parameters: ParameterValues = None,
    workers: int | None = None,
    **options: Unpack[FrequencyResponseKeywords],
) -> HarmonicResponse: ...
@overload
def frequency_response(
    model: Model | StructuralModel,
    frequencies: Sequence[float] | np.ndarray | None = None,
    *,
    parameters: ManyDesigns,
    workers: int | None = None,
    **options: Unpack[FrequencyResponseKeywords],
) -> Batch: ...
@check_arguments
def frequency_response(
    model: Model | StructuralModel,
    frequencies: Sequence[float] | np.ndarray | None = None,
    *,
    parameters: ParameterValues | ManyDesigns = None,
    workers: int | None = None,
    **options: Unpack[FrequencyResponseKeywords],
) -> HarmonicResponse | Batch:
    """Complex amplitudes of outputs under harmonic inputs, about an operating point.

    Parameters
    ----------
    model : Model or StructuralModel
    frequencies : [Hz]; by default a grid that resolves all resonances
    parameters : new values of parameters, without rebuilding; with an array of values per
        parameter a ``Batch`` of all designs, which are run one by one and need ``frequencies``
    workers : upper limit of processes of a batch; None for all cores
    **options : fields of ``FrequencyResponse``: inputs, outputs, excitation, span, method, count,
        about, time, equilibrium; of structures damping, loss_factor, damping_ratio, lumped

    Raises
    ------
    AnalysisError
        No equilibrium, unknown inputs or outputs; ``SingularityError`` at undamped resonances.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("quarter of a car")
    >>> road = system.parameter("road", 0.0, "m")
    >>> wheel = system.add(planar.Particle("wheel", mass=1.0))
    >>> body = system.add(planar.Particle("body", mass=4.0, position=(0.5, 0)))
    >>> for name, part in (("low", wheel), ("high", body)):
    ...     rail = system.add(planar.PinInSlot(name, system.ground.center, part.center))
    >>> drive = system.add(planar.CoordinateDriver("drive", wheel.center, road))
    >>> ends = wheel.center, body.center
    >>> spring = planar.Spring("spring", *ends, stiffness=100.0, damping=4.0, free_length=0.5)
    >>> added = system.add(spring)
    >>> inputs, outputs = ["road"], ["body.x"]
    >>> h = da.frequency_response(system.build(), [0.0, 1.0], inputs=inputs, outputs=outputs)
    >>> s = 2j * 3.141592653589793  # (k + c s)/(k + c s + m s²)
    >>> exact = (100 + 4 * s) / (100 + 4 * s + 4 * s**2)
    >>> round(abs(h["body.x"][1].item() - exact), 12)
    0.0
    """
    verb, outputs = "frequency_response", options.pop("outputs", None)  # elsewhere, times
    analysis = analysis_of(FrequencyResponse, verb, model, parameters, **options)
    analysis = replace(analysis, frequencies=frequencies, outputs=outputs)
    return run_analysis(analysis, model, parameters, workers=workers)  # type: ignore[no-any-return]
