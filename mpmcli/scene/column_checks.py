"""What is wrong with the columns of files of points: those that nothing reads, densities and numbers of particles."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from mpmcli.core.analysis import STRESS_COMPONENTS
from mpmcli.core.suggest import did_you_mean, listing
from mpmcli.geometry.points import DENSITY
from mpmcli.scene.own_numbers import (
    MATERIAL_RANGE,
    ColumnError,
    RowNumbers,
    can_differ,
    number_keys,
    numbers_of_columns,
)
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
    numbers = () if material is None or material.kind == "rigid" else tuple(number_keys(material))
    keys = set(() if material is None else type(material).model_fields) - {"kind", "field", DENSITY} | set(
        numbers
    )
    own = [name for name in others if name in keys]
    differ = numbers if own and numbers and can_differ(material, parts.analysis.kind) else ()
    fixed = [name for name in own if name not in differ]
    if fixed and material is not None:
        allowed = f"in '{material.kind}' only density{''.join(f', {name}' for name in differ)} can"
        if "equation_of_state" in material.properties:
            allowed = f"because '{material.kind}' is an equation of state, which has one set of numbers"
        words = (
            f"{place}: {_columns(fixed)} cannot differ from particle to particle, {allowed}; leave the column "
            f"out, and give '{fixed[0]}' in the material, one body and material per value"
        )
        yield ".region.file", words, "column", "error"
    elif own:
        yield from _number_problems(body, material, own, place, parts)
    idle = [name for name in others if name not in (*stresses, *own)]
    if idle:
        known = (*STRESSES, DENSITY, "volume", *keys)
        hint = next(filter(None, (did_you_mean(name, known) for name in idle[:MOST_NAMED])), "")
        yield ".region.file", f"{place}: nothing reads {_columns(idle)}{hint}", "no_effect", "warning"
    if body.region.density is not None and material is not None:
        yield from _density_problems(body, material, place, parts)


def _number_problems(
    body: Any, material: Any, own: list[str], place: str, parts: Parts
) -> Iterator[tuple[str, str, str, str]]:
    """Yield what does not go with numbers of particles."""
    reason = None
    if parts.heat is not None or getattr(parts.method, "heating", None) == "adiabatic":
        reason = "heat needs one set of numbers of the material"
    elif parts.fracture is not None:
        reason = "stress intensity factors need one set of numbers of the material"
    if reason is not None:
        yield ".region.file", f"{place}: {_columns(own)} cannot be used here: {reason}", "column", "error"
        return
    columns = body.region.numbers([*own, *([] if body.region.density is None else [DENSITY])])
    found: RowNumbers | None = None
    try:
        found = numbers_of_columns(material, columns, parts.analysis.kind)
    except ColumnError as error:
        words = f"{body.region.place_of(error.row, error.column)}: {error.words}"
        yield ".region.file", words, "column", "error"
        return
    except ArithmeticError:
        pass
    sizes = np.abs(np.stack(list(columns.values())))
    is_possible = ((sizes == 0.0) | ((sizes >= MATERIAL_RANGE[0]) & (sizes <= MATERIAL_RANGE[1]))).all()
    if found is None or not is_possible or np.isnan(found.table).any():
        words = f"{place}: some numbers of {_columns(own)} are too large or too small to calculate with"
        yield ".region.file", words, "range", "error"


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
    if reason is not None:
        words = f"{place}: the column 'density' cannot be used here: {reason}"
        yield ".region.file", words, "column", "error"


def _columns(names: list[str]) -> str:
    """The columns in words."""
    quoted = [f"'{name}'" for name in names]
    return f"column{'s' * (len(names) > 1)} {listing(quoted, MOST_NAMED)}"
