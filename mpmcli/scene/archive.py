"""What is written of a run, and when."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from mpmcli.core.model import Model, PositiveTime
from mpmcli.scene.values import Name, Point

Column = Annotated[str, Field(min_length=1)]


class ParticleArchive(Model):
    """Files of all particles."""

    every: PositiveTime  # type: ignore[valid-type]
    """Time between files."""
    fields: tuple[Column, ...] = ("velocity", "stress")
    """Quantities to write, besides position, identity, body and material."""
    precision: Literal["float32", "float64"] = "float32"
    """Precision of the numbers."""
    compression: Literal["none", "lz4", "zlib"] = "none"
    """Compression of the files."""


class GlobalArchive(Model):
    """The table of quantities of the whole scene, ``globals.csv``."""

    every: PositiveTime  # type: ignore[valid-type]
    """Time between rows."""
    columns: tuple[Column, ...] | None = None
    """Columns to write; without it all that the scene has a use for."""


class GridArchive(Model):
    """Files of the grid."""

    every: PositiveTime  # type: ignore[valid-type]
    """Time between files."""
    fields: tuple[Column, ...] = ("mass", "velocity")
    """Quantities of the nodes to write."""


class Archive(Model):
    """Files of results; what is left out is not written."""

    particles: ParticleArchive | None = None
    """Files of all particles."""
    globals: GlobalArchive | None = None
    """The table of quantities of the whole scene."""
    grid: GridArchive | None = None
    """Files of the grid."""


class ParticleProbe(Model):
    """A table of the quantities of one particle."""

    kind: Literal["particle"]
    name: Name
    """Name of the probe, and of its table."""
    body: Name
    """The body whose particle is followed."""
    near: Point
    """The particle is the one nearest to this point at the start."""
    columns: tuple[Column, ...] = ("position", "velocity")
    """Quantities of the particle to write."""
    every: PositiveTime | None = None  # type: ignore[valid-type]
    """Time between rows; without it that of ``archive.globals``."""


class PointProbe(Model):
    """A table of the quantities of the grid at a point."""

    kind: Literal["point"]
    name: Name
    """Name of the probe, and of its table."""
    at: Point
    """The point."""
    columns: tuple[Column, ...] = ("velocity",)
    """Quantities of the grid to write."""
    every: PositiveTime | None = None  # type: ignore[valid-type]
    """Time between rows; without it that of ``archive.globals``."""


Probe = Annotated[ParticleProbe | PointProbe, Field(discriminator="kind")]
