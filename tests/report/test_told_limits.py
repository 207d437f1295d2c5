"""What a verdict says that it does not know agrees with what it says that it found."""

from __future__ import annotations

from dataclasses import replace

import pytest

from ves_twin.diagnosis.build_up.result import Left, Proved
from ves_twin.diagnosis.law.result import LAW
from ves_twin.diagnosis.record.residual_structure import ResidualStructure
from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.diagnosis.verdict.cause import Cause, Estimate
from ves_twin.diagnosis.verdict.verdict import (
    Basis,
    ChannelError,
    Findable,
    Kind,
    Statistics,
    Verdict,
)
from ves_twin.report.diagnosis.answer import (
    confidence_sentence,
    nearest_sentence,
    next_step,
    verdict_sentence,
)
from ves_twin.report.diagnosis.basis import gain_words, rests_on
from ves_twin.report.diagnosis.limits import blind_causes, next_sentences
from ves_twin.report.diagnosis.out_of_step import out_of_step_sentence
from ves_twin.report.diagnosis.proved import proved_parts, standing_words
from ves_twin.report.diagnosis.strained import check_sentence, tuned_words

FIGURES = Statistics(1.0, 2.0, 9.0, 5.0)
SIZE = Estimate(92e3, 88e3, 96e3, "N/m", 1e5)


def verdict(firm: bool = True, left_out: tuple[str, ...] = ()) -> Verdict:
    basis = Basis("declared", "declared", "measured", left_out=left_out)
    cause = Cause("viscous_friction", "slide", {"damping": SIZE}, 1.0, firm, None)
    one = Proved("viscous_friction", "slide", {}, 1e-6, 20, {"force": (9.0, 8.0)}, firm)
    names = ("viscous_friction@slide", "joint_spring@slide", "quadratic_drag@slide")
    return Verdict(
        Kind.PARTIAL,
        basis,
        FIGURES,
        causes=(cause,),
        tuned={"joint_spring@slide:stiffness": SIZE},
        smallest_findable={name: Findable(None, "1") for name in names},
        proved=(one,),
        put_to_proof=1,
        false_discovery_rate=0.05,
    )


def test_nothing_is_said_to_be_unknown_of_what_has_a_size_beside_others():
    assert blind_causes(verdict()) == ["quadratic drag at slide"]


@pytest.mark.parametrize(
    ("firm", "left_out", "warned"),
    [
        (True, (LAW,), True),
        (True, (f"{LAW} (some 12 min: --law asks for it)",), True),
        (True, ("pairs of causes",), False),
        (False, (LAW,), False),
    ],
)
def test_firm_names_are_told_with_a_law_that_nobody_looked_for(firm, left_out, warned):
    """A one-sided stop in a car's strut, which the library lacks, was called a cubic spring."""
    assert ("No law was looked for" in confidence_sentence(verdict(firm, left_out))) is warned


@pytest.mark.parametrize(
    ("there", "held_out", "warned"),
    [(1.8, "measured", True), (0.9, "measured", False), (1.8, "split", False)],
)
def test_held_out_recordings_of_another_motion_are_told(there, held_out, warned):
    """Two frictions of a series elastic joint were not proved, as a chirp hid them."""
    gain = Gain(0.2, 0.1, 0.3, 9.0, 8.0, errors={"force": (2.5, there)})
    error = ChannelError(9.0, 8.0, 0.6, 0.5, "N", 2.0, tolerances_si=0.58)
    plain = verdict()
    told = replace(
        plain,
        gain=gain,
        residuals={"force": error},
        basis=replace(plain.basis, held_out=held_out),
    )
    words = confidence_sentence(told)
    assert ("3.6 times as far off as the fitted ones (force)" in words) is warned


def test_held_out_recordings_of_the_same_motion_are_said_to_be_that():
    plain = verdict()
    again = replace(plain, basis=replace(plain.basis, held_out_repeats=True))
    told = "what is proved is proved for that motion"
    assert told in confidence_sentence(again)
    assert told not in confidence_sentence(plain)
    assert "held-out recordings that repeat the fitted motion" in rests_on(again.basis)
    assert "repeat" not in rests_on(plain.basis)


@pytest.mark.parametrize(
    ("pull", "high", "told"), [(-3.8, 96e3, True), (-1.2, 96e3, False), (-3.8, 104e3, False)]
)
def test_numbers_of_the_model_that_left_their_tolerance_are_told(pull, high, told):
    """The mass of a pendubot's first link, 3.8 declared sd off and right, stood in a file alone."""
    plain = verdict()
    tuned = {"joint_spring@slide:stiffness": replace(SIZE, pull=pull, high=high)}
    words = tuned_words(replace(plain, tuned=tuned))
    assert ("3.8 declared tolerances from the model's 100 kN/m" in words) is told
    assert told or not words


def test_numbers_that_moved_are_told_where_no_cause_explains_the_record_too():
    """A weight 7.2 tolerances off stood in verdict.json alone, below *unknown*."""
    plain = replace(verdict(), verdict=Kind.UNKNOWN, causes=(), alternatives=())
    tuned = {"body_mass@load:mass": replace(SIZE, pull=-7.2, high=96e3)}
    assert "7.2 declared tolerances" in tuned_words(replace(plain, tuned=tuned))
    astray = replace(plain.statistics, misfit_in_order=1e6)  # a simulation out of step tells none
    assert not tuned_words(replace(plain, tuned=tuned, statistics=astray))


def test_a_named_cause_that_a_law_changed_is_no_number_of_the_model():
    """A ball's friction was told as the model's 2.08 mN, where the model had none."""
    plain = verdict()
    (cause,) = plain.causes
    name = f"{cause.effect}@{cause.target}:{next(iter(cause.parameters))}"
    told = replace(plain, tuned={name: replace(SIZE, pull=-3.8, high=96e3)})
    assert tuned_words(told).endswith("beside the law")
    assert "declared tolerances" not in tuned_words(told)
    assert not check_sentence(told)


def test_a_named_cause_whose_work_a_law_may_do_is_told_beside_the_models_number():
    """Friction of a screw was told as -1.8 to 1.8 mN m and nothing else, and no friction pushes."""
    plain = verdict()
    (cause,) = plain.causes
    name = f"{cause.effect}@{cause.target}:{next(iter(cause.parameters))}"
    model = cause.parameters[name.rpartition(":")[2]].nominal
    none = replace(SIZE, nominal=model + 5e3, low=model - 1e3, high=model + 1e3)
    words = tuned_words(replace(plain, tuned={name: none}))
    assert words.endswith("beside the law, not clear of the model's 100 kN/m")
    clear = replace(none, low=model + 1e3, high=model + 9e3)
    assert tuned_words(replace(plain, tuned={name: clear})).endswith("beside the law")


@pytest.mark.parametrize(("pull", "high", "told"), [(-3.8, 96e3, True), (-2.9, 96e3, False)])
def test_what_data_put_far_off_its_tolerance_is_to_be_measured_next(pull, high, told):
    """A link's mass, doubled by its owner, was tuned by 4 declared tolerances and not advised."""
    plain = verdict()
    gain = Gain(0.6, 0.5, 0.7, 9.0, 4.0, errors={"force": (2.5, 1.0)})
    tuned = {"joint_spring@slide:stiffness": replace(SIZE, pull=pull, high=high)}
    off = replace(plain, tuned=tuned, gain=gain)
    words = "joint spring at slide 92 kN/m (model 100 kN/m)"
    assert (words in check_sentence(off)) is told
    assert (words in next_step(off)) is told
    assert "viscous friction at slide" in next_step(off)


def test_a_simulation_that_falls_out_of_step_is_told_and_what_was_done_instead():
    plain = verdict()
    far = replace(FIGURES, misfit_in_order=220.0)
    by_noise = replace(plain, statistics=far)
    by_motion = replace(by_noise, basis=replace(plain.basis, by_motion=True))
    assert not out_of_step_sentence(plain)
    assert "this record was judged by noise alone" in out_of_step_sentence(by_noise)
    assert "efforts are compared in place of motions" in out_of_step_sentence(by_motion)
    assert "drive.horizon" in next_step(by_noise)
    assert "drive.horizon" not in next_step(by_motion)
    unknown = replace(by_noise, verdict=Kind.UNKNOWN, causes=(), proved=())
    assert verdict_sentence(unknown).startswith("Nothing can be told")
    assert "times the most that noise leaves" in confidence_sentence(unknown)


@pytest.mark.parametrize(
    ("count", "said"), [(1, "part 0;"), (4, "part 2 and part 3;"), (9, "part 3 and 5 more;")]
)
def test_what_was_left_out_to_save_time_is_told_in_one_short_line(count, said):
    told = rests_on(verdict(left_out=tuple(f"part {n}" for n in range(count))).basis)
    assert said in told
    assert told.count("part") == min(count, 4)
    assert "--minutes gives more" in told


@pytest.mark.parametrize(
    ("like", "named"),
    [
        (("coulomb_friction@slide", "force_offset@slide"), "Coulomb friction at slide"),
        (("viscous_asymmetry@slide", "force_offset@slide"), "force offset at slide"),
        (("viscous_asymmetry@slide",), "Coulomb asymmetry at slide"),
    ],
)
def test_a_friction_that_would_push_is_told_by_what_it_may_be_instead(like, named):
    """The headline named a youBot's Coulomb asymmetry, which the table said no friction does."""
    takes = {"force": (9.0, 8.0)}
    one = Proved("coulomb_asymmetry", "slide", {}, 1e-6, 20, takes, False, like, drives=True)
    said = verdict_sentence(replace(verdict(False), proved=(one,)))
    assert f"Something that acts like {named}." in said
    assert "push" in standing_words(one)
    assert (named in standing_words(one)) is ("asymmetry" not in named)


@pytest.mark.parametrize(
    ("given", "than"), [(2.17, "the tolerances alone, tuned"), (0.5, "the model as given")]
)
def test_what_an_extension_is_worse_than_is_told(given, than):
    """2.17 as given, 1.54 tuned and 1.75 with it was called worse than the model as given."""
    gain = Gain(None, None, None, 2.0, 3.0, {"force": (1.54, 1.75)}, given={"force": given})
    left = ResidualStructure(9.0, (), None, ())
    unknown = replace(
        verdict(), verdict=Kind.UNKNOWN, suspect="joint_spring@slide", gain=gain, leftover=left
    )
    assert f"It predicts force worse than {than}:" in nearest_sentence(unknown)


@pytest.mark.parametrize(("left", "share"), [(0.998, "all"), (0.4, "0.4"), (1.2, "1.2")])
def test_a_channel_that_is_not_explained_at_all_is_told_as_all_of_its_spread(left, share):
    error = ChannelError(9.0, 9.0, 1.0, left, "N", 1.0)
    figures = replace(FIGURES, misfit=50.0, misfit_threshold=5.0)
    unknown = replace(
        verdict(), verdict=Kind.UNKNOWN, statistics=figures, residuals={"force": error}, proved=()
    )
    assert f"{share} of the spread of force" in confidence_sentence(unknown)


def test_of_two_answers_that_share_a_cause_what_differs_is_told():
    """An arm's shoulder was told from itself: both answers began with its viscous friction."""
    kinds = ("viscous_friction", "force_offset", "viscous_friction", "coulomb_friction")
    causes = tuple(Cause(kind, "elbow", {"size": SIZE}, 0.5, True, None) for kind in kinds)
    told = replace(
        verdict(), verdict=Kind.AMBIGUOUS, causes=causes, alternatives=((0, 1), (2, 1), (2, 3))
    )
    (said, *_) = next_sentences(told)
    assert said.startswith("To tell force offset at elbow from Coulomb friction at elbow:")


@pytest.mark.parametrize(
    ("alternatives", "said"),
    [
        (((1,), (1, 3)), "To tell force offset at elbow alone from Coulomb friction at elbow with"),
        (((0,), (2,)), "To tell viscous friction at elbow: "),
    ],
)
def test_answers_of_which_one_is_a_part_of_the_other_are_told_apart(alternatives, said):
    kinds = ("viscous_friction", "force_offset", "viscous_friction", "coulomb_friction")
    causes = tuple(Cause(kind, "elbow", {"size": SIZE}, 0.5, True, None) for kind in kinds)
    told = replace(verdict(), verdict=Kind.AMBIGUOUS, causes=causes, alternatives=alternatives)
    assert next_sentences(told)[0].startswith(said)


@pytest.mark.parametrize("given", [8.0, 9.5])
def test_who_has_a_better_model_is_not_sent_to_the_extended_one(given):
    """A spring took 6 % from what tuning had left of two arms, and both were better as given."""
    gain = Gain(0.2, 0.1, 0.3, 9.0, 8.0, {"force": (10.0, 9.0)}, given={"force": given})
    told = replace(verdict(firm=False), gain=gain)
    assert next_step(told).startswith("Keep the model as it was given") is (given < 9.0)
    assert ("as well or better" in gain_words(told)) is (given < 9.0)


@pytest.mark.parametrize(("rms", "told"), [(0.3, True), (0.8, False)])
def test_a_channel_of_which_less_is_left_than_its_noise_says_that_this_is_declared_too_large(
    rms, told
):
    """Of a cart's pole a third of the noise was left, and two causes proved within it."""
    one = replace(verdict(), put_to_proof=1, left={"force": Left(rms, 0.9, "N", 1.0, 0.1)})
    text = "".join(map(str, proved_parts(one)))
    assert ("force: less is left than the noise that is declared" in text) is told
