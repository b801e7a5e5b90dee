"""Environments of Gymnasium, an optional package for reinforcement learning."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from dalembert.design.ecosystem.learning_task import LearningTask
from dalembert.errors import UnsupportedError
from dalembert.model.graph.model import Model
from dalembert.packages import optional_package
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.arguments import check_arguments


@check_arguments
def gymnasium_environment(
    model: Model,
    *,
    reward: str | Expression | Callable[..., Any],
    terminated: str | Expression | Callable[..., Any] | None = None,
    step: float,
    substeps: int = 1,
    duration: float | None = None,
    actions: Sequence[str] | None = None,
    observations: Sequence[Any] | None = None,
    parameters: Mapping[str, float] | None = None,
    initial: Mapping[str, tuple[float, float]] | Callable[..., Any] | None = None,
    lanes: int | None = None,
    autoreset: str = "NEXT_STEP",
    render_mode: str | None = None,
    **options: Any,
) -> Any:
    """``gymnasium.Env`` of a model, or ``gymnasium.vector.VectorEnv`` of many lanes of it.

    Actions are inputs within their bounds, observations are outputs. ``pip install
    dalembert[control]``.

    Parameters
    ----------
    model : Model
    reward : formula of measures at the end of a step, or a function ``(observations by name,
        actions) → number``, of arrays where there are lanes
    terminated : formula that is positive where an episode ends, or a function with the arguments
        of ``reward``
    step, substeps, **options : as of ``Stepper``
    duration : time after which an episode is truncated [s]
    actions : names of inputs, by default all of the model; their bounds are those of the action
    observations : measures, by default the outputs of the model
    parameters : new values
    initial : range of each parameter that is random at every reset, such as an initial angle, or a
        function ``rng → values of parameters``
    lanes : number of lanes of a vector environment; by default a single environment
    autoreset : how ended lanes start again, an ``AutoresetMode`` of Gymnasium by name:
        ``"NEXT_STEP"``, ``"SAME_STEP"`` or ``"DISABLED"``
    render_mode : ``"rgb_array"`` for pictures of a single environment

    Raises
    ------
    UnsupportedError
        Gymnasium is not installed, or the model cannot be stepped.
    AnalysisError
        The model has no inputs or outputs, or unknown names.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("sled")
    >>> sled = system.add(planar.Particle("sled", mass=2.0))
    >>> thrust = system.input("thrust", unit="N", bounds=(-1, 1))
    >>> drive = system.add(planar.Force("drive", sled.center, (thrust, 0)))
    >>> place = system.output("place", sled.x)
    >>> sled = da.gymnasium_environment(system.build(), reward="-sled.x**2", step=0.1, duration=1.0)
    >>> observation, info = sled.reset(seed=1)
    >>> observation, reward, terminated, truncated, info = sled.step([1.0])
    >>> round(observation[0].item(), 6), terminated, truncated
    (0.0025, False, False)
    """
    optional_package("gymnasium", "gymnasium_environment")
    from dalembert.design.ecosystem.gymnasium_classes import Environment, LaneEnvironment

    stepping = {"step": step, "substeps": substeps, "parameters": parameters, **options}
    task = LearningTask(
        model, reward, terminated, duration, actions, observations, initial, stepping
    )
    if lanes is None:
        return Environment(task, render_mode)
    if render_mode is not None:
        raise UnsupportedError("lanes are not drawn; leave render_mode, or use one environment")
    return LaneEnvironment(task, lanes, autoreset)
