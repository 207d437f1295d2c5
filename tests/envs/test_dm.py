"""The dm_control face: a real Physics over the live rig, and Gymnasium's episode to the last bit."""

import copy
import pickle
import unittest
from unittest import mock

import numpy as np
import pytest
from dm_control import mujoco as dm_mujoco
from dm_control import viewer
from dm_control.rl import control
from dm_control.suite.wrappers import pixels
from dm_control.viewer import runtime
from dm_env import StepType, test_utils
from short_episodes import make_short

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.envs import RIG_ENVIRONMENTS, dm
from ves_twin.envs.picture import NoPictureError, check_off_screen
from ves_twin.envs.wrappers import RandomRigs

ENV_OF = dict(zip((task for _, task in dm.ALL_TASKS), RIG_ENVIRONMENTS, strict=True))


def loaded(task, random=4, **environment_kwargs):
    scenario = make_short(ENV_OF[task]).unwrapped.briefing().scenario
    given = {"plant": "ves2_fast", "scenario": scenario, "random": random}
    return dm.load("ves2", task, given, environment_kwargs)


@pytest.fixture(scope="module")
def damping():
    made = loaded("vibration_damping")
    yield made
    made.close()


@pytest.mark.parametrize("task", [task for _, task in dm.ALL_TASKS])
def test_it_shows_gymnasium_s_episode_to_the_last_bit(task):
    env, face = make_short(ENV_OF[task]), loaded(task)
    seen, _ = env.reset(seed=4)
    step = face.reset()
    assert step.step_type is StepType.FIRST
    rng = np.random.default_rng(1)
    while not step.last():
        np.testing.assert_array_equal(np.concatenate(list(step.observation.values())), seen)
        np.testing.assert_array_equal(face.physics.data.qpos, env.unwrapped.sim.data.qpos)
        for name, spec in face.observation_spec().items():
            spec.validate(step.observation[name])
        action = rng.uniform(-1, 1, env.action_space.shape)
        step, (seen, gain, terminated, truncated, _) = face.step(action), env.step(action)
        assert step.reward == gain
        assert step.last() == (terminated or truncated)
    assert step.discount == 1.0  # the end of time is not the end of the task
    assert face.step(action).first()


@pytest.mark.parametrize("task", [task for _, task in dm.ALL_TASKS])
def test_deepmind_s_own_test_of_the_interface_passes_and_skips_nothing(task):
    env = make_short(ENV_OF[task])

    class Contract(test_utils.EnvironmentTestMixin, unittest.TestCase):
        def make_object_under_test(self):
            return dm.control_environment(env, random=4)

    found = unittest.TestResult()
    unittest.defaultTestLoader.loadTestsFromTestCase(Contract).run(found)
    assert found.testsRun == 4
    assert not [text for _, text in [*found.errors, *found.failures, *found.skipped]]


def test_its_physics_is_the_rig_itself(damping):
    damping.reset()
    physics = damping.physics
    assert isinstance(damping, control.Environment)
    assert isinstance(physics, dm_mujoco.Physics)
    before = physics.named.data.xpos["platform/top", "z"]
    damping.step(np.ones(3))
    assert physics.named.data.xpos["platform/top", "z"] != before
    assert physics.named.model.body_mass["arm/link3"] == 9.0
    assert damping.control_timestep() == pytest.approx(physics.time())


def test_a_push_on_the_arm_moves_the_base_that_is_emulated():
    results = []
    for push in (0.0, 50.0):
        face = loaded("vibration_damping")
        face.reset()
        face.physics.named.data.xfrc_applied["arm/link3", 0] = push
        for _ in range(10):
            step = face.step(np.zeros(3))
        results.append(step.observation["platform.pose"][0])
    assert results[1] > results[0]


def test_steps_and_resets_that_the_rig_does_not_have_are_refused(damping):
    damping.reset()
    with pytest.raises(InvalidInputError, match="nstep"):
        damping.physics.step(1)
    with pytest.raises(InvalidInputError, match="keyframe"):
        damping.physics.reset(0)
    with pytest.raises(InvalidInputError, match="visualize_reward"):
        dm.load("ves2", "vibration_damping", visualize_reward=True)
    with pytest.raises(UnknownNameError, match="did you mean 'vibration_damping'"):
        dm.load("ves2", "vibration_dampin")
    with pytest.raises(UnknownNameError, match="did you mean 'flat_observation'"):
        dm.load("ves2", "vibration_damping", environment_kwargs={"flat_observations": True})
    with pytest.raises(UnknownNameError, match="domain"):
        dm.load("ves3", "vibration_damping")
    with pytest.raises(InvalidInputError, match="physical units"):
        dm.control_environment(make_short("VesTwin/VibrationDamping-v0", scaled=True))


def test_a_copy_is_the_mechanics_alone(damping):
    damping.reset()
    for other in (
        damping.physics.copy(),
        copy.deepcopy(damping.physics),
        pickle.loads(pickle.dumps(damping.physics)),
    ):
        assert type(other) is dm_mujoco.Physics
        np.testing.assert_array_equal(other.data.qpos, damping.physics.data.qpos)
        other.step()
        assert np.any(other.data.qpos != damping.physics.data.qpos)


def test_flat_observations_have_the_columns_of_gymnasium():
    face = loaded("platform_tracking", flat_observation=True)
    seen, _ = make_short("VesTwin/PlatformTracking-v0").reset(seed=4)
    np.testing.assert_array_equal(face.reset().observation["observations"], seen)
    assert face.observation_spec()["observations"].shape == seen.shape


def test_another_rig_is_followed():
    env = RandomRigs(make_short("VesTwin/VibrationDamping-v0"), "train-v0")
    face = dm.control_environment(env, random=1)
    pointers = []
    for _ in range(2):
        face.reset()
        pointers.append(face.physics.data.ptr)
        assert face.physics.data.ptr is env.unwrapped.sim.data
        mass = face.physics.named.model.body_mass["arm/link3"]
        assert mass == env.unwrapped.sim.model.body("arm/link3").mass[0]
    assert pointers[0] is not pointers[1]


def test_pixels_come_by_the_suite_s_own_wrapper(damping):
    try:
        check_off_screen()
    except NoPictureError as error:
        pytest.skip(str(error))
    shown = pixels.Wrapper(damping, render_kwargs={"height": 60, "width": 80})
    first = shown.reset().observation["pixels"]
    assert first.shape == (60, 80, 3)
    assert first.std() > 5.0
    for _ in range(10):
        second = shown.step(np.ones(3)).observation["pixels"]
    assert np.any(first != second)


def test_the_viewer_s_runtime_plays_an_episode(damping):
    """What `dm_control.viewer.launch` drives, without its window."""
    failed = mock.Mock()
    played = runtime.Runtime(damping, policy=lambda step: np.full(3, 0.2))
    played.on_error += [failed]
    for _ in range(30):
        played.tick(0.1, paused=False)
    failed.assert_not_called()
    assert played.state is runtime.State.STOPPED  # a second, then over
    assert callable(viewer.launch)
