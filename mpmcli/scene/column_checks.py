"""What is wrong with the columns of files of points: those that nothing reads, and densities of particles."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from mpmcli.core.analysis import STRESS_COMPONENTS
from mpmcli.core.suggest import did_you_mean, listing
from mpmcli.geometry.points import DENSITY
from mpmcli.scene.parts import Parts

MOST_NAMED = 5
"""Columns of a file that a message names."""
OF_ONE_DENSITY = ("granular", "rigid")
"""Kinds of material, beside equations of state, whose stress depends on the density, or that have none."""
STRESSES = tuple(f"stress_{name}" for name in STRESS_COMPONENTS[3])


def column_problems(body: Any, parts: Parts) -> Iterator[tuple[str, str, str, str]]:
    """Yield place, words, code and severity of what is wrong with the columns of a body of points."""
    material = parts.materials.get(body.material)
    reads_stress = getattr(body.stress, "kind", None) == "points"
    place, others = body.region.columns_beside(STRESSES if reads_stress else ())
    stresses = [name for name in others if name in STRESSES]
    if stresses:
        words = f"{place}: nothing reads {_columns(stresses)}; give the body 'stress: {{kind: points}}'"
        yield ".region.file", words, "no_effect", "warning"
    keys = () if material is None else type(material).model_fields.keys() - {"kind", "field"}
    own = [name for name in others if name in keys]
    if own:
        words = (
            f"{place}: {_columns(own)} cannot differ from particle to particle, only density can; leave the column "
            f"out, and give '{own[0]}' in the material, one body and material per value"
        )
        yield ".region.file", words, "column", "error"
    idle = [name for name in others if name not in (*stresses, *own)]
    if idle:
        known = (*STRESSES, DENSITY, "volume", *keys)
        hint = next(filter(None, (did_you_mean(name, known) for name in idle[:MOST_NAMED])), "")
        yield ".region.file", f"{place}: nothing reads {_columns(idle)}{hint}", "no_effect", "warning"
    if body.region.density is not None and material is not None:
        yield from _density_problems(body, material, place, parts)


def _density_problems(
    body: Any, material: Any, place: str, parts: Parts
) -> Iterator[tuple[str, str, str, str]]:
    """Yield what does not go with densities of particles."""
    reason = None
    if "equation_of_state" in material.properties or material.kind in OF_ONE_DENSITY:
        reason = f"a material of kind '{material.kind}' has one density"
    elif parts.heat is not None or getattr(parts.method, "heating", None) == "adiabatic":
        reason = "heat needs one density of the material"
    elif getattr(parts.method, "artificial_viscosity", None) is not None:
        reason = "artificial viscosity needs one density of the material"
    elif getattr(body.stress, "kind", None) == "geostatic":
        reason = "geostatic stress needs one density of the material; give the stresses in the file"
    else:
        for _, load in parts.loads:
            if "impedance_of" in load.effects() and load.loaded_face()[0] == body.name:
                reason = f"the load '{load.name}' absorbs waves of a material with one density"
    if reason is not None:
        words = f"{place}: the column 'density' cannot be used here: {reason}"
        yield ".region.file", words, "column", "error"


def _columns(names: list[str]) -> str:
    """The columns in words."""
    quoted = [f"'{name}'" for name in names]
    return f"column{'s' * (len(names) > 1)} {listing(quoted, MOST_NAMED)}"
