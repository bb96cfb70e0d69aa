"""Names in a scene become columns of tables and fields of archives, or errors in words."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from mpmcli.core.errors import Problem, SceneError
from mpmcli.core.suggest import did_you_mean, listing
from mpmcli.output import (  # noqa: F401  (they fill the registry)
    contact_quantities,
    crack_quantities,
    global_quantities,
    heat_quantities,
    interface_quantities,
    particle_quantities,
)
from mpmcli.output.quantities import QUANTITIES, Context, Quantity
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.archive import FIELDS, FIELDS_OF_SOME

DEFAULT = "default"
"""The word for "the columns that this scene has by itself" in a list of columns."""

OF_CRACKS = ("crack", "tip")
NAMED = ("reaction", "heat", "pair", "field", *OF_CRACKS)
"""Places whose quantities are computed by name."""
PLACES = ("global", "material", "body", *NAMED)
"""Places whose quantities are columns."""


@dataclass(frozen=True)
class Column:
    """One column of a table: a component of a quantity, for one owner where it has owners."""

    name: str
    quantity: Quantity
    row: int | None = None
    owner: str = ""
    aliases: tuple[str, ...] = ()

    @property
    def dimension(self) -> str:
        """Physical dimension of its numbers."""
        return self.quantity.dimension

    def pick(self, values: Any, snapshot: Snapshot) -> float:
        """Its number among the values of its quantity."""
        where = self.quantity.where
        if where in NAMED:
            found = values.get(self.owner)
            if found is None:
                return 0.0
            return float(found if self.row is None else found[self.row])
        if where in ("body", "material"):
            owners = snapshot.state.bodies if where == "body" else snapshot.state.materials
            index = owners.index(self.owner)
            return float(values[index] if self.row is None else values[self.row, index])
        return float(values if self.row is None else values[self.row])


def evaluate(columns: Iterable[Column], snapshot: Snapshot) -> list[float]:
    """The numbers of one row of a table; each quantity is computed once."""
    known: dict[int, Any] = {}
    numbers = []
    for column in columns:
        key = id(column.quantity)
        if key not in known:
            known[key] = column.quantity.compute(snapshot)
        numbers.append(column.pick(known[key], snapshot))
    return numbers


def all_columns(context: Context) -> list[Column]:
    """Every column that a table of this scene can have, in their order."""
    columns: list[Column] = []
    for quantity in QUANTITIES.at(*PLACES):
        if quantity.exists(context):
            columns += _columns_of(quantity, context)
    columns += [Column(name, _extra(name), aliases=(name,)) for name in context.extra]
    first: dict[str, Column] = {}
    for column in columns:
        first.setdefault(column.name, column)
    return list(first.values())


def _columns_of(quantity: Quantity, context: Context) -> list[Column]:
    base = quantity.name
    parts: list[tuple[int | None, str]] = [
        (i, f"{base}_{row}") for i, row in enumerate(quantity.rows(context))
    ]
    parts = parts or [(None, base)]
    if quantity.where == "global":
        return [Column(name, quantity, row, "", (base, name)) for row, name in parts]
    return [
        Column(f"{name}[{owner}]", quantity, row, owner, (base, name, f"{base}[{owner}]", f"{name}[{owner}]"))
        for owner in quantity.names(context)
        for row, name in parts
    ]


EXTRA = {
    "boundary_friction_work": (
        "energy", "energy taken out by friction on planes and walls; part of boundary_work, where it is negative"),
    "deleted_particles": ("1", "number of particles that have left the grid (domain.on_exit: delete)"),
    "deleted_mass": ("mass", "their mass"),
    "deleted_heat": ("energy", "the heat_inflow that they took with them"),
    "feedback_rate": ("rate", "rate of feedback damping (method.damping.feedback)"),
    "mean_order": (
        "1", "mean over all steps of the order that the transfer reached, 1 in steps of FLIP (transfers with dynamic, "
        "every_courant or every_steps)"),
}  # fmt: skip
"""Columns that the solver names, in scenes that have them: their dimensions, and what they mean."""


def extra_quantities() -> list[Quantity]:
    """The columns that the solver names."""
    return [_extra(name) for name in EXTRA]


def _extra(name: str) -> Quantity:
    dimension, text = EXTRA.get(name, ("1", "as named by the solver"))
    return Quantity(name, name, dimension, "scalar", "global", lambda s: s.state.extra.get(name, 0.0), text)


def default_columns(context: Context) -> list[Column]:
    """The columns that a table has if the scene asks for none in particular: only what the scene uses."""
    return [column for column in all_columns(context) if column.quantity.is_default(context)]


def resolve_columns(
    names: Iterable[str] | None, context: Context, path: str = "archive.globals.columns"
) -> list[Column]:
    """The columns that a list of names stands for.

    A name is a column (``momentum_x``, ``stress_xx[rubber]``), a quantity (``momentum``, ``stress``: all its
    components and owners), one component of all owners (``stress_xx``), all components of one owner
    (``stress[rubber]``), or ``default``: the columns without a list. Without names: those as well. Raises SceneError
    listing every name that is no column of this scene, with the nearest one.
    """
    if names is None:
        return default_columns(context)
    by_alias: dict[str, list[Column]] = {DEFAULT: default_columns(context)}
    for column in all_columns(context):
        for alias in dict.fromkeys(column.aliases):
            by_alias.setdefault(alias, []).append(column)
    chosen: dict[str, Column] = {}
    problems = []
    for index, name in enumerate(names):
        if name in by_alias:
            chosen |= {column.name: column for column in by_alias[name]}
        elif name not in ("step", "time", "dt"):
            text = unknown_column(name, by_alias, context)
            problems.append(Problem(path=f"{path}.{index}", message=text, code="unknown_column"))
    if problems:
        raise SceneError(problems)
    return list(chosen.values())


def chosen_names(
    names: Iterable[str], noun: str, known: Iterable[str], path: str, code: str,
    why_absent: Callable[[str], str] = lambda name: "",
) -> list[str]:  # fmt: skip
    """The names, each once; SceneError lists all that are not known, with why, or with the nearest one."""
    names, known = list(names), list(known)
    problems = [
        Problem(f"{path}.{index}", why_absent(name) or unknown_name(name, noun, known), code=code)
        for index, name in enumerate(names)
        if name not in known
    ]
    if problems:
        raise SceneError(problems)
    return list(dict.fromkeys(names))


def unknown_name(name: str, noun: str, names: Iterable[str]) -> str:
    """``'masss' is no column of this scene; did you mean 'mass'? (…)``."""
    known = list(names)
    shown = list(dict.fromkeys(alias.split("[")[0] for alias in known))
    return f"'{name}' is not a {noun}{did_you_mean(name, known)} (allowed: {listing(shown)})"


def unknown_column(name: str, names: Iterable[str], context: Context) -> str:
    """Why a name is no column of a scene: what its cracks lack for it, or the nearest name."""
    base, _, owner = name.removesuffix("]").partition("[")
    elsewhere = {quantity.name for quantity in QUANTITIES.at(*PLACES[: -len(OF_CRACKS)])}
    for quantity in QUANTITIES.at(*OF_CRACKS):
        if quantity.name not in elsewhere and base.removesuffix("_x").removesuffix("_y") == quantity.name:
            words = crack_quantities.why_missing(quantity, owner, context)
            if words:
                return f"'{name}' {words}"
    return _absent(name, PLACES, context) or unknown_name(name, "column of this scene", names)


def _absent(name: str, places: Iterable[str], context: Context) -> str:
    """Return what is said of a name that other scenes have; empty where there is none."""
    base = name.partition("[")[0]
    named = [q for q in QUANTITIES.at(*places) if q.name in (base, base.rpartition("_")[0])]
    if not named or any(quantity.exists(context) for quantity in named):
        return ""
    return f"'{name}' does not exist in this scene ({named[0].description.partition(';')[0]})"


def fields_of(context: Context) -> dict[str, Quantity]:
    """What can be written of this scene's particles, by name, history variables of its materials included."""
    found = {q.name: q for q in QUANTITIES.at("particle") if q.exists(context)}
    for name in dict.fromkeys(context.history):
        found.setdefault(name, _history(name))
    return found


_OF_PRESSURE = (
    "crack_driver", "dissipated_energy", "heat_energy", "internal_energy", "plastic_work", "plastic_work_of_step",
    "preconsolidation_pressure", "stiffening", "stored_energy",
)  # fmt: skip
HISTORY_DIMENSIONS = {
    "temperature": "temperature",
    **dict.fromkeys(("band_x", "band_y", "band_z"), "length"),
    **dict.fromkeys(_OF_PRESSURE, "pressure"),
}


def _history(name: str) -> Quantity:
    dimension = HISTORY_DIMENSIONS.get(name, "1")
    text = f"history variable '{name}' of the materials that have it, 0 for the others"
    return Quantity(name, name, dimension, "scalar", "particle", lambda s: s.history(name), text)


def archived_names(asked: Iterable[str] | None, context: Context) -> Iterable[str]:
    """What ``archive.particles.fields`` asks for, or what archives have without it."""
    if asked is not None:
        return asked
    known = fields_of(context)
    return (*FIELDS, *(name for name in FIELDS_OF_SOME if name in known))


def resolve_fields(
    names: Iterable[str], context: Context, path: str = "archive.particles.fields"
) -> list[Quantity]:
    """The quantities of particles with these names, each once; SceneError names all that are unknown."""
    known = fields_of(context)
    chosen = chosen_names(
        names, "field of particles", known, path, "unknown_field", lambda name: _absent(name, ("particle",), context)
    )  # fmt: skip
    return [known[name] for name in chosen]
