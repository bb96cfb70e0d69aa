"""Quantities of interfaces: energies, areas, mean jumps and tractions of pairs; of the full ring where axisymmetric."""

from collections.abc import Callable
from operator import attrgetter
from typing import Any

from mpmcli.core.state import InterfaceMeans, InterfaceView
from mpmcli.output.contact_quantities import pair_name
from mpmcli.output.global_quantities import never
from mpmcli.output.quantities import QUANTITIES, Context, Quantity
from mpmcli.output.snapshot import Snapshot


def _view(snapshot: Snapshot) -> InterfaceView:
    contact = snapshot.state.contact
    if contact is None or contact.interfaces is None:
        raise ValueError("the state has no interfaces")
    return contact.interfaces


def _of_pairs(name: str, is_sum: bool) -> Callable[[Snapshot], dict[str, float]]:
    """Numbers of every pair that has an interface; sums over its area are those of the full ring."""

    def compute(snapshot: Snapshot) -> dict[str, float]:
        view, contact = _view(snapshot), snapshot.state.contact
        assert contact is not None
        owner = view.means() if name in InterfaceMeans._fields else view
        values = getattr(owner, name) * (snapshot.full_ring if is_sum else 1.0)
        return {pair_name(contact.pairs[i]): float(values[i]) for i in view.numbers}

    return compute


def _total_energy(snapshot: Snapshot) -> float:
    """That of bodies in contact and of the faces of cracks."""
    contact, cracks = snapshot.state.contact, snapshot.state.cracks
    energy = 0.0 if cracks is None else float(cracks.interface_energy.sum())
    if contact is not None and contact.interfaces is not None:
        energy += float(contact.interfaces.energy.sum())
    return energy * snapshot.full_ring


def _exists_anywhere(context: Context) -> bool:
    return bool(context.interfaces or context.crack_interfaces)


_INTERFACES, _COHESIVE = attrgetter("interfaces"), attrgetter("cohesive")


def _pair(
    name: str, symbol: str, dimension: str, of_view: str, text: str, owners: Any = _INTERFACES
) -> Quantity:
    compute = _of_pairs(of_view, is_sum=dimension in ("energy", "area"))
    return Quantity(
        name,
        symbol,
        dimension,
        "scalar",
        "pair",
        compute,
        text,
        exists=owners,
        is_default=never,
        owners=owners,
    )


QUANTITIES.add(
    Quantity("interface_energy", "E_i", "energy", "scalar", "global", _total_energy,
             "energy stored in interfaces", exists=_exists_anywhere),
    Quantity("interface_work", "W_i", "energy", "scalar", "global",
             lambda s: s.state.work["interface_work"] * s.full_ring,
             "energy that interfaces have taken out of the bodies; interface_energy, cohesive_work and the "
             "numerical loss are its parts",
             exists=_exists_anywhere),
    Quantity("cohesive_work", "D_i", "energy", "scalar", "global",
             lambda s: float(_view(s).cohesive_work.sum()) * s.full_ring,
             "energy dissipated by the damage of cohesive interfaces, accumulated", exists=_COHESIVE),
    Quantity("interface_lost", "n_i", "1", "scalar", "global", lambda s: float(_view(s).lost),
             "number of contacts of intact interfaces that open by more than a cell, where nodes no longer "
             "receive both sides, or that break because they slip by more than half a cell",
             exists=_INTERFACES, is_default=never),
    _pair("interface_energy", "E_i", "energy", "energy", "energy stored in the interface of a pair"),
    _pair("cohesive_work", "D_i", "energy", "cohesive_work",
          "energy dissipated by the damage of the interface of a pair, accumulated", owners=_COHESIVE),
    _pair("interface_area", "A_i", "area", "area", "area of the interface of a pair that is not broken"),
    _pair("broken_area", "A_b", "area", "broken_area",
          "area of the interface of a pair that has broken so far", owners=_COHESIVE),
    _pair("jump_normal", "δ_n", "length", "jump_normal",
          "mean jump of displacement along the normal where the interface of a pair is not broken, open +"),
    _pair("jump_tangential", "δ_t", "length", "jump_tangential",
          "mean size of the jump of displacement along the surface where the interface of a pair is not broken"),
    _pair("interface_traction_normal", "T_n", "pressure", "traction_normal",
          "mean traction along the normal where the interface of a pair is not broken, tension +"),
    _pair("interface_traction_tangential", "T_t", "pressure", "traction_tangential",
          "mean size of the traction along the surface where the interface of a pair is not broken"),
    Quantity("damage_of_bond", "d", "1", "scalar", "particle", lambda s: _view(s).particle_damage(),
             "share of the stiffness that the cohesive interface nearest to the particle has lost; 1: broken, 0 "
             "also where there is none",
             exists=_COHESIVE),
)  # fmt: skip
