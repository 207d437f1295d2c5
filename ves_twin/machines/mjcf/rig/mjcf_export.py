"""mjcf_of: an MJCF machine's model with what its file found, as one plain MJCF file."""

from __future__ import annotations

import copy
import os
import tempfile
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
from numpy.typing import NDArray

from ves_twin.core.errors import InvalidInputError, one_line
from ves_twin.core.mjcf_export import MjcfExport
from ves_twin.effects.element import Element
from ves_twin.machines.mjcf.rig.account import changed_numbers
from ves_twin.machines.mjcf.rig.actuator_bias import bias_of, write_biases
from ves_twin.machines.mjcf.rig.law_share import carried_of
from ves_twin.machines.mjcf.rig.machine import Rig

NEVER = (
    "the columns of a log: units, signs, zeros, noise, and what drives the machine",
    "typical sizes, tolerances and sources of the numbers",
)
"""What no MJCF file of a machine has."""

SIZES = ("nq", "nv", "nu", "nbody", "njnt", "ngeom", "nsite", "nmesh", "ntendon", "neq")
NUMBERS = (
    *("body_mass", "body_inertia", "body_pos", "body_ipos", "dof_damping", "dof_frictionloss"),
    *("dof_armature", "jnt_stiffness", "actuator_gear", "actuator_gainprm", "actuator_biasprm"),
)
"""Of a model, that are held against what was written."""

DIGITS = 1e-5
"""Relative error of a number with six digits."""

REST = 0.01
"""Share of a law from which what MJCF lacks of it is told."""

COMPILER = "attached models, boundmass, boundinertia, settotalmass, inertiafromgeom"
"""What writes another model than it is, or none."""


def mjcf_of(rig: Rig, folder: Path) -> MjcfExport:
    """The model's file with all numbers that the machine's file changes, at MJCF's six digits.

    Dry friction is as stiff in it as it is simulated here. An effect counts as carried if the
    compiled model differs by it: what acts on commands, readings or by a law of its own does not.
    Of a law over a joint's speed it has what friction loss and damping are.

    Args:
        rig: both files.
        folder: that the new file will lie in, from which it finds meshes and textures.

    Raises:
        InvalidInputError: a model that MuJoCo cannot write so that it reads the same again.
    """
    model = copy.copy(rig.model)
    carried = [f"{name}: {values}" for name, values in changed_numbers(rig)]
    lost: list[str] = []
    for effect, _ in rig.effects_at({}):
        before = _numbers(model)
        if (bias := bias_of(effect, model)) is not None:
            bias.edit(model)
        elif effect.element is not Element.LOG:  # a log's clock stretches the step, no machine
            effect.edit_model(model)
        (lost if np.array_equal(before, _numbers(model)) else carried).append(effect.label)
    for law in rig.laws:
        part = carried_of(law, model)
        if part is not None:
            carried.append(f"of law {law.label}, {part.words(model)}")
            part.edit(model)
        if part is None or part.left > REST:
            rest = f", {100.0 * part.left:.2g} % of it" if part else ""
            lost.append(f"law {law.label}{rest}")
    body = _xml(rig.folder / rig.description.model, model, folder)
    title = f"{rig.description.name}, exported by ves_twin; hash {rig.identity}."
    return MjcfExport.of(title, body, carried, lost, NEVER)


def rig_of_mjcf(rig: Rig, text: str, folder: Path) -> Rig:
    """A rig whose model is such a file, written into a folder, and that changes nothing of it."""
    name = "carried.xml"
    (folder / name).write_text(text, encoding="utf-8")
    plain: dict[str, object] = {"model": name, "parameters": (), "present": {}, "laws": ()}
    read = Rig(rig.description.model_copy(update=plain), folder, rig.file)
    _ = read.model, read.identity  # while the file is there
    return read


def _numbers(model: mujoco.MjModel) -> NDArray[np.uint8]:
    """All that a model holds, byte by byte."""
    held = np.empty(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, held)
    return held


def _xml(path: Path, model: mujoco.MjModel, folder: Path) -> str:
    """A model's file with the numbers of another model of the same sizes."""
    with tempfile.TemporaryDirectory() as place:
        written = Path(place) / "model.xml"
        try:
            mujoco.MjModel.from_xml_path(str(path))  # MuJoCo writes over what it read last
            mujoco.mj_saveLastXML(str(written), model)
            root = ElementTree.parse(written).getroot()
            _assets(root, path.parent.resolve())
            write_biases(root, model)
            written.write_text(ElementTree.tostring(root, encoding="unicode"), encoding="utf-8")
            _check(mujoco.MjModel.from_xml_path(str(written)), model)
        except (ValueError, mujoco.FatalError) as error:
            expected = f"a model that MuJoCo writes and reads again, without {COMPILER}"
            raise InvalidInputError(str(path), one_line(error), expected) from None
    _assets(root, path.parent, folder)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def _assets(root: ElementTree.Element, there: Path, folder: Path | None = None) -> None:
    """Let a file find what lies in a model's folder, absolute, or from another folder."""
    compiler = root.find("compiler")
    if compiler is None or root.find("asset") is None:
        return
    for name in ("meshdir", "texturedir"):
        own = there / compiler.get(name, "")  # what is absolute stays so
        compiler.set(
            name, (own if folder is None else Path(os.path.relpath(own, folder))).as_posix()
        )


def _check(read: mujoco.MjModel, model: mujoco.MjModel) -> None:
    """Hold what was written against what was meant.

    Raises:
        ValueError: with what differs.
    """
    for name in SIZES:
        if getattr(read, name) != getattr(model, name):
            raise ValueError(f"{name} is {getattr(read, name)}, was {getattr(model, name)}")
    if read.names != model.names:
        raise ValueError("names differ")
    for name in NUMBERS:
        one, two = getattr(read, name), getattr(model, name)
        if not np.allclose(
            one, two, rtol=DIGITS, atol=DIGITS * float(np.max(np.abs(two), initial=0))
        ):
            raise ValueError(f"{name} is not written as it is")
