"""refusal: why an extension is only a candidate."""

from __future__ import annotations

from ves_twin.diagnosis.verdict.verdict import Verdict


def refusal(verdict: Verdict) -> str:
    """Why the extension of a verdict that names causes is only a candidate; empty where it passed.

    It must gain on held-out recordings, and ahead in time where its sizes belong to a stretch. What
    is proved one by one need not gain in z^2 where the bare error of every channel falls.
    """
    gain, ahead = verdict.gain, verdict.forecast
    if verdict.proved and all(one.ended for one in verdict.proved):
        return "what was fitted ends its range, and stands for something else"
    if gain is None:
        return "there were no held-out recordings to prove it on"
    if gain.share is None:
        return "the held-out recordings show nothing that it could improve"
    if not gain.by_causes:
        return "the held-out recordings are explained better without the cause: they lack it"
    if gain.grown:
        return "the rms errors on held-out recordings grow with it"
    if not gain.passed and not (verdict.proved and gain.fallen):
        return f"its gain on held-out recordings is not clear of zero (from {gain.low:.2f})"
    if ahead is not None and not ahead.carries_on:
        return "it holds between the recordings it was fitted to and not beyond their end"
    return ""
