"""Numbers of materials that particles have from the file of points that fills their body."""

from __future__ import annotations

from collections.abc import Iterator
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin

import numpy as np
from pydantic import BaseModel, ValidationError

from mpmcli.geometry.points import DENSITY
from mpmcli.materials.own_numbers import TWINS, OwnMaterial
from mpmcli.scene.report import words_of

Array = np.ndarray

OF_HEAT = frozenset({"T0", "conductivity", "expansion", "heat_capacity", "taylor_quinney", "temperature"})
"""Numbers that matter to heat only."""
MATERIAL_RANGE = (1e-100, 1e100)
"""Sizes of numbers of materials of which formulas may take third powers."""


def number_keys(model: Any) -> Iterator[str]:
    """Yield the keys of a material's numbers, those of its parts as ``part.key``, without density and heat."""
    for name, value, is_number in _members(model):
        if isinstance(value, BaseModel):
            yield from (f"{name}.{inner}" for inner, _, is_inner in _members(value) if is_inner)
        elif is_number and name not in OF_HEAT and name != DENSITY:
            yield name


def _members(model: Any) -> Iterator[tuple[str, Any, bool]]:
    for key, field in type(model).model_fields.items():
        yield field.alias or key, getattr(model, key), _is_number(field.annotation)


def _is_number(annotation: Any) -> bool:
    """Whether a type is float, perhaps with bounds, or None."""
    if get_origin(annotation) is Annotated:
        return _is_number(get_args(annotation)[0])
    return annotation is float or (
        get_origin(annotation) in (Union, UnionType)
        and all(each is NoneType or _is_number(each) for each in get_args(annotation))
    )


def own_keys(body: Any, material: Any) -> list[str]:
    """Return the keys of the material that are columns of the body's file of points."""
    if material is None or not body.region.gives_particles:
        return []
    return [key for key in number_keys(material) if body.region.has_column(key)]


def can_differ(material: Any, analysis: str) -> bool:
    """Return whether particles may have numbers of the material of their own."""
    return type(material.parameters(analysis, False)) in TWINS and not material.bands


def is_calculable(model: Any, kind: str) -> bool:
    """Return whether the numbers that kernels need follow from those of a material."""
    if model.kind == "rigid":
        return True
    try:
        with np.errstate(all="ignore"):
            numbers = model.parameters(kind, False)
            model.initial_wave_speed(kind)
    except (ArithmeticError, np.linalg.LinAlgError):
        return False
    return not any(value != value for value in numbers if isinstance(value, float))


def models_of_columns(material: Any, columns: dict[str, Array]) -> tuple[list[Any], Array]:
    """Return the different models that columns (n,) by key make of a material, and which one each row has, (n,).

    Raises
    ------
    ColumnError
        If a row makes no material.
    """
    values, first, rows = np.unique(
        np.stack(list(columns.values()), axis=1), axis=0, return_index=True, return_inverse=True
    )
    found = []
    for value, row in zip(values, first, strict=True):
        try:
            found.append(_with_numbers(material, dict(zip(columns, map(float, value), strict=True))))
        except ValidationError as error:
            raise ColumnError(int(row), list(columns), error) from None
    return found, rows.ravel()


class ColumnError(ValueError):
    """A row of columns that makes no material.

    Attributes
    ----------
    row : its number
    column : the column that is wrong, or the first one
    words : what is wrong
    """

    def __init__(self, row: int, columns: list[str], error: ValidationError):
        first = error.errors()[0]
        inner = [name for name in columns if name.rpartition(".")[2] in first["loc"]]
        self.row, self.column = row, (inner or columns)[0]
        self.words = words_of(first["type"], first.get("ctx", {}), dict(first))
        super().__init__(self.words)


def _with_numbers(material: Any, numbers: dict[str, float]) -> Any:
    """Return a material with other numbers, by key; raises ValidationError."""
    given = _given(material)
    for key, value in numbers.items():
        part, _, inner = key.partition(".")
        if inner:
            given[part] = type(given[part])(**(_given(given[part]) | {inner: value}))
        else:
            given[part] = value
    return type(material)(**given)


def _given(model: Any) -> dict[str, Any]:
    fields = type(model).model_fields
    return {fields[name].alias or name: getattr(model, name) for name in model.model_fields_set}


def own_models(body: Any, material: Any, X: Array) -> tuple[list[Any], Array]:
    """Return the models of a body's particles at positions X (d, n) at the start, and which one each has, (n,)."""
    keys = own_keys(body, material)
    if body.region.density is not None:
        keys.append(DENSITY)
    return models_of_columns(material, body.region.columns_at(keys, X))


def materials_of(scene: Any) -> list[Any]:
    """Return the materials of a scene, those whose particles have numbers of their own as ``OwnMaterial``."""
    found: list[Any] = []
    for name, material in scene.materials.items():
        bodies = [body for body in scene.bodies if body.material == name]
        if not any(own_keys(body, material) for body in bodies):
            found.append(material)
            continue
        models = [model for body in bodies for model in body_models(scene, body)]
        found.append(OwnMaterial(material, models, scene.analysis.kind))
    return found


def body_models(scene: Any, body: Any) -> list[Any]:
    """Return the different models of a body's particles."""
    material = scene.materials[body.material]
    if not own_keys(body, material) and getattr(body.region, DENSITY, None) is None:
        return [material]
    return own_models(body, material, body.region.particles(scene.dimensions)[0])[0]


def set_own_numbers(scene: Any, model: Any, body: Any, X: Array, H: Array) -> None:
    """Write the numbers of a body's particles at positions X (d, n) into the history H (rows, n) of an OwnMaterial.

    What the history starts with may depend on them.
    """
    if not isinstance(model, OwnMaterial):
        return
    material = scene.materials[body.material]
    first = len(material.history)
    rows, which = [material], np.zeros(X.shape[1], dtype=np.int64)
    if body.region.gives_particles and (own_keys(body, material) or body.region.density is not None):
        rows, which = own_models(body, material, X)
    for name in material.initial_history():
        H[material.history.index(name)] = np.array([each.initial_history()[name] for each in rows])[which]
    table = np.array([model.parameters(scene.analysis.kind, False) for model in rows])
    H[first : first + table.shape[1]] = table[which].T
