"""Bodies: groups of particles of one generator and material, by a region where they fill cells evenly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcli.importers.cbgeo.particles import Filled, as_table, filled
from mpmcli.importers.cbgeo.reading import Array
from mpmcli.importers.cbgeo.source import OtherGenerator
from mpmcli.importers.cbgeo.work import Work


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
            work.note("not_supported", ("particles", index, "generator", "type"), words)
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
        if materials.get(material):
            bodies.append(body)
            found.append(Made(name, members, even))
    _refuse_stress(work)
    return found


def _refuse_stress(work: Work) -> None:
    stress = work.cloud.stress
    if stress is not None and stress.any():
        words = "this version of mpmcli has no initial stress"
        work.note("not_supported", ("mesh", "particles_stresses"), words)
