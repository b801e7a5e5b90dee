"""Environments of Gymnasium: its own checker, episodes, lanes."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from laws.test_stepper import cart_pole

import dalembert as da
from dalembert import planar
from dalembert.errors import AnalysisError, UnsupportedError

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


def drop(**options):
    """A mass under an input; the episode ends below -1 m, the integration fails above 1e150 m/s."""
    system = da.System("drop")
    mass = system.add(planar.Particle("mass", mass=1.0))
    system.add(planar.PinInSlot("rail", system.ground.center, mass.center))
    push = system.input("push", unit="N")
    blowup = system.input("blowup")
    system.add(planar.Force("drive", mass.center, (push + blowup * mass.vx**9, 0)))
    system.output("x", mass.x)
    task = {"reward": "mass.x", "terminated": "-1 - mass.x", "step": 0.5, "duration": 2.3}
    return da.gymnasium_environment(system.build(), **task, **options)


def test_lanes_start_again_in_the_same_step():
    many = drop(lanes=3, autoreset="SAME_STEP")
    many.reset(seed=1)
    actions = np.array([[0.0, 0.0], [-20.0, 0.0], [0.0, 0.0]])
    seen, reward, terminated, truncated, infos = many.step(actions)
    assert terminated.tolist() == [False, True, False] and not truncated.any()
    assert np.allclose(seen, 0.0) and reward[1] == pytest.approx(-2.5)
    assert infos["final_obs"][1] == pytest.approx(-2.5)
    assert infos["_final_obs"].tolist() == [False, True, False]
    for _ in range(4):  # the duration is reached after five steps of 0.5 s
        seen, _, terminated, truncated, infos = many.step(np.zeros((3, 2)))
    assert truncated.tolist() == [True, False, True] and not terminated.any()
    assert infos["time"].tolist() == [2.5, 2.0, 2.5]


def test_lanes_start_again_by_reset_alone():
    many = drop(lanes=3, autoreset="DISABLED")
    many.reset(seed=1)
    _, _, terminated, _, _ = many.step(np.array([[0.0, 0.0], [-20.0, 0.0], [4.0, 0.0]]))
    with pytest.raises(AnalysisError, match=r"lanes 1 have ended; reset them"):
        many.step(np.zeros((3, 2)))
    seen, _ = many.reset(options={"reset_mask": terminated})
    assert np.allclose(seen[:, 0], [0.0, 0.0, 0.5])
    with pytest.raises(AnalysisError, match="unknown option 'mask'"):
        many.reset(options={"mask": terminated})
    with pytest.raises(AnalysisError, match="autoreset is 'never'"):
        drop(lanes=3, autoreset="never")
    with pytest.raises(UnsupportedError, match="lanes are not drawn"):
        drop(lanes=3, render_mode="rgb_array")


@pytest.mark.parametrize("lanes", [None, 2])
def test_a_failed_integration_ends_an_episode(lanes):
    """The observation is the last finite one, the reward zero, and others go on."""
    environment = drop(lanes=lanes)
    environment.reset(seed=1)
    push, failing = np.array([4.0, 0.0]), np.array([4.0, 1e200])
    environment.step(push if lanes is None else np.array([push, push]))
    action = failing if lanes is None else np.array([push, failing])
    seen, reward, terminated, truncated, infos = environment.step(action)
    if lanes is None:
        assert seen[0] == pytest.approx(0.5) and (reward, terminated, truncated) == (0, True, False)
        assert "would not be finite" in infos["failure"]
        return
    assert np.allclose(seen[:, 0], [2.0, 0.5]) and np.allclose(reward, [2.0, 0.0])
    assert terminated.tolist() == infos["failed"].tolist() == [False, True]
    seen, *_ = environment.step(np.array([push, push]))
    assert np.allclose(seen[:, 0], [4.5, 0.0])


def test_models_need_inputs_and_outputs():
    system = da.System("stone")
    system.add(da.planar.Particle("stone", mass=1.0))
    with pytest.raises(AnalysisError, match="no outputs to observe"):
        da.gymnasium_environment(system.build(), reward="1", step=0.1)
    with pytest.raises(AnalysisError, match="no inputs to act on"):
        da.gymnasium_environment(system.build(), reward="1", step=0.1, observations=["stone.x"])
    with pytest.raises(AnalysisError, match="'tild'"):
        da.gymnasium_environment(cart_pole(), **TASK | {"initial": {"tild": (0, 1)}})
