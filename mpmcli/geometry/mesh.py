"""Regions enclosed by a triangulated surface from a file."""

from functools import cached_property
from typing import Literal

from pydantic import field_validator
from pydantic_core.core_schema import ValidationInfo

from mpmcli.geometry.base import REGIONS, Array, Region
from mpmcli.geometry.files import ReadableFile, path_of
from mpmcli.geometry.mesh_files import read_surface
from mpmcli.geometry.surface import Surface
from mpmcli.geometry.vectors import Factor


@REGIONS.register
class Mesh(Region):
    """What a closed surface encloses (3D): STL, OBJ, PLY, VTP, or the outside of a volume mesh, VTU or MSH.

    Cavities inside an outer surface stay empty.
    """

    dimensions = frozenset({3})

    kind: Literal["mesh"]
    open: Literal["error", "allow"] = "error"
    """What to do with a surface that has holes; where it has, points behind a hole may be taken wrongly."""
    scale: Factor = 1.0
    """Factor from the file's lengths to the scene's."""
    file: ReadableFile
    """Mesh file (stl, obj, ply, vtp, vtu, msh), beside the scene."""

    @field_validator("file")
    @classmethod
    def _closed(cls, name: str, info: ValidationInfo) -> str:
        surface = read_surface(path_of(name))
        if surface.open_edges and info.data.get("open") == "error":
            edges = "1 open edge" if surface.open_edges == 1 else f"{surface.open_edges} open edges"
            raise ValueError(
                f"the surface in '{name}' is not closed ({edges}); repair it, or use 'open: allow'"
            )
        return name

    @cached_property
    def surface(self) -> Surface:
        """The surface in the scene's lengths, before it is turned and moved."""
        read = read_surface(path_of(self.file))
        return read if self.scale == 1 else Surface(read.corners * self.scale, read.triangles)

    def _inside(self, points: Array) -> Array:
        return self.surface.contains(points)

    def _turned_bounds(self, turn: Array) -> tuple[Array, Array]:
        corners = self.surface.corners @ turn.T
        return corners.min(axis=0), corners.max(axis=0)

    def _measure(self, d: int) -> float | None:
        return self.surface.volume

    def _centroid(self, d: int) -> Array | None:
        return self.surface.centroid

    def files(self) -> list[str]:
        return [self.file]

    def notes(self) -> list[str]:
        surface = self.surface
        state = f"open along {surface.open_edges} edges" if surface.open_edges else "closed"
        words = f"mesh '{self.file}': {len(surface.triangles)} triangles, {state}"
        if surface.pieces > 1:
            words += f", {surface.pieces} pieces"
        if surface.branched_edges:
            words += f", {surface.branched_edges} edges with more than two triangles"
        return [words]
