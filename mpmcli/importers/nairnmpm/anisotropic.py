"""Materials with axes, and the axes of bodies."""

import math
from collections.abc import Callable
from typing import Any

from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.constants import quotient
from mpmcli.importers.nairnmpm.job import Job, Material
from mpmcli.importers.nairnmpm.shapes import NAMES
from mpmcli.importers.nairnmpm.values import Value

Made = dict[str, Any]
ANISOTROPIC = {2, 3, 4, 15}
AXIAL = {"EA": "E_axial", "ET": "E_transverse", "GA": "G_axial", "nuA": "nu_axial", "nuT": "nu_transverse"}
ORTHOTROPIC = {
    **{f"E{theirs}": f"E{ours}" for theirs, ours in zip("xyz", "123", strict=True)},
    **{
        f"{word}{theirs}": f"{word}{ours}"
        for word in ("G", "nu")
        for theirs, ours in (("xy", "12"), ("xz", "13"), ("yz", "23"))
    },
}


def with_axes(kind: str, names: dict[str, str], axis: str = "") -> Callable[[Job, Material], Made | None]:
    """An elastic material with axes, by the names of its constants."""

    def make(job: Job, material: Material) -> Made | None:
        made: Made = {"kind": kind} | ({"axis": axis} if axis else {})
        others = _axial(job, material.command) if axis else _reversed(job, material.command)
        for theirs, ours in names.items():
            value = others.get(theirs) or job.needed(material.command, theirs)
            if value is None:
                return None
            made[ours] = value
        return made

    return make


def _axial(job: Job, command: Command) -> dict[str, Value]:
    """Constants that follow from others: of ET, nuT and GT, two are given; nuA is 0.33 by default."""
    given = {name: job.property(command, name) for name in ("ET", "nuT", "GT", "nuA")}
    found = {name: value for name, value in given.items() if value is not None}
    if "nuA" not in found:
        job.changed(command, "without nuA, NairnMPM's value is 0.33")
        found["nuA"] = Value(0.33)
    shear = found.pop("GT", None)
    if shear is None:
        return found
    if "ET" in found and "nuT" in found:
        job.error(command, "ET, nuT and GT are given, of which two are enough")
    elif "ET" in found:
        found["nuT"] = Value(quotient(found["ET"].scaled, 2 * shear.scaled) - 1)
    elif "nuT" in found:
        found["ET"] = Value(2 * shear.scaled * (1 + found["nuT"].scaled))
    return found


def _reversed(job: Job, command: Command) -> dict[str, Value]:
    """Constants that are given with their axes the other way round: Gyx = Gxy, nuyx/Ey = nuxy/Ex."""
    found: dict[str, Value] = {}
    for a, b in ("xy", "xz", "yz"):
        shear, ratio = job.property(command, f"G{b}{a}"), job.property(command, f"nu{b}{a}")
        if shear is not None:
            found[f"G{a}{b}"] = shear
        along, across = job.property(command, f"E{a}"), job.property(command, f"E{b}")
        if ratio is not None and command.first(f"nu{a}{b}") is not None:
            job.error(command, f"nu{a}{b} and nu{b}{a} are given, of which one is enough")
        elif ratio is not None and along is not None and across is not None:
            found[f"nu{a}{b}"] = Value(ratio.scaled * quotient(along.scaled, across.scaled))
    return found


_HILL = ("xx", "yy", "zz", "xy", "xz", "yz")


def hill(job: Job, material: Material) -> Made | None:
    """Hill plasticity: yield stresses along and across the axes, with the flow stress of the first of them."""
    command = material.command
    made = with_axes("hill_plastic", ORTHOTROPIC)(job, material)
    given = {key: job.property(command, f"yld{key}") for key in _HILL}
    found = {key: value for key, value in given.items() if value is not None and value.scaled > 0}
    K, n = job.property(command, "Khard"), job.property(command, "nhard")
    if made is None:
        return None
    lacking = [f"yld{key}" for key in (_HILL if job.analysis == "3d" else _HILL[:4]) if key not in found]
    if lacking:
        job.note("not_supported", command, f"yield stresses without bound: {', '.join(lacking)}")
        return None
    flow = found["xx"]
    ratios = {
        f"R{number}": Value((math.sqrt(3.0) if key in _HILL[3:] else 1.0) * found[key].scaled / flow.scaled)
        for key, number in zip(_HILL[1:], ("22", "33", "12", "13", "23"), strict=True)
        if key in found
    }
    made["anisotropy"] = {"kind": "ratios", **ratios}
    made["hardening"] = {"kind": "linear", "yield_stress": flow}
    if K is None or K.scaled == 0:
        return made
    job.changed(command, "the plastic strain of the hardening law is conjugate to Hill's equivalent stress")
    slope = Value(flow.scaled * K.scaled)
    if n is None or n.scaled == 1:
        made["hardening"]["modulus"] = slope
    else:
        made["hardening"] |= {"kind": "power_law", "B": slope, "n": n}
    return made


def body_axes(job: Job, command: Command) -> list[Made]:
    """The turns of the material axes of a body.

    NairnMPM turns them clockwise. The rotation from material axes to those of the grid is the product of its rotations
    in their order: the last one turns first.
    """
    turns: list[Made] = []
    for inside in command.children:
        if inside.name in NAMES:
            break  # what follows is not for this shape
        if inside.name == "Unrotate":
            inside.handled = True
            turns = []
        elif inside.name.startswith("Rotate"):
            inside.handled = True
            angle = _clockwise(job, inside)
            if angle is not None:
                turns.insert(0, {"angle": angle, "axis": inside.name[-1].lower()})
    whole = job.number(command, "angle")
    if not turns and whole is not None and whole.number != 0:
        turns = [{"angle": whole.negative, "axis": "z"}]
    if job.analysis != "3d":
        if any(turn["axis"] != "z" for turn in turns):
            job.error(command, "in 2D, material axes turn about z only")
        for turn in turns:
            del turn["axis"]
    return turns


def _clockwise(job: Job, command: Command) -> Any:
    """Minus an angle: a number, or an expression of place."""
    try:
        float(job.word(command))
    except ValueError:
        formula = job.formula(command, command.text)
        return None if formula is None else formula.negative
    value = job.number(command, None)
    return value.negative if value is not None and value.number != 0 else None
