"""Probes: one table each, of a particle, of a point of the grid, of two velocity fields, or of a crack."""

import itertools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np

from mpmcli.core.errors import Problem, SceneError
from mpmcli.core.state import GridView, State
from mpmcli.core.suggest import did_you_mean, listing
from mpmcli.output.columns import chosen_names, resolve_fields
from mpmcli.output.quantities import AXES, QUANTITIES, Context, Probe, Quantity, columns_of
from mpmcli.output.snapshot import Snapshot


class ParticleProbe(Probe):
    """Follows the particle of a body that was nearest to a point at the start.

    Parameters
    ----------
    state : that of the start; without it, only columns are known
    near : the point, shape (d,) [length]
    quantities : what is written of it; NaN once the particle has been deleted
    """

    def __init__(
        self,
        name: str,
        state: State | None,
        body: str | None,
        near: Sequence[float],
        quantities: Sequence[Quantity],
        context: Context,
    ):
        self.name = name
        self.quantities = list(quantities)
        self.id = -1 if state is None else nearest_particle(state, body, near)
        self.columns, self.dimensions = columns_of(self.quantities, context)

    def look(self, snapshot: Snapshot) -> list[float]:
        found = np.flatnonzero(snapshot.particles.id == self.id)
        if not len(found):
            return [float("nan")] * len(self.columns)
        values = [np.atleast_1d(q.compute(snapshot)[..., found[0]]) for q in self.quantities]
        return [number.item() for number in itertools.chain.from_iterable(values)]


class PointProbe(Probe):
    """Stands at a fixed point and reads nodal fields through linear functions.

    Only nodes with mass take part in a velocity, only those with contact in its normal, separation and traction
    (their weights are scaled to sum to 1); these are NaN where there is none. Before the first step everything is
    NaN.
    """

    def __init__(self, name: str, at: Sequence[float], fields: Sequence[str]):
        self.name = name
        self.at = np.array(at, dtype=float)
        self.fields = list(fields)
        self.columns, self.dimensions = [], []
        for field in self.fields:
            axes = AXES[: len(self.at)] if GRID_FIELDS[field].is_vector else ""
            self.columns += [f"{field}_{axis}" for axis in axes] or [field]
            self.dimensions += [GRID_FIELDS[field].dimension] * max(len(axes), 1)

    def look(self, snapshot: Snapshot) -> list[float]:
        grid = snapshot.state.grid
        if grid is None or not snapshot.has_grid:
            return [float("nan")] * len(self.columns)
        nodes, weights = linear_weights(grid, self.at)
        numbers: list[float] = []
        for field in self.fields:
            values = nodal_values(snapshot, field)[nodes]
            among = GRID_FIELDS[field].among
            if among:
                held = np.atleast_2d(grid.fields[among]()[nodes].T).any(axis=0)
                shares = np.where(held, weights, 0.0)
                total = shares.sum()
                values = shares @ values / total if total > 0.0 else np.full(values.shape[1:], np.nan)
            else:
                values = weights @ values
            numbers += [number.item() for number in np.atleast_1d(values)]
        return numbers


class PairProbe(Probe):
    """Reads what two velocity fields do to each other.

    Parameters
    ----------
    pair : its name in columns, ``"left|right"``
    sign : −1 where vectors are wanted of the second of its fields
    """

    def __init__(self, name: str, pair: str, sign: float, quantities: Sequence[Quantity], context: Context):
        self.name = name
        self.pair, self.sign = pair, sign
        self.quantities = list(quantities)
        self.columns, self.dimensions = columns_of(self.quantities, context)

    def look(self, snapshot: Snapshot) -> list[float]:
        numbers: list[float] = []
        for quantity in self.quantities:
            values = np.atleast_1d(quantity.compute(snapshot)[self.pair])
            sign = self.sign if quantity.rank == "vector" else 1.0
            numbers += [sign * number for number in values.tolist()]
        return numbers


@dataclass(frozen=True)
class GridField:
    """A nodal field that can be written.

    Attributes
    ----------
    dimension : physical dimension
    is_vector : one number per axis
    description : one line for the documentation
    among : another field, which is zero where this one has no value; empty for sums, which are of the full ring
    exists : function of a ``Context``: whether the scene has it
    """

    dimension: str
    is_vector: bool
    description: str
    among: str = ""
    exists: Callable[[Context], Any] = lambda context: True


def _of_side(side: int) -> dict[str, GridField]:
    words = f"on side {side} of the node, {WHERE[side]}"
    mass, needed = f"mass_side_{side}", 4 if side > 1 else 2

    def exists(context: Context) -> bool:
        return context.sides >= needed

    return {
        mass: GridField("mass", False, f"mass {words}", exists=exists),
        f"velocity_side_{side}": GridField("velocity", True, f"velocity {words}", among=mass, exists=exists),
    }


WHERE = ("its own", "beyond its first crack", "beyond its second crack", "beyond both of its cracks")
_CONTACT: dict[str, Any] = {"among": "contact_normal", "exists": attrgetter("has_normals")}
_INTERFACE: dict[str, Any] = {"among": "interface_is_there", "exists": attrgetter("interfaces")}
_WITH_HEAT = attrgetter("has_heat")
GRID_FIELDS = {
    "mass": GridField("mass", False, "mass"),
    "momentum": GridField("momentum", True, "momentum"),
    "force": GridField("force", True, "total force in the last step"),
    "velocity": GridField("velocity", True, "velocity of the centre of mass of all velocity fields", among="mass"),
    "contact_normal": GridField(
        "1", True, "unit normal, from the first velocity field at the node outward", **_CONTACT),
    "contact_separation": GridField(
        "length", False, "distance of the two sides at the start of the last step, negative where they overlap; nan "
        "where unknown", **_CONTACT),
    "contact_traction": GridField(
        "pressure", True, "contact force per area on the first velocity field", **_CONTACT),
    "interface_jump": GridField(
        "length", True, "jump of displacement from the first velocity field at the node to the second; 0 without an "
        "interface", **_INTERFACE),
    "interface_traction": GridField(
        "pressure", True, "traction of the interface on the first velocity field at the node; 0 without an interface",
        **_INTERFACE),
    "interface_damage": GridField(
        "1", False, "share of its stiffness that the interface has lost; 1: broken, 0 without an interface",
        **_INTERFACE),
    "heat_capacity": GridField(
        "energy/temperature", False, "heat capacity in the last step that conducted", exists=_WITH_HEAT),
    "temperature": GridField(
        "temperature", False, "temperature after the last step that conducted, mean by capacity of all velocity fields",
        among="heat_capacity", exists=_WITH_HEAT),
    **{name: entry for side in range(4) for name, entry in _of_side(side).items()},
}  # fmt: skip
"""Nodal fields by name; rigid bodies are in none of them but those of contact."""


def grid_fields(context: Context) -> dict[str, GridField]:
    """The nodal fields that a scene has."""
    return {name: entry for name, entry in GRID_FIELDS.items() if entry.exists(context)}


def resolve_grid_fields(
    names: Iterable[str], context: Context, path: str = "archive.grid.fields"
) -> list[str]:
    """The names, each once; SceneError names all that the scene does not have."""
    return chosen_names(names, "field of the grid", grid_fields(context), path, "unknown_field")


def nodal_values(snapshot: Snapshot, name: str) -> np.ndarray:
    """A nodal field by name, (n,) or (n, d); mass, momentum and force are those of the full ring."""
    grid = snapshot.state.grid
    if grid is None:
        raise ValueError("the state has no grid")
    values = grid.fields[name]()
    return values if GRID_FIELDS[name].among else values * snapshot.full_ring


def linear_weights(grid: GridView, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The 2ᵈ nodes around a point, as flattened indices, and its multilinear weights there."""
    place = (np.asarray(at) - grid.lower) / grid.cell
    first = np.clip(np.floor(place).astype(int), 0, np.array(grid.nodes) - 2)
    part = place - first
    nodes, weights = [], []
    for corner in itertools.product((0, 1), repeat=len(part)):
        index, weight = 0, 1.0
        for axis in reversed(range(len(part))):
            index = index * grid.nodes[axis] + int(first[axis]) + corner[axis]
            weight *= part[axis] if corner[axis] else 1.0 - part[axis]
        nodes.append(index)
        weights.append(weight)
    return np.array(nodes), np.array(weights)


def nearest_particle(state: State, body: str | None, near: Sequence[float]) -> int:
    """Identity of the particle (of a body) nearest to a point; of equally near ones the smallest identity."""
    particles = state.particles
    owned = (
        np.ones(particles.count, dtype=bool) if body is None else particles.body == state.bodies.index(body)
    )
    if not owned.any():
        raise SceneError(f"a probe follows a particle of body '{body}', which has no particles")
    distance = ((particles.X[:, owned] - np.asarray(near, dtype=float)[:, None]) ** 2).sum(axis=0)
    # round-off must not decide between equally near particles
    candidates = distance <= distance.min() * (1.0 + 1e-9)
    return int(particles.id[owned][candidates].min())


OF_INTERFACES = (
    "jump_normal",
    "jump_tangential",
    "interface_traction_normal",
    "interface_traction_tangential",
)
OF_CONTACTS = ("contact_force", "contact_area")
"""What probes show of pairs with and without an interface law, as far as the scene has it, if not asked for more."""


def resolve_pair(
    between: Sequence[str], names: Iterable[str] | None, context: Context, path: str
) -> tuple[str, float, list[Quantity]]:
    """Return the pair that two names stand for, −1 if they stand the other way round, and the quantities of a probe.

    Raises SceneError if the fields cannot meet, or a column is unknown.
    """
    if not context.has_contact:
        raise SceneError(
            [Problem(f"{path}.kind", "needs 'contact' and several velocity fields", code="pair")]
        )
    known, problems = context.field_of, []
    for place, name in enumerate(between):
        if name not in known:
            hint = did_you_mean(name, known) or f" ({listing(known)})"
            words = f"there is no velocity field '{name}'{hint}"
            problems.append(Problem(f"{path}.between.{place}", words, code="unknown_reference"))
    if problems:
        raise SceneError(problems)
    first, second = (known[name] for name in between)
    ways = {f"{first}|{second}": 1.0, f"{second}|{first}": -1.0}
    pair = next((way for way in ways if way in context.pairs), None)
    if pair is None:
        words = "the two are one velocity field" if first == second else "both are rigid, and never touch"
        raise SceneError([Problem(f"{path}.between", words, code="pair")])
    there = {q.name: q for q in QUANTITIES.at("pair") if q.exists(context) and pair in q.names(context)}
    if names is None:
        usual = OF_INTERFACES if pair in context.interfaces else OF_CONTACTS
        names = [name for name in usual if name in there]
    chosen = chosen_names(names, "column of this pair", there, f"{path}.columns", "unknown_column")
    return pair, ways[pair], [there[name] for name in chosen]


def make_probe(model: Any, state: State | None, context: Context, path: str) -> Probe:
    """A probe from its words in the scene; ``state`` is that of the start, without which it only knows its columns.

    Raises SceneError if a column is unknown.
    """
    if model.name in (".", "..") or any(mark in model.name for mark in "/\\\0"):
        raise SceneError([Problem(f"{path}.name", f"'{model.name}' is not a valid file name")])
    if model.kind == "particle":
        quantities = resolve_fields(model.columns, context, f"{path}.columns")
        return ParticleProbe(model.name, state, model.body, model.near, quantities, context)
    if model.kind == "pair":
        pair, sign, quantities = resolve_pair(model.between, model.columns, context, path)
        return PairProbe(model.name, pair, sign, quantities, context)
    if model.kind in ("crack_tip", "crack_opening"):
        from mpmcli.output.crack_probes import make_crack_probe

        return make_crack_probe(model, context, path)
    return PointProbe(model.name, model.at, resolve_grid_fields(model.columns, context, f"{path}.columns"))
