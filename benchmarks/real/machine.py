"""Set: a measured machine made ready: its two files, recordings to fit and to hold out."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import mujoco
import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.model.forward import Channel
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording
from ves_twin.machines.mjcf.rig.machine import Rig


@dataclass(frozen=True)
class Set:
    """One way to ask: which recordings are fitted, and which are held out.

    `error` tells that of a rig on recordings where it is not the rms of the compared channels.
    """

    name: str
    rig: Rig
    fitted: list[Recording]
    held_out: list[Recording]
    expert: str
    asked: str
    error: Callable[[Rig, Sequence[Recording]], str] | None = None

    def noisy(self, seed: int) -> Set:
        """With white noise of the declared sd more in all that is compared: what hangs on it?"""
        rng, channels = np.random.default_rng(seed), MjcfForward.of(self.rig).channels
        groups = [
            [_noisy(one, channels, rng) for one in group] for group in (self.fitted, self.held_out)
        ]
        return replace(self, fitted=groups[0], held_out=groups[1])


def _noisy(
    recording: Recording, channels: Sequence[Channel], rng: np.random.Generator
) -> Recording:
    signals = {name: np.array(values) for name, values in recording.signals.items()}
    for channel in channels:
        if channel.signal in signals:
            noise = channel.sd * rng.standard_normal(len(recording.time))
            signals[channel.signal][:, channel.column] += noise
    return replace(recording, signals=signals)


def machine(folder: Path, name: str, model: str, description: str) -> Rig:
    """Write the two files and load them."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.xml").write_text(model)
    (folder / f"{name}.toml").write_text(description)
    return Rig.load(str(folder / f"{name}.toml"))


def of_urdf(urdf: Path, joints: Iterable[str]) -> mujoco.MjSpec:
    """An arm of a URDF without shapes, contacts, limits and friction, a motor at each joint."""
    tree = ElementTree.parse(urdf)
    for link in tree.getroot().iter("link"):
        for part in (*link.findall("visual"), *link.findall("collision")):
            link.remove(part)
        inertia = link.find("inertial/inertia")
        if inertia is not None and float(inertia.attrib["ixx"]) == 0.0:  # rounded to zero there
            for axis in ("ixx", "iyy", "izz"):
                inertia.attrib[axis] = "1e-4"
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(tree.getroot(), encoding="unicode"))
    for k, name in enumerate(joints, 1):
        joint = spec.joint(name)
        joint.limited, joint.frictionloss, joint.actfrclimited = 0, 0.0, 0
        actuator = spec.add_actuator(name=f"motor_{k}", target=name)
        actuator.trntype = mujoco.mjtTrn.mjTRN_JOINT
    spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    return spec


def read(rig: Rig, path: Path) -> Recording:
    """A log of the machine."""
    return read_rig_recording(path, rig)


def stretch(recording: Recording, start: float, stop: float) -> Recording:
    """Rows from start to stop [s]."""
    rows = (recording.time >= start) & (recording.time < stop)
    signals = {name: values[rows] for name, values in recording.signals.items()}
    return Recording(recording.time[rows], signals, recording.info)


OF_JOINTS = (
    "viscous_friction",
    "coulomb_friction",
    "viscous_asymmetry",
    "coulomb_asymmetry",
    "quadratic_drag",
    "stribeck_friction",
    "load_friction",
    "force_offset",
    "joint_spring",
    "rotor_inertia",
)
"""Kinds that are offered at every joint of an arm."""


def effects(*kinds: tuple[str, Iterable[str]]) -> str:
    """Tables of what may be wrong, and where."""
    tables = (f'\n[[effects]]\nkind = "{k}"\non = {json.dumps(list(on))}\n' for k, on in kinds)
    return "".join(tables)
