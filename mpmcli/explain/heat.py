"""What heat conduction will do in a run: limit, interval, reach, filtered waves, memory."""

from dataclasses import asdict
from typing import Any

from mpmcli.core.suggest import listing
from mpmcli.shapes import SHAPES
from mpmcli.solver.simulation import Simulation
from mpmcli.stability.conduction import Conduction, filter_factor
from mpmcli.stability.heat import SHORTEST_REACH, HeatForecast, conduction_of

STEP_SHARE = 0.5
"""Rough cost of a heat step over that of a step of FLIP."""
FAR = 99.0
"""Per cent below the stable Fourier number from which on they are not told."""
ON_LINE = 1e-6
"""How far from a grid line, in cells, a plane still counts as on it."""
PARTICLE_ARRAYS = ("T", "T_carried", "T_start", "heat_inflow", "entropy", "heat_flux")
WAVELENGTHS = (4, 8, 16)
"""Wavelengths in cells of which is told what a step of FMPM removes."""


def heat_facts(
    scene: Any, simulation: Simulation, found: HeatForecast, kernels: dict[str, list[str]]
) -> dict[str, Any]:
    """Return what is known of conduction in a scene that has it, fit for JSON.

    ``kernels`` are those of each task, by its title; conduction shares those of forces and of moving particles.
    """
    assert simulation.heat is not None
    heat, transfer = scene.heat, scene.heat.transfer
    of_heat = {name: array for name, array in simulation.nodal_arrays().items() if name.startswith("heat.")}
    particles = [a for name, a in simulation.particles.arrays().items() if name in PARTICLE_ARRAYS]
    of_tasks = [name for title, names in kernels.items() if title.split()[0].endswith(".h") for name in names]
    return asdict(found) | {
        "transfer": transfer.kind,
        "order": transfer.order,
        "every_steps": getattr(transfer, "every_steps", None),
        "interval_is_chosen": heat.interval == "auto",
        "margin": 1.0 - found.fourier / found.limit,
        "degrees_of_freedom": len(simulation.heat.nodal.v),
        "arrays": sorted(of_heat),
        "kernels": list(dict.fromkeys(of_tasks)),
        "particle_bytes": sum(array.nbytes for array in particles),
        "grid_bytes": sum(array.nbytes for array in of_heat.values()),
        "removed": _removed(scene),
        "off_grid_lines": _off_grid_lines(scene),
        "splines": SHAPES[scene.method.shape].grid_functions == "quadratic" and bool(_planes(scene)),
    }


def cost_of_heat(scene: Any, found: HeatForecast, pass_share: float) -> float:
    """Return the rough cost of conduction per step, over that of a step of FLIP."""
    return (STEP_SHARE + pass_share * (scene.heat.transfer.order - 1)) / found.interval


def _removed(scene: Any) -> dict[str, float]:
    """Return the share of waves that one step of FMPM removes, by their length in cells."""
    if scene.heat.transfer.kind != "fmpm":
        return {}
    conductions: list[Conduction | None] = [conduction_of(scene, body) for body in scene.bodies]
    known = [each for each in conductions if each is not None]
    return {
        str(length): max(float(filter_factor(each, length) ** each.order) for each in known)
        for length in WAVELENGTHS
        if known
    }


def _planes(scene: Any) -> list[tuple[str, Any]]:
    """Names and planes of conditions that hold temperatures of nodes on a plane."""
    places: list[tuple[str, Any]] = [
        (c.name, getattr(c, "on", None)) for c in scene.conditions_on("temperature")
    ]
    return [(name, on.plane) for name, on in places if getattr(on, "plane", None) is not None]


def _off_grid_lines(scene: Any) -> dict[str, float]:
    """Return the conditions whose plane is between grid lines, with its distance from the nearest one in cells."""
    found = {}
    for name, plane in _planes(scene):
        line = (plane.at - scene.grid.lower[plane.index]) / scene.grid.cell[plane.index]
        if abs(line - round(line)) > ON_LINE:
            found[name] = abs(line - round(line))
    return found


# ---------------------------------------------------------------- in words


def heat_in_words(facts: dict[str, Any]) -> list[str]:
    """Return the lines about conduction; none without it."""
    if not facts:
        return []
    return [
        f"{_transfer_in_words(facts)}; {facts['degrees_of_freedom']} degrees of freedom, particles "
        f"{facts['particle_bytes'] / 2**20:.1f} MiB, grid {facts['grid_bytes'] / 2**20:.1f} MiB",
        _diffusivities_in_words(facts["diffusivities"]),
        _limit_in_words(facts),
        _reach_in_words(facts),
        *_filter_in_words(facts),
        *_planes_in_words(facts),
    ]


def _transfer_in_words(facts: dict[str, Any]) -> str:
    order = facts["order"]
    name = f"{facts['transfer'].upper()}({order})" if facts["transfer"] == "fmpm" or order > 1 else "FLIP"
    if facts["every_steps"] is not None:
        name += f" in 1 of {facts['every_steps']} heat steps, FLIP in the others"
    interval = facts["interval"]
    often = "every step" if interval == 1 else f"1 of {interval} steps"
    if facts["interval_is_chosen"]:
        often += " (auto, at the start; every step while friction may heat)"
    return f"{name}; conducted in {often}"


def _diffusivities_in_words(diffusivities: dict[str, float]) -> str:
    each = [f"{value:.3g} ({name})" for name, value in diffusivities.items()]
    return f"diffusivity {listing(each, 8)}" if each else "no material conducts heat"


def _limit_in_words(facts: dict[str, Any]) -> str:
    margin = 100 * facts["margin"]
    if margin > FAR:
        stable = f"stable up to {facts['limit']:.3g} ({facts['because']})"
        return f"Fourier number {facts['fourier']:.3g} of a heat step; {stable}"
    side, warning = ("below", "") if margin >= 0.0 else ("above", "; the run may fail")
    verdict = f"{abs(margin):.0f} % {side}"
    return (
        f"Fourier number {facts['fourier']:.3g} of a heat step, {verdict} the stable one, {facts['limit']:.3g} "
        f"({facts['because']}){warning}"
    )


def _reach_in_words(facts: dict[str, Any]) -> str:
    words = f"{facts['heat_steps']} heat steps, in which conduction reaches {facts['reach']:.2g} cells"
    return words + ": it has no effect on this grid" * (0.0 < facts["reach"] < SHORTEST_REACH)


def _filter_in_words(facts: dict[str, Any]) -> list[str]:
    of = facts["filter"]
    if of is None:
        return []
    removed = ", ".join(f"{share:.2g} of {length} cells" for length, share in facts["removed"].items())
    return [
        f"FMPM({of['order']}) keeps waves longer than {of['wave']:.3g} cells (body '{of['body']}': {of['length']:.3g} "
        f"cells); a heat step removes of waves {removed}"
    ]


def _planes_in_words(facts: dict[str, Any]) -> list[str]:
    instead = "hold the face of the body instead (on: {body: ..., face: ...})"
    lines = [
        f"condition '{name}' holds nodes, and its plane is {distance:.2g} cells from the nearest grid line; {instead}"
        for name, distance in facts["off_grid_lines"].items()
    ]
    if facts["splines"] and not lines:
        lines.append(
            f"held nodes of quadratic splines hold the plane with an error of some per cent; {instead}"
        )
    return lines
