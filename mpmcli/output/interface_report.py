"""What a run has to say of its interfaces at its end: where their energy went, and how many opened too far."""

from __future__ import annotations

from typing import Any

from mpmcli.core.state import State


def interface_facts(state: State, largest: float) -> dict[str, Any]:
    """Return what the manifest keeps of interfaces, ``{}`` without them; energies are those of the full ring.

    Parameters
    ----------
    largest : largest kinetic_energy + |stress_work| so far, 0 where it is not known [energy]

    Returns
    -------
    dict
        ``interfaces``: ``work`` that they took out of the bodies, ``energy`` stored in them, ``cohesive_work``,
        ``loss`` that is none of both, ``relative_loss`` over ``largest`` or None, and ``lost``, the contacts of all
        steps that opened by more than a cell, or broke because they slipped by more than half a cell.
    """
    view = None if state.contact is None else state.contact.interfaces
    if view is None:
        return {}
    ring = state.full_ring
    work = state.work["interface_work"] * ring
    energy, spent = float(view.energy.sum()) * ring, float(view.cohesive_work.sum()) * ring
    loss = work - energy - spent
    found = {"work": work, "energy": energy, "cohesive_work": spent, "loss": loss}
    return {
        "interfaces": found
        | {"relative_loss": loss / largest if largest > 0.0 else None, "lost": view.all_lost}
    }


def in_words(facts: dict[str, Any], unit: str) -> str:
    """Return the energies of ``interface_facts`` in a sentence."""
    unit = f" {unit}" if unit else ""
    share = facts["relative_loss"]
    of_all = "" if share is None else f" ({100.0 * share:.2g} % of the largest energy of the bodies)"
    spent = f", {facts['cohesive_work']:.4g}{unit} is dissipated by damage" if facts["cohesive_work"] else ""
    return (
        f"interfaces took {facts['work']:.4g}{unit} out of the bodies: {facts['energy']:.4g}{unit} is stored{spent}, "
        f"{facts['loss']:.2g}{unit} is numerical loss{of_all}"
    )


def lost_in_words(lost: int) -> str:
    """Return the warning of interfaces that opened too far for the grid."""
    return (
        f"in {lost} contacts (of all steps) an intact interface opened by more than a cell, where nodes no longer "
        "receive both sides and tractions fade, or slipped by more than half a cell, where it breaks whatever its law "
        "says, because nodes then join matter that was not bonded; use larger cells, a stiffer interface or a law that "
        "fails earlier"
    )
