"""What a run has to say of its interfaces and cracks at its end: where energy went, and what went beyond the grid."""

from typing import Any

from mpmcli.core.state import State


def interface_facts(state: State, largest: float) -> dict[str, Any]:
    """Return what the manifest keeps of interfaces, ``{}`` without them; energies are those of the full ring.

    ``interfaces``: ``work`` that they took out of the bodies, ``energy`` stored in them, ``cohesive_work``,
    ``loss`` that is none of both, ``relative_loss`` over ``largest`` or None, and ``lost``, the contacts of all
    steps that opened by more than a cell, or broke because they slipped by more than half a cell. ``largest`` is
    the largest kinetic_energy + |stress_work| so far, 0 where it is not known [energy].
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


def interfaces_in_words(facts: dict[str, Any], unit: str) -> str:
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


def lumped_in_words(share: float) -> str:
    """Return the warning of contacts at nodes of three or more bodies."""
    return (
        f"{100.0 * share:.2g} % of the contacts that touched were at nodes of three or more bodies, where each met the "
        "sum of all others: momentum is not conserved there, and bodies may go into each other; try "
        "contact.three_or_more: coupled"
    )


def crack_facts(state: State) -> dict[str, Any]:
    """Return what the manifest keeps of cracks, ``{}`` without them; energies are those of the full ring.

    ``cracks``: ``name``, ``length``, ``points``, ``tips`` (number of ends that are tips) and ``released_energy`` of
    each, and ``stretch``: largest and smallest length of its segments over their first one, where points stay;
    ``third_cracks``: nodes of all steps at which a third crack was left out.
    """
    view = state.cracks
    if view is None:
        return {}
    cracks = [
        {
            "name": chain.name,
            "length": chain.length,
            "points": chain.count,
            "tips": sum(map(bool, chain.tips)),
            "released_energy": float(view.released[chain.index]) * state.full_ring,
            "stretch": view.stretch[:, chain.index].tolist(),
        }
        for chain in view.chains
    ]
    return {"cracks": cracks, "third_cracks": view.all_third}


def crack_in_words(crack: dict[str, Any], length: str, energy: str) -> str:
    """Return what is known of a crack in a line, with units of length and energy."""
    words = [f"crack {crack['name']}: length {crack['length']:.4g} {length}".rstrip()]
    words.append(f"{crack['points']} points")
    words.append(("no tip", "1 tip", "2 tips")[crack["tips"]])
    if crack["released_energy"]:
        words.append(f"growth released {crack['released_energy']:.4g} {energy}".rstrip())
    return ", ".join(words)


def third_in_words(count: int) -> str:
    """Return the warning of nodes at which three cracks meet."""
    return (
        f"at {count} nodes (of all steps) a third crack was left out, because a node has sides of two; use smaller "
        "cells where more than two cracks meet"
    )


def stretch_in_words(crack: dict[str, Any]) -> str:
    """Return the warning of a crack whose segments have stretched or shrunk too much, empty if none has."""
    from mpmcli.cracks.chain import SHRUNK, STRETCHED

    longest, shortest = crack["stretch"]
    if longest <= STRETCHED and shortest >= SHRUNK:
        return ""
    what = f"grew to {longest:.3g}" if longest > STRETCHED else f"shrank to {shortest:.3g}"
    return f"segments of crack '{crack['name']}' {what} times their first length; use 'respace: true' for it"
