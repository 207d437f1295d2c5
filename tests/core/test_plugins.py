"""Installed packages add controllers by entry points; clashes and broken ones are one clear line."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.cli.main import main
from ves_twin.control.registry import GRAVITY_COMPENSATIONS, PLATFORM_CONTROLLERS
from ves_twin.core.errors import PluginError, UnknownNameError, VesTwinError
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.outcome import Outcome
from ves_twin.thesis.claim import load_claims
from ves_twin.thesis.context import Context
from ves_twin.thesis.evaluators.registry import ANSWERS

SHORT = {"run.duration": 0.3, "run.settle": 0.3}
HEAVE = '''
import numpy as np
from ves_twin.control.controller import PlatformController


class Heave(PlatformController):
    """Heaves by a centimetre with 1 Hz."""

    def __init__(self, start):
        self.start = start

    @classmethod
    def build(cls, task):
        return cls(task.start)

    def update(self, time, readings):
        return self.start + np.array([0.0, 0.0, 0.01 * np.sin(2 * np.pi * time), 0.0, 0.0, 0.0])

    def snapshot(self):
        return None

    def restore(self, snapshot):
        pass


class Unfinished(PlatformController):
    pass


number = 3
'''


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Make a distribution importable: `install(package, {group: {name: target}}, module source)`."""

    def build(package, groups, source=HEAVE):
        site = tmp_path / package
        info = site / f"{package}-1.2.dist-info"
        info.mkdir(parents=True)
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.2\n")
        lines = []
        for group, points in groups.items():
            lines += [f"[{group}]", *(f"{name} = {target}" for name, target in points.items())]
        (info / "entry_points.txt").write_text("\n".join(lines) + "\n")
        (site / f"{package}.py").write_text(source)
        monkeypatch.syspath_prepend(str(site))
        monkeypatch.delitem(sys.modules, package, raising=False)

    return build


@pytest.fixture(autouse=True)
def forget():
    before = set(sys.modules)
    yield
    for name in set(sys.modules) - before:
        if name.startswith("bobbing"):
            del sys.modules[name]


def heave_scenario(**changes):
    return vt.Scenario.load("position_sine", {**SHORT, "platform.mode": "bobbing", **changes})


def test_a_controller_of_an_installed_package_runs_a_scenario(install):
    install("bobbing", {"ves_twin.controllers": {"bobbing": "bobbing:Heave"}})
    assert "bobbing" in PLATFORM_CONTROLLERS
    assert "bobbing" not in sys.modules  # loaded only when it is named
    run = vt.simulate(heave_scenario())
    expected = 0.01 * np.sin(2 * np.pi * run.time)[:, None] * np.eye(6)[2]
    assert run.info.outcome == "completed"
    np.testing.assert_allclose(run["platform.command"], expected, rtol=0, atol=1e-12)


def test_such_a_controller_is_held_against_the_zero_g_reference_if_it_emulates(install):
    install("bobbing", {"ves_twin.controllers": {"bobbing": "bobbing:Heave"}})
    assert "reference.pose" not in vt.simulate(heave_scenario()).signals
    run = vt.simulate(heave_scenario(**{"platform.emulated": "table_5_2"}))
    assert "reference.pose" in run.signals


def test_a_gravity_compensation_of_an_installed_package_is_found(install):
    source = "from ves_twin.control.gravity import NoCompensation\nmake = lambda port: NoCompensation()\n"
    install("bobbing", {"ves_twin.gravity": {"bobbing": "bobbing:make"}}, source)
    assert not GRAVITY_COMPENSATIONS["bobbing"](None).subtracts


def test_a_package_that_is_not_installed_is_an_unknown_mode():
    with pytest.raises(VesTwinError, match="unknown mode 'bobbing'"):
        heave_scenario()
    with pytest.raises(UnknownNameError, match="did you mean 'position'"):
        PLATFORM_CONTROLLERS["positon"]


def test_built_in_names_need_no_package():
    assert PLATFORM_CONTROLLERS.built_in == ("position", "admittance", "micro_gravity")
    assert [n for n in PLATFORM_CONTROLLERS if n in PLATFORM_CONTROLLERS.built_in] == list(
        PLATFORM_CONTROLLERS.built_in
    )


@pytest.mark.parametrize("name", ["position", "bobbing"])
def test_a_name_that_two_sides_claim_is_refused(install, name):
    install("bobbing", {"ves_twin.controllers": {name: "bobbing:Heave"}})
    if name == "bobbing":
        install("bobbing_too", {"ves_twin.controllers": {name: "bobbing_too:Heave"}})
    with pytest.raises(PluginError, match=f"'{name}' is claimed by .* and by bobbing") as caught:
        PLATFORM_CONTROLLERS[name]
    assert "\n" not in str(caught.value)
    assert list(PLATFORM_CONTROLLERS).count(name) == 1


@pytest.mark.parametrize(
    ("target", "source", "words"),
    [
        ("bobbing:Heave", "import no_such_module", "ModuleNotFoundError: No module named"),
        ("bobbing:Heave", "def (", "SyntaxError"),
        ("bobbing:Heave", "raise RuntimeError('two\\nlines')", "RuntimeError: two lines"),
        ("bobbing:Nothing", HEAVE, "AttributeError"),
        ("bobbing:number", HEAVE, "is not a class derived from PlatformController"),
        ("bobbing:Unfinished", HEAVE, "lacks build, restore, snapshot, update"),
    ],
)
def test_a_broken_plugin_is_one_clear_line(install, target, source, words):
    install("bobbing", {"ves_twin.controllers": {"bobbing": target}}, source)
    with pytest.raises(PluginError) as caught:
        vt.Simulator(None, heave_scenario())
    assert words in str(caught.value)
    assert "bobbing 1.2" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_command_line_ends_with_code_2_on_a_broken_plugin(install, tmp_path, capsys):
    install("bobbing", {"ves_twin.controllers": {"bobbing": "bobbing:number"}})
    words = ["run", "position_sine", "--set", "platform.mode=bobbing", "--out", str(tmp_path)]
    assert main(words) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_info_names_the_packages_without_loading_them(install, capsys):
    install("bobbing", {"ves_twin.controllers": {"bobbing": "bobbing:Heave"}}, "def (")
    assert main(["info"]) == 0
    assert "ves_twin.controllers: bobbing  bobbing 1.2 (bobbing:Heave)" in capsys.readouterr().out


STICKY = '''
from dataclasses import dataclass
from typing import ClassVar

from ves_twin.effects.effect import LEGS, Effect
from ves_twin.effects.magnitude import Magnitude


@dataclass(frozen=True)
class Sticky(Effect):
    """A leg transducer reads too long."""

    length: float = 0.0

    kind: ClassVar[str] = "sticky"
    targets: ClassVar[tuple[str, ...]] = LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("length", "m", 0.0, 1e-3, 0.1),)
    channels: ClassVar[tuple[str, ...]] = ("leg.length",)
    source: ClassVar[str] = "a test"

    def edit_loop(self, parameters):
        parameters["transducer"]["home"][self.index] += self.length


class Vague(Effect):
    pass
'''


def test_an_installed_effect_acts_like_a_built_in_one(install):
    install("bobbing", {"ves_twin.effects": {"sticky": "bobbing:Sticky"}}, STICKY)
    changes = SHORT | {"run.noise": False}
    plain = vt.simulate(vt.Scenario.load("position_sine", changes))
    key = {"effects.sticky.leg.2.length": 0.002}
    moved = vt.simulate(vt.Scenario.load("position_sine", changes | key))
    assert moved.info.effects == {"sticky": {"leg.2": {"length": 0.002}}}
    assert np.abs(moved["truth.pose"] - plain["truth.pose"]).max() > 1e-4


def test_an_installed_effect_that_declares_nothing_is_one_line(install):
    install("bobbing_vague", {"ves_twin.effects": {"vague": "bobbing_vague:Vague"}}, STICKY)
    with pytest.raises(PluginError, match=r"'vague' of bobbing_vague 1\.2 .* lacks kind, targets"):
        vt.Simulator(None, vt.Scenario.load("position_sine", {"effects.vague.rig.x": 1.0}), 0)


def test_the_modes_of_the_thesis_are_asked_for_without_those_of_plugins(install):
    install("other_lab", {"ves_twin.controllers": {"heave": "other_lab:Heave"}})
    asked = []

    class Asked(Context):
        def run(self, scenario, changes=None):
            asked.append(Scenario.load(scenario, changes).platform.mode)
            info = SimpleNamespace(outcome=Outcome.COMPLETED)
            return SimpleNamespace(recording=SimpleNamespace(info=info), command=scenario)

    found = ANSWERS["C002"](Asked(vt.Plant.load("ves2")), load_claims()["C002"])
    assert "heave" in PLATFORM_CONTROLLERS
    assert found.holds
    assert asked == ["position", "admittance", "micro_gravity"]
