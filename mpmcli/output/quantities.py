"""The quantity registry: everything that can be shown, with name, symbol, dimension, rank and place.

It feeds the arrays of particle archives, the columns of tables, and their units. A quantity of rank vector or
tensor gives one column per component (``momentum_x``, ``stress_xy``); one that lives on materials, bodies or
boundary conditions gives one per name, in brackets (``stress_xx[rubber]``), one of a pair of velocity fields one per
pair (``contact_force_x[left|right]``). Materials come first: where a
body has the name of a material and a quantity lives on both, the column in brackets is the material's.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from mpmcli.core.analysis import ANALYSES, F_COMPONENTS, STRESS_COMPONENTS
from mpmcli.output.snapshot import Snapshot

AXES = "xyz"


@dataclass(frozen=True)
class Context:
    """What a scene has, as far as it decides which quantities exist.

    ``reactions`` are names of boundary conditions; ``work`` names the energies that the solver accumulates;
    ``heated_by`` are names of conditions and loads of heat; ``has_temperature``: all particles have a temperature;
    ``history`` the history variables of all materials; ``extra`` further columns by name. ``velocity_fields`` are
    several only where there is contact; ``field_of`` says which one a name stands for, ``pairs`` (``"left|right"``)
    which of them can meet. ``interfaces`` are the pairs that have an interface law, ``cohesive`` those whose damage is
    remembered. ``cracks`` are names, ``tips`` their ends in material (``"main:end"``), ``growing`` those that may grow,
    ``crack_interfaces`` cracks with springs or tractions between their faces, ``crack_tractions`` with the
    latter.

    ``has_fracture``: fracture quantities are known at tips; ``has_crack_events``: cracks may grow or break.

    ``has_normals``: contact knows directions and areas; ``creates_momentum``: it may violate the balance
    of momentum.
    """

    analysis: str
    bodies: tuple[str, ...]
    materials: tuple[str, ...]
    history: tuple[str, ...] = ()
    reactions: tuple[str, ...] = ()
    heated_by: tuple[str, ...] = ()
    has_heat: bool = False
    exchanges_heat: bool = False
    has_friction_heat: bool = False
    has_temperature: bool = False
    work: tuple[str, ...] = ()
    has_viscosity: bool = False
    extra: tuple[str, ...] = ()
    rigid_bodies: tuple[str, ...] = ()
    rigid_materials: tuple[str, ...] = ()
    velocity_fields: tuple[str, ...] = ()
    rigid_fields: tuple[str, ...] = ()
    field_of: Mapping[str, str] = field(default_factory=dict)
    pairs: tuple[str, ...] = ()
    interfaces: tuple[str, ...] = ()
    cohesive: tuple[str, ...] = ()
    cracks: tuple[str, ...] = ()
    tips: tuple[str, ...] = ()
    growing: tuple[str, ...] = ()
    crack_interfaces: tuple[str, ...] = ()
    crack_tractions: tuple[str, ...] = ()
    has_fracture: bool = False
    has_crack_events: bool = False
    has_normals: bool = False
    creates_momentum: bool = False

    @property
    def sides(self) -> int:
        """How many sides of cracks a node may have."""
        return (1, 2, 4)[min(len(self.cracks), 2)]

    @property
    def has_contact(self) -> bool:
        """Whether several velocity fields can meet."""
        return len(self.velocity_fields) > 1

    @property
    def dimensions(self) -> int:
        """Number of axes of the grid."""
        return ANALYSES[self.analysis]().dimensions

    @property
    def is_axisymmetric(self) -> bool:
        """Whether x is the radius."""
        return self.analysis == "axisymmetric"

    def owners(self, where: str) -> tuple[str, ...]:
        """The names in brackets of quantities that live ``where``."""
        return {
            "body": self.bodies,
            "material": self.materials,
            "reaction": self.reactions,
            "heat": self.heated_by,
            "pair": self.pairs,
            "field": self.velocity_fields,
            "crack": self.cracks,
            "tip": self.tips,
        }.get(where, ())


@dataclass(frozen=True)
class Quantity:
    """One entry of the registry.

    Attributes
    ----------
    name, symbol, description : word of the tables, mathematical symbol, one line for the documentation
    dimension : physical dimension (``"energy"``, ``"pressure"``, ``"1"``, …), which the scene's units label
    rank : ``scalar``, ``vector``, ``tensor`` (symmetric) or ``gradient`` (nine components)
    where : ``particle``, ``global``, ``body``, ``material``, ``reaction``, ``heat`` (its sources),
        ``pair`` or ``field`` (of velocity), ``crack`` or ``tip`` (of one)
    compute : function of a ``Snapshot``. Particles give (N,) or (rows, N); globals a number or (rows,);
        bodies and materials (groups,) or (rows, groups); the others a dict from name to a number or (rows,)
    exists, is_default : functions of a ``Context``: whether the scene has it, and has it without being asked
    owners : function of a ``Context``: the names in brackets, where they are not all of their kind
    components : names of the rows in a ``Context`` where they are not those of the rank
    """

    name: str
    symbol: str
    dimension: str
    rank: str
    where: str
    compute: Callable[[Snapshot], Any]
    description: str
    exists: Callable[[Context], bool] = lambda context: True
    is_default: Callable[[Context], bool] = lambda context: True
    components: Callable[[Context], tuple[str, ...]] | None = None
    owners: Callable[[Context], tuple[str, ...]] | None = None

    def rows(self, context: Context) -> tuple[str, ...]:
        """Names of the stored components; empty for a scalar."""
        if self.components is not None:
            return self.components(context)
        d = context.dimensions
        by_rank = {
            "scalar": (),
            "vector": tuple(AXES[:d]),
            "tensor": STRESS_COMPONENTS[d],
            "gradient": F_COMPONENTS[d],
        }
        return by_rank[self.rank]

    def names(self, context: Context) -> tuple[str, ...]:
        """The names in brackets of its columns."""
        return context.owners(self.where) if self.owners is None else self.owners(context)


def columns_of(quantities: Iterable[Quantity], context: Context) -> tuple[list[str], list[str]]:
    """Return the columns of quantities of one thing, and their dimensions."""
    columns: list[str] = []
    dimensions: list[str] = []
    for quantity in quantities:
        rows = quantity.rows(context)
        columns += [f"{quantity.name}_{row}" for row in rows] or [quantity.name]
        dimensions += [quantity.dimension] * max(1, len(rows))
    return columns, dimensions


class Probe:
    """What the recorder asks of a probe; kinds give ``look``, or ``rows`` where there are several at a time."""

    name: str
    columns: list[str]
    dimensions: list[str]

    def look(self, snapshot: Snapshot) -> list[float]:
        """Return the numbers of its columns."""
        return self.rows(snapshot)[0]

    def rows(self, snapshot: Snapshot) -> list[list[float]]:
        """Return what it adds to its table."""
        return [self.look(snapshot)]


class Quantities:
    """The registry: entries are told apart by where they live and by name."""

    def __init__(self) -> None:
        self._entries: dict[tuple[str, str], Quantity] = {}

    def add(self, *quantities: Quantity) -> None:
        """Add entries; a name may be used once in each place."""
        for quantity in quantities:
            key = (quantity.where, quantity.name)
            if key in self._entries:
                raise ValueError(f"quantity {key} is registered twice")
            self._entries[key] = quantity

    def __iter__(self) -> Iterator[Quantity]:
        return iter(self._entries.values())

    def at(self, *places: str) -> list[Quantity]:
        """The entries that live in one of the places, in the order of their registration."""
        return [quantity for quantity in self if quantity.where in places]


QUANTITIES = Quantities()
