"""Task of reinforcement learning: actions, observations, rewards and random starts of a model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import ceil
from typing import Any

import numpy as np

from dalembert.analysis.stepping.stepper import Stepper
from dalembert.errors import AnalysisError
from dalembert.model.graph.model import Model
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.wording import unknown

Judgement = str | Expression | Callable[..., Any]
"""Formula of measures, or a function of observations and actions."""
CLOSE = 1e-9
"""Fraction of a step that counts as zero."""
Initial = Mapping[str, tuple[float, float]] | Callable[..., Any] | None


class LearningTask:
    """What an episode consists of; parameters as of ``gymnasium_environment``.

    Formulas of reward and end are additional outputs of the stepper, after the observations.
    """

    def __init__(
        self,
        model: Model,
        reward: Judgement,
        terminated: Judgement | None,
        duration: float | None,
        actions: Sequence[str] | None,
        observations: Sequence[Any] | None,
        initial: Initial,
        stepping: Mapping[str, Any],
    ):
        seen = list(model.outputs.values() if observations is None else observations)
        if not seen:
            raise AnalysisError("the model has no outputs to observe; give observations=")
        self.reward, self.terminated, self.initial = reward, terminated, initial
        formulas = [j for j in (reward, terminated) if isinstance(j, (str, Expression))]
        options = dict(stepping)
        length = options.pop("step")
        self.stepper = Stepper(model, length, inputs=actions, outputs=[*seen, *formulas], **options)
        names = self.stepper.input_names
        if not names:
            raise AnalysisError("the model has no inputs to act on; declare them, or give actions=")
        self.names = self.stepper.output_names[: len(self.stepper.output_names) - len(formulas)]
        self.count = len(self.names)
        bounds = [model.parameters[name].bounds for name in names]
        self.low, self.high = (np.array(column) for column in zip(*bounds, strict=True))
        self.length = length
        if duration is not None and not 0 < duration < np.inf:
            raise AnalysisError(f"duration is {duration!r}; give a positive number of seconds")
        self.limit = np.inf if duration is None else ceil(duration / length - CLOSE)
        if isinstance(initial, Mapping):
            for name in initial:
                if name not in model.parameters:
                    raise AnalysisError(unknown("parameter", name, model.parameters))

    def draw(self, rng: np.random.Generator, count: int | None = None) -> dict[str, Any]:
        """Values of the random parameters of one start, or of several."""
        if self.initial is None:
            return {}
        if isinstance(self.initial, Mapping):
            ranges = self.initial.items()
            return {n: rng.uniform(*ends, size=count) for n, ends in ranges}
        if count is None:
            return dict(self.initial(rng))
        each = [self.initial(rng) for _ in range(count)]
        return {n: np.array([draw[n] for draw in each]) for n in each[0]}

    def judge(self, outputs: np.ndarray, actions: np.ndarray) -> tuple[Any, Any, Any]:
        """Observations, rewards and whether episodes end, of (…, ny) outputs."""
        observations, extra = outputs[..., : self.count], list(outputs[..., self.count :].T)
        by_name = {name: observations[..., k] for k, name in enumerate(self.names)}
        reward = self.reward(by_name, actions) if callable(self.reward) else extra.pop(0)
        if self.terminated is None:
            ended = np.zeros(observations.shape[:-1], bool)
        elif callable(self.terminated):
            ended = self.terminated(by_name, actions)
        else:
            ended = extra.pop(0) > 0
        return observations, reward, ended
