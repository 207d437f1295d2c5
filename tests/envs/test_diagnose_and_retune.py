"""DiagnoseAndRetune: trials on a sealed machine, one of which is scored, and nothing told of it."""

import gymnasium as gym
import numpy as np
import pytest

from ves_twin.core.errors import ControllerError, InvalidInputError, UnknownNameError
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.envs.baselines.diagnosed_retuning import DiagnosedRetuning
from ves_twin.envs.baselines.fitted_retuning import FittedRetuning
from ves_twin.envs.baselines.retuning import tuned
from ves_twin.envs.baselines.still import Still
from ves_twin.envs.evaluation import Trial, built, evaluate, run_episode
from ves_twin.envs.joint_task import JointTask
from ves_twin.envs.policy import Policy
from ves_twin.machines.machine import Machine
from ves_twin.machines.mjcf.motion.forward import MjcfForward

ID = "VesTwin/DiagnoseAndRetune-v0"

FRICTION = {"coulomb_friction@joint:level": 0.3}
LATE = {"sensor_delay@joint:delay": 0.02}
BIAS = {"sensor_offset@joint.angle.1:offset": 0.05}

ROUND_OFF = 1e-9
"""Of angles [rad] and rates [rad/s] that two loops over the same steps find."""


@pytest.fixture(scope="module")
def env():
    return gym.make(ID, experiments=1, disable_env_checker=True).unwrapped


@pytest.fixture(scope="module")
def task():
    return JointTask.of(Machine.load("pendulum"))


def asked(env, **columns):
    """An action with some columns in their units, the others zero."""
    action = np.zeros(env.actions.width)
    for name, value in columns.items():
        at = env.actions.slices[name.replace("__", ".")]
        action[at] = value / env.actions.high[at]
    return action


def scored(env, action, hidden, seed=0):
    """The return of an action in both trials."""
    env.reset(seed=seed, options={"hidden": hidden})
    env.step(action)
    return env.step(action)[1]


def test_experiments_are_free_and_the_last_trial_is_scored(env):
    seen, info = env.reset(seed=1)
    assert not np.any(seen[:-1])
    left = env.observations.slices["trials.left"]
    assert seen[left] == [2.0]
    seen, gain, terminated, truncated, info = env.step(asked(env))
    assert (gain, terminated, truncated, info["outcome"]) == (0.0, False, False, "running")
    assert seen[left] == [1.0]
    seen, gain, terminated, truncated, info = env.step(asked(env))
    assert (terminated, truncated, info["outcome"]) == (False, True, "completed")
    assert gain == info["metrics"]["return"] == -info["metrics"]["tracking_rms"] < 0.0
    assert info["metrics"]["tracking_peak"] > info["metrics"]["tracking_rms"]
    with pytest.raises(InvalidInputError, match="reset"):
        env.step(asked(env))


def test_same_seed_same_episode_and_another_one_another_machine(env):
    def episode(seed):
        env.reset(seed=seed)
        return np.array([env.step(asked(env))[0] for _ in range(2)]), env.faults

    one, hidden = episode(3)
    two, again = episode(3)
    np.testing.assert_array_equal(one, two)
    assert hidden == again
    assert episode(4)[1] != hidden


def test_every_cause_is_hidden_at_a_tenth_to_all_of_its_size(env):
    causes = {(h.effect, h.target): h for h in env._blind.forward.hypotheses}
    nominal = {p.name: p.nominal for p in env._blind.forward.parameters}
    found = set()
    for seed in range(80):
        env.reset(seed=seed)
        (fault,) = env.faults
        cause = causes[fault["kind"], fault["target"]]
        size = abs(fault["value"] - nominal[cause.parameters[0]])
        assert 0.0999 * cause.largest[0] <= size <= 1.0001 * cause.largest[0]
        found.add(cause.label)
    assert found == {cause.label for cause in causes.values()}


def test_nothing_tells_the_fault_but_what_was_measured(env):
    told = []
    for hidden in (FRICTION, BIAS):
        seen, info = env.reset(seed=5, options={"hidden": hidden})
        known = env.briefing()
        told.append((seen.tolist(), repr(info), known.task.rig.identity, known.trials))
        assert set(env.observations.slices) == {*known.task.signals, "trials.left"}
        _, _, _, _, info = env.step(asked(env))
        assert set(info) == {"time", "cost", "costs", "clipped", "outcome"}
        assert info["costs"] == {"effort": info["cost"]}
    assert told[0] == told[1]


@pytest.mark.parametrize(
    ("hidden", "columns"),
    [
        (FRICTION, {"feedforward__dry": 0.3}),
        (LATE, {"reading__late": 0.02}),
        (BIAS, {"reading__offset": 0.05}),
        ({"joint_spring@joint:stiffness": 0.6}, {"feedforward__spring": 0.6}),
        ({"viscous_friction@joint:damping": 0.1}, {"feedforward__viscous": 0.05}),
    ],
)
def test_a_controller_that_is_told_the_fault_loses_less_than_half(env, hidden, columns):
    assert scored(env, asked(env, **columns), hidden) > 0.5 * scored(env, asked(env), hidden)


def test_the_last_trial_has_no_test_effort(env):
    rows = []
    for effort in (0.0, 0.8):
        env.reset(seed=2)
        env.step(asked(env))
        rows.append(env.step(asked(env, test__effort=effort))[0])
    np.testing.assert_array_equal(*rows)


def test_an_experiment_has_it(env):
    rows = []
    for effort in (0.0, 0.8):
        env.reset(seed=2)
        rows.append(env.step(asked(env, test__effort=effort))[0])
    assert np.ptp(rows[0] - rows[1]) > 0.1


def test_the_recorded_commands_in_open_loop_give_the_recorded_motion(task):
    """The loop of the trial and the rollout of the diagnosis are two codes over the same steps."""
    values = {**LATE, **FRICTION, "actuator_gain@drive:gain": 1.1}
    trial = task.run(task.nominal, np.random.default_rng(4), values=values)
    noise = task.noise * np.random.default_rng(4).standard_normal((len(task.time), 2))
    record = task.recording(trial.rows, "trial")
    forward = MjcfForward.of(task.rig)
    rows = forward.simulate(Excitation.of(record, forward.drive, rate=100.0), values)
    assert np.max(np.abs(rows + noise - trial.rows[:, 1:])) < ROUND_OFF


def test_tuning_on_the_true_machine_beats_the_believed_one(env, task):
    hidden = {**LATE, "joint_spring@joint:stiffness": 0.6}
    action = tuned(env.briefing(), task.rig, hidden)
    assert scored(env, action, hidden) > 0.2 * scored(env, asked(env), hidden)


def test_mistakes_are_one_line(env):
    with pytest.raises(UnknownNameError, match="did you mean 'hidden'"):
        env.reset(options={"hiden": {}})
    with pytest.raises(UnknownNameError, match="did you mean"):
        env.reset(options={"hidden": {"sensor_delay@joint:dely": 0.1}})
    with pytest.raises(InvalidInputError, match="experiments"):
        gym.make(ID, experiments=-1)
    with pytest.raises(InvalidInputError, match="one drive"):
        gym.make(ID, plant="emps")
    env.reset(seed=0)
    with pytest.raises(InvalidInputError, match="finite numbers"):
        env.step(np.full(env.actions.width, np.nan))
    with pytest.raises(InvalidInputError, match="VES II"):
        evaluate(Trial(ID, "still", "test-v0", None), range(1))


def test_a_policy_for_a_rig_is_refused_in_one_line(env):
    class Careless(Policy):
        @classmethod
        def build(cls, briefing):
            return cls(briefing.belief)

        begin = act = None

    with pytest.raises(ControllerError, match="Careless cannot be built from a TrialSpec"):
        built(Careless, env)


@pytest.mark.nightly
@pytest.mark.parametrize("policy", [DiagnosedRetuning, FittedRetuning])
def test_a_baseline_that_looks_at_experiments_finds_the_bias(policy):
    env = gym.make(ID, experiments=2, disable_env_checker=True)
    seed = next(s for s in range(100) if _kind(env, s) == "sensor_offset")
    episode = run_episode(env, built(policy, env), seed)
    still = run_episode(env, built(Still, env), seed)
    assert episode.metrics["return"] > 0.2 * still.metrics["return"]


def _kind(env, seed):
    env.reset(seed=seed)
    return env.unwrapped.faults[0]["kind"]
