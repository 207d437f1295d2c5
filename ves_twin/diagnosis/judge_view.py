"""judge_view: the verdict on a view, by simulations or by the motion."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from ves_twin.diagnosis.build_up.halves import carried_point
from ves_twin.diagnosis.build_up.one_way import one_way_twins
from ves_twin.diagnosis.decide import Conclusion, decide
from ves_twin.diagnosis.experiment.next_experiment import separations
from ves_twin.diagnosis.explain.disagreement import Alone, disagreement
from ves_twin.diagnosis.explain.explain import explain
from ves_twin.diagnosis.fit.explanation import Explanation
from ves_twin.diagnosis.fit.fit_context import FitContext
from ves_twin.diagnosis.law.explained import Lawful, lawful_explanation, lawful_rest
from ves_twin.diagnosis.law.own_motion import own_motion
from ves_twin.diagnosis.law.result import LAW
from ves_twin.diagnosis.record.runs import Progress
from ves_twin.diagnosis.unseen.held_out import HeldOut
from ves_twin.diagnosis.verdict.assemble_verdict import assemble_verdict
from ves_twin.diagnosis.verdict.verdict import Kind, Proposal, Verdict
from ves_twin.diagnosis.view import View


def judge_view(view: View, progress: Progress, alone: bool = False) -> Verdict:
    """The verdict by simulations; by the motion, where they fall out of step and do not tell.

    By the motion before several causes, since simulations of those may use up the time; after a
    glance at single ones, one of which may be enough.
    """
    findings = view.findings
    lawless = replace(findings, settings=replace(findings.settings, laws=False))
    if view.out_of_step and _one_is_enough(view, progress, glance=True):
        found = judge_as_seen(replace(view, findings=lawless), progress, alone)
        if not found.lacks:
            return found
    moved = view.seen_by_motion(progress)
    by_motion = judge_as_seen(moved, progress) if moved else None
    if by_motion is None or not (by_motion.proved or by_motion.lawful):
        return judge_as_seen(view, progress, alone)
    found = judge_as_seen(replace(view, findings=lawless), progress, alone)
    return by_motion if found.lacks else found


def judge_as_seen(view: View, progress: Progress, alone: bool = False) -> Verdict:
    """Explain one view; `alone` asks for a single cause that leaves noise, and for nothing else."""
    findings, exclude = view.findings, view.material.exclude
    if not view.loud:
        return assemble_verdict(findings, Kind.NOTHING, view.basis, exclude)
    if alone and not _one_is_enough(view, progress):
        return assemble_verdict(findings, Kind.UNKNOWN, view.basis, exclude)
    desk = FitContext(findings.first, findings.limits, findings.settings, progress)
    held = view.held()
    every = () if view.moved else (*view.material.recordings, *view.material.held_out)
    end = decide(desk, findings.seen.runs.forward, every, held, view.standstill)
    proposals = _next(view, end)
    budget = findings.seen.runs.budget
    budget.stage(1.0)
    apart = _apart(view, end, progress)
    budget.stage(math.inf if findings.settings.laws else 1.0)  # asked for, whatever it takes
    lawful = _lawful(view, end, held, progress)
    report = end.built.report if end.built else None
    if end.built is not None and _proves(end):
        report = own_motion(end.built, progress)
    basis = replace(view.basis, left_out=tuple(budget.left_out))
    if end.cut:
        basis = replace(basis, held_out="split")
    shown, unknown = lawful.explanation if lawful else None, end.kind is Kind.UNKNOWN
    findings = replace(
        findings,
        law=lawful.finding if lawful else None,
        shown=shown if unknown else None,
        beside=None if unknown else shown,
        found=end.found,
        built=report,
        gain=lawful.gain if lawful and shown and unknown else end.gain,
        forecast=end.forecast,
        before=end.before,
        proposals=proposals,
        twins=_twins(end, held),
        apart=apart,
    )
    return assemble_verdict(findings, end.kind, basis, exclude)


def _twins(end: Conclusion, held: HeldOut | None) -> Mapping[str, tuple[str, ...]]:
    """What nothing in the recordings tells from causes that are named together."""
    if end.found is None or not end.kind.names_causes or _proves(end):
        return {}
    runs, fit = end.found.evidence.runs, end.found.best
    places = [(runs, fit.shift)]
    if held is not None:
        there = held.seen.runs
        places.append((there, carried_point(runs, there, fit.shift)))
    labels = {cause.label for one in end.found.chosen for cause in one.causes}
    return one_way_twins(sorted(labels), places)


def _proves(end: Conclusion) -> bool:
    return end.built is not None and bool(end.built.report.proved)


def _apart(view: View, end: Conclusion, progress: Progress) -> tuple[Alone, ...]:
    """What each recording says alone, where together they are not explained."""
    found, findings = end.found, view.findings
    if _proves(end) or (found is not None and found.adequate):
        return ()
    bank, whitening = findings.first.screen.bank, view.whitening
    return disagreement(
        findings.seen, bank, whitening, findings.limits, findings.settings, progress
    )


def _lawful(view: View, end: Conclusion, held: HeldOut | None, progress: Progress) -> Lawful | None:
    """A law where no cause explains the record, or of what proved ones leave."""
    chosen, first = view.findings.settings, view.findings.first
    unknown = end.kind is Kind.UNKNOWN
    looks = not chosen.sparse if chosen.laws is None else chosen.laws  # dear runs: if asked
    wanted = looks and (unknown or (end.kind is Kind.PARTIAL and _proves(end)))
    if not wanted or view.findings.seen.runs.budget.skips(LAW):
        return None
    progress(0.0, "looking for a law" if unknown else "looking for a law in what is left")
    if end.built is not None and not unknown:
        return lawful_rest(end.built, view.limits, chosen, view.standstill, progress)
    return lawful_explanation(first, end.found, view.limits, chosen, held, progress)


def _one_is_enough(view: View, progress: Progress, glance: bool = False) -> bool:
    """Whether something is there, and a single cause leaves noise."""
    if not view.loud:
        return False
    had = view.findings
    found = explain(had.first, had.limits, had.settings, progress, together=False, glance=glance)
    return found is not None and found.adequate


def _next(view: View, end: Conclusion) -> tuple[Proposal, ...]:
    """Experiments that would tell causes apart."""
    found: Explanation | None = end.found
    if end.kind is not Kind.AMBIGUOUS or view.moved or found is None:
        return ()
    programmes = view.material.next_programmes
    offered = programmes() if callable(programmes) else programmes
    ranked = separations(view.findings.seen.runs, found.chosen, offered)
    return tuple(Proposal(s.programme.name, s.chi2) for s in ranked)
