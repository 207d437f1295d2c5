"""GivenModel: a user's MJCF or URDF file, compiled, with motors where a URDF has none."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import mujoco
import numpy as np

from ves_twin.core.engine_log import log_engine
from ves_twin.core.errors import FileAccessError, InvalidInputError, one_line
from ves_twin.machines.mjcf.draft.spots import single_joints

SMALLEST_INERTIA = 1e-4
"""Least inertia [kg m^2] of a URDF's link: files of arms round those of a wrist to zero."""

INERTIA = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
INDICES = ((0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2))
"""Numbers of a URDF's inertia, and where they stand in the tensor."""

ROUNDED = 1e-6
"""Share by which a second moment may be below zero: files round, and so does MuJoCo's check."""

FLAT = 1e-3
"""Share of the largest second moment that the others have at least: a flat body's."""

DRIVEN = frozenset({"revolute", "prismatic", "continuous"})

LINKS = 3
"""Joints in a row from which on centres that all lie in their joints are no chance: assumed."""

CENTRED = 1e-6
"""Distance [m] of a centre from its joint that is none: files round."""


@dataclass(frozen=True)
class GivenModel:
    """A model, and the text of the file that must be written for it.

    Attributes:
        path: of the user's file.
        model: compiled.
        text: MJCF to write beside the machine's file; empty where the user's file will do.
        notes: what was done to it, a sentence each.
    """

    path: Path
    model: mujoco.MjModel
    text: str
    notes: tuple[str, ...]

    @staticmethod
    def read(path: Path) -> GivenModel:
        """A model of either kind.

        Raises:
            FileAccessError: missing file.
            InvalidInputError: neither MJCF nor URDF, links without inertia whose shapes are
                missing, no joint with a name that turns or slides, or no actuators.
        """
        try:
            root = ElementTree.fromstring(path.read_bytes())
        except OSError as error:
            raise FileAccessError(f"model file '{path}': {error.strerror}") from None
        except ElementTree.ParseError as error:
            raise InvalidInputError(str(path), one_line(error), "an MJCF or URDF file") from None
        log_engine()
        if root.tag == "robot":
            found = _of_urdf(path, root)
        else:
            try:
                model = mujoco.MjModel.from_xml_path(str(path))
            except (ValueError, mujoco.FatalError) as error:
                raise InvalidInputError(str(path), one_line(error), "a MuJoCo model") from None
            found = GivenModel(path, model, "", ())
        if not single_joints(found.model):
            came = "no named joint that turns or slides"
            raise InvalidInputError(str(path), came, "one; name= in <joint> names it")
        return found


def _of_urdf(path: Path, root: ElementTree.Element) -> GivenModel:
    """As MJCF without shapes, contacts and stops, with a motor at each joint that is driven."""
    notes, missing = [], _without_shapes(root, path)
    if missing:
        few = ", ".join(missing[:2])
        notes.append(f"{len(missing)} mesh files are missing ({few}): shapes are left out")
    _refuse_words(root, path)
    thin = [name for link in root.iter("link") if (name := _thickened(link))]
    if thin:
        words = f"inertia of {', '.join(thin)} is zero: {SMALLEST_INERTIA:g} kg m^2 is taken"
        notes.append(words)
    bent = [name for link in root.iter("link") if (name := _made_physical(link))]
    if bent:
        why = "a moment is below zero, or above the sum of the other two"
        notes.append(f"no body has the inertia of {', '.join(bent)} ({why}): the nearest is taken")
    bare = [link.get("name", "?") for link in root.iter("link") if link.find("inertial") is None]
    driven = [j.get("name", "") for j in root.iter("joint") if j.get("type") in DRIVEN]
    try:
        spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
        for name in driven:
            joint = spec.joint(name)
            joint.limited, joint.actfrclimited = 0, 0
            actuator = spec.add_actuator(name=f"motor_{name}", target=name)
            actuator.trntype = mujoco.mjtTrn.mjTRN_JOINT
        spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        model = spec.compile()
        text = str(spec.to_xml())
    except (ValueError, mujoco.FatalError) as error:
        light = bare and "mass" in str(error)
        hint = f"; without <inertial>: {', '.join(bare)}" if light else ""
        expected = "a URDF whose moving links have <inertial>"
        raise InvalidInputError(str(path), one_line(error) + hint, expected) from None
    notes += _words_of_centres(model)
    notes.append(
        f"a motor was added at each of {len(driven)} joints; stops and contacts are left out"
    )
    return GivenModel(path, model, text, tuple(notes))


def _without_shapes(root: ElementTree.Element, path: Path) -> list[str]:
    """Takes shapes off; the mesh files among them that are not there."""
    missing = []
    for link in root.iter("link"):
        for part in (*link.findall("visual"), *link.findall("collision")):
            for mesh in part.iter("mesh"):
                name = mesh.get("filename", "")
                if not (path.parent / name.removeprefix("file://")).is_file():
                    missing.append(name.rpartition("/")[2])
            link.remove(part)
    return sorted(set(missing))


def _refuse_words(root: ElementTree.Element, path: Path) -> None:
    """Refuses a word where a mass or an inertia is a number."""
    for link in root.iter("link"):
        for part in (*link.findall("inertial/mass"), *link.findall("inertial/inertia")):
            for key, text in part.items():
                if not _is_number(text):
                    name, came = link.get("name", "?"), f'{key}="{text}"'
                    raise InvalidInputError(f"{path}: link {name}", came, "a number")


def _words_of_centres(model: mujoco.MjModel) -> list[str]:
    """That all links of an arm have their centre of mass in their joint: nobody measured any."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    roots = model.body_weldid
    heavy = np.flatnonzero((model.body_mass > 0.0) & (roots > 0))
    aside = data.xipos[heavy] - data.xpos[roots[heavy]]
    deepest = max(map(partial(_depth, model), heavy), default=0)
    if np.any(np.abs(aside) > CENTRED) or deepest < LINKS:
        return []
    words = f"all {len(heavy)} links have their centre of mass in their joint: placeholders? Write"
    return [f"{words} what a drawing says, or measure them: the weight of an arm hangs on it"]


def _depth(model: mujoco.MjModel, body: int) -> int:
    """Joints between a body and the world."""
    count = 0
    while body > 0:
        count += int(model.body_jntnum[body])
        body = int(model.body_parentid[body])
    return count


def _is_number(text: str) -> bool:
    """Whether a text is a finite number."""
    try:
        return bool(np.isfinite(float(text)))
    except ValueError:
        return False


def _thickened(link: ElementTree.Element) -> str:
    """Gives a link whose inertia is rounded to zero the smallest one; its name if so."""
    mass, inertia = link.find("inertial/mass"), link.find("inertial/inertia")
    if mass is None or inertia is None or float(mass.get("value", "0")) <= 0.0:
        return ""
    axes = [axis for axis in ("ixx", "iyy", "izz") if float(inertia.get(axis, "0")) <= 0.0]
    for axis in axes:
        inertia.set(axis, f"{SMALLEST_INERTIA:g}")
    return link.get("name", "") if axes else ""


def _made_physical(link: ElementTree.Element) -> str:
    """Gives a link whose inertia no mass can have the nearest one that some has; its name if so.

    I = tr(S) 1 - S with second moments S = 1/2 tr(I) 1 - I, which are positive of any mass.
    """
    told = link.find("inertial/inertia")
    if told is None:
        return ""
    numbers = {axes: float(told.get(axes, "0")) for axes in INERTIA}
    xx, yy, zz, xy, xz, yz = numbers.values()
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    size, axes = np.linalg.eigh(0.5 * np.trace(inertia) * np.eye(3) - inertia)
    if xx + yy + zz <= 0.0 or size[0] >= -ROUNDED * size[-1]:
        return ""
    moments = axes @ np.diag(np.maximum(size, FLAT * size[-1])) @ axes.T
    nearest = np.trace(moments) * np.eye(3) - moments
    for name, (row, column) in zip(INERTIA, zip(*INDICES, strict=True), strict=True):
        told.set(name, f"{nearest[row, column]:.9g}")
    return link.get("name", "")
