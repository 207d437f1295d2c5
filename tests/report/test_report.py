"""The page of a verdict: what stands on it, and that it is never surer than its basis."""

import re
from dataclasses import replace
from html import escape

import numpy as np
import pytest
from matplotlib.text import Text
from rerun.chunk import RrdReader
from toy import Toy, programme, record

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.quantity import shares
from ves_twin.data.quality.check import Check, Grade, failed
from ves_twin.diagnosis.bank.envelope import ENVELOPE_SD
from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.build_up.result import Inseparable, Left, Proved, Size
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.experiment.aliases import Lookalike
from ves_twin.diagnosis.experiment.next_experiment import separations
from ves_twin.diagnosis.explain.rivals import Standing
from ves_twin.diagnosis.fit.refine import refine
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.preprocess import preprocess
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.diagnosis.verdict.cause import Estimate
from ves_twin.diagnosis.verdict.refusal import refusal
from ves_twin.diagnosis.verdict.verdict import ChannelError, Kind
from ves_twin.report.diagnosis.answer import headline, next_step, suspect_words, tone
from ves_twin.report.diagnosis.basis import basis_sentences, gain_words, taken_words
from ves_twin.report.diagnosis.credibility import Pedigree, credibility
from ves_twin.report.diagnosis.limits import limit_sentences
from ves_twin.report.diagnosis.page import diagnosis_page
from ves_twin.report.diagnosis.pictures import answer_figure
from ves_twin.report.diagnosis.proved import FEW, inseparable_lines, near_sentence
from ves_twin.report.diagnosis.words import interval_words, size_words, spoken
from ves_twin.report.html import Html, markup
from ves_twin.report.rerun.diagnosis import (
    diagnosis_blueprint,
    onset_of,
    write_diagnosis_rrd,
)

HELD = programme(9)


@pytest.fixture(scope="module")
def settings(banks):
    return Settings(nulls=60, cache=banks)


def said(settings, sizes, seed=51, spread=0.0, **options):
    data = record(np.random.default_rng(seed), sizes, spread=spread)
    return diagnose(Toy(), [data], settings=settings, **options)


@pytest.fixture(scope="module")
def friction(settings):
    return said(settings, {"friction.size": 0.1})


@pytest.fixture(scope="module")
def proven(settings):
    held = record(np.random.default_rng(50), {"friction.size": 0.1}, spread=0.0, fed=HELD)
    return said(settings, {"friction.size": 0.1}, held_out=[held])


@pytest.fixture(scope="module")
def proven_page(proven):
    return diagnosis_page(proven, "Diagnosis of <run>", "The plant is plant.toml.")


@pytest.fixture
def undrawn(monkeypatch):
    """Pictures of their words alone, for tests of words: drawing takes most of a page's time."""

    def spelled(figure, name, caption):
        told = " ".join(text.get_text() for text in figure.findobj(Text))
        return Html(f"<figure>{escape(told)}<figcaption>{markup(caption)}</figcaption></figure>")

    monkeypatch.setattr("ves_twin.report.diagnosis.pictures.svg", spelled)


def first_screen(page):
    return words_of(page[page.index("<h1>") : page.index("<section>")])


def words_of(page):
    """A span is within a line, any other tag ends one."""
    return re.sub(r"<[^>]*>", " ", re.sub(r"</?span[^>]*>", "", page))


def second_screen(page):
    """The figures behind the first one."""
    return words_of(page.split("<section>")[1])


def test_the_first_screen_says_what_was_found_how_sure_what_next_and_on_what_it_rests(
    proven, proven_page
):
    page = proven_page
    top = first_screen(page)
    assert "Diagnosis of &lt;run&gt;" in top
    size = proven.causes[0].parameters["friction.size"]
    (told,) = re.findall(r"Found: friction at plant, ([\d.]+)\.", top)
    assert float(told) == pytest.approx(size.value, abs=(size.high - size.low) / 20)
    share = shares(proven.gain.share, proven.gain.low, proven.gain.high)[0]
    assert f"Held-out recordings confirm it: there it takes {share} of the error" in top
    assert "What next. Look at friction at plant on the machine" in " ".join(top.split())
    assert "declared tolerances and held-out recordings; a recording of this machine" in top
    assert page.index("<figure>") < page.index("<section>")  # one picture


def test_the_figures_behind_it_have_size_interval_gain_and_basis(proven, proven_page):
    top = second_screen(proven_page)
    size = proven.causes[0].parameters["friction.size"]
    ends = re.search(r"([-\d.e]+) to ([-\d.e]+)", top)
    width = size.high - size.low  # of which the printed digits show a tenth
    assert [float(end) for end in ends.groups()] == pytest.approx(
        [size.low, size.high], abs=width / 20
    )
    numbers = [float(number) for number in re.findall(r"-?\d+\.\d+", top)]
    assert any(number == pytest.approx(size.value, abs=width / 20) for number in numbers)
    assert f"{shares(proven.gain.share, proven.gain.low, proven.gain.high)[0]} of the error" in top
    assert "declared, not measured" in top


@pytest.mark.usefixtures("undrawn")
def test_without_held_out_data_the_first_screen_says_so_and_is_no_surer(friction):
    top = first_screen(diagnosis_page(friction))
    assert "Best explained by friction at plant" in top
    assert "no other recording has tested it" in top
    assert "a held-out recording or a recording of this machine in order was not given" in top
    assert "Record another programme on the same machine and give it as --held-out." in top
    assert "Found" not in top
    assert tone(friction) == "open"


def test_a_gain_that_is_not_clear_takes_the_word_found_away(proven):
    assert tone(proven) == "bad"
    doubtful = replace(proven, gain=Gain(0.5, -0.1, 1.1, 2.0, 1.5))
    assert "do not confirm it" in headline(doubtful)
    assert tone(doubtful) == "open"
    repaired = replace(proven, gain=Gain(0.6, 0.4, 0.8, 2.0, 1.4, without=1.02))
    assert "better without it" in headline(repaired)
    assert "lack it" in refusal(repaired)
    assert tone(repaired) == "open"
    blind = replace(proven, gain=Gain(None, None, None, 1.01, 1.0))
    assert "neither confirm nor refute it" in headline(blind)
    assert tone(blind) == "open"
    loose = replace(proven, causes=(replace(proven.causes[0], firm=False, sigmas=4.2),))
    assert "4.2 declared tolerances off" in headline(loose)
    assert "Found" not in headline(loose)


@pytest.mark.usefixtures("undrawn")
def test_nothing_is_good_news_only_as_far_as_the_recording_can_show(settings):
    nothing = said(settings, {}, seed=1)
    assert nothing.verdict is Kind.NOTHING
    assert (tone(nothing), "Nothing found" in headline(nothing)) == ("good", True)
    blind = {k: replace(f, value=None) for k, f in nothing.smallest_findable.items()}
    assert headline(replace(nothing, smallest_findable=blind)).startswith("Nothing can be said")
    some = {**nothing.smallest_findable, "friction@plant": blind["friction@plant"]}
    assert "nothing about 1 of 6 causes" in headline(replace(nothing, smallest_findable=some))
    assert tone(replace(nothing, smallest_findable=some)) == "open"
    page = diagnosis_page(replace(nothing, smallest_findable=some))
    assert "Nothing can be said about: friction at plant." in page


def test_every_rival_has_a_reason(friction):
    standings = [rival.standing for rival in friction.rivals]
    assert standings[0] is Standing.KEPT
    assert friction.rivals[0].behind == 0.0
    assert Standing.LOST in standings
    assert {name for rival in friction.rivals for name in rival.causes} >= {
        "friction@plant",
        "lag@plant",
    }
    for rival in friction.rivals[1:]:
        lost_by_data = rival.place is not None and rival.place.rival > rival.place.best
        assert rival.standing is not Standing.LOST or lost_by_data or rival.pull > 3.0


@pytest.mark.usefixtures("undrawn")
def test_a_pair_tells_what_each_alone_would_leave(settings):
    pair = said(settings, {"friction.size": 0.02, "bump.size": -0.15})
    assert pair.verdict is Kind.SEVERAL
    alone = [r for r in pair.rivals if r.standing is Standing.ALONE]
    assert {("friction@plant",), ("bump@plant",)} <= {r.causes for r in alone}
    assert all(r.behind > 0.0 for r in alone)
    assert "alone it leaves" in diagnosis_page(pair)


@pytest.mark.usefixtures("undrawn")
def test_an_unknown_shows_the_nearest_and_does_not_accept_it(settings):
    u = HELD.drive["drive.u"][:, 0]
    data = record(np.random.default_rng(3), added=(u**3)[:, None] * [0.02, 0.0], fed=HELD)
    verdict = diagnose(Toy(), [data], settings=settings)
    assert verdict.verdict is Kind.UNKNOWN
    page = diagnosis_page(verdict)
    top = first_screen(page)
    assert "no cause in the library explains" in top
    assert "Nearest, and not accepted" in second_screen(page)
    assert "nearest cause" in top
    assert suspect_words(verdict).startswith("Nearest, and not accepted: ")
    assert suspect_words(replace(verdict, suspect="")) == ""
    near = verdict.nearest[0]
    assert size_words(next(iter(near.parameters.values()))) in suspect_words(verdict)


@pytest.mark.usefixtures("undrawn")
def test_what_predicts_held_out_data_worse_than_the_given_model_is_no_candidate(settings):
    u = HELD.drive["drive.u"][:, 0]
    data = record(np.random.default_rng(3), added=(u**3)[:, None] * [0.02, 0.0], fed=HELD)
    order = record(np.random.default_rng(4))
    verdict = diagnose(Toy(), [data], settings=settings, held_out=[order])
    assert verdict.verdict is Kind.UNKNOWN
    assert "out.0" in verdict.gain.worse
    assert verdict.nearest == ()
    assert "no candidate is written" in second_screen(diagnosis_page(verdict))
    assert diagnose(Toy(), [data], settings=settings).nearest  # nobody has tried it elsewhere


def test_the_traces_are_the_record_and_fit_it_better_with_the_cause(friction):
    shown = friction.exhibit.traces[0]
    data = record(np.random.default_rng(51), {"friction.size": 0.1}, spread=0.0)
    assert shown.measured == pytest.approx(data["out"], abs=1e-6)  # single precision
    before = np.std(shown.measured - shown.nominal, axis=0)
    after = np.std(shown.measured - shown.fitted, axis=0)
    assert np.all(after < 0.5 * before)
    assert friction.residuals["out.1"].after == pytest.approx(
        np.sqrt(np.mean(shown.after[:, 1] ** 2))
    )
    assert "exhibit" not in friction.to_dict()


def test_the_page_is_one_file_without_a_network_and_under_five_megabytes(friction):
    page = diagnosis_page(friction)
    assert not re.search(r'(?:src|href)="(?!#)', page)
    ids = re.findall(r'\bid="([^"]*)"', page)
    assert len(ids) == len(set(ids))
    wide = widened(friction, 24, 3)  # more channels than VES II has
    assert len(diagnosis_page(wide)) < 5e6


def widened(verdict, count, recordings):
    exhibit = verdict.exhibit
    noise = np.random.default_rng(0).standard_normal((2000, count))
    time = 0.01 * np.arange(2000)
    traces = replace(
        exhibit.traces[0],
        time=time,
        measured=noise,
        nominal=noise,
        fitted=noise,
        tolerances=noise,
        reach=np.ones_like(noise),
        sigma_time=time,
        before=noise,
        after=noise,
        without=noise,
    )
    channels = tuple(replace(exhibit.channels[0], name=f"out.{c}") for c in range(count))
    cells = tuple(
        replace(cell, channel=c) for c in range(count) for cell in exhibit.after if not cell.channel
    )
    errors = {channel.name: verdict.residuals["out.0"] for channel in channels}
    shown = replace(
        exhibit, channels=channels, traces=(traces,) * recordings, before=cells, after=cells
    )
    return replace(verdict, exhibit=shown, residuals=errors)


def test_the_rerun_file_has_every_channel_of_the_three_models(friction, tmp_path):
    path = write_diagnosis_rrd(friction, tmp_path / "diagnosis.rrd")
    found = {}
    for chunk in RrdReader(path).stream():
        entity = str(chunk.entity_path)
        if not chunk.is_static and entity.startswith(("/r1/compared", "/r1/sigma")):
            rows = chunk.to_record_batch().column("Scalars:scalars").to_pylist()
            found.setdefault(chunk.entity_path, []).extend(rows)
    assert set(found) == {
        f"/r1/{kind}/{c.name}" for kind in ("compared", "sigma") for c in friction.exhibit.channels
    }
    shown = friction.exhibit.traces[0]
    rows = np.array(found["/r1/compared/out.1"])
    models = (shown.measured, shown.nominal, shown.tolerances, shown.fitted)
    expected = [x[:, 1] for x in models]
    assert rows == pytest.approx(np.column_stack(expected))
    assert np.array(found["/r1/sigma/out.0"])[:, 1] == pytest.approx(shown.after[:, 0])
    assert not list(tmp_path.glob("*.partial"))


def test_measured_nominal_and_extended_lie_over_each_other_in_one_view(friction, tmp_path):
    reader = RrdReader(write_diagnosis_rrd(friction, tmp_path / "diagnosis.rrd"))
    names = {}
    for chunk in reader.stream():
        if chunk.is_static and "SeriesLines:names" in chunk.to_record_batch().schema.names:
            (names[chunk.entity_path],) = chunk.to_record_batch()["SeriesLines:names"].to_pylist()
    (blueprint,) = reader.blueprints()
    views = [
        chunk.to_record_batch()["ViewContents:query"].to_pylist()[0]
        for chunk in reader.stream(store=blueprint)
        if "ViewContents:query" in chunk.to_record_batch().schema.names
    ]
    shown = {contents[0] for contents in views if len(contents) == 1}
    for channel in friction.exhibit.channels:
        entity = f"/r1/compared/{channel.name}"
        words = ("measured", "model before", "tolerances fitted", "with the cause")
        assert [n.rpartition(" [")[0] for n in names[entity]] == list(words)
        assert entity in shown  # one entity of four columns: one plot


@pytest.fixture(scope="module")
def turned_up(settings):
    """A cause that commissioning knows too, 15 of its sd off."""
    return said(settings, {"plant.gain": 0.3})


def test_the_rerun_file_jumps_to_the_onset_and_has_a_line_of_heat_for_each_channel(
    friction, tmp_path
):
    reader = RrdReader(write_diagnosis_rrd(friction, tmp_path / "diagnosis.rrd"))
    entities = {str(chunk.entity_path) for chunk in reader.stream()}
    for name in ("before", "after"):
        assert {f"/r1/heat/{name}/{part}" for part in ("map", "channels", "now")} <= entities
    assert "/r1/events" in entities
    assert not any(entity.startswith("/r1/bodies") for entity in entities)  # a toy has none
    exhibit = friction.exhibit
    onset = onset_of(exhibit, 0)
    quiet = replace(exhibit, before=exhibit.after)
    assert exhibit.traces[0].time[0] <= onset < exhibit.traces[0].time[-1]
    assert onset_of(quiet, 0) is None
    assert onset_of(exhibit, 1) is None  # there is no second recording
    diagnosis_blueprint(quiet)


def test_tolerances_alone_stay_within_what_a_machine_in_order_may_have(turned_up):
    """Fitted without a limit they would take the cause over, and the picture show no difference."""
    assert [cause.effect for cause in turned_up.causes] == ["gain"]
    shown = turned_up.exhibit.traces[0]
    left = [np.nanstd(z) for z in (shown.without, shown.after)]
    assert left[0] > 3.0 * left[1]


def test_the_channel_drawn_first_is_the_one_that_the_cause_changes_most(friction):
    exhibit, traces = friction.exhibit, friction.exhibit.traces[0]
    gap = np.nansum(np.square(traces.without - traces.after), axis=0)
    assert exhibit.telling[0] == np.argmax(gap)
    loud = replace(traces, before=traces.before * [1.0, 1e3])  # loud, and no cause's doing
    assert replace(exhibit, traces=(loud,)).telling[0] == exhibit.telling[0]
    assert replace(exhibit, traces=(loud,), causes=()).telling[0] == 1


def test_a_machine_in_order_lies_within_the_envelope_and_a_faulty_one_does_not(settings, turned_up):
    inside = []
    for seed in range(30, 38):
        shown = said(settings, {}, seed=seed, spread=1.0).exhibit.traces[0]
        inside.append(np.mean(np.abs(shown.measured - shown.nominal) < ENVELOPE_SD * shown.reach))
    assert np.mean(inside) == pytest.approx(0.954, abs=0.05)  # two sd of a normal draw
    shown = turned_up.exhibit.traces[0]
    outside = np.abs(shown.measured - shown.nominal) > ENVELOPE_SD * shown.reach
    assert np.mean(outside) > 0.5


def test_a_verdict_from_a_file_has_no_traces_to_write(friction, tmp_path):
    bare = replace(friction, exhibit=None)
    with pytest.raises(InvalidInputError, match="no traces"):
        write_diagnosis_rrd(bare, tmp_path / "diagnosis.rrd")
    assert "friction at plant" in diagnosis_page(bare)


@pytest.fixture(scope="module")
def twins(settings):
    plant = Toy(causes=("lag", "late", "friction"))
    data = record(np.random.default_rng(2), {"lag.size": 0.2}, plant=plant)
    return diagnose(plant, [data], next_programmes=lambda: [programme(8)], settings=settings)


@pytest.mark.usefixtures("undrawn")
def test_an_ambiguous_group_is_told_as_one_of_several_with_what_to_record_next(twins):
    assert twins.verdict is Kind.AMBIGUOUS
    page = diagnosis_page(twins)
    top = first_screen(page)
    assert "One of these 2, and the recording cannot tell which" in top
    figures = second_screen(page)
    assert figures.count("one of 2, firm") == 2
    assert "look alike in these recordings" in page
    # the same shape twice: even odds, and no size at which they part
    either = ("lag at plant from late at plant", "late at plant from lag at plant")
    assert any(f"Cannot tell {pair}: odds 1" in figures for pair in either)  # a tie has no order
    assert "100 to 1 would settle it" in figures
    told = "Recordings like these cannot tell {} at any size up to 1."
    assert any(told.format(pair) in page for pair in either)
    pairs = {(pair.cause, pair.other, pair.beyond) for pair in twins.lookalikes}
    assert pairs == {("lag@plant", "late@plant", None), ("late@plant", "lag@plant", None)}
    assert any(f"To tell {pair}: toy." in page for pair in either)


def test_the_menu_is_ranked_by_few_commissioning_errors_where_there_are_many(monkeypatch, settings):
    """One of two errors of the plant is kept: the ranking of a loud and a quiet programme holds."""
    monkeypatch.setattr("ves_twin.diagnosis.experiment.next_experiment.NUISANCES", 1)
    plant = Toy(causes=("lag", "friction", "ripple"))
    data = record(np.random.default_rng(4), {"lag.size": 0.05}, spread=0.0, plant=plant)
    seen = preprocess(plant, [data])
    base = linearise(seen.runs, seen.runs.origin)
    evidence = Evidence(seen.runs, seen.measured, whitening_declared(seen.runs))
    fits = [
        refine(
            evidence, (h,), seen.runs.depart(seen.runs.origin, seen.runs.indices(h), [0.02]), base
        )
        for h in plant.hypotheses
        if h.effect in {"lag", "friction"}
    ]
    quiet, loud = programme(8, amplitude=0.1), programme(8, amplitude=2.0)
    few = separations(seen.runs, fits, [quiet, loud])
    monkeypatch.setattr("ves_twin.diagnosis.experiment.next_experiment.NUISANCES", 16)
    every = separations(seen.runs, fits, [quiet, loud])
    assert few[0].programme is every[0].programme is loud
    for one, other in zip(few, every, strict=True):
        assert one.chi2 >= 0.999 * other.chi2  # what is not marginalised cannot stand for a rival


@pytest.mark.parametrize(
    ("label", "said"),
    [
        ("sensor_cross_talk@sensor.my.fy", "sensor cross talk at sensor my from fy"),
        ("anchor_position@leg.1.x", "anchor position at leg 1 x"),
        ("coulomb_friction@joint", "Coulomb friction at joint"),
        ("ripple@axis.320", "ripple (n = 320) at axis"),
        ("drive_cross_talk@m5 from m6", "drive cross talk at m5 from m6"),
    ],
)
def test_a_cause_is_said_so_that_its_place_can_be_found(label, said):
    assert spoken(label) == said


def proof_of(verdict, firm):
    """The same verdict, as one cause of three that was proved."""
    one = Proved(
        effect="friction",
        target="plant",
        parameters={"size": Size(0.1, 0.09, 0.11, "1", 0.0)},
        p=1e-5,
        blocks=20,
        takes={"out.0": (0.08, 0.02)},
        firm=firm,
        acts_like=() if firm else ("lag@plant",),
    )
    return replace(
        verdict,
        verdict=Kind.PARTIAL,
        proved=(one,),
        put_to_proof=3,
        false_discovery_rate=0.05,
        p_limit=0.02,
        left={"out.0": Left(0.02, 0.08, "1", 0.01, 0.3, {"out.1": 0.7}, {"drive.u": 0.2})},
        inseparable=(Inseparable(("friction@plant", "lag@plant"), 14.0),),
    )


def test_a_tolerance_that_gives_way_to_a_fault_is_told_with_what_was_proved(proven):
    """A part that the model has with a tolerance, and that was exchanged, is no cause beside it."""
    verdict = proof_of(proven, firm=True)
    assert "strained" not in headline(verdict)
    limit = verdict.statistics.naming_limit
    best = replace(verdict.rivals[0], standing=Standing.KEPT, pull=limit + 10.0)
    other = replace(
        verdict, rivals=(best,), tuned={"inertia@hub:value": Estimate(3e-4, 2e-4, 4e-4, "1", 1e-4)}
    )
    assert f"by up to {limit + 10.0:.0f} sd: inertia at hub 0.0003 (model 0.0001)" in headline(
        other
    )
    listed = {"inertia@hub:value": Estimate(3e-4, 2e-4, 4e-4, "1", 1e-4, pull=-7.1)}
    assert "by up to 7 sd: inertia at hub" in headline(replace(other, tuned=listed))


@pytest.mark.usefixtures("undrawn")
def test_a_proved_extension_that_is_not_firm_acts_like_its_name_and_its_stand_ins(proven):
    verdict = proof_of(proven, firm=False)
    assert "Something that acts like friction at plant" in headline(verdict)
    assert "Firm" not in headline(verdict)
    assert "Acts like: friction at plant" in verdict.words
    assert "or lag@plant" in verdict.words
    page = diagnosis_page(verdict)
    assert "acts like it, or like lag at plant" in page
    assert "Firm: friction at plant" in headline(proof_of(proven, firm=True))


def test_the_terminal_tells_a_few_combinations_that_are_not_separated_and_each_once(proven):
    verdict = proof_of(proven, firm=False)
    (one,) = verdict.inseparable
    assert inseparable_lines(replace(verdict, inseparable=(one, one))) == inseparable_lines(verdict)
    assert "only a combination of them is known" in inseparable_lines(verdict)[0]
    many = tuple(replace(one, ratio=10.0 + k) for k in range(FEW + 3))
    lines = inseparable_lines(replace(verdict, inseparable=many))
    assert len(lines) == FEW + 1
    assert lines[-1] == "3 more combinations are in report.html"


@pytest.mark.usefixtures("undrawn")
def test_where_more_is_wrong_sizes_of_noise_alone_are_not_promised(proven):
    verdict = proof_of(proven, firm=False)
    page, sure = diagnosis_page(verdict), diagnosis_page(proven)
    assert "seen seven times out of ten" in sure
    assert "seen seven times out of ten" not in page
    assert "Here it lacks more (out.0: 2 times the noise is left)" in page
    quiet = {"out.0": replace(verdict.left["out.0"], rms=0.008)}
    assert "Here it lacks more, so" in diagnosis_page(replace(verdict, left=quiet))
    unknown = replace(proven, verdict=Kind.UNKNOWN)
    assert "Here it lacks more, so" in diagnosis_page(unknown)
    pair = Lookalike("friction@plant", "lag@plant", 0.01, "1", 0.2)
    assert "would be taken for lag" in " ".join(
        limit_sentences(replace(proven, lookalikes=(pair,)))
    )
    said = " ".join(limit_sentences(replace(verdict, lookalikes=(pair,))))
    assert "would be taken for" not in said
    assert "Intervals count what is left unexplained" in said


@pytest.mark.usefixtures("undrawn")
def test_numbers_of_the_model_that_the_fit_moved_are_told_beside_what_they_alone_leave(proven):
    """A fault within a wide tolerance is no cause, and takes most of the error away."""
    surely, maybe = Estimate(3e-4, 2e-4, 4e-4, "1", 1e-4), Estimate(3e-4, 0.0, 4e-4, "1", 1e-4)
    page = diagnosis_page(replace(proven, tuned={"inertia@hub:value": surely}))
    assert "inertia at hub, value" in page
    assert "What a wide tolerance lets move is not called a fault" in page
    assert "inertia at hub" not in diagnosis_page(replace(proven, tuned={"inertia@hub:x": maybe}))
    assert "tolerances alone" in page
    for error in proven.residuals.values():
        assert error.after_si <= error.tolerances_si <= error.before_si


@pytest.mark.usefixtures("undrawn")
def test_what_is_left_is_told_with_the_few_signals_that_it_follows_most(proven):
    verdict = proof_of(proven, firm=True)
    many = {f"drive.{k}": 0.1 * k for k in range(1, 7)}
    left = {"out.0": replace(verdict.left["out.0"], laws=many)}
    page = diagnosis_page(replace(verdict, left=left))
    assert "drive.6 (60 %), drive.5 (50 %), drive.4 (40 %) and 3 more" in page
    assert "out.1 (+0.70)" in page


@pytest.mark.usefixtures("undrawn")
def test_a_number_that_its_limit_holds_is_told_first_and_without_an_interval(proven):
    """Held at 5 sd it stands for a cause that was not found: noise alone says nothing of it."""
    sure = Estimate(3e-4, 2.9e-4, 3.1e-4, "1", 1e-4)
    stuck = Estimate(600.0, 596.0, 604.0, "N s/m", 400.0, at_limit=True)
    tuned = {"inertia@hub:value": sure, "viscous_friction@slide3:damping": stuck}
    verdict = replace(proof_of(proven, firm=True), tuned=tuned)
    told = headline(verdict)
    assert "At the limit of its tolerance, so that it stands for something else" in told
    assert "viscous friction at slide3 600 N s/m (model 400 N s/m)" in told
    assert "inertia" not in told
    assert told.count("stands for") == 1
    page = diagnosis_page(verdict)
    assert "held at its limit" in page
    assert interval_words(stuck) not in page
    close = replace(
        verdict,
        tuned={
            "actuator_gain@drive:gain": Estimate(500.4, 500.0, 501.0, "1", 500.0, at_limit=True)
        },
    )
    assert "actuator gain at drive 500 (model 500, 0.4 more)" in headline(close)
    assert "limit of its tolerance" in headline(replace(proven, tuned=tuned, verdict=Kind.UNKNOWN))
    assert "limit of its tolerance" not in headline(replace(verdict, tuned={"inertia@hub:x": sure}))


@pytest.mark.usefixtures("undrawn")
def test_what_is_accepted_since_every_error_falls_is_not_called_no_clear_gain(proven):
    verdict = proof_of(proven, firm=False)
    gain = Gain(-0.16, -0.19, -0.13, 4.0, 4.6, {"out.0": (2.9, 2.0)})
    assert "The error of every channel falls" in diagnosis_page(replace(verdict, gain=gain))
    assert "fast ones, which noise weighs most, grow" in gain_words(replace(verdict, gain=gain))
    grown = replace(gain, errors={"out.0": (2.0, 2.2)})
    assert "slow errors fall" not in gain_words(replace(verdict, gain=grown))
    worse = headline(replace(verdict, gain=replace(gain, errors={"out.0": (2.0, 4.0)})))
    assert "improves the prediction of held-out data, but rms errors there grow" in worse
    assert "grow" not in headline(replace(verdict, gain=gain))
    assert "no clear gain" in diagnosis_page(replace(verdict, gain=gain, proved=()))


@pytest.mark.usefixtures("undrawn")
def test_what_ends_its_range_is_not_counted_as_proved(proven):
    verdict = proof_of(proven, firm=False)
    ended = replace(verdict, proved=(replace(verdict.proved[0], ended=True),))
    said = "At the end of its range, so not proved: friction at plant"
    assert said in headline(ended)
    assert "No causes improve the prediction" in headline(ended)
    assert "0 of them improve" in diagnosis_page(ended)
    assert ", accepted)" not in diagnosis_page(replace(ended, p_limit=0.05))
    assert next_step(ended).startswith("Look for what else is wrong")
    assert next_step(verdict).startswith("Simulate with the extended model")
    both = replace(verdict, proved=(*verdict.proved, *ended.proved))
    assert "The range of friction at plant ended the fit" in next_step(both)
    assert "range" not in next_step(verdict)
    assert "0 extensions proved" in ended.words
    assert said.partition(":")[0] in ended.words
    assert said not in headline(verdict)


@pytest.mark.parametrize(("sds", "inside"), [(0.5, True), (10.0, False)])
def test_a_measurement_inside_the_envelope_is_said_not_to_show_the_cause(friction, sds, inside):
    (traces,) = friction.exhibit.traces
    shifted = replace(traces, measured=traces.nominal + np.float32(sds) * traces.reach)
    page = answer_figure(replace(friction.exhibit, traces=(shifted,)), "with the cause")
    assert ("The measurement stays inside" in page) == inside
    assert ("a curve inside may still be one" in page) != inside
    assert f"all {len(friction.exhibit.channels)} together" in page or not inside


def test_what_improves_the_prediction_is_to_be_used_and_firm_names_to_be_looked_at(proven):
    assert next_step(proof_of(proven, firm=True)) == (
        "Simulate with the extended model, and look at friction at plant."
    )
    unsure = next_step(proof_of(proven, firm=False))
    assert "Simulate with the extended model" in unsure
    assert "friction" not in unsure


def test_where_tolerances_explain_the_record_the_next_step_is_to_say_what_is_known(settings):
    nothing = said(settings, {}, seed=1)
    blind = {**nothing.smallest_findable}
    blind["friction@plant"] = replace(blind["friction@plant"], value=None)
    step = next_step(replace(nothing, smallest_findable=blind))
    assert step.startswith("Narrow the tolerances of what you know better than declared")


@pytest.mark.usefixtures("undrawn")
def test_the_page_tells_how_many_were_tried_what_is_left_and_what_is_not_separated(proven):
    page = diagnosis_page(proof_of(proven, firm=True))
    said = re.sub(r"<[^>]*>", " ", page)
    assert "3 causes were tested on held-out data; 1 of them improve" in said
    assert "at most 5 % are expected to be false" in said
    assert "out.1 (+0.70)" in said
    assert "drive.u (20 %)" in said
    assert "friction at plant, lag at plant: only a combination of them is known" in said
    assert "14 times worse" in said


def test_where_more_than_noise_stays_the_gain_is_told_by_the_rms_and_by_units_of_noise(proven):
    """As the damper's: the rms falls from 10.5 to 2.2 kN, its fast part is hardly touched."""
    errors = {"force": (10505.0, 2204.0), "flow": (2.0, 1.5), "speed": (1.0, 1.03)}
    gain = Gain(0.059, 0.01, 0.119, before=405.0, after=382.0, errors=errors)
    words = gain_words(replace(proven, verdict=Kind.PARTIAL, gain=gain))
    assert "the rms error on held-out recordings falls by 79 % (force)" in words
    assert "grows by 3 % (speed)" in words
    assert "of its square in units of noise, 6 % (1 % to 12 %) goes" in words
    assert "flow" not in words
    same = replace(gain, errors={"force": (2.0, 1.0), "speed": (6.1823, 6.1825)})
    assert "stays (speed)" in gain_words(replace(proven, verdict=Kind.PARTIAL, gain=same))
    both = replace(gain, errors={"force": (2.0, 1.0), "speed": (2.0, 1.5)})
    words = gain_words(replace(proven, verdict=Kind.PARTIAL, gain=both))
    assert "falls by 50 % (force) and by 25 % (speed);" in words
    left = gain_words(replace(proven, gain=gain))  # noise alone is left: one measure says it all
    assert left == taken_words(gain)


@pytest.mark.parametrize(
    ("spread", "after", "told"), [(0.17, 30.0, True), (2.0, 30.0, False), (0.17, 1.0, False)]
)
def test_a_gain_that_leaves_more_than_a_channel_moves_by_says_so(proven, spread, after, told):
    """A trolley that ran away by 28.7 m did so by 0.33 m then: a gain of 99 %."""
    gain = Gain(0.99, 0.98, 1.0, before=9e4, after=9e2, errors={"rail": (28.7, 0.33)})
    error = ChannelError(9e4, after, 28.7, 0.33, "m", spread)
    residuals = {"rail": error}
    words = gain_words(replace(proven, verdict=Kind.PARTIAL, gain=gain, residuals=residuals))
    assert ("rail is still predicted worse than by a constant" in words) is told


@pytest.mark.usefixtures("undrawn")
def test_causes_whose_p_one_stretch_of_time_may_turn_are_told_on_both_sides_of_the_limit(proven):
    sure = proof_of(proven, firm=True)
    assert not near_sentence(sure)  # p is 1e-5, of 0.02 that are allowed
    assert "Accepted is a p" not in diagnosis_page(sure)
    missed = replace(sure, unproved={"lag@plant": 0.05, "drift@plant": 0.07})
    assert "Near it: lag at plant (p 0.05, not accepted)." in near_sentence(missed)
    assert near_sentence(missed) in diagnosis_page(missed)
    close = replace(sure, proved=(replace(sure.proved[0], p=0.009),))
    assert "Near it: friction at plant (p 0.009, accepted)." in near_sentence(close)
    assert not near_sentence(proven)
    small = replace(sure, unproved={"lag@plant": 1e-6})
    assert near_sentence(small).endswith("so not kept: lag at plant.")


def test_what_is_proved_stands_in_the_verdict_file(proven):
    told = proof_of(proven, firm=True).to_dict()
    assert told["proved"][0]["takes"] == {"out.0": (0.08, 0.02)}
    assert told["false_discovery_rate"] == 0.05
    assert told["left"]["out.0"]["rms"] == 0.02


@pytest.mark.usefixtures("undrawn")
def test_no_loud_cell_is_said_beside_the_threshold_and_not_as_noise(proven):
    quiet = replace(proven, leftover=replace(proven.leftover, loud=()))
    page = diagnosis_page(quiet)
    assert "beyond noise." not in page[page.index("What is left") :]
    assert "the most that machines in order leave" in page


def factor(verdict, name):
    return next(one for one in credibility(verdict) if one.name == name)


@pytest.mark.usefixtures("undrawn")
def test_validated_is_said_of_external_held_out_recordings_with_a_gain_and_of_nothing_else(
    proven, proven_page
):
    """Every other basis, whatever else it has, must not bring the word onto the page."""
    assert proven.basis.recordings == "unknown"  # a toy wrote them
    external = replace(proven, basis=replace(proven.basis, recordings="external"))
    assert factor(external, "validation").standing is Pedigree.VALIDATED
    assert ">validated<" in diagnosis_page(external)
    without = (
        proven,
        replace(external, basis=replace(external.basis, held_out="none"), gain=None),
        replace(external, gain=None),
        replace(external, gain=Gain(0.5, -0.1, 1.1, 2.0, 1.5)),
        replace(external, gain=Gain(0.6, 0.4, 0.8, 2.0, 1.4, without=1.02)),
        replace(external, verdict=Kind.UNKNOWN, causes=()),
        replace(external, verdict=Kind.NOTHING, causes=()),
        replace(external, basis=replace(external.basis, recordings="simulated")),
    )
    for verdict in without:
        assert factor(verdict, "validation").standing is Pedigree.OPEN
        assert "validated" not in diagnosis_page(replace(verdict, exhibit=None))
    assert proven.exhibit is not None  # of the first the page with its pictures, too
    assert "validated" not in proven_page


def test_what_is_declared_is_called_assumed_and_what_is_flawed_is_not_called_measured(proven):
    assert factor(proven, "results uncertainty").standing is Pedigree.ASSUMED
    told = replace(proven, basis=replace(proven.basis, noise="measured", tolerances="measured"))
    assert factor(told, "results uncertainty").standing is Pedigree.MEASURED
    half = replace(proven, basis=replace(proven.basis, noise="measured"))
    said = factor(half, "results uncertainty").said
    assert "Noise: measured; tolerances: declared." in said
    flawed = replace(proven, quality=(Check("gaps", Grade.FAILED, (), "two"),))
    assert factor(flawed, "input pedigree").standing is Pedigree.OPEN
    assert "gaps" in factor(flawed, "input pedigree").said
    assert len(credibility(proven)) == 8


@pytest.mark.usefixtures("undrawn")
def test_flaws_that_repeat_unfold_behind_the_first_of_each_sort(friction):
    repeats = [failed("repeats", f"recording {n}: 5 rows repeat") for n in range(1, 61)]
    stays = [failed("saturation", "recording 3: duty stays at its end")]
    page = diagnosis_page(replace(friction, quality=(*repeats, *stays)))
    told, _, rest = page.partition("58 more like these")
    assert told.count("rows repeat") == 2
    assert "duty stays" in told
    assert "<details>" in told.rpartition("recording 2: 5 rows repeat")[2]
    assert rest.partition("</details>")[0].count("rows repeat") == 58
    assert "did not pass: repeats, saturation." in page


def test_a_step_that_puts_a_channel_off_is_told_with_a_finer_one(proven):
    """Where its error is half of what is left; not where more than that is left anyway."""
    name, error = next(iter(proven.residuals.items()))

    def told(step):
        return replace(proven, residuals={name: replace(error, step_si=step)})

    coarse, fine = told(5.0 * error.after_si), told(0.4 * error.after_si)
    said = " ".join(basis_sentences(coarse))
    assert f"the model's step puts {name}" in said
    assert "5 times what is left of it" in said
    assert "Take a step 4 times smaller" in next_step(coarse)
    some = told(0.6 * error.after_si)
    assert any(text.startswith("Step:") for text in basis_sentences(some))
    assert next_step(some) == next_step(proven)  # more is left by something else
    assert not any(text.startswith("Step:") for text in basis_sentences(fine))
    assert next_step(fine) == next_step(proven)
    assert "smaller" not in next_step(replace(coarse, verdict=Kind.NOTHING))


def test_an_unknown_that_leaves_little_tells_what_noise_would_accept_it(proven):
    name, error = next(iter(proven.residuals.items()))

    def told(share):
        little = replace(error, spread=1.0, after_si=share)
        return next_step(replace(proven, verdict=Kind.UNKNOWN, causes=(), residuals={name: little}))

    assert "At most 8 % of a channel's spread is left" in told(0.08)
    assert f"declare twice what is left as noise in the machine's file ({name}: 0.16" in told(0.08)
    assert "noise" not in told(0.3)


def test_a_limit_above_the_rate_says_why_it_is_that_high(proven):
    """0.2 beside *at most 5 % are false* reads as a contradiction."""
    missed = replace(proof_of(proven, firm=True), unproved={"lag@plant": 0.05})
    assert "at most. Near" in near_sentence(missed)
    high = replace(missed, p_limit=0.2, unproved={"lag@plant": 0.3})
    assert "0.2 at most (that high since most of them are plainly there)" in near_sentence(high)
