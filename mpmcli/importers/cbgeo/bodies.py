"""Bodies: groups of particles of one generator and material, by a region where they fill cells evenly."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcli.importers.base import Expression
from mpmcli.importers.cbgeo.mesh import AXES, rounded
from mpmcli.importers.cbgeo.particles import Filled, as_table, filled
from mpmcli.importers.cbgeo.reading import Array
from mpmcli.importers.cbgeo.source import OtherGenerator
from mpmcli.importers.cbgeo.work import Work
from mpmcli.importers.scene_text import number_text

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "xz")
"""Components of stress in the order of the source."""
LINEAR = 1e-5
"""How far stresses may lie from a linear field, in shares of the largest one: files have few digits."""


@dataclass(frozen=True)
class Made:
    """A body of the scene: its name, its particles in the source, and the boxes that they fill, if they do."""

    name: str
    members: Array
    filled: Filled | None


def add_bodies(work: Work, materials: dict[int, str]) -> list[Made]:
    """Translate all particles."""
    for index, entry in enumerate(work.given.source.particles):
        if isinstance(entry.generator, OtherGenerator):
            kind = entry.generator.type
            words = "particles that appear during the run" if kind == "inject" else f"the generator '{kind}'"
            work.lacks(("particles", index, "generator", "type"), words)
    cloud = work.cloud
    groups = sorted(set(zip(cloud.generator.tolist(), cloud.material.tolist(), strict=True)))
    found: list[Made] = []
    bodies = work.scene.setdefault("bodies", [])
    for generator, material in groups:
        members = np.flatnonzero((cloud.generator == generator) & (cloud.material == material))
        name = "body" if len(groups) == 1 else f"body {len(found) + 1}"
        even = filled(cloud.x[members], cloud.volume[members], work.grid)
        body: dict[str, Any] = {"name": name, "material": materials.get(material, "")}
        if even is not None:
            body["region"] = even.region()
            same = len(set(even.per_axis)) == 1
            body["particles_per_axis"] = even.per_axis[0] if same else even.per_axis
            if even.at_gauss_points:
                words = f"particles lie in the middles of {even.per_axis[0]} sub-cells per axis, not at Gauss points"
                work.note("changed", ("particles", generator, "generator"), words)
        else:
            file = f"{name.replace(' ', '_')}.csv"
            work.made.files[file] = as_table(cloud.x[members], cloud.volume[members])
            body["region"] = {"kind": "points", "file": file}
            words = f"{len(members)} particles with the volumes that CB-Geo gives them"
            work.made.comment(("bodies", len(bodies)), words)
        stress = _stress(work, members)
        if stress is not None:
            body["stress"] = stress
        if materials.get(material):
            bodies.append(body)
            found.append(Made(name, members, even))
    return found


def _stress(work: Work, members: Array) -> dict[str, Any] | None:
    """The stress of a body at the start, where each component is constant or linear in space; None without stress."""
    if work.cloud.stress is None or not work.cloud.stress[members].any():
        return None
    stress = work.cloud.stress[members]
    x = work.cloud.x[members]
    largest = float(np.abs(stress).max())
    made: dict[str, Any] = {"kind": "components"}
    for name, values in zip(COMPONENTS, stress.T, strict=True):
        field = _linear(x, values, LINEAR * largest)
        if field is None:
            words = f"initial stresses {name} that are neither constant nor linear in space"
            work.lacks(("mesh", "particles_stresses"), words)
            return None
        if field != 0:
            made[name] = field
    return made


def _linear(x: Array, values: Array, tolerance: float) -> float | Expression | None:
    """A number, or an expression linear in x, y, z, that gives values (n,) at places (n, d); None if none does."""
    if np.ptp(values) <= tolerance:
        mean = float(rounded(values.mean()))
        return mean if abs(mean) > tolerance else 0.0
    matrix = np.c_[np.ones(len(x)), x - x.mean(axis=0)]
    numbers = np.linalg.lstsq(matrix, values, rcond=None)[0]
    if np.abs(matrix @ numbers - values).max() > tolerance:
        return None
    slopes = [
        slope if abs(slope) * np.ptp(x[:, k]) > tolerance else 0.0 for k, slope in enumerate(numbers[1:])
    ]
    start = float(rounded(numbers[0] - np.dot(slopes, x.mean(axis=0))))
    text = number_text(start) if abs(start) > tolerance else ""
    for axis, slope in zip(AXES, slopes, strict=False):
        if slope:
            factor = number_text(float(rounded(np.array(abs(slope)))))
            text += f"{' - ' if slope < 0 else ' + '}{factor}*{axis}"
    return Expression(text.removeprefix(" + ").replace(" - ", "-", 1) if text.startswith(" ") else text)
