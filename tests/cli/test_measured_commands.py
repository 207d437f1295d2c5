"""inspect, import, export, and an imported log through compare: as a laboratory would use them."""

import json

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.cli.main import main
from ves_twin.core.recording.files import load_recording, save_recording
from ves_twin.data.mapping.import_map import ImportMap
from ves_twin.machines.load import open_machine

SCENARIO = {
    "run.duration": 6.0,
    "plant": "ves2_fast",
    "arm.moves": [{"start": 0.5, "duration": 2.0, "to": [0.8, 0.4, 0.3]}],
}

AXES = ("Fx (N)", "Fy (N)", "Fz (N)", "Tx (Nm)", "Ty (Nm)", "Tz (Nm)")


def lab_columns(run):
    """The run as a bench would log it: mm and deg, its own names, a wrench of the other sign."""
    columns = {"Time (ms)": 1e3 * run.time + 5e4}
    columns |= {f"L{i + 1} cmd [mm]": 1e3 * run["leg.command"][:, i] for i in range(6)}
    columns |= {f"L{i + 1} [mm]": 1e3 * run["leg.length"][:, i] for i in range(6)}
    columns |= {f"q{i + 1}_cmd_deg": np.degrees(run["arm.command"][:, i]) for i in range(3)}
    columns |= {f"q{i + 1}_deg": np.degrees(run["arm.q"][:, i]) for i in range(3)}
    columns |= {name: -run["sensor.wrench"][:, i] for i, name in enumerate(AXES)}
    return columns | {f"grav_{n}": run["gravity.estimate"][:, i] for i, n in enumerate(AXES)}


@pytest.fixture(scope="module")
def run():
    return vt.simulate(vt.Scenario.load("identify_fast", SCENARIO), seed=3)


@pytest.fixture
def lab(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    columns = lab_columns(run)
    rows = zip(*columns.values(), strict=True)
    lines = ["# bench 3", ";".join(columns), *(";".join(f"{v:.9g}" for v in row) for row in rows)]
    (tmp_path / "lab.csv").write_text("\n".join(lines) + "\n")
    return tmp_path


def accept_guesses(path):
    """What a user does with a drafted map: read the guesses, take the right ones, say the signs."""
    lines, inside = [], False
    for line in path.read_text().splitlines():
        inside = line == "# [[channel]]" or (inside and line.startswith("#"))
        line = line.removeprefix("# ") if inside else line
        lines.append(line)
        if line.startswith('to = "sensor.wrench'):
            lines.append("sign = -1")
    path.write_text("\n".join(lines) + "\n")


@pytest.mark.slow
@pytest.mark.usefixtures("unpictured")
def test_a_log_of_a_bench_is_inspected_mapped_imported_and_compared(lab, capsys):
    assert main(["inspect", "lab.csv", "--draft-map", "--json"]) == 0
    seen = json.loads(capsys.readouterr().out)
    assert seen["tables"][0]["clock"]["rate"] == pytest.approx(79.26, abs=0.01)
    accept_guesses(lab / seen["map"])
    words = ["import", "lab.csv", "--map", seen["map"], "--out", "rec.parquet", "--json"]
    assert main(words) == 0
    account = json.loads(capsys.readouterr().out)
    assert account["suspected"] == account["checks"] == account["faults"] == []
    assert len(account["channels"]) == 30
    told = 'scenario = "identify_fast"\nplant = "ves2_fast"\n'
    (lab / "lab.toml").write_text(told)
    words = ["compare", "rec.parquet", "--experiment", "lab.toml", "--out", "cmp", "--json"]
    assert main(words) == 0
    (found,) = json.loads(capsys.readouterr().out)["recordings"]
    assert len(found["channels"]) == 15
    assert found["beyond_noise"] == []
    # the same with a sign left as the bench has it: not silently nothing
    wrong = (lab / seen["map"]).read_text().replace("sign = -1\n", "")
    (lab / "wrong.toml").write_text(wrong)
    assert main(["import", "lab.csv", "--map", "wrong.toml", "--out", "wrong.parquet"]) == 0
    capsys.readouterr()
    main(["compare", "wrong.parquet", "--experiment", "lab.toml", "--out", "cmp2", "--json"])
    (found,) = json.loads(capsys.readouterr().out)["recordings"]
    assert any(name.startswith("sensor.wrench") for name in found["beyond_noise"])


@pytest.mark.slow
@pytest.mark.usefixtures("unpictured")
def test_an_experiment_may_differ_by_recording(run, tmp_path, capsys):
    heavy = vt.Plant.load("ves2_fast").with_values({"arm.mass": [13.0, 22.4, 5.0, 2.0]})
    other = vt.simulate(vt.Scenario.load("identify_fast", SCENARIO), heavy, seed=5)
    for name, one in (("plain", run), ("heavy", other)):
        info = type(one.info)("measured")
        save_recording(vt.Recording(one.time, one.signals, info), tmp_path / f"{name}.parquet")
    told = tmp_path / "lab.toml"
    head = 'scenario = "identify_fast"\nplant = "ves2_fast"\ncompare = ["sensor.wrench"]\n'
    own = '[recordings.heavy.parameters]\n"arm.mass" = [13.0, 22.4, 5.0, 2.0]\n'
    files = [str(tmp_path / f"{name}.parquet") for name in ("plain", "heavy")]
    words = ["compare", *files, "--experiment", str(told), "--out", str(tmp_path / "out"), "--json"]
    loud = {}
    for text in (head, head + own):
        told.write_text(text)
        assert main(words) == 0
        recordings = json.loads(capsys.readouterr().out)["recordings"]
        loud[text] = [bool(r["beyond_noise"]) for r in recordings]
    assert loud == {head: [False, True], head + own: [False, False]}


def test_a_folder_of_a_run_is_inspected_and_exported(run, tmp_path, capsys):
    save_recording(run, tmp_path / "recording.parquet")
    assert main(["inspect", str(tmp_path)]) == 0
    assert "leg.length.6" in capsys.readouterr().out
    assert main(["export", str(tmp_path), "--out", str(tmp_path / "run.csv")]) == 0
    assert "run.csv.json" in capsys.readouterr().out
    assert len((tmp_path / "run.csv").read_text().splitlines()) == len(run) + 1


def test_an_edited_map_is_never_overwritten(lab, capsys):
    for name in ("lab.map.toml", "lab.map-2.toml"):
        assert main(["inspect", "lab.csv", "--draft-map"]) == 0
        assert capsys.readouterr().out.strip().endswith(name)


def test_start_and_end_cut_and_keep_what_they_say(lab, capsys):
    text = '[clock]\ncolumn = "Time (ms)"\n[[channel]]\nfrom = "L1 [mm]"\nto = "leg.length.1"\n'
    (lab / "m.toml").write_text("schema = 1\n" + text)
    words = ["import", "lab.csv", "--map", "m.toml", "--out", "sub/rec.parquet"]
    assert main([*words, "--start", "1", "--end", "2500 ms"]) == 0
    recording = load_recording(lab / "sub" / "rec.parquet")
    assert recording.time[-1] == pytest.approx(1.5, abs=0.013)
    assert recording.info.imported["zero"] == pytest.approx(51.0, abs=0.013)


def test_a_lab_file_of_ves_ii_is_read_by_its_map_as_its_import_is(lab):
    text = '[clock]\ncolumn = "Time (ms)"\n[[channel]]\nfrom = "L1 [mm]"\nto = "leg.length.1"\n'
    (lab / "m.toml").write_text("schema = 1\n" + text)
    assert main(["import", "lab.csv", "--map", "m.toml", "--out", "rec.parquet"]) == 0
    machine = open_machine("ves2_fast", ImportMap.load("m.toml"))
    read, imported = machine.read("lab.csv"), machine.read("rec.parquet")
    assert np.array_equal(read["leg.length"], imported["leg.length"], equal_nan=True)
    assert np.array_equal(read.time, imported.time)


def test_bad_input_gets_one_line_and_writes_nothing(lab, capsys):
    good = 'schema = 1\n[clock]\ncolumn = "Time (ms)"\n'
    channel = '[[channel]]\nfrom = "{}"\nto = "{}"\n'
    (lab / "good.toml").write_text(good + channel.format("L1 [mm]", "leg.length.1"))
    (lab / "typo.toml").write_text(good + channel.format("L1 [m]", "leg.length.1"))
    (lab / "lenght.toml").write_text(good + channel.format("L1 [mm]", "leg.lenght.1"))
    (lab / "old.toml").write_text(good.replace("1", "9"))
    (lab / "empty.csv").write_text("Time (ms);L1 [mm]\n")
    before = set(lab.iterdir())
    cases = [
        (["inspect", "no.csv"], "No such file"),
        (["inspect", "empty.csv"], "0 rows"),
        (["inspect", "lab.csv", "--draft-mpa"], "did you mean '--draft-map'"),
        (
            ["import", "lab.csv", "--map", "typo.toml", "--out", "r.parquet"],
            "did you mean 'L1 [mm]'",
        ),
        (["import", "lab.csv", "--map", "lenght.toml", "--out", "r.parquet"], "'leg.length.1'"),
        (["import", "lab.csv", "--map", "old.toml", "--out", "r.parquet"], "schema version 9"),
        (["import", "lab.csv", "--map", "no.toml", "--out", "r.parquet"], "no.toml"),
        (["import", "empty.csv", "--map", "good.toml", "--out", "r.parquet"], "0 rows"),
        (["import", "lab.csv", "--map", "good.toml", "--out", "r.csv"], ".parquet"),
        (
            ["import", "lab.csv", "--map", "good.toml", "--out", "r.parquet", "--start", "9"],
            "window",
        ),
        (
            ["import", "lab.csv", "--map", "good.toml", "--out", "r.parquet", "--start", "x"],
            "--start",
        ),
        (["import", "lab.csv", "--out", "r.parquet"], "--map"),
        (["export", "lab.csv", "--out", "r.csv"], "expected a Parquet recording"),
        (["export", "no.parquet", "--out", "r.csv"], "does not exist"),
    ]
    for words, says in cases:
        assert main(words) == 2, words
        out, err = capsys.readouterr()
        assert out == ""
        assert says in err, (words, err)
        assert err.count("\n") == 1
    assert set(lab.iterdir()) == before
