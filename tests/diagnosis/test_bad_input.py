"""Bad input of a diagnosis: clear words, and never a confident wrong name."""

from dataclasses import replace

import numpy as np
import pytest
from toy import PERIOD, SD, Toy, programme, record

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.bank.signature_library import build_bank
from ves_twin.diagnosis.bank.slices import of_channels, of_recording, of_time
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.model.grid import AnalysisGrid
from ves_twin.diagnosis.record import preprocess
from ves_twin.diagnosis.record.likeness import check_likeness
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Kind
from ves_twin.report.diagnosis.answer import headline
from ves_twin.report.diagnosis.limits import limit_sentences
from ves_twin.report.diagnosis.words import alone_sentences

FRICTION = {"friction.size": 0.03}


@pytest.fixture(scope="module")
def settings(banks):
    return Settings(nulls=60, cache=banks)


def with_out(data, values):
    return Recording(data.time, {**data.signals, "out": values}, data.info)


def holed(data):
    values = data["out"].copy()
    values[100:190, 0] = np.nan
    values[400, 1] = np.nan
    return with_out(data, values)


def test_holes_are_left_out_and_told_and_the_cause_is_still_named(settings):
    data = record(np.random.default_rng(1), FRICTION)
    v = diagnose(Toy(), [holed(data)], settings=settings)
    assert (v.verdict, v.causes[0].effect) == (Kind.NAMED, "friction")
    assert v.holes == pytest.approx({"out.0": 90 / 800, "out.1": 1 / 800})
    whole = diagnose(Toy(), [data], settings=settings).causes[0].parameters["friction.size"]
    size = v.causes[0].parameters["friction.size"]
    assert abs(size.value - whole.value) < whole.high - whole.low
    assert size.high - size.low > 0.99 * (whole.high - whole.low)  # less data tells no more
    shown = v.exhibit.traces[0].measured
    assert np.isnan(shown[100:190, 0]).all()
    assert np.isfinite(shown[:, 1]).sum() == 799


@pytest.mark.slow
def test_rigs_in_order_with_holes_are_left_in_peace(settings):
    said = [
        diagnose(Toy(), [holed(record(np.random.default_rng(s)))], settings=settings).verdict
        for s in range(40)
    ]
    # alpha is 0.2 % for each threshold: 2 of 40 has a probability of 1 %
    assert sum(kind is not Kind.NOTHING for kind in said) <= 1


def test_what_is_drawn_across_a_hole_does_not_matter(settings, monkeypatch):
    data = holed(record(np.random.default_rng(2), FRICTION))
    clean = diagnose(Toy(), [data], settings=settings)
    monkeypatch.setattr(preprocess, "_bridged", lambda rows: np.where(np.isfinite(rows), rows, 9.0))
    assert diagnose(Toy(), [data], settings=settings).to_dict() == clean.to_dict()


def test_rows_of_the_grid_that_a_hole_touches_are_marked():
    grid = AnalysisGrid.of(0.002)
    rows = np.zeros((1000, 1), dtype=bool)
    rows[500] = True
    values = np.zeros((1000, 1))
    values[500] = 1.0
    marked = grid.touched(rows)[:, 0]
    untouched = np.abs(grid.reduce(values)[:, 0]) < 1e-12  # round-off of the transform
    assert np.all(marked | untouched)
    assert marked.sum() <= 10 + 1  # taps over the rows of one row of the grid


def test_an_empty_channel_counts_as_not_recorded(settings):
    data = record(np.random.default_rng(1), FRICTION)
    values = data["out"].copy()
    values[:500, 1] = np.nan
    v = diagnose(Toy(), [with_out(data, values)], settings=settings)
    assert v.unseen == ("out.1",)


def dropping(data, share, channels, seed=0):
    """Every value lost with a probability of its own."""
    values = data["out"].copy()
    lost = np.random.default_rng(seed).random(values.shape) < share
    lost[:, [c for c in range(2) if c not in channels]] = False
    values[lost] = np.nan
    return with_out(data, values)


def test_a_channel_that_drops_out_all_over_counts_as_not_recorded(settings):
    data = record(np.random.default_rng(1), FRICTION)
    v = diagnose(Toy(), [dropping(data, 0.25, (0,))], settings=settings)
    assert v.unseen == ("out.0",)  # a quarter of 800 rows, and none of 10 in a row without a hole
    assert v.holes["out.0"] == pytest.approx(0.25, abs=0.05)
    assert (v.verdict, v.causes[0].effect) == (Kind.NAMED, "friction")
    assert any("holes all over" in said for said in limit_sentences(v))


def test_channels_that_all_drop_out_are_refused(settings):
    data = record(np.random.default_rng(1), FRICTION)
    with pytest.raises(InvalidInputError, match="samples between the holes"):
        diagnose(Toy(), [dropping(data, 0.25, (0, 1))], settings=settings)


def test_a_standstill_that_mixes_channels_with_holes_side_by_side_is_refused(settings):
    data, still = record(np.random.default_rng(1)), np.zeros((3000, 2))
    still += np.random.default_rng(2).standard_normal(still.shape) * SD
    time, info = PERIOD * np.arange(len(still)), RecordingInfo("measured")
    standstill = Recording(time, {"drive.u": 0.0 * still[:, :1], "out": still}, info)
    values = data["out"].copy()
    values[5:400:10, 0] = np.nan
    values[405::10, 1] = np.nan
    holed = with_out(data, values)
    diagnose(Toy(), [holed], settings=settings)
    with pytest.raises(InvalidInputError, match="holes of all channels"):
        diagnose(Toy(), [holed], standstill=standstill, settings=settings)


def test_too_few_rigs_in_order_are_refused_and_not_dropped_without_a_word(settings):
    rigs = [record(np.random.default_rng(s)) for s in range(3)]
    with pytest.raises(InvalidInputError, match=r"commissioned rigs.*3.*at least 5"):
        diagnose(Toy(), rigs[:1], commissioning=rigs, settings=settings)


def test_set_points_with_holes_are_refused(settings):
    data = record(np.random.default_rng(1))
    fed = data["drive.u"].copy()
    fed[3] = np.nan
    broken = Recording(data.time, {**data.signals, "drive.u": fed}, data.info)
    with pytest.raises(InvalidInputError, match=r"drive\.u of recording 1.*set-points"):
        diagnose(Toy(), [broken], settings=settings)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda x: x[:, ::-1], "columns look swapped"),
        (lambda x: x * [-1.0, 1.0], "the other sign"),
    ],
)
def test_columns_that_are_swapped_or_turned_are_refused_by_name(settings, change, words):
    data = record(np.random.default_rng(1), FRICTION, plant=Apart())
    with pytest.raises(InvalidInputError, match=words):
        diagnose(Apart(), [with_out(data, change(data["out"]))], settings=settings)
    assert diagnose(Apart(), [data], settings=settings).causes[0].effect == "friction"


class Apart(Toy):
    """The second channel is the drive half a second late, so that the two are no copies."""

    @property
    def identity(self):
        return f"apart {super().identity}"

    def simulate(self, programme, values, refined=False):
        rows = super().simulate(programme, values, refined)
        u = programme.drive["drive.u"][:, 0]
        gain = dict(values).get("plant.gain", 1.0)
        rows[:, 1] += gain * (np.roll(u, 50) - u)
        return rows


def test_without_excitation_nothing_can_be_said_about_what_it_would_show(settings):
    still = Excitation("still", programme().time, {"drive.u": 0 * programme().drive["drive.u"]})
    data = record(np.random.default_rng(1), FRICTION, fed=still)
    v = diagnose(Toy(), [data], settings=settings)
    assert v.verdict is Kind.NOTHING
    for cause in ("friction", "lag", "gain"):
        assert v.smallest_findable[f"{cause}@plant"].value is None
    assert "This recording can say nothing about" in headline(v)


def test_a_recording_of_another_plant_gets_no_name(settings):
    u = programme().drive["drive.u"][:, 0]
    other = np.column_stack([np.roll(np.abs(u), 80), np.cumsum(u) * 0.01])
    data = record(np.random.default_rng(1))
    v = diagnose(Toy(), [with_out(data, other)], settings=settings)
    assert (v.verdict, v.causes) == (Kind.UNKNOWN, ())
    assert "hardly looks like one of this machine" in headline(v)


@pytest.mark.slow
def test_recordings_that_contradict_one_another_are_told_apart(settings):
    one = record(np.random.default_rng(1), FRICTION, spread=0.0)
    two = record(np.random.default_rng(2), {"bump.size": 0.1}, spread=0.0, fed=programme(5))
    three = record(np.random.default_rng(3), {"friction.size": -0.03}, spread=0.0, fed=programme(5))
    v = diagnose(Toy(), [one, three], settings=settings)
    assert (v.verdict, v.causes) == (Kind.UNKNOWN, ())
    assert headline(v).startswith("These recordings do not agree")
    assert [a.causes for a in v.alone] == [("friction@plant",)] * 2
    assert v.alone[0].sizes[0][0] == pytest.approx(0.03, abs=0.005)
    assert v.alone[1].sizes[0][0] == pytest.approx(-0.03, abs=0.005)
    assert "friction at plant, 0.0" in alone_sentences(v)[0]
    # one rig with two causes, each seen by both recordings, is no contradiction
    both = {**FRICTION, "bump.size": 0.1}
    pair = [record(np.random.default_rng(k), both, spread=0.0, fed=programme(k)) for k in (1, 5)]
    assert diagnose(Toy(), pair, settings=settings).verdict is Kind.SEVERAL
    v = diagnose(Toy(), [one, two], settings=settings)
    assert v.verdict is not Kind.NAMED


def test_a_part_of_a_bank_is_the_bank_of_the_part():
    feeds = (programme(1), programme(5))
    whole = build_bank(Runs(Toy(), feeds, (0, 1)))
    single = build_bank(Runs(Toy(), feeds[:1], (0, 1)))
    short = feeds[0].time[:400]
    cut = Excitation("cut", short, {"drive.u": feeds[0].drive["drive.u"][:400]})
    parts = (
        (of_recording(whole, 1), build_bank(Runs(Toy(), feeds[1:], (0, 1)))),
        (of_channels(single, (1,)), build_bank(Runs(Toy(), feeds[:1], (1,)))),
        (of_time(single, 399 * 0.01), build_bank(Runs(Ended(), (cut,), (0, 1)))),
    )
    for part, own in parts:
        assert part.base.runs.programmes[0].identity == own.base.runs.programmes[0].identity
        rows = slice(None, -2)  # the toy's lag looks two rows ahead
        for entry in range(len(own.owner)):
            there = own.signature(entry)[rows]
            assert part.signature(entry)[rows] == pytest.approx(there, abs=1e-6)
        assert [*part.owner] == [*own.owner]
        assert part.base.columns[:, rows] == pytest.approx(own.base.columns[:, rows], abs=1e-6)
        assert [*part.base.runs.sd] == [*own.base.runs.sd]


class Ended(Toy):
    """Its drift is that of the whole programme though only the first half is simulated."""

    def simulate(self, programme_, values, refined=False):
        whole = programme()
        return super().simulate(whole, values, refined)[: len(programme_.time)]


def test_a_small_column_that_moves_against_a_wrong_model_is_no_turned_one():
    data = record(np.random.default_rng(1))
    seen = preprocess.preprocess(Toy(), [with_out(data, data["out"] * [-0.05, 1.0])])
    check_likeness(seen, seen.runs.one(seen.runs.origin))
    turned = preprocess.preprocess(Toy(), [with_out(data, data["out"] * [-0.5, 1.0])])
    with pytest.raises(InvalidInputError, match="the other sign"):
        check_likeness(turned, turned.runs.one(turned.runs.origin))


def test_a_turned_column_is_told_with_the_offset_beside():
    data = record(np.random.default_rng(1))
    turned = preprocess.preprocess(Toy(), [with_out(data, data["out"] * [-0.5, 1.0] + [0.7, 0.0])])
    with pytest.raises(InvalidInputError, match=r"-0\.50\d times it, and 0\.69 beside"):
        check_likeness(turned, turned.runs.one(turned.runs.origin))


def test_a_column_that_drifts_the_other_way_is_no_turned_one():
    """A slope of a table turns the way of a sled on air round, and not the sensor of it."""
    data = record(np.random.default_rng(1))
    seen = preprocess.preprocess(Toy(), [data])
    way = np.linspace(0.0, 5.0, len(seen.measured))[:, None] ** 2 * [1.0, 0.0]
    nominal = seen.runs.one(seen.runs.origin)
    drifted = replace(seen, measured=(seen.measured - way).astype(np.float32))
    check_likeness(drifted, (nominal + way).astype(np.float32))
    turned = replace(seen, measured=((seen.measured * [-1.0, 1.0]) - way).astype(np.float32))
    with pytest.raises(InvalidInputError, match="the other sign"):
        check_likeness(turned, (nominal + way).astype(np.float32))


def test_what_looks_odd_in_one_of_three_recordings_alone_is_let_through():
    data = record(np.random.default_rng(1))
    turned = with_out(data, data["out"] * [-0.5, 1.0])
    few = preprocess.preprocess(Toy(), [data, data, turned])
    check_likeness(few, few.runs.one(few.runs.origin))
    most = preprocess.preprocess(Toy(), [data, turned, turned])
    with pytest.raises(InvalidInputError, match="the other sign"):
        check_likeness(most, most.runs.one(most.runs.origin))


def test_a_held_out_recording_that_is_too_short_is_refused_before_anything_is_simulated(settings):
    """After 82 s of a measured flexible link before."""

    class Counted(Toy):
        runs = 0

        def simulate(self, *given, **named):
            Counted.runs += 1
            return super().simulate(*given, **named)

    data = record(np.random.default_rng(1), FRICTION)
    short = Recording(data.time[:60], {n: v[:60] for n, v in data.signals.items()}, data.info)
    with pytest.raises(InvalidInputError, match="got 60, expected at least 100"):
        diagnose(Counted(), [data], held_out=[short], settings=settings)
    assert Counted.runs == 0
