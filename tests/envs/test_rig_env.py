"""Laws that every registered environment obeys."""

import copy
import subprocess
import sys

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from short_episodes import make_short

from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError
from ves_twin.core.signals import SIGNALS, Role
from ves_twin.envs import ENVIRONMENTS, picture
from ves_twin.envs.true_state import true_state
from ves_twin.plant.plant import Plant


def episode(env, seed, actions, options=None):
    """Observations, rewards, ends of an episode under given actions."""
    seen, info = env.reset(seed=seed, options=options)
    rows, gains, infos = [seen], [], [info]
    for action in actions:
        seen, gain, terminated, truncated, info = env.step(action)
        rows.append(seen)
        gains.append(gain)
        infos.append(info)
        if terminated or truncated:
            break
    return np.array(rows), np.array(gains), infos


def actions_of(env, count=10, seed=5):
    return np.random.default_rng(seed).uniform(-1, 1, (count, *env.action_space.shape))


@pytest.fixture
def window(monkeypatch):
    """A display; where there is none, a window's work is done off screen."""

    class Hidden(picture._OffScreen):
        def draw(self, model, data):
            assert super().draw(model, data).std() > 10.0

    if picture._headless():
        monkeypatch.setattr(picture, "_Window", Hidden)


@pytest.mark.usefixtures("window")
@pytest.mark.parametrize("scaled", [False, True])
@pytest.mark.parametrize("identity", sorted(ENVIRONMENTS))
def test_the_checker_of_gymnasium_has_nothing_to_say_and_skips_nothing(identity, scaled):
    env = make_short(identity, scaled=scaled).unwrapped
    check_env(env)  # warnings are errors here
    env.close()


def test_it_can_be_made_through_its_module():
    for identity in ENVIRONMENTS:
        assert gym.make(f"ves_twin.envs:{identity}").spec.id == identity


def test_no_import_is_needed_where_the_name_says_the_module():
    code = "import gymnasium as gym; print(gym.make('ves_twin.envs:VesTwin/VibrationDamping-v0'))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "VibrationDamping" in done.stdout


def test_a_first_reset_imports_no_slow_package_that_it_does_not_need():
    code = """if True:
        import sys, gymnasium as gym
        env = gym.make("ves_twin.envs:VesTwin/VibrationDamping-v0", plant="ves2_fast")
        env.reset(seed=0)
        print({"matplotlib", "pandas", "pint"} & set(sys.modules))
    """
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"


def test_scaled_observations_are_shares_of_the_same_episode(env):
    scenario = env.briefing().scenario
    scaled = type(env)(plant=env.plant_of({}), scenario=scenario, scaled=True)
    assert scaled.observation_space.dtype == scaled.action_space.dtype == np.float32
    rows, _, _ = episode(env, 3, actions_of(env))
    seen, _ = scaled.reset(seed=3)
    for row, action in zip(rows[1:], actions_of(env), strict=True):
        np.testing.assert_array_equal(seen, scaled.observations.shares(scaled.reading))
        seen, *_ = scaled.step(action)
        np.testing.assert_array_equal(scaled.reading, row)
        assert seen in scaled.observation_space
        half = (scaled.observations.high - scaled.observations.low) / 2.0
        error = np.abs(scaled.observations.physical(seen) - row) / half
        assert np.max(error) <= np.finfo(np.float32).eps


def test_spaces_are_finite_and_actions_normalised(env):
    for space in (env.observation_space, env.action_space):
        assert np.all(np.isfinite(space.low))
        assert np.all(np.isfinite(space.high))
    assert np.all(env.action_space.high == 1.0)


def test_no_observation_is_truth(env):
    truths = {s.name for s in SIGNALS.values() if s.role is Role.TRUTH}
    assert not truths & set(env.observations.slices)
    assert not any(name.startswith("truth") for name in env.observations.slices)


def test_every_column_has_a_name_and_a_unit(env):
    for table in (env.observations, env.actions):
        assert len(table.columns) == table.width == len(set(table.columns))
        assert all(len(c.units) == c.width and c.meaning for c in table.channels)
        assert table.table().count("\n") == len(table.channels) + 1


def test_same_seed_and_actions_give_the_same_episode_to_the_last_bit(env):
    actions = actions_of(env)
    one = episode(env, 3, actions)
    episode(env, 8, actions_of(env, seed=6))  # something else in between leaves no trace
    two = episode(env, 3, actions)
    np.testing.assert_array_equal(one[0], two[0])
    np.testing.assert_array_equal(one[1], two[1])


def test_a_new_environment_repeats_it_too(env):
    actions = actions_of(env)
    other = type(env)(plant=env.plant_of({}), scenario=env.briefing().scenario)
    one, two = episode(env, 3, actions), episode(other, 3, actions)
    np.testing.assert_array_equal(one[0], two[0])
    np.testing.assert_array_equal(one[1], two[1])


def test_another_seed_gives_another_episode(env):
    actions = actions_of(env)
    assert not np.array_equal(episode(env, 3, actions)[0][-1], episode(env, 4, actions)[0][-1])


def test_looking_changes_nothing(env):
    actions = actions_of(env)
    one = episode(env, 3, actions)
    env.reset(seed=3)
    rows = []
    for action in actions:
        rows.append(env.step(action)[0])
        true_state(env.sim.rig)
        copy.copy(env.sim.data)
        env.briefing()
    np.testing.assert_array_equal(one[0][1:], rows)


def test_an_episode_ends_with_its_time_and_says_its_figures(env):
    _, gains, infos = episode(env, 1, np.zeros((1000, *env.action_space.shape)))
    assert infos[-1]["outcome"] == "completed"
    assert infos[-1]["time"] == pytest.approx(1.0, abs=env.span / 2)
    assert infos[-1]["metrics"]["return"] == pytest.approx(gains.sum(), rel=1e-12)
    assert all("metrics" not in info for info in infos[:-1])
    with pytest.raises(InvalidInputError, match="reset"):
        env.step(np.zeros(env.action_space.shape))


def test_actions_beyond_the_bounds_count_as_the_bounds(env):
    beyond = np.full((5, *env.action_space.shape), 3.0)
    one, two = episode(env, 3, beyond), episode(env, 3, np.ones_like(beyond))
    np.testing.assert_array_equal(one[0], two[0])
    assert one[2][1]["clipped"]
    assert not two[2][1]["clipped"]


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_an_action_that_is_no_number_is_refused_before_anything_moves(env, bad):
    env.reset(seed=0)
    before = env.sim.data.qpos.copy()
    action = np.zeros(env.action_space.shape)
    action[0] = bad
    with pytest.raises(InvalidInputError, match="finite numbers"):
        env.step(action)
    with pytest.raises(InvalidInputError, match="finite numbers"):
        env.step(np.zeros(2))
    np.testing.assert_array_equal(env.sim.data.qpos, before)
    env.step(np.zeros(env.action_space.shape))  # the episode goes on


def test_costs_add_up_and_truth_is_the_rig_s(env):
    *_, infos = episode(env, 3, actions_of(env))
    for info in infos:
        assert info["cost"] == pytest.approx(sum(info["costs"].values()))
        assert set(info["costs"]) == {"stroke", "wrench", "stability"}
    pose, q = true_state(env.sim.rig)
    np.testing.assert_array_equal(infos[-1]["truth"]["truth.pose"], pose)
    np.testing.assert_array_equal(infos[-1]["truth"]["truth.arm_q"], q)


def test_a_safety_stop_terminates_with_its_reason_and_never_pays(env):
    tunes = "legs.gain" in env.actions.slices  # shakes by a gain that is too high, but slowly
    side = 60.0 if tunes else 25.0
    narrow = {"sensor.range": [side, side, 3000.0, 600.0, 600.0, 600.0]}
    hard = Plant.load("ves2_fast").with_values(narrow)
    shaken = np.sign(actions_of(env, 40)) ** (2 if tunes else 1)
    _, gains, infos = episode(env, 0, shaken, {"plant": hard})
    assert infos[-1]["outcome"] == "wrench_range"
    assert "force sensor" in infos[-1]["reason"]
    _, kept, _ = episode(env, 0, shaken)
    assert gains.sum() < kept.sum()


def test_options_hold_for_one_episode(env):
    heavier = Plant.load("ves2_fast").with_values({"leg.rod_mass": 4.0})
    actions = actions_of(env)
    plain = episode(env, 3, actions)
    changed = episode(env, 3, actions, {"plant": heavier})
    again = episode(env, 3, actions)
    assert not np.array_equal(plain[0][-1], changed[0][-1])
    np.testing.assert_array_equal(plain[0], again[0])


def test_unknown_options_and_plants_are_named(env):
    with pytest.raises(UnknownNameError, match="did you mean 'plant'"):
        env.reset(options={"plants": "ves2"})
    with pytest.raises(UnknownNameError, match="did you mean 'ves2_fast'"):
        env.reset(options={"plant": "ves2_fats"})
    with pytest.raises(VesTwinError, match="goal"):
        env.reset(options={"goal": "there"})
    with pytest.raises(UnknownNameError, match="render_mode"):
        type(env)(render_mode="rgb")


def test_a_scenario_that_does_not_fit_is_refused():
    with pytest.raises(InvalidInputError, match="moves by itself"):
        gym.make("VesTwin/VibrationDamping-v0", scenario="beam_horizontal_truth")
    with pytest.raises(InvalidInputError, match="mode 'position'"):
        gym.make("VesTwin/PlatformTracking-v0", scenario="vibration_damping")
    with pytest.raises(InvalidInputError, match="emulated"):
        gym.make("VesTwin/VibrationDamping-v0", scenario="platform_tracking")


def test_nothing_works_before_the_first_reset():
    bare = gym.make("VesTwin/VibrationDamping-v0").unwrapped
    with pytest.raises(InvalidInputError, match="reset"):
        bare.step(np.zeros(3))
    with pytest.raises(InvalidInputError, match="reset"):
        bare.sim  # noqa: B018
