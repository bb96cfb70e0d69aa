"""What is written of a run, and when."""

import math
import re
from collections.abc import Iterable
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema

from mpmcli.core.model import Model, PositiveTime
from mpmcli.core.suggest import listing
from mpmcli.scene.values import Name, Point

Column = Annotated[str, Field(min_length=1)]

CLOCK_UNITS = {"s": 1.0, "min": 60.0, "h": 3600.0, "day": 86400.0, "days": 86400.0, "d": 86400.0}
CLOCK_TIME = re.compile(r"\s*(\d+\.?\d*|\.\d+)\s*([^\W\d_]+)\s*\Z")


def clock_seconds(text: str) -> float:
    """Seconds of a time by the clock such as ``"15 min"``; ValueError with words for the user."""
    found = CLOCK_TIME.match(text)
    if found is None or found[2] not in CLOCK_UNITS:
        raise ValueError(
            f"'{text}' is not a wall-clock time; write a number and a unit, such as '15 min' ({listing(CLOCK_UNITS)})"
        )
    seconds = float(found[1]) * CLOCK_UNITS[found[2]]
    if not (seconds > 0.0 and math.isfinite(seconds)):
        raise ValueError("must be above 0")
    return seconds


def _read_clock_time(value: Any) -> Any:
    if isinstance(value, int | float) and not isinstance(value, bool):
        raise ValueError(f"a wall-clock time needs a unit, such as '{value:g} min'")
    if isinstance(value, str):
        clock_seconds(value)
    return value


ClockTime = Annotated[
    str,
    BeforeValidator(_read_clock_time),
    WithJsonSchema({"type": "string", "pattern": rf"^\s*(\d+\.?\d*|\.\d+)\s*({'|'.join(CLOCK_UNITS)})\s*$"}),
]
"""A time by the clock, with its unit."""


FIELDS = ("displacement", "velocity", "stress", "deformation_gradient")
"""Quantities that archives of particles have without being asked."""
FIELDS_OF_SOME = ("temperature", "equivalent_plastic_strain", "damage")
"""Further ones of the scenes that have them."""


class ParticleArchive(Model):
    """Files of all particles."""

    every: PositiveTime
    """Time between files."""
    fields: tuple[Column, ...] | None = None
    """Quantities to write, besides position, identity, body and material.

    Without it displacement, velocity, stress and deformation_gradient, and of temperature, equivalent_plastic_strain
    and damage those that the scene has.
    """
    precision: Literal["float32", "float64"] = "float32"
    """Precision of the numbers."""
    compression: Literal["none", "lz4", "zlib"] = "none"
    """Compression of the files."""


class GlobalArchive(Model):
    """The table of quantities of the whole scene, ``globals.csv``."""

    every: PositiveTime
    """Time between rows."""
    columns: tuple[Column, ...] | None = None
    """Columns to write; without it all that the scene has a use for."""


class GridArchive(Model):
    """Files of the grid."""

    every: PositiveTime
    """Time between files."""
    fields: tuple[Column, ...] = ("mass", "velocity")
    """Quantities of the nodes to write."""


class CrackArchive(Model):
    """Files of the cracks: the plane and both faces of each."""

    every: PositiveTime
    """Time between files."""


class CheckpointArchive(Model):
    """When the state is saved from which a run can be resumed.

    With this key also at the end of the run; signals and ``--max-walltime`` save it in any case.
    """

    every: PositiveTime | None = None
    """Time between checkpoints."""
    wall: ClockTime | None = None
    """Time between checkpoints by the clock, with a unit: 15 min."""

    @property
    def wall_seconds(self) -> float:
        """Seconds by the clock between checkpoints, infinite where none are asked for."""
        return math.inf if self.wall is None else clock_seconds(self.wall)


class Archive(Model):
    """Files of results; what is left out is not written."""

    particles: ParticleArchive | None = None
    """Files of all particles."""
    globals: GlobalArchive | None = None
    """The table of quantities of the whole scene."""
    grid: GridArchive | None = None
    """Files of the grid."""
    cracks: CrackArchive | None = None
    """Files of the cracks."""
    checkpoint: CheckpointArchive | None = None
    """The state from which a run can be resumed."""


class _Probe(Model):
    """What all probes have."""

    kind: str
    name: Name
    """Name of the probe, and of its table."""
    every: PositiveTime | None = None
    """Time between rows; without it that of ``archive.globals``."""


class ParticleProbe(_Probe):
    """A table of the quantities of one particle."""

    kind: Literal["particle"]
    body: Name
    """The body whose particle is followed."""
    near: Point
    """The particle is the one nearest to this point at the start."""
    columns: tuple[Column, ...] = ("position", "velocity")
    """Quantities of the particle to write."""


class PointProbe(_Probe):
    """A table of the quantities of the grid at a point."""

    kind: Literal["point"]
    at: Point
    """The point."""
    columns: tuple[Column, ...] = ("velocity",)
    """Quantities of the grid to write."""


class PairProbe(_Probe):
    """A table of what two velocity fields do to each other."""

    kind: Literal["pair"]
    between: Annotated[tuple[Name, ...], Field(min_length=2, max_length=2)]
    """The two fields, named as in ``contact.pairs``; vectors are those on the first of them."""
    columns: Annotated[tuple[Column, ...], Field(min_length=1)] | None = None
    """Quantities of the pair to write; without it its mean jump and traction where it has an interface law, else its
    contact force and area."""


class CrackTipProbe(_Probe):
    """A table of what happens at the tip of a crack."""

    kind: Literal["crack_tip"]
    crack: Name
    """Name of the crack."""
    end: Literal["start", "end"] = "end"
    """Which of its ends, where its path starts or where it ends."""
    columns: Annotated[tuple[Column, ...], Field(min_length=1)] = ("position", "length")
    """Quantities of the tip to write."""


class CrackOpeningProbe(_Probe):
    """A table of the opening along a crack: at every time a row per point, from the start of its path on."""

    kind: Literal["crack_opening"]
    crack: Name
    """Name of the crack."""


Probe = Annotated[
    ParticleProbe | PointProbe | PairProbe | CrackTipProbe | CrackOpeningProbe, Field(discriminator="kind")
]


def shows(archive: Archive, probes: Iterable[Any], field: str) -> bool:
    """Return whether archives of particles or probes that follow one have a field."""
    particles = archive.particles
    asked = () if particles is None else FIELDS if particles.fields is None else particles.fields
    return field in asked or any(probe.kind == "particle" and field in probe.columns for probe in probes)


def grid_shows(archive: Archive, probes: Iterable[Any], fields: Iterable[str]) -> bool:
    """Return whether archives of the grid or probes at points have one of some fields."""
    asked = set() if archive.grid is None else set(archive.grid.fields)
    asked.update(*(probe.columns for probe in probes if probe.kind == "point"))
    return not asked.isdisjoint(fields)


def tables_show(scene: Any, word: str) -> bool:
    """Return whether columns of tables, or criteria of the end of the run and of events, use a word."""
    columns = () if scene.archive.globals is None else scene.archive.globals.columns or ()
    criteria = [event.when for event in scene.events or ()]
    criteria += [] if scene.time.stop_when is None else [scene.time.stop_when]
    return any(word in text for text in (*columns, *(each.condition for each in criteria)))
