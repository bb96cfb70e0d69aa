"""What a run has to say of its cracks at its end: how long they are, what their growth released, what was left out."""

from __future__ import annotations

from typing import Any

from mpmcli.core.state import State


def crack_facts(state: State) -> dict[str, Any]:
    """Return what the manifest keeps of cracks, ``{}`` without them; energies are those of the full ring.

    Returns
    -------
    dict
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


def in_words(crack: dict[str, Any], length: str, energy: str) -> str:
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
