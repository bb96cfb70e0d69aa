"""What interface laws will do in a run: springs against the time step, process zones, gaps at the start, memory."""

import math
from collections.abc import Sequence
from typing import Any

from mpmcli.contact.choice import ContactChoice
from mpmcli.core.compiled.kernel import Kernel
from mpmcli.core.suggest import listing
from mpmcli.geometry.fill import fill_bodies
from mpmcli.interfaces.interfaces import LOST, SLIPPED
from mpmcli.scene.interface_checks import process_zone, resistances, softest_modulus, starts_of_joints
from mpmcli.solver.simulation import Simulation
from mpmcli.stability.springs import springs_of

MOST_PAIRS = 6
"""Interfaces that are told one by one."""


def interface_facts(
    scene: Any, simulation: Simulation, contact: ContactChoice, dt: float, kernels: Sequence[str]
) -> dict[str, Any]:
    """Return what is known of interfaces in a scene that has some, fit for JSON; ``{}`` without."""
    if not contact.has_interfaces:
        return {}
    words, cell = scene.contact.interface, min(scene.grid.cell)
    filled = fill_bodies(scene.bodies, simulation.grid, simulation.plan.analysis)
    starts = starts_of_joints(scene, filled)
    springs = [spring for spring in springs_of(scene) if spring.joint in [start.joint for start in starts]]
    pairs = []
    for start in starts:
        joint = start.joint
        mine = [spring for spring in springs if spring.joint == joint]
        pairs.append(
            {
                "between": [joint.first, joint.second],
                "law": joint.law.kind,
                "phi": {spring.direction: dt / spring.longest_step for spring in mine},
                "longest_step": min((spring.longest_step for spring in mine), default=None),
                "speed": max((math.sqrt(s.stiffness * cell / s.density) for s in mine), default=None),
                "largest_stiffness": min((spring.mass / dt**2 for spring in mine), default=None),
                "nodes": start.nodes,
                "bonded": start.bonded,
                "gap": start.gap if math.isfinite(start.gap) else None,
                "zone_cells": _zones(scene, joint),
                "failure_cells": {mode: r.opening / cell for mode, r in resistances(joint.law)},
            }
        )
    names = {k.name for k in Kernel.registered if k[False].py_func.__module__.startswith("mpmcli.interfaces")}
    p = simulation.particles
    arrays = {"X0": p.X0, "interface": p.interface}
    return {
        "jump": words.jump,
        "step": words.step,
        "area": words.area,
        "initial_gap": words.initial_gap,
        "largest_opening": LOST * max(scene.grid.cell),
        "largest_slip": SLIPPED * max(scene.grid.cell),
        "couples": len(contact.fields) > 2,
        "has_loop": bool(contact.increments),
        "pairs": pairs,
        "kernels": [name for name in kernels if name.split("(")[0] in names],
        "arrays": {name: array.nbytes for name, array in arrays.items() if array is not None},
    }


def _zones(scene: Any, joint: Any) -> dict[str, float]:
    """Return the cells in the process zone of each mode, with the softer side's modulus; none in one dimension."""
    if scene.dimensions == 1:
        return {}
    from mpmcli.scene.fields import field_name

    sides = (joint.first, joint.second)
    models = [scene.materials[body.material] for body in scene.bodies if field_name(scene, body) in sides]
    modulus, cell = softest_modulus(models, scene.analysis.kind), max(scene.grid.cell)
    if not math.isfinite(modulus):
        return {}
    return {mode: process_zone(modulus, each) / cell for mode, each in resistances(joint.law)}


# ---------------------------------------------------------------- in words


def interfaces_in_words(facts: dict[str, Any]) -> list[str]:
    """Return the lines about interfaces; none without them."""
    if not facts:
        return []
    memory = ", ".join(f"{name} {size / 2**20:.2g} MiB" for name, size in facts["arrays"].items())
    loop = " and in 3.b on every increment of the FMPM loop" if facts["has_loop"] else ""
    is_free = facts["step"] == "implicit" and facts["jump"] != "extrapolated"
    free = " (no limit of the time step)" if is_free else ""
    lines = [
        f"jump {facts['jump']}, step {facts['step']}{free}, area {facts['area']}; gaps up to "
        f"{facts['initial_gap']:g} cells are bonded; particles keep {memory}",
        f"task 1.a holds perfect directions; tractions act in 3.a on updated momenta{loop}",
    ]
    lines.append(
        f"a bond that slips by more than half a cell, {facts['largest_slip']:.3g}, breaks; beyond an opening of a "
        f"cell, {facts['largest_opening']:.3g}, tractions fade (column interface_lost counts both)"
    )
    if facts["couples"]:
        lines.append("where three or more fields meet at a node, all pairs are coupled")
    for pair in facts["pairs"][:MOST_PAIRS]:
        lines += _pair_in_words(pair, facts["step"])
    if len(facts["pairs"]) > MOST_PAIRS:
        stiffest = max((max(p["phi"].values(), default=0.0) for p in facts["pairs"]), default=0.0)
        lines.append(
            f"{len(facts['pairs']) - MOST_PAIRS} more pairs; the stiffest of all has φ = {stiffest:.3g}"
        )
    return lines


def _pair_in_words(pair: dict[str, Any], step: str) -> list[str]:
    first, second = pair["between"]
    parts = [f"φ = {_by_mode(pair['phi'])}"] if pair["phi"] else []
    if pair["zone_cells"]:
        parts.append(f"process zone {_by_mode(pair['zone_cells'])} cells")
    if pair["failure_cells"]:
        parts.append(f"failure at {_by_mode(pair['failure_cells'])} cells")
    where = f"bonded at {pair['bonded']} of {pair['nodes']} nodes with mass of both bodies at the start"
    if not pair["bonded"]:
        gap = "" if pair["gap"] is None else f", gap {pair['gap']:.3g}"
        where = f"never bonded: {pair['nodes']} nodes have mass of both bodies at the start{gap}"
    lines = [f"{first}|{second}: {', '.join([pair['law'], *parts])}; {where}"]
    if step == "oscillator" and pair["phi"]:
        verdict = "" if max(pair["phi"].values()) <= 1.0 else "; unstable here, use step: implicit"
        lines.append(
            f"  oscillator: stable for time steps below {pair['longest_step']:.3g} and, in steps of this length, for "
            f"stiffnesses below {pair['largest_stiffness']:.3g}; speed of the interface {pair['speed']:.3g}{verdict}"
        )
    return lines


def _by_mode(numbers: dict[str, float]) -> str:
    """``0.17 (normal), 0.14 (tangential)``."""
    return listing([f"{value:.3g} ({mode})" for mode, value in numbers.items()], 2)
