"""What a scene chooses about contact, and what follows from it: arrays, kernels, facts for people."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from mpmcli.contact.contact_nodes import find_candidates
from mpmcli.core.grid import Grid
from mpmcli.core.order import CellOrder
from mpmcli.core.particles import Particles

Array = np.ndarray


class ContactChoice:
    """What a scene chooses about contact.

    Parameters
    ----------
    model : the scene's ``contact``, or None
    fields, rigid_fields : names of the velocity fields, and whether each belongs to a rigid body
    laws, table : the law models, and (fields, fields) the index of the law of each pair, −1 for none
    has_loop : steps (some at least) have an FMPM loop
    particles_per_axis : least number of a body's particles per cell and axis
    thickness : of a plane analysis, area of a 1D one, else 1
    needs_area : areas of contact are needed whatever the laws
    whole_fields : for each field, whether no crack cuts it; None without cracks

    Attributes
    ----------
    exists : several velocity fields can meet
    used : indices of the laws of pairs that exist, ascending
    acting : the laws of those that do something
    knows_normals : some law needs normals, separations and areas, and with them the particles near contact nodes
    uses_rigid_surfaces : normals of contacts with rigid bodies are those of their surfaces
    breaks : some law has adhesion that breaks
    has_interfaces : some law is one of interfaces
    lumped, increments, later : contact acts on updated momenta, on every FMPM increment, on final velocities
    starts : contact acts on extrapolated momenta
    removal : share of their overlap by which a step drives apart sides in contact
    """

    def __init__(
        self, model: Any, fields: list[str], rigid_fields: Sequence[bool], laws: list[Any], table: Array,
        has_loop: bool, particles_per_axis: int = 1, thickness: float = 1.0, needs_area: bool = False,
        whole_fields: Sequence[bool] | None = None,
    ):  # fmt: skip
        self.model = model
        self.fields, self.rigid_fields = fields, list(rigid_fields)
        self.laws, self.table = laws, table
        self.whole_fields = None if whole_fields is None else np.array(whole_fields)
        self.particles_per_axis, self.thickness = particles_per_axis, thickness
        self.exists = model is not None and len(fields) > 1
        self.used = sorted({int(i) for i in table.ravel() if i >= 0})
        self.acting = [laws[i] for i in self.used if not laws[i].skipped]
        self.knows_normals = any(law.needs_normal for law in self.acting) or (
            needs_area and bool(self.acting)
        )
        takes_surface = getattr(getattr(model, "normal", None), "rigid_normal", "method") == "surface"
        self.uses_rigid_surfaces = takes_surface and self.knows_normals and any(self.rigid_fields)
        self.breaks = any(law.adhesive for law in self.acting)
        self.has_interfaces = any(law.is_interface for law in self.acting)
        way = model.increments if self.acting and has_loop else "lumped"
        self.lumped = bool(self.acting) and way != "after"
        self.increments = way if way in ("net", "evolving") else ""
        self.later = way in ("after", "combined")
        self.starts = bool(self.acting) and not model.once
        drives = self.lumped and any(law.drives_apart for law in self.acting)
        self.removal = float(model.overlap_removal) if drives else 0.0

    @property
    def drives_apart(self) -> bool:
        """Whether sides that overlap are driven apart."""
        return self.removal > 0.0

    def nodal_arrays(self, grid: Grid) -> dict[str, Array]:
        """Allocate the arrays over all nodes that contact asks for, by name."""
        arrays: dict[str, Array] = {}
        if self.exists:
            arrays["slot_of_node"] = np.full(grid.sides * grid.node_count, -1, dtype=np.int32)
            if self.knows_normals and getattr(self.model.normal, "reuse", False):
                arrays["guesses"] = np.zeros((grid.dof_count, grid.dimensions))
        return arrays

    def particle_arrays(self, particles: Particles) -> dict[str, Array]:
        """Allocate the arrays over particles that contact asks for, by name."""
        arrays: dict[str, Array] = {}
        if self.has_interfaces or (self.knows_normals and self.model.separation.needs_displacement):
            arrays["X0"] = particles.X.copy()
        if self.breaks:
            arrays["bond"] = np.ones(particles.count)
        return arrays

    def facts(self, order: CellOrder) -> dict[str, Any]:
        """Return the choices in words, and how many nodes and particles the first step checks for contact."""
        if not self.exists:
            return {}
        near = find_candidates(order, order.grid)
        rigid = [name for name, is_rigid in zip(self.fields, self.rigid_fields, strict=True) if is_rigid]
        is_screened = len(rigid) + 1 < len(self.fields) and any(law.screened for law in self.acting)
        return {
            "fields": list(self.fields),
            "rigid_fields": rigid,
            "laws": [law.kind for law in self.laws],
            "normal": self.model.normal.kind if self.knows_normals else None,
            "rigid_surfaces": self.uses_rigid_surfaces,
            "separation": self.model.separation.kind if self.knows_normals else None,
            "increments": self.increments or None,
            "mass_ratio": self.model.mass_ratio if is_screened else 0.0,
            "candidate_nodes": len(near.node),
            "candidate_particles": len(near.particle) if self.knows_normals else 0,
        }
