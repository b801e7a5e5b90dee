"""``linearize`` and ``solve_modes`` of mechanisms and structures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Unpack

from dalembert.analysis.keywords import ModalKeywords
from dalembert.analysis.modes.modal import Modal
from dalembert.analysis.times import analysis_of
from dalembert.errors import AnalysisError
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.graph.model import Model
from dalembert.results.modes import Modes
from dalembert.results.motion import Motion
from dalembert.results.structural.result import StructuralResult
from dalembert.text.arguments import check_arguments


def _modes(verb: str, model: Any, about: Any, parameters: Any, options: Any) -> Any:
    """Modes of a model, from the arguments of a function."""
    analysis = analysis_of(Modal, verb, model, parameters, about=about, **options)
    if about is not None and parameters:
        names = ", ".join(parameters)
        raise AnalysisError(f"{verb}: {names} cannot be given with about=, which has its own")
    return analysis.run(model, parameters)


@check_arguments
def linearize(
    model: Model | StructuralModel,
    about: Motion | StructuralResult | None = None,
    count: int | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    **options: Unpack[ModalKeywords],
) -> Modes:
    """Frequencies, damping ratios and shapes of small motions about a state.

    Parameters
    ----------
    model : Model or StructuralModel
    about : equilibrium, motion whose last instant is the state, or statics with one load case; by
        default the equilibrium of a mechanism, the unloaded structure
    count : number of modes, by default all of a mechanism and six of a structure
    parameters : new values of parameters, without rebuilding
    **options : fields of ``Modal``: time, equilibrium, coordinates, lumped, shift

    Raises
    ------
    AnalysisError
        No equilibrium was found, or wrong options; ``SingularityError`` where a free motion has no
        mass.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("oscillator")
    >>> body = system.add(planar.Particle("body", mass=1.0, position=(0.5, 0)))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    >>> ends = system.ground.center, body.center
    >>> spring = planar.Spring("spring", *ends, stiffness=100.0, damping=2.0, free_length=0.5)
    >>> part = system.add(spring)
    >>> modes = da.linearize(system.build())
    >>> modes.damping_ratios.round(6), (modes.frequencies * 2 * math.pi).round(6)
    (array([0.1]), array([10.]))
    """
    return _modes("linearize", model, about, parameters, {"count": count, **options})  # type: ignore[no-any-return]


@check_arguments
def solve_modes(
    model: Model | StructuralModel,
    count: int = 6,
    about: Motion | StructuralResult | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    **options: Unpack[ModalKeywords],
) -> Modes:
    """The lowest modes of small motions; of a structure, ``K φ = ω² M φ``.

    The same as ``linearize`` with a number of modes.

    Parameters
    ----------
    model : Model or StructuralModel
    count : number of modes
    about : state about which the motions are small, as in ``linearize``
    parameters : new values of parameters, without rebuilding
    **options : fields of ``Modal``: lumped, shift, time, equilibrium, coordinates

    Raises
    ------
    AnalysisError
        Wrong options, no mass; ``SingularityError`` where a part moves freely.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> chain = da.Structure("two masses")
    >>> nodes = [chain.node(name, x) for name, x in (("a", 0), ("b", 1), ("c", 2), ("d", 3))]
    >>> for k in range(3):
    ...     ends = nodes[k], nodes[k + 1]
    ...     spring = chain.add(structures.AxialSpring(f"k{k}", *ends, stiffness=9.0))
    >>> for node in nodes[1:3]:
    ...     mass = chain.add(structures.PointMass(f"m_{node.name}", node, mass=1.0))
    >>> for end in (nodes[0], nodes[3]):
    ...     chain.support(end)
    >>> modes = da.solve_modes(chain.build(), 2)
    >>> (modes.frequencies * 2 * math.pi)**2  # k/m and 3 k/m
    array([ 9., 27.])
    """
    return _modes("solve_modes", model, about, parameters, {"count": count, **options})  # type: ignore[no-any-return]
