"""Classes of environments, which exist where Gymnasium is installed."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import Env
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from dalembert.analysis.stepping.input_values import lane_numbers
from dalembert.design.ecosystem.learning_task import LearningTask
from dalembert.errors import AnalysisError, SolverFailure, UnsupportedError
from dalembert.results.pictures.scene import is_spatial
from dalembert.text.wording import listed, unknown

RATE = 30
"""Upper limit of the frames per second that metadata state."""


def _spaces(task: LearningTask) -> tuple[Box, Box]:
    """Spaces of actions and observations."""
    unlimited = np.full(task.count, np.inf)
    return (
        Box(task.low, task.high, dtype=np.float64),
        Box(-unlimited, unlimited, dtype=np.float64),
    )


def _known(options: dict[str, Any] | None, *names: str) -> dict[str, Any]:
    """Options of a reset.

    Raises
    ------
    AnalysisError
        An unknown one.
    """
    for name in options or {}:
        if name not in names:
            raise AnalysisError(unknown("option", name, names))
    return options or {}


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
        chosen = _known(options, "parameters").get("parameters") or {}
        values = self.task.draw(self.np_random) | dict(chosen)
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
    """Lanes of a mechanism, which start again after their ends.

    ``NEXT_STEP``: with the next step, whose action the lane ignores. ``SAME_STEP``: at once; the
    last observations are ``infos["final_obs"]``. ``DISABLED``: by
    ``reset(options={"reset_mask": ...})`` alone. A lane whose integration fails ends, with its last
    finite observation; ``infos["failed"]`` marks it.
    """

    def __init__(self, task: LearningTask, lanes: int, autoreset: str):
        modes = [mode.name for mode in AutoresetMode]
        if str(autoreset).upper() not in modes:
            raise AnalysisError(f"autoreset is {autoreset!r}; give one of {', '.join(modes)}")
        self.mode = AutoresetMode[str(autoreset).upper()]
        self.metadata = {"autoreset_mode": self.mode, "render_modes": []}
        self.task, self.num_envs, self.render_mode = task, lanes, None
        self.single_action_space, self.single_observation_space = _spaces(task)
        self.action_space = batch_space(self.single_action_space, lanes)
        self.observation_space = batch_space(self.single_observation_space, lanes)
        self.lanes = task.stepper.lanes(lanes)
        self._counts, self._ended = np.zeros(lanes, dtype=int), np.zeros(lanes, dtype=bool)
        self._seen = self.lanes.outputs[:, : task.count].copy()

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin episodes in all lanes, or in those of the mask ``options["reset_mask"]``.

        ``options["parameters"]`` are values instead of random ones, numbers or one for each of
        these lanes.
        """
        super().reset(seed=seed)
        chosen = _known(options, "reset_mask", "parameters")
        numbers = lane_numbers(self.num_envs, chosen.get("reset_mask"))
        self._begin(numbers, chosen.get("parameters"))
        return self._seen.copy(), self._infos(np.zeros(self.num_envs, bool))

    def _begin(self, numbers: np.ndarray, parameters: dict[str, Any] | None = None) -> None:
        if numbers.size:
            values = self.task.draw(self.np_random, numbers.size) | dict(parameters or {})
            outputs = self.lanes.reset(numbers, parameters=values)
            self._seen[numbers] = outputs[numbers, : self.task.count]
        self._counts[numbers], self._ended[numbers] = 0, False

    def _infos(self, failed: np.ndarray) -> dict[str, Any]:
        return {"time": self.lanes.time, "failed": failed}

    def step(
        self, actions: Any
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Advance all lanes by one step."""
        begun = self._ended.copy()
        if begun.any() and self.mode is AutoresetMode.DISABLED:
            raise AnalysisError(
                f"lanes {listed(list(map(str, np.flatnonzero(begun))))} have ended; reset them by "
                'reset(options={"reset_mask": ...})'
            )
        actions = np.asarray(actions, dtype=float)
        outputs = self.lanes.step(actions).copy()
        failed = self.lanes.failed & ~begun
        outputs[begun | failed, : self.task.count] = self._seen[begun | failed]
        outputs[begun | failed, self.task.count :] = 0.0
        self._counts += ~begun
        seen, reward, ended = self.task.judge(outputs, actions)
        self._seen[:] = seen
        reward = np.where(begun | failed, 0.0, reward)
        ended = (np.asarray(ended, bool) | failed) & ~begun
        truncated = (self._counts >= self.task.limit) & ~begun
        infos = self._infos(failed)
        self._begin(np.flatnonzero(begun))
        self._ended = ended | truncated
        if self.mode is AutoresetMode.SAME_STEP and self._ended.any():
            again = self._ended.copy()
            infos |= {"final_obs": self._seen.copy(), "_final_obs": again}
            infos |= {"final_info": dict(infos), "_final_info": again}
            self._begin(np.flatnonzero(again))
        return self._seen.copy(), reward, ended, truncated, infos
