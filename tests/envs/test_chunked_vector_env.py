"""ChunkedVectorEnv: as Gymnasium's own vectors, and as single environments, to the last bit."""

import threading

import gymnasium as gym
import numpy as np
import pytest
from short_episodes import make_short, short

from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError
from ves_twin.envs.chunked_vector_env import ChunkedVectorEnv
from ves_twin.envs.wrappers import LateObservations

DAMPING = "VesTwin/VibrationDamping-v0"
COUNT = 3  # over two threads: shares of one and of two


seen: list[tuple[str, int]] = []


class Told(gym.Wrapper):
    """Tells in which thread it is used."""

    def reset(self, **words):
        seen.append(("reset", threading.get_ident()))
        return super().reset(**words)

    def step(self, action):
        seen.append(("step", threading.get_ident()))
        return super().step(action)

    def render(self):
        seen.append(("render", threading.get_ident()))
        return super().render()

    def close(self):
        seen.append(("close", threading.get_ident()))
        super().close()


def refused_in_a_share(env):
    if threading.current_thread() is not threading.main_thread():
        raise RuntimeError("of a thread")
    return env


def late(env):
    return LateObservations(env, 1)


def same(found, expected):
    assert list(found) == list(expected)
    for key, value in expected.items():
        if isinstance(value, dict):
            same(found[key], value)
        elif key == "final_obs":
            for a, b in zip(found[key], value, strict=True):
                np.testing.assert_array_equal(a, b)
        else:
            assert found[key].dtype == value.dtype
            np.testing.assert_array_equal(found[key], value)


@pytest.fixture(scope="module")
def envs():
    made = ChunkedVectorEnv(
        DAMPING,
        COUNT,
        threads=2,
        wrappers=[late],
        plant="ves2_fast",
        scenario=short("vibration_damping"),
    )
    yield made
    made.close()


def test_a_batch_equals_gymnasiums_own_through_the_end_of_an_episode(envs):
    expected = gym.make_vec(
        DAMPING,
        num_envs=COUNT,
        vectorization_mode="sync",
        wrappers=[late],
        plant="ves2_fast",
        scenario=short("vibration_damping"),
    )
    rng = np.random.default_rng(1)
    first, info = envs.reset(seed=[4, 9, 2])
    plain, told = expected.reset(seed=[4, 9, 2])
    np.testing.assert_array_equal(first, plain)
    same(info, told)
    for _ in range(22):  # an episode has 19 steps
        actions = rng.uniform(-1, 1, (COUNT, 3))
        *batch, info = envs.step(actions)
        *plain, told = expected.step(actions)
        for a, b in zip(batch, plain, strict=True):
            assert a.dtype == b.dtype
            np.testing.assert_array_equal(a, b)
        same(info, told)


def test_each_equals_a_single_environment(envs):
    actions = np.random.default_rng(1).uniform(-1, 1, (6, COUNT, 3))
    found = [envs.reset(seed=7)[0], *(envs.step(a)[0] for a in actions)]
    for k in range(COUNT):
        env = late(make_short(DAMPING))
        single = [env.reset(seed=7 + k)[0], *(env.step(a[k])[0] for a in actions)]
        np.testing.assert_array_equal(np.array(found)[:, k], single)


def test_what_is_refused_moves_nothing(envs):
    rows = []
    for wrong in (False, True):
        envs.reset(seed=1)
        if wrong:
            bad = np.zeros((COUNT, 3))
            bad[-1, 0] = np.nan
            with pytest.raises(InvalidInputError, match="finite numbers of shape"):
                envs.step(bad)
            with pytest.raises(InvalidInputError, match="actions"):
                envs.step(np.zeros((COUNT, 2)))
        rows.append(envs.step(np.ones((COUNT, 3)))[0])
    np.testing.assert_array_equal(*rows)


def test_an_error_of_a_share_arrives_as_what_it_is(envs):
    with pytest.raises(UnknownNameError, match="did you mean 'plant'"):
        envs.reset(options={"plnt": "ves2"})
    with pytest.raises(InvalidInputError, match="reset_mask"):
        envs.reset(options={"reset_mask": np.ones(COUNT, bool)})
    with pytest.raises(VesTwinError, match="nothing_such"):
        envs.get_attr("nothing_such")
    with pytest.raises(InvalidInputError, match="3 of them"):
        envs.reset(seed=[1, 2])
    assert envs.reset(seed=1)[0].shape == (COUNT, envs.single_observation_space.shape[0])


def test_attributes_are_told_and_set_in_order(envs):
    assert envs.get_attr("render_mode") == (None,) * COUNT
    envs.set_attr("marked", [1, 2, 3])
    assert envs.get_attr("marked") == (1, 2, 3)
    with pytest.raises(InvalidInputError, match="marked"):
        envs.set_attr("marked", [1, 2])


def test_what_cannot_be_made_leaves_no_thread():
    before = threading.active_count()
    with pytest.raises(UnknownNameError, match="ves3"):
        ChunkedVectorEnv(DAMPING, 2, plant="ves3")
    with pytest.raises(InvalidInputError, match="num_envs"):
        ChunkedVectorEnv(DAMPING, 0)
    with pytest.raises(UnknownNameError, match="did you mean 'NextStep'"):
        ChunkedVectorEnv(DAMPING, 2, autoreset_mode="next_step")
    with pytest.raises(VesTwinError, match="of a thread"):
        ChunkedVectorEnv(DAMPING, 2, threads=2, wrappers=[refused_in_a_share], plant="ves2_fast")
    assert threading.active_count() == before


def test_within_the_last_step_and_when_closed():
    options = {"plant": "ves2_fast", "scenario": short("vibration_damping")}
    found = ChunkedVectorEnv(DAMPING, 2, threads=2, autoreset_mode="SameStep", **options)
    mode = {"autoreset_mode": "SameStep"}
    expected = gym.make_vec(
        DAMPING, num_envs=2, vectorization_mode="sync", vector_kwargs=mode, **options
    )
    found.reset(seed=1), expected.reset(seed=1)
    found.call("reset"), expected.envs[0].reset(), expected.envs[1].reset()
    actions = np.zeros((2, 3))
    for _ in range(20):
        *batch, info = found.step(actions)
        *plain, told = expected.step(actions)
        for a, b in zip(batch, plain, strict=True):
            np.testing.assert_array_equal(a, b)
        same(info, told)
    found.close()
    with pytest.raises(InvalidInputError, match="closed"):
        found.step(actions)


def test_they_are_made_stepped_drawn_and_closed_in_the_thread_of_their_share():
    """A picture's context belongs to the thread that made it."""
    seen.clear()
    envs = ChunkedVectorEnv(
        DAMPING, 3, threads=2, wrappers=[Told], plant="ves2_fast",
        scenario=short("vibration_damping"), render_mode="rgb_array",
    )  # fmt: skip
    envs.reset(seed=1)
    envs.step(np.zeros((3, 3)))
    (a, b, c) = envs.render()
    envs.close()
    assert a.shape == b.shape == c.shape
    alone = {verb for verb, _ in seen}
    assert alone == {"reset", "step", "render", "close"}
    for verb in ("reset", "step", "render"):
        threads = [thread for one, thread in seen if one == verb]
        assert len(threads) == 3
        assert len(set(threads)) == 2
        assert threading.get_ident() not in threads
