"""make_laws, answer_laws, score_laws: laws that no library has, hidden in a machine."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from ves_twin.core.json_text import json_text
from ves_twin.core.recording.files import load_recording
from ves_twin.core.recording.recording import Recording
from ves_twin.core.whole_file import write_whole
from ves_twin.diagnosis.law.result import LawFinding
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.diagnose import diagnose
from ves_twin.suites.hidden_law import LAW_KINDS, VES2_LAW_KINDS, HiddenLaw, draw_law, takes
from ves_twin.suites.machine import BlindMachine, BlindRig
from ves_twin.suites.machines import machine_of
from ves_twin.suites.mjcf import BlindMjcf
from ves_twin.suites.save_bare import save_bare
from ves_twin.suites.spot import PENDULUM, Spot, spots_of
from ves_twin.suites.suite import OF_VES2

MACHINE = "pendulum"

FILES = ("recording.parquet", "held_out.parquet")
"""Of a case."""

STANDSTILL = "standstill.parquet"

IN_ORDER, LIBRARY = "none", "library"
"""Cases that hide nothing, and a cause that the library has."""

LIBRARY_SIZES = (4.0, 0.8)
"""Of a library cause: so many of its smallest, and of its largest, size."""


@dataclass(frozen=True)
class LawTruth:
    """What a case hides.

    Attributes:
        case: its folder.
        kind: of `LAW_KINDS`, a kind outside the library, IN_ORDER or LIBRARY.
        seed: of everything drawn.
        machine: in which it is hidden.
    """

    case: str
    kind: str
    seed: tuple[int, int]
    machine: str = MACHINE

    @property
    def rng(self) -> np.random.Generator:
        """Draws of the case."""
        return np.random.default_rng(self.seed)


@dataclass(frozen=True)
class LawAnswer:
    """What a diagnosis said of a case.

    Attributes:
        verdict: kind.
        law: what the search for a law found; None if there was none.
        seconds: processor time, that of workers included.
    """

    verdict: str
    law: Mapping[str, object] | None
    seconds: float


def make_laws(kinds: Sequence[str], folder: Path, seed: int, name: str = MACHINE) -> list[LawTruth]:
    """Write recordings that hide a law each; the truths go beside the folder.

    Args:
        kinds: one for each case.
        folder: for the recordings, which tell nothing else.
        seed: of everything drawn.
        name: of the machine.
    """
    machine = machine_of(name)
    rng = np.random.default_rng([seed, 0])
    standing = BlindRig(machine.commissioned(rng))
    save_bare(machine.record(standing, "standstill", rng), folder / STANDSTILL)
    truths = [LawTruth(f"case-{n:04d}", kind, (seed, n), name) for n, kind in enumerate(kinds, 1)]
    for truth in truths:
        rig, _ = hidden_in(machine, truth)
        rng = np.random.default_rng([*truth.seed, 1])
        again = machine.again(rig.values, rng, 1.0, 0.0)
        pair = (rig, BlindRig(again, rig.outside, rig.size, law=rig.law))
        for one, programme, name in zip(pair, ("train", "held_out"), FILES, strict=True):
            save_bare(machine.record(one, programme, rng), folder / truth.case / name)
    content = [asdict(truth) for truth in truths]
    write_whole(truth_file(folder), json_text(content) + "\n")
    return truths


def hidden_in(machine: BlindMachine, truth: LawTruth) -> tuple[BlindRig, HiddenLaw | None]:
    """The rig of a case, and its law where that is one of ours."""
    rng = truth.rng
    values = machine.commissioned(rng)
    if truth.kind in {*LAW_KINDS, *VES2_LAW_KINDS}:
        law = draw_law(truth.kind, rng, _spots(machine, truth.machine))
        return BlindRig(values, law=law), law
    if truth.kind == LIBRARY:
        library = machine.forward.hypotheses
        cause = library[int(rng.integers(len(library)))]
        low, high = LIBRARY_SIZES[0] * cause.smallest[0], LIBRARY_SIZES[1] * cause.largest[0]
        size = float(rng.choice(cause.signs) * np.exp(rng.uniform(np.log(low), np.log(high))))
        known = {p.name: p for p in machine.forward.parameters}[cause.parameters[0]]
        there = values.get(known.name, known.nominal)
        values = {**values, known.name: float(np.clip(there + size, known.low, known.high))}
        return BlindRig(values), None
    if truth.kind == IN_ORDER:
        return BlindRig(values), None
    low, high = machine.outside[truth.kind]
    return BlindRig(values, truth.kind, float(np.exp(rng.uniform(np.log(low), np.log(high))))), None


def _spots(machine: BlindMachine, name: str) -> tuple[Spot, ...]:
    """Joints of a machine at which laws are hidden."""
    if name == MACHINE or not isinstance(machine, BlindMjcf):
        return (PENDULUM,)
    return spots_of(machine.forward, machine.programme("train"))


def hidden_kinds(name: str) -> list[str]:
    """Kinds that can be hidden in a machine."""
    if name in OF_VES2:
        return [*VES2_LAW_KINDS]
    if name == MACHINE:
        return [*LAW_KINDS, *WHERE]
    spots = _spots(machine_of(name), name)
    return [kind for kind in LAW_KINDS if any(takes(spot, kind) for spot in spots)]


def truth_file(folder: Path) -> Path:
    """Beside the folder: an answer is given from the folder alone."""
    return folder.with_suffix(".truths.json")


def read_law_truths(folder: Path) -> list[LawTruth]:
    """As `make_laws` wrote them."""
    content = json.loads(truth_file(folder).read_text(encoding="utf-8"))
    return [
        LawTruth(c["case"], c["kind"], (c["seed"][0], c["seed"][1]), c["machine"]) for c in content
    ]


def answer_laws(
    folder: Path,
    settings: Settings,
    told: Callable[[str, LawAnswer], None],
    name: str = MACHINE,
) -> dict[str, LawAnswer]:
    """Diagnose every case from its recordings, with laws looked for; answered ones stay.

    Args:
        folder: of the suite.
        settings: of the diagnosis.
        told: called with each answer.
        name: of the machine.
    """
    file = folder / "answers.json"
    found: dict[str, LawAnswer] = {}
    if file.is_file():
        content = json.loads(file.read_text(encoding="utf-8"))
        found = {case: LawAnswer(**answer) for case, answer in content.items()}
    still = load_recording(folder / STANDSTILL)
    for place in sorted(folder.glob("case-*")):
        if place.name in found:
            continue
        begin = _processor_time()
        recording, held = (load_recording(place / name) for name in FILES)
        law, verdict = _answered(recording, held, still, settings, name)
        found[place.name] = LawAnswer(verdict, law, round(_processor_time() - begin, 1))
        told(place.name, found[place.name])
        text = json_text({case: asdict(answer) for case, answer in found.items()})
        write_whole(file, text + "\n")
    return found


def _processor_time() -> float:
    """Of this process and of its workers that have ended [s]."""
    return sum(os.times()[:4])


def _answered(
    recording: Recording, held: Recording, still: Recording, settings: Settings, name: str
) -> tuple[dict[str, object] | None, str]:
    quiet = None if name in OF_VES2 else still  # legs hunt over a count while they stand
    found = diagnose(
        [recording], OF_VES2.get(name, name), held_out=[held], standstill=quiet, settings=settings
    )
    law: LawFinding | None = found.verdict.law
    return (asdict(law) if law else None), found.verdict.verdict.value


@dataclass(frozen=True)
class LawScore:
    """How one case was answered.

    Attributes:
        kind: that was hidden.
        verdict: kind of verdict.
        claimed: whether a law was claimed.
        place: whether place and variables are right; None where nobody can tell them.
        rms: of the law less the truth over the range seen, as a share of the truth's own; None
            where no law of one variable was found at the right place.
        gain: held-out gain of the law; None without one.
        covered: share of the band's places that hold the truth; None without a band.
        seconds: processor time.
    """

    kind: str
    verdict: str
    claimed: bool
    place: bool | None
    rms: float | None
    gain: float | None
    covered: float | None
    seconds: float


WHERE: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "quadratic_drag": ("joint", ("speed@joint",)),
    "gravity_tilt": ("joint", ("position@joint",)),
    "late_drift": ("joint.angle", ("time",)),
    "offset_step": ("joint.angle", ("time",)),
    "line": ("joint.angle", ("time",)),
    "encoder_hysteresis": ("joint.angle", ()),
    "soft_stop": ("joint", ("position@joint",)),
    "stuck_samples": ("joint.angle", ()),
}
"""Where the kinds outside the library act, and on what they depend."""


def score_law(truth: LawTruth, answer: LawAnswer) -> LawScore:
    """Hold an answer against the truth."""
    law = answer.law
    _, hidden = hidden_in(machine_of(truth.machine), truth)
    where = WHERE.get(truth.kind)
    if hidden is not None:
        where = hidden.place, (hidden.of,)
    gain = law["gain"] if law else None
    share = gain["share"] if isinstance(gain, dict) else None
    right = None
    if where is not None:
        right = law is not None and (law["place"], tuple(_texts(law["of"]))) == where
    rms, covered = None, None
    if hidden is not None and law is not None and right and law["shape"] == "table":
        rms, covered = _against(hidden, law)
    claimed = law is not None and bool(law["claimed"])
    return LawScore(truth.kind, answer.verdict, claimed, right, rms, share, covered, answer.seconds)


def _texts(value: object) -> list[str]:
    return [str(one) for one in value] if isinstance(value, list | tuple) else []


def _numbers(value: object) -> list[list[float]]:
    return [list(map(float, one)) for one in value] if isinstance(value, list | tuple) else []


def _against(hidden: HiddenLaw, law: Mapping[str, object]) -> tuple[float, float | None]:
    """Rms error over the range seen, less what a constant is: commissioning errors have one."""
    (low, high), *_ = _numbers(law["seen"])
    knots = _numbers(law["knots"])[0]
    values = law["values"]
    x = np.linspace(low, high, 61)
    true = np.asarray(hidden.function(x))
    found = np.interp(x, knots, np.asarray(values, float))
    rms = float(np.std(found - true) / max(float(np.std(true)), 1e-12))
    band = _numbers(law["band"])
    if not band:
        return rms, None
    at, least, most = (np.array(rows) for rows in band)
    shift = float(np.mean(found - true))
    there = np.asarray(hidden.function(at)) + shift
    return rms, float(np.mean((there >= least) & (there <= most)))
