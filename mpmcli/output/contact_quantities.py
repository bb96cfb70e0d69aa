"""Quantities of contact, in scenes with several velocity fields; of the full ring where axisymmetric."""

from collections.abc import Callable
from operator import attrgetter

import numpy as np

from mpmcli.core.state import ContactView
from mpmcli.output.global_quantities import axes_of_momentum, never
from mpmcli.output.quantities import QUANTITIES, Quantity
from mpmcli.output.snapshot import Snapshot

MOST_PAIRS = 10
"""Tables have columns of every pair without being asked in scenes with at most so many pairs."""


def pair_name(pair: tuple[str, str]) -> str:
    """``left|right``: how columns call a pair of velocity fields."""
    return "|".join(pair)


def _view(snapshot: Snapshot) -> ContactView:
    contact = snapshot.state.contact
    if contact is None:
        raise ValueError("the state has no contact")
    return contact


def _forces(snapshot: Snapshot) -> dict[str, np.ndarray]:
    view = _view(snapshot)
    force = view.force * snapshot.full_ring
    return {pair_name(pair): row for pair, row in zip(view.pairs, force, strict=True)}


def _forces_on_fields(snapshot: Snapshot) -> dict[str, np.ndarray]:
    view = _view(snapshot)
    total: dict[str, np.ndarray] = {}
    for (first, second), force in zip(view.pairs, view.force * snapshot.full_ring, strict=True):
        total[first] = total.get(first, 0.0) + force
        total[second] = total.get(second, 0.0) - force
    return total


def _areas(snapshot: Snapshot) -> dict[str, float]:
    view = _view(snapshot)
    area = view.area * snapshot.full_ring
    return {pair_name(pair): float(row) for pair, row in zip(view.pairs, area, strict=True)}


def _count(name: str) -> Callable[[Snapshot], float]:
    return lambda snapshot: float(getattr(_view(snapshot), name))


_with_contact, _with_normals = attrgetter("has_contact"), attrgetter("has_normals")


QUANTITIES.add(
    Quantity("contact_force", "F_c", "force", "vector", "pair", _forces,
             "contact force on the first of two velocity fields in the last step; without being asked in tables of at "
             f"most {MOST_PAIRS} pairs",
             exists=_with_contact, is_default=lambda context: len(context.pairs) <= MOST_PAIRS),
    Quantity("contact_area", "A_c", "area", "scalar", "pair", _areas,
             "area of two velocity fields in contact in the last step", exists=_with_normals, is_default=never),
    Quantity("contact_force", "F_c", "force", "vector", "field", _forces_on_fields,
             "contact force of all others on a velocity field in the last step",
             exists=_with_contact, is_default=never),
    Quantity("rigid_work", "W_r", "energy", "scalar", "field",
             lambda s: {name: work * s.full_ring for name, work in _view(s).rigid_work.items()},
             "work that a rigid body has done by contact, accumulated; part of boundary_work",
             exists=lambda context: context.has_contact and bool(context.rigid_fields),
             owners=lambda context: context.rigid_fields),
    Quantity("contact_nodes", "n_c", "1", "scalar", "global", _count("nodes"),
             "number of nodes with mass of several velocity fields", exists=_with_contact),
    Quantity("contact_touching", "n_t", "1", "scalar", "global", _count("touching"),
             "number of contacts that touch; a node has one where two fields share it, with more fields one each",
             exists=_with_contact, is_default=never),
    Quantity("contact_unconverged", "n_u", "1", "scalar", "global", _count("unconverged"),
             "number of contacts whose normal did not converge in the last step",
             exists=_with_normals, is_default=never),
    Quantity("contact_momentum_error", "ΔP_c", "momentum", "vector", "global",
             lambda s: (_view(s).momentum_error * s.full_ring)[int(s.is_axisymmetric) :],
             "momentum that contact has created where its forces are not equal and opposite (three or more fields "
             "at a node, normals of each field's own), accumulated; in axisymmetric analyses the axial component",
             exists=_with_contact, is_default=lambda context: context.creates_momentum, components=axes_of_momentum),
    Quantity("contact_normal", "n", "1", "vector", "particle", lambda s: _view(s).particle_normal(),
             "outward unit normal at the contact that the particle is nearest to, 0 where there is none",
             exists=_with_normals),
)  # fmt: skip
