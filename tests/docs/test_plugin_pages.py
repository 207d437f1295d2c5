"""The examples of the plugin pages, taken from the pages, do what the pages say."""

import re
import sys
from pathlib import Path

import numpy as np
import pytest
from two_link import programme, rig

import ves_twin as vt
from ves_twin.cli.main import main
from ves_twin.control.controller import PlatformController
from ves_twin.core.code_file import load_class
from ves_twin.effects.registry import EFFECTS, parse_effects
from ves_twin.envs.evaluation import Trial, evaluate
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.plant.assembly import assemble

PAGES = Path(__file__).parents[2] / "docs" / "plugins"
SHORT = {"run.duration": 3.0, "run.noise": False}
FAST = vt.Plant.load("ves2_fast")
MASS, STIFFNESS = 200.0, 800.0
READ_LATE = 5e-4  # a tenth of 1 - cos(0.1); a length is read a tick late and in counts


def example(page):
    """The Python block of a page."""
    (code,) = re.findall(r"```python\n(.*?)```", (PAGES / page).read_text("utf-8"), re.DOTALL)
    return code


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Make a page's example importable with the entry point that the page shows."""

    def build(page):
        text = (PAGES / page).read_text("utf-8")
        group, name, module, target = re.search(
            r'\[project\.entry-points\."(\S+)"\]\s+(\w+) = "(\w+):(\w+)"', text
        ).groups()
        info = tmp_path / f"{module}-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[{group}]\n{name} = {module}:{target}\n")
        (tmp_path / f"{module}.py").write_text(example(page))
        monkeypatch.syspath_prepend(str(tmp_path))
        monkeypatch.delitem(sys.modules, module, raising=False)

    return build


def written(page, name, tmp_path):
    path = tmp_path / name
    path.write_text(example(page), encoding="utf-8")
    return path


def test_the_platform_of_the_page_bobs_as_its_equation_says(tmp_path):
    """Without noise, while the arm is lifted; against an integration of the same equation."""
    from scipy.integrate import solve_ivp

    path = written("platform-controller.md", "spring.py", tmp_path)
    spring = load_class(f"{path}:HeaveSpring", PlatformController)
    lift = {"arm.moves": [{"start": 0.3, "duration": 1.0, "to": [0.0, 1.2, 0.0]}]}
    scenario = vt.Scenario.load("beam_horizontal_truth", SHORT | lift)
    sim = vt.Simulator(FAST, scenario, controller=spring)
    sim.advance(3.0)
    time, signals = sim.recorder.sink.collect()
    force = -(signals["sensor.wrench"] - signals["gravity.estimate"])[:, 2]
    period = time[1] - time[0]

    def rate(t, y):  # the reading of a cycle is held
        held = force[min(int(t / period + 1e-9), len(force) - 1)]
        return [y[1], (held - 125.0 * y[1] - STIFFNESS * y[0]) / MASS]

    height = solve_ivp(rate, (0.0, time[-1]), [0.0, 0.0], t_eval=time, max_step=period / 4)
    commanded = signals["platform.command"][:, 2]
    assert np.ptp(commanded) > 5e-3  # 5 mm; it does bob
    two_cycles = 2.0 * np.max(np.abs(np.diff(commanded)))  # which cycle a reading counts for
    assert np.max(np.abs(commanded - height.y[0])) < two_cycles


@pytest.mark.slow
def test_the_controller_of_the_page_runs_from_the_command_line(tmp_path, capsys):
    path = written("platform-controller.md", "spring.py", tmp_path)
    words = ["run", "beam_horizontal_truth", "--controller", f"{path}:HeaveSpring", "--no-rrd"]
    words += ["--set", "run.duration=0.5", "--plant", "ves2_fast", "--out", str(tmp_path / "run")]
    assert main(words) == 0
    assert "HeaveSpring" in (tmp_path / "run" / "summary.json").read_text()
    capsys.readouterr()


def test_the_compensation_of_the_page_is_right_at_the_start_and_wrong_once_the_arm_moved(install):
    install("gravity-compensation.md")
    # a platform that stands: what differs is the arm alone
    still = {**SHORT, "platform": {"mode": "position"}, "gravity": {"method": "lumped"}}
    run = vt.simulate(vt.Scenario.load("beam_horizontal_truth", still), FAST)
    exact = vt.simulate(
        vt.Scenario.load("beam_horizontal_truth", still | {"gravity": {"method": "truth"}}), FAST
    )
    off = np.abs(run["gravity.estimate"] - exact["gravity.estimate"])
    at_start, at_end = run.time < 0.4, run.time > 2.6
    assert off[at_start].max() < 1.0  # N, N m of 919 N: the belief is right, the legs sag a little
    assert off[at_end, 3:5].max() > 50.0  # the arm's centre of mass went to the other side


def test_the_effect_of_the_page_scales_what_one_leg_reads(install):
    install("effect.md")
    plain, tilted = (
        vt.simulate(
            vt.Scenario.load("position_sine", {"run.duration": 1.0, "run.noise": False, **more}),
            FAST,
        )
        for more in ({}, {"effects.tilted_transducer.leg.3.angle": 0.1})
    )
    assert tilted.info.effects == {"tilted_transducer": {"leg.3": {"angle": 0.1}}}
    zero = vt.simulate(
        vt.Scenario.load(
            "position_sine",
            {"run.duration": 1.0, "run.noise": False, "effects.tilted_transducer.leg.3.angle": 0.0},
        ),
        FAST,
    )
    np.testing.assert_array_equal(zero["leg.length"], plain["leg.length"])
    slopes = []
    for run in (plain, tilted):
        true = np.array([FAST.geometry.lengths(pose)[2] for pose in run["truth.pose"]])
        slopes.append(np.polyfit(true, run["leg.length"][:, 2], 1)[0])
    assert slopes[0] == pytest.approx(1.0, abs=READ_LATE)
    assert slopes[1] == pytest.approx(np.cos(0.1), abs=READ_LATE)


def test_the_effect_on_any_machine_brakes_a_slide_and_an_arm(install, tmp_path):
    install("effect-on-any-machine.md")
    machine = rig(tmp_path, more='\n[[effects]]\nkind = "fan"\non = ["rail"]\n')
    forward = MjcfForward.of(machine)
    plain, braked = (forward.simulate(programme(), {"fan@rail:drag": d}) for d in (0.0, 20.0))
    assert np.abs(braked[:, 0]).max() < 0.9 * np.abs(plain[:, 0]).max()
    (fan,) = parse_effects({"fan": {"arm.q2": {"drag": 3.0}}})
    damping = [
        assemble(plant, 341e-6).compile().joint("arm/q2").damping[0]
        for plant in (FAST, FAST.extended(fan))
    ]
    assert damping[1] == pytest.approx(damping[0] + 3.0)


@pytest.mark.slow
def test_the_policy_of_the_page_follows_better_than_none(tmp_path):
    path = written("policy.md", "ahead.py", tmp_path)
    scores = [
        evaluate(Trial("PlatformTracking-v0", name, "none", "ves2_fast"), range(2))
        .figures["return"]
        .iqm
        for name in (f"{path}:Ahead", "still")
    ]
    assert scores[0] > 0.5 * scores[1] > scores[1]  # less than half of the loss is left


def test_every_kind_of_any_machine_stands_in_the_table_of_its_page():
    page = (PAGES.parent / "machine-file.md").read_text("utf-8")
    told = set(re.findall(r"`(\w+)`", page.partition("| kind of effect |")[2]))
    assert {name for name in EFFECTS.built_in if EFFECTS[name].anywhere} <= told
