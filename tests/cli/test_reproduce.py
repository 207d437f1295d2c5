"""reproduce: what it prints, what it writes, and one line for whatever is wrong."""

import json

import pytest

from ves_twin.cli.main import main
from ves_twin.thesis.claim import load_claims
from ves_twin.thesis.evaluation import Evaluation
from ves_twin.thesis.evaluators import registry
from ves_twin.thesis.figures import registry as figures
from ves_twin.thesis.figures.figure import FigureResult


@pytest.fixture
def quick_answers(monkeypatch):
    """Every claim answered at once by a number, so that the command can be tested as a whole."""
    answers = dict.fromkeys(load_claims(), lambda context, claim: Evaluation((6.0,), note="n"))
    monkeypatch.setattr(registry, "ANSWERS", answers)


@pytest.fixture
def one_figure(monkeypatch):
    def draw(plant, folder, quick):
        path = folder / "fig-5-99.png"
        path.write_bytes(b"png")
        return FigureResult("fig-5-99", "a figure", path, {"peak dB": 1.5}, ("look here",))

    monkeypatch.setitem(figures.FIGURES, "fig-5-99", draw)


def test_json_lists_every_claim_and_nothing_else(capsys, quick_answers):
    assert main(["reproduce", "--quick", "--json", "--no-cache"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert len(content["rows"]) == 132
    assert {"verdict", "twin", "thesis", "unit", "tolerance", "command", "figure"} <= set(
        content["rows"][0]
    )
    assert {"calibrated_on", "errata", "leave_one_out", "counts"} <= set(content["rows"][0])
    assert content["plant_hash"]


def test_the_score_comes_before_the_chapters(capsys, quick_answers):
    assert main(["reproduce", "--no-cache"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "neither inputs nor were used in calibration" in lines[1]
    assert "Chapter 2" in lines


def test_a_folder_gets_page_and_json(capsys, tmp_path, quick_answers):
    assert main(["reproduce", "--no-cache", "--out", str(tmp_path)]) == 0
    assert {p.name for p in tmp_path.iterdir()} == {"scorecard.json", "thesis-scorecard.md"}
    assert len(json.loads((tmp_path / "scorecard.json").read_text())["rows"]) == 132
    assert (tmp_path / "thesis-scorecard.md").read_text().startswith("# Scorecard")


def test_one_claim_is_told_in_full(capsys):
    assert main(["reproduce", "c060", "C129", "--no-cache"]) == 0
    out = capsys.readouterr().out
    assert "C060" in out
    assert "93.4 kg (corrected 93.7, E-27)" in out
    assert "ves-twin reproduce C129" in out


def test_another_plant_is_held_against_the_thesis(capsys, tmp_path):
    plant = tmp_path / "soft.toml"
    plant.write_text(
        'schema = 1\nname = "soft"\nbase = "ves2"\n[parameters]\n"sensor.corner" = 25.0\n'
    )
    assert main(["reproduce", "C129", "--plant", str(plant), "--no-cache", "--json"]) == 0
    row = json.loads(capsys.readouterr().out)["rows"][0]
    assert row["verdict"] == "differs"
    assert row["twin"] == [pytest.approx(25.0, rel=0.01)]


def test_a_figure_is_drawn_with_its_numbers(capsys, tmp_path, one_figure):
    assert main(["reproduce", "fig-5-99", "--out", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert "peak dB" in out
    assert "look here" in out
    assert (tmp_path / "fig-5-99.png").exists()
    assert main(["reproduce", "fig-5-99", "--json", "--out", str(tmp_path)]) == 0
    assert json.loads(capsys.readouterr().out)["figures"][0]["numbers"] == {"peak dB": 1.5}


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["C0722"], "did you mean 'C072'"),
        (["fig-5-999"], "did you mean 'fig-5-99'"),
        (["C072", "--plant", "ves3"], "did you mean 'ves2'"),
        (["--models", "right"], "thesis"),
        (["--qick"], "did you mean '--quick'"),
        (["C060", "--out", "/dev/null/x"], "cannot write"),
    ],
)
def test_bad_input_is_one_line_and_exit_2(capsys, one_figure, arguments, says):
    assert main(["reproduce", *arguments]) == 2
    captured = capsys.readouterr()
    assert says in captured.err
    assert len(captured.err.strip().splitlines()) == 1
    assert captured.out == ""
