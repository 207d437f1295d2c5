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
from ves_twin.machines.mjcf.rig.machine import Rig

NEVER = (
    "the columns of a log: units, signs, zeros, noise, and what drives the machine",
    "typical sizes, tolerances and sources of the numbers",
)
"""What no MJCF file of a machine has."""


def mjcf_of(rig: Rig, folder: Path) -> MjcfExport:
    """The model's file with all numbers that the machine's file changes, at MJCF's six digits.

    Dry friction is as stiff in it as it is simulated here. An effect counts as carried if the
    compiled model differs by it: what acts on commands, readings or by a law of its own does not.

    Args:
        rig: both files.
        folder: that the new file will lie in, from which it finds meshes and textures.

    Raises:
        InvalidInputError: numbers that no rigid body can have.
    """
    model = copy.copy(rig.model)
    carried = [f"{name}: {values}" for name, values in changed_numbers(rig)]
    lost: list[str] = []
    for effect, _ in rig.effects_at({}):
        before = _numbers(model)
        if effect.element is not Element.LOG:  # a log's clock stretches the step, no machine
            effect.edit_model(model)
        (lost if np.array_equal(before, _numbers(model)) else carried).append(effect.label)
    lost += [f"law {law.label}" for law in rig.laws]
    body = _xml(rig.folder / rig.description.model, model, folder)
    title = f"{rig.description.name}, exported by ves_twin; hash {rig.identity}."
    return MjcfExport.of(title, body, carried, lost, NEVER)


def _numbers(model: mujoco.MjModel) -> NDArray[np.uint8]:
    """All that a model holds, byte by byte."""
    held = np.empty(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, held)
    return held


def _xml(path: Path, model: mujoco.MjModel, folder: Path) -> str:
    """A model's file with the numbers of another model of the same sizes."""
    try:
        mujoco.MjModel.from_xml_path(str(path))  # MuJoCo writes over what it read last
        with tempfile.TemporaryDirectory() as place:
            written = Path(place) / "model.xml"
            mujoco.mj_saveLastXML(str(written), model)
            root = ElementTree.parse(written).getroot()
    except (ValueError, mujoco.FatalError) as error:
        raise InvalidInputError(str(path), one_line(error), "a model that can be written") from None
    compiler = root.find("compiler")
    if compiler is not None and root.find("asset") is not None:
        for name in ("meshdir", "texturedir"):
            there = path.parent / compiler.get(name, "")
            compiler.set(name, Path(os.path.relpath(there, folder)).as_posix())
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"
