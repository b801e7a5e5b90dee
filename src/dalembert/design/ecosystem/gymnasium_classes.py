"""Classes of environments, which exist where Gymnasium is installed."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import Env
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from dalembert.design.ecosystem.learning_task import LearningTask
from dalembert.errors import SolverFailure, UnsupportedError
from dalembert.results.pictures.scene import is_spatial

RATE = 30
"""Upper limit of the frames per second that metadata state."""


def _spaces(task: LearningTask) -> tuple[Box, Box]:
    """Spaces of actions and observations."""
    unlimited = np.full(task.count, np.inf)
    return (
        Box(task.low, task.high, dtype=np.float64),
        Box(-unlimited, unlimited, dtype=np.float64),
    )


class Environment(Env):  # type: ignore[misc]
    """One mechanism; episodes end by a formula, a failure of the integration, or after a time."""

    def __init__(self, task: LearningTask, render_mode: str | None = None):
        self.metadata = {"render_modes": ["rgb_array"]}
        self.metadata["render_fps"] = max(1, min(RATE, round(1 / task.length)))
        if render_mode not in (None, "rgb_array"):
            raise UnsupportedError(f"render_mode is {render_mode!r}; it is None or 'rgb_array'")
        self.task, self.stepper, self.render_mode = task, task.stepper, render_mode
        self.action_space, self.observation_space = _spaces(task)
        self._count = 0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin an episode; ``options["parameters"]`` are values instead of random ones."""
        super().reset(seed=seed)
        values = self.task.draw(self.np_random) | dict((options or {}).get("parameters", {}))
        self._count = 0
        outputs = self.stepper.reset(values or None)
        return outputs[: self.task.count], {"time": self.stepper.time}

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Advance by one step."""
        self._count += 1
        try:
            outputs = self.stepper.step(action)
        except SolverFailure as failure:
            seen = self.stepper.outputs[: self.task.count]
            return seen, 0.0, True, False, {"time": self.stepper.time, "failure": str(failure)}
        seen, reward, ended = self.task.judge(outputs, np.asarray(action))
        truncated = self._count >= self.task.limit
        return seen, float(reward), bool(ended), truncated, {"time": self.stepper.time}

    def render(self) -> np.ndarray | None:
        """Picture of the present state (height, width, 3), by Matplotlib."""
        if self.render_mode is None:
            return None
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        figure = Figure(figsize=(5, 4), dpi=100)
        canvas = FigureCanvasAgg(figure)
        motion = self.stepper.snapshot()
        spatial = is_spatial(motion.model)
        motion.draw(ax=figure.add_subplot(projection="3d" if spatial else None))
        canvas.draw()
        return np.asarray(canvas.buffer_rgba())[:, :, :3].copy()


class LaneEnvironment(VectorEnv):  # type: ignore[misc]
    """Lanes of a mechanism; an ended lane starts again with the next step, whose action it ignores.

    A lane whose integration fails ends.
    """

    def __init__(self, task: LearningTask, lanes: int):
        self.metadata = {"autoreset_mode": AutoresetMode.NEXT_STEP, "render_modes": []}
        self.task, self.num_envs, self.render_mode = task, lanes, None
        self.single_action_space, self.single_observation_space = _spaces(task)
        self.action_space = batch_space(self.single_action_space, lanes)
        self.observation_space = batch_space(self.single_observation_space, lanes)
        self.lanes = task.stepper.lanes(lanes)
        self._counts, self._ended = np.zeros(lanes, dtype=int), np.zeros(lanes, dtype=bool)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin episodes in all lanes, or in those of the mask ``options["reset_mask"]``."""
        super().reset(seed=seed)
        mask = (options or {}).get("reset_mask")
        chosen = np.ones(self.num_envs, bool) if mask is None else np.asarray(mask, bool)
        self._begin(chosen)
        return self.lanes.outputs[:, : self.task.count].copy(), {}

    def _begin(self, chosen: np.ndarray) -> None:
        numbers = np.flatnonzero(chosen)
        if numbers.size:
            values = self.task.draw(self.np_random, numbers.size)
            self.lanes.reset(numbers, parameters=values)
        self._counts[numbers], self._ended[numbers] = 0, False

    def step(
        self, actions: Any
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Advance all lanes by one step."""
        begun = self._ended.copy()
        outputs = self.lanes.step(actions)
        failed = self.lanes.failed & ~begun
        if begun.any():
            self._begin(begun)
            outputs = self.lanes.outputs
        self._counts += ~begun
        seen, reward, ended = self.task.judge(outputs, np.asarray(actions))
        reward = np.where(begun | failed, 0.0, reward)
        ended = (np.asarray(ended, bool) | failed) & ~begun
        truncated = (self._counts >= self.task.limit) & ~begun
        self._ended = ended | truncated
        return seen.copy(), reward, ended, truncated, {}
