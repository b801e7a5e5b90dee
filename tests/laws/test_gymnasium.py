"""Environments of Gymnasium: its own checker, episodes, lanes."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from laws.test_stepper import cart_pole

import dalembert as da
from dalembert.errors import AnalysisError

TASK = {
    "reward": "1 - (pole.angle - pi/2)**2 - 0.01*push**2",
    "terminated": "abs(pole.angle - pi/2) - 0.2",
    "step": 0.02,
    "substeps": 2,
    "duration": 0.5,
    "initial": {"tilt": (1.47, 1.67)},
}


@pytest.mark.filterwarnings("ignore::UserWarning")  # recommendations for spaces
def test_environment_passes_the_checker():
    environment = da.gymnasium_environment(cart_pole(), render_mode="rgb_array", **TASK)
    check_env(environment)
    picture = environment.render()
    assert picture.dtype == np.uint8 and picture.shape[2] == 3 and np.ptp(picture) > 100


def test_formulas_and_functions_agree():
    model = cart_pole()
    rules = {
        "reward": lambda y, u: 1 - (y["pole_angle"] - np.pi / 2) ** 2 - 0.01 * u[..., 0] ** 2,
        "terminated": lambda y, u: abs(y["pole_angle"] - np.pi / 2) > 0.2,
    }
    one, other = (da.gymnasium_environment(model, **TASK | rule) for rule in ({}, rules))
    for environment in (one, other):
        environment.reset(seed=7)
    for k in range(25):
        first, second = (environment.step([np.sin(k)]) for environment in (one, other))
        assert np.array_equal(first[0], second[0])
        assert first[1] == pytest.approx(second[1], abs=1e-14)
        assert first[2:4] == second[2:4]
    assert first[3] is True  # 0.5 s
    assert isinstance(one, gymnasium.Env)


def test_lanes_are_environments_and_start_again():
    model, lanes = cart_pole(), 9
    many = da.gymnasium_environment(model, lanes=lanes, **TASK)
    single = da.gymnasium_environment(model, **TASK)
    assert many.metadata["autoreset_mode"] is gymnasium.vector.AutoresetMode.NEXT_STEP
    observations, _ = many.reset(seed=3)
    assert many.observation_space.contains(observations)
    start = observations[:, 1].copy()
    single.reset(options={"parameters": {"tilt": start[4]}})
    ended = np.zeros(lanes, bool)
    for k in range(60):
        actions = np.full((lanes, 1), 10 * np.sin(k))
        observations, rewards, terminated, truncated, _ = many.step(actions)
        assert not np.any((terminated | truncated) & ended)  # the step that starts a lane again
        assert np.all(rewards[ended] == 0)
        assert np.all(np.abs(observations[ended, 1] - np.pi / 2) < 0.101)
        if ended[4]:
            tilt = observations[4, 1]
            seen, _ = single.reset(options={"parameters": {"tilt": tilt}})
        else:
            seen, reward, *over, _ = single.step(actions[4])
            assert rewards[4] == pytest.approx(reward, abs=1e-12)
            assert [terminated[4], truncated[4]] == over
        assert np.allclose(observations[4], seen, atol=1e-12)
        ended = terminated | truncated
    again, _ = many.reset(seed=3)
    assert np.array_equal(again[:, 1], start)


def test_models_need_inputs_and_outputs():
    system = da.System("stone")
    system.add(da.planar.Particle("stone", mass=1.0))
    with pytest.raises(AnalysisError, match="no outputs to observe"):
        da.gymnasium_environment(system.build(), reward="1", step=0.1)
    with pytest.raises(AnalysisError, match="no inputs to act on"):
        da.gymnasium_environment(system.build(), reward="1", step=0.1, observations=["stone.x"])
    with pytest.raises(AnalysisError, match="'tild'"):
        da.gymnasium_environment(cart_pole(), **TASK | {"initial": {"tild": (0, 1)}})
