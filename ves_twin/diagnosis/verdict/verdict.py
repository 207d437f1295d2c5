"""Verdict: what a diagnosis says, as it stands in verdict.json."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from enum import StrEnum
from pathlib import Path

from ves_twin.core.whole_file import write_whole
from ves_twin.data.quality.check import Check
from ves_twin.diagnosis.build_up.result import Inseparable, Left, Proved
from ves_twin.diagnosis.experiment.aliases import Lookalike
from ves_twin.diagnosis.explain.disagreement import Alone
from ves_twin.diagnosis.explain.rivals import Rival
from ves_twin.diagnosis.law.result import LawFinding
from ves_twin.diagnosis.record.residual_structure import ResidualStructure
from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.diagnosis.verdict.cause import MANY, Cause, Estimate
from ves_twin.diagnosis.verdict.report_traces import ReportTraces

COUNTS = {2: "two", 3: "three", 4: "four"}
"""Numbers of causes as words."""

SCHEMA = 1
"""Version of verdict.json; fields are added without a new one, never changed."""


class Kind(StrEnum):
    """The six answers.

    several: two or more causes together explain it. partial: a cause that beats all rivals on
    held-out data while something unexplained remains.
    """

    NOTHING = "nothing"
    NAMED = "named"
    AMBIGUOUS = "ambiguous"
    SEVERAL = "several"
    PARTIAL = "partial"
    UNKNOWN = "unknown"

    @property
    def names_a_plant(self) -> bool:
        """Whether its causes, all together, are meant: they make an extended plant."""
        return self in (Kind.NAMED, Kind.SEVERAL, Kind.PARTIAL)

    @property
    def names_causes(self) -> bool:
        """Whether it names causes at all, rivals of one another too."""
        return self.names_a_plant or self is Kind.AMBIGUOUS


@dataclass(frozen=True)
class ChannelError:
    """Rms error of a channel before and after, in noise sigma (whitened) and in its unit.

    `spread` is the sd of what was measured, in that unit; `tolerances_si` what the model leaves
    with its tolerances fitted and no cause, which then equals `after_si`. `step_si` is what the
    model's step puts it off by, to first order: twice what halving it changes.
    """

    before: float
    after: float
    before_si: float
    after_si: float
    unit: str
    spread: float = 0.0
    tolerances_si: float | None = None
    step_si: float = 0.0


@dataclass(frozen=True)
class Basis:
    """On what the verdict rests: each measured, declared or none.

    `recordings` is "external" where all, held-out ones too, come from logs of a machine, "unknown"
    otherwise. `baseline_differs` is the largest difference of the baseline's inputs from those of
    the record, of their range. `left_out` names what there was no time for. `pieces` is how many
    the measured recordings were cut into, each simulated from its own start; 0: they were whole.
    `by_motion` says that efforts which the measured motion lacks were compared, and no simulation;
    `held_out_repeats` that held-out recordings were fed in, or moved, as fitted ones.
    """

    noise: str
    tolerances: str
    held_out: str
    baseline: str = "none"
    recordings: str = "unknown"
    baseline_differs: float | None = None
    left_out: tuple[str, ...] = ()
    pieces: int = 0
    by_motion: bool = False
    held_out_repeats: bool = False


@dataclass(frozen=True)
class Findable:
    """Smallest size of a cause that would have been found; None: nothing can be said about it."""

    value: float | None
    unit: str


@dataclass(frozen=True)
class Proposal:
    """A next programme with the chi^2 by which it should part the rivals."""

    programme: str
    separation: float


@dataclass(frozen=True)
class Statistics:
    """The figures the verdict was taken on, each beside its threshold.

    `naming_odds` are those at which a rival is dropped; `widened` is the factor on the declared
    tolerances with which this was found, above 1 where recordings of rigs in order ask for it.
    `misfit_in_order` is what simulated rigs in order leave, where it is so far above noise that it
    tells nothing; the thresholds are then those of noise.
    """

    effect: float
    effect_threshold: float
    misfit: float
    misfit_threshold: float
    misfit_after: float | None = None
    second_effect: float | None = None
    naming_limit: float | None = None
    tolerance_scale: float | None = None
    naming_odds: float | None = None
    widened: float = 1.0
    misfit_in_order: float | None = None


@dataclass(frozen=True)
class Verdict:
    """What was found, how sure it is, and what it rests on.

    `alternatives` are numbers of `causes`: each alternative explains the record by itself, by one
    cause or by several together; one alternative unless ambiguous. `gain` is on held-out
    recordings; `forecast` is ahead in time, where a cause's sizes belong to the recorded stretch
    of it. `tuned` are the plant's commissioning numbers at the fit. `lookalikes` say what a named
    cause could be taken for, and up to which size, and `smallest_findable` which sizes would have
    shown, both beside noise and tolerances alone; `twins` are cosines of all pairs. `quality` has
    the checks that a recording did not pass; `alone` what each recording says by itself, where all
    together have no explanation. `proved` are the causes that held-out data
    prove one by one, out of `put_to_proof`, with the false-discovery rate that this keeps and the
    largest p that it allows; `unproved` has those of the same choice that were not, with their p;
    `left` is what then stays of each channel, `inseparable` what is known only in combination.
    `nearest` are the causes that come nearest where none is named, unless they predict a held-out
    channel worse than the model as it was given. `law` is what was found where no cause explains
    the record and a law was looked for; if it is claimed, `tuned`, `residuals`, `leftover` and
    `gain` are with it. A law that is a `part` stands beside the causes, and `tuned`
    has their sizes as they were fitted together with it. `exhibit` has the traces of the report,
    and stays out of verdict.json.
    """

    verdict: Kind
    basis: Basis
    statistics: Statistics
    causes: tuple[Cause, ...] = ()
    alternatives: tuple[tuple[int, ...], ...] = ()
    residuals: Mapping[str, ChannelError] = field(default_factory=dict)
    gain: Gain | None = None
    forecast: Gain | None = None
    tuned: Mapping[str, Estimate] = field(default_factory=dict)
    leftover: ResidualStructure | None = None
    suspect: str = ""
    rivals: tuple[Rival, ...] = ()
    smallest_findable: Mapping[str, Findable] = field(default_factory=dict)
    twins: tuple[tuple[str, str, float], ...] = ()
    lookalikes: tuple[Lookalike, ...] = ()
    next_experiment: tuple[Proposal, ...] = ()
    unseen: tuple[str, ...] = ()
    holes: Mapping[str, float] = field(default_factory=dict)
    excluded: tuple[str, ...] = ()
    quality: tuple[Check, ...] = ()
    alone: tuple[Alone, ...] = ()
    proved: tuple[Proved, ...] = ()
    put_to_proof: int | None = None
    false_discovery_rate: float | None = None
    p_limit: float | None = None
    unproved: Mapping[str, float] = field(default_factory=dict)
    left: Mapping[str, Left] = field(default_factory=dict)
    inseparable: tuple[Inseparable, ...] = ()
    nearest: tuple[Cause, ...] = ()
    law: LawFinding | None = None
    exhibit: ReportTraces | None = field(default=None, repr=False, compare=False)
    schema: int = SCHEMA

    def to_dict(self) -> dict[str, object]:
        """Plain values for JSON, without the traces."""
        content = asdict(replace(self, exhibit=None))
        del content["exhibit"]
        return content

    def to_json(self) -> str:
        """The text of verdict.json."""
        return json.dumps(self.to_dict(), indent=2, allow_nan=False)

    def save(self, path: Path) -> None:
        """Write verdict.json.

        Raises:
            FileAccessError: not writable.
        """
        write_whole(path, self.to_json() + "\n")

    @property
    def words(self) -> str:
        """The verdict in one sentence."""
        match self.verdict:
            case Kind.NOTHING:
                return "Nothing beyond noise and commissioning tolerances."
            case Kind.UNKNOWN:
                if self.lawful:
                    return self.lawful
                if self.statistics.misfit_in_order is not None:
                    return "Nothing can be told: machines in order fall as far out of step."
                hint = f"; the nearest of its causes is {self.suspect}" if self.suspect else ""
                return f"Something is wrong that the library does not explain{hint}."
            case _:
                limit = "" if self.verdict is Kind.AMBIGUOUS else self.limit
                if self.proved:
                    return self.proving + limit
                return self.naming([self._name(i) for i in range(len(self.causes))]) + limit

    @property
    def lacks(self) -> bool:
        """Whether more is wrong than what was named explains."""
        return self.verdict in (Kind.PARTIAL, Kind.UNKNOWN)

    @property
    def lawful(self) -> str:
        """The sentence of a law that is claimed in place of a cause; empty without one."""
        if self.law is None or not self.law.claimed or self.law.part:
            return ""
        return f"No cause in the library explains it. A law does: {self.law.words}."

    def naming(self, names: Sequence[str], begin: str = "") -> str:
        """The sentence of a verdict that names causes.

        Args:
            names: of its causes, one each.
            begin: words before what explains the record; none if empty.
        """
        every, begin = " and ".join(names), f"{begin} " if begin else ""
        match self.verdict:
            case Kind.AMBIGUOUS:
                groups = [" with ".join(names[i] for i in a) for a in self.alternatives]
                listed = "; ".join(groups)
                return f"One of these {len(groups)}, and the recording cannot tell which: {listed}."
            case Kind.PARTIAL:
                return f"Part of it is {every}. Something more stays unexplained."
            case Kind.SEVERAL:
                count = COUNTS.get(len(names), str(len(names)))
                count = count if begin else count.capitalize()
                return f"{begin}{count} causes together: {every}."
            case _:
                return f"{begin}{every}."

    @property
    def unconfirmed(self) -> bool:
        """Whether held-out recordings could have confirmed the causes, and did not."""
        return self.gain is not None and self.gain.unconfirmed

    @property
    def proving(self) -> str:
        """The sentences of a verdict whose causes were proved one by one."""
        names = {f"{c.effect}@{c.target}": self._name(i) for i, c in enumerate(self.causes)}
        firm = [names[one.label] for one in self.proved if one.firm]
        like = [
            " or ".join([names[one.label], *one.acts_like])
            for one in self.proved
            if not (one.firm or one.ended)
        ]
        ended = [names[one.label] for one in self.proved if one.ended]
        count = len(firm) + len(like)
        said = [f"{count} extension{'s' * (count != 1)} proved to predict held-out data better."]
        said += [f"Named: {'; '.join(firm)}."] if firm else []
        said += [f"Acts like: {'; '.join(like)}."] if like else []
        said += [f"At the end of its range, so not proved: {'; '.join(ended)}."] if ended else []
        if self.verdict is Kind.PARTIAL:
            said.append("Something more stays unexplained.")
        if self.law is not None and self.law.part and self.law.claimed:
            said.append(f"Of what they leave, a law takes a part: {self.law.words}.")
        return " ".join(said)

    @property
    def limit(self) -> str:
        """What the extension is good for, where it holds between recordings and not beyond."""
        if self.forecast is None or self.forecast.carries_on:
            return ""
        worst = max(self.forecast.errors.items(), key=lambda item: item[1][1] / item[1][0])
        name, (before, after) = worst
        unit = self.residuals[name].unit
        return (
            " It fills in between the recordings and cannot be carried on beyond them: ahead in"
            f" time {name} is {after:.3g} {unit} off with it, {before:.3g} {unit} without."
        )

    def _name(self, number: int) -> str:
        cause = self.causes[number]
        shown = list(cause.largest.items())
        many = len(cause.parameters)
        told = f"{many} numbers, the largest " if many > MANY else ""
        changed = self.basis.baseline == "measured"
        origin = "at the baseline" if changed else "nominal"
        sizes = ", ".join(
            f"{name} = {p.told(origin)}" for name, p in (shown[:1] if told else shown)
        )
        first = f"{cause.effect} at {cause.target}: {told}{sizes}"
        text = " or ".join([first, *cause.acts_like])
        if cause.firm or (cause.sigmas is None and (self.proved or cause.acts_like)):
            return text
        if self.unconfirmed:
            return f"{text}, which the held-out recordings do not confirm"
        if cause.ended:
            return f"{text}: an end of its range holds it"
        if cause.sigmas is None:
            rows = "its clock explains that as well" if cause.below_row else "it may be none"
            return f"{text}: {rows}"
        if changed:
            return f"{text}, {cause.sigmas:.1f} sigmas of a change since then: fault or drift"
        return f"{text}, {cause.sigmas:.1f} declared sigmas off: fault or commissioning error"
