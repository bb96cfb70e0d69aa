"""Numbers of materials, density among them, that particles have from the file of points that fills their body."""

from collections.abc import Callable, Iterator, Mapping
from types import NoneType, UnionType
from typing import Annotated, Any, NamedTuple, Union, get_args, get_origin

import numpy as np
from pydantic import BaseModel, ValidationError

from mpmcli.core.rows import RowError, by_rows
from mpmcli.geometry.points import DENSITY
from mpmcli.materials.own_numbers import TWINS, OwnMaterial
from mpmcli.scene.report import words_of

Array = np.ndarray

OF_HEAT = frozenset({"T0", "conductivity", "expansion", "heat_capacity", "taylor_quinney", "temperature"})
"""Numbers that matter to heat only."""
MATERIAL_RANGE = (1e-100, 1e100)
"""Sizes of numbers of materials of which formulas may take third powers."""


def number_keys(model: Any) -> Iterator[str]:
    """Yield the keys of a material's numbers without density and heat; those of its parts as ``part.key``.

    Those of the parts of a list are ``list.index.key``, as in every path of a scene.
    """
    for name, value, is_number in _members(model):
        if isinstance(value, BaseModel):
            yield from _keys_of_part(name, value)
        elif isinstance(value, tuple):
            for index, part in enumerate(value):
                if isinstance(part, BaseModel):
                    yield from _keys_of_part(f"{name}.{index}", part)
        elif is_number and name not in OF_HEAT and name != DENSITY:
            yield name


def _keys_of_part(path: str, part: BaseModel) -> Iterator[str]:
    return (f"{path}.{name}" for name, _, is_number in _members(part) if is_number)


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
    return type(material.parameters(analysis, False)) in TWINS


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


class RowNumbers(NamedTuple):
    """What a material makes of rows of numbers."""

    table: Array
    """Numbers of its law (members, n)."""
    speed: Array
    """Wave speed at rest (n,) [velocity]."""
    history: dict[str, Array]
    """Start values (n,) of history variables, by name."""


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


def numbers_of_columns(material: Any, columns: Mapping[str, Array], kind: str) -> RowNumbers:
    """Return what a material makes of columns (n,) by key, for a kind of analysis.

    The model is made for the rows with the extremes of a column, whose ranges then hold for all rows; its checks of
    several numbers, and what it makes of them, are evaluated for all rows at once.

    Raises ColumnError if a row makes no material, and RowError if numbers are too large or too small to calculate
    with.
    """
    extremes = {int(find(column)): None for column in columns.values() for find in (np.argmin, np.argmax)}
    for row in extremes:
        _check_row(material, columns, row)
    names = tuple(material.initial_history())

    def evaluate(model: Any) -> tuple[Any, ...]:
        _check_again(model)
        start = model.initial_history()
        return (
            *model.parameters(kind, False),
            model.initial_wave_speed(kind),
            *(start[name] for name in names),
        )

    try:
        found = values_of_rows(material, columns, evaluate)
    except RowError as error:
        _check_row(material, columns, error.row)
        raise
    last = len(found) - len(names)
    return RowNumbers(found[: last - 1], found[last - 1], dict(zip(names, found[last:], strict=True)))


def values_of_rows(
    material: Any, columns: Mapping[str, Array], values: Callable[[Any], tuple[Any, ...]]
) -> Array:
    """Return values (k, n) of the models that rows of columns (n,) by key make; raises RowError."""

    def unchecked(model: Any, changed: dict[str, Any]) -> Any:
        return model.model_copy(update=changed)

    return by_rows(lambda numbers: values(with_numbers(material, numbers, unchecked)), columns)


def row_of(columns: Mapping[str, Array], row: int) -> dict[str, float]:
    """Return the numbers of a row by key."""
    return {key: float(column[row]) for key, column in columns.items()}


def _check_row(material: Any, columns: Mapping[str, Array], row: int) -> None:
    try:
        with_numbers(material, row_of(columns, row))
    except ValidationError as error:
        raise ColumnError(row, list(columns), error) from None


def _checked(model: Any, changed: dict[str, Any]) -> Any:
    """Return a model with other values, by field; raises ValidationError."""
    fields = type(model).model_fields
    given = {name: getattr(model, name) for name in model.model_fields_set} | changed
    return type(model)(**{fields[name].alias or name: value for name, value in given.items()})


def _check_again(model: Any) -> None:
    """Let a model and its parts check that its values go together; raises ValueError."""
    for name, check in type(model).__pydantic_decorators__.model_validators.items():
        if check.info.mode == "after":
            getattr(model, name)()
    for name in type(model).model_fields:
        value = getattr(model, name)
        for part in value if isinstance(value, tuple) else (value,):
            if isinstance(part, BaseModel):
                _check_again(part)


def with_numbers(
    model: Any, numbers: Mapping[str, Any], remade: Callable[[Any, dict[str, Any]], Any] = _checked
) -> Any:
    """Return a material with other numbers, by key; raises ValidationError."""
    parts: dict[str, dict[str, Any]] = {}
    for key, value in numbers.items():
        if not key:
            return value
        first, _, rest = key.partition(".")
        parts.setdefault(first, {})[rest] = value
    if isinstance(model, tuple):
        return tuple(with_numbers(part, parts.get(str(i), {}), remade) for i, part in enumerate(model))
    if not parts:
        return model
    names = {field.alias or name: name for name, field in type(model).model_fields.items()}
    return remade(
        model,
        {names[key]: with_numbers(getattr(model, names[key]), inner, remade) for key, inner in parts.items()},
    )


def values_of_particles(
    body: Any, material: Any, values: Callable[[Any], tuple[Any, ...]], X: Array | None = None
) -> Array:
    """Return values (k, n) of the models of a body's particles at positions X (d, n) at the start, by default all.

    Without columns of their own they have the same (k, 1).
    """
    keys = _own_columns(body, material)
    if not keys:
        return np.array(values(material))[:, None]
    columns = body.region.numbers(keys) if X is None else body.region.columns_at(keys, X)
    return values_of_rows(material, columns, values)


def _own_columns(body: Any, material: Any) -> list[str]:
    """Return the columns of the body's file that the material reads."""
    density = [] if getattr(body.region, DENSITY, None) is None else [DENSITY]
    return own_keys(body, material) + density


def fastest_wave(scene: Any, body: Any) -> float:
    """Return the largest wave speed at rest of a body's particles, by their own numbers [velocity]."""
    material, kind = scene.materials[body.material], scene.analysis.kind
    columns = body.region.numbers(keys) if (keys := _own_columns(body, material)) else {}
    if not columns:
        return float(material.initial_wave_speed(kind))
    return float(numbers_of_columns(material, columns, kind).speed.max())


def materials_of(scene: Any) -> list[Any]:
    """Return the materials of a scene, those whose particles have numbers of their own as ``OwnMaterial``."""
    found: list[Any] = []
    for name, material in scene.materials.items():
        bodies = [body for body in scene.bodies if body.material == name]
        if any(own_keys(body, material) for body in bodies):
            fastest = max(fastest_wave(scene, body) for body in bodies)
            material = OwnMaterial(material, fastest, scene.analysis.kind)
        found.append(material)
    return found


def set_own_numbers(scene: Any, model: Any, body: Any, X: Array, H: Array) -> None:
    """Write the numbers of a body's particles at positions X (d, n) into the history H (rows, n) of an OwnMaterial.

    What the history starts with may depend on them.
    """
    if not isinstance(model, OwnMaterial):
        return
    material, kind = scene.materials[body.material], scene.analysis.kind
    first = len(material.history)
    if not _own_columns(body, material):
        numbers = np.array(material.parameters(kind, False))
        H[first : first + len(numbers)] = numbers[:, None]
        return
    columns = body.region.columns_at(_own_columns(body, material), X)
    found = numbers_of_columns(material, columns, kind)
    for name, start in found.history.items():
        H[material.history.index(name)] = start
    H[first : first + len(found.table)] = found.table


def lightest_density(body: Any, material: Any) -> float:
    """Return the smallest mass density of the particles of a body of this material."""
    own = getattr(body.region, "density", None)
    return float(material.density if own is None else own.min())


def lightness(scene: Any) -> list[float]:
    """Return the density of each material over that of its lightest particle.

    It is 1 of materials without own densities, and of those whose particles have further numbers of their own: their
    wave speeds take them into account.
    """
    found = []
    for name, material in scene.materials.items():
        bodies = [body for body in scene.bodies if body.material == name and material.kind != "rigid"]
        if any(own_keys(body, material) for body in bodies):
            bodies = []
        found.append(
            max((material.density / lightest_density(body, material) for body in bodies), default=1.0)
        )
    return found
