"""Conduction at the edges of what numbers and particles allow."""

from __future__ import annotations

from typing import Any

import exact_heat as exact
import numpy as np
import pytest
import yaml
from particle_sums import ParticleSums

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

FLIP, FMPM = {"kind": "flip"}, {"kind": "fmpm", "order": 4}
TRANSFERS = [FLIP, FMPM]
every_transfer = pytest.mark.parametrize("transfer", TRANSFERS, ids=["flip", "fmpm4"])
SOLID = {
    "kind": "linear_elastic",
    "density": 1.0,
    "E": 1.0,
    "nu": 0.0,
    "heat_capacity": 1.0,
    "conductivity": 1.0,
}


def named(transfer: dict) -> str:
    order = f"({transfer['order']})" if "order" in transfer else ""
    return f"{transfer['kind'].upper()}{order}"


class Bar(ParticleSums):
    """Bodies side by side along x, one after another from ``at`` on; ``gap`` between them."""

    def __init__(
        self, *bodies: tuple[float, Any, dict[str, Any]], transfer: dict | None = None, at: float = 0.0,
        gap: float = 0.0, step: float = 0.1, per: int = 2, velocity: float = 0.0, cells: int = 30,
        unit: float = 1.0, time: float = 1.0, **keys: Any,
    ):  # fmt: skip
        members, materials = [], {}
        for i, (length, T, changes) in enumerate(bodies):
            materials[f"m{i}"] = SOLID | changes
            region = {"kind": "box", "lower": [at * unit], "upper": [(at + length) * unit]}
            member = {"name": f"b{i}", "material": f"m{i}", "region": region, "temperature": T}
            member["particles_along"] = "region"
            members.append(member | {"particles_per_axis": per, "velocity": [velocity * unit / time]})
            at += length + gap
        scene = {
            "version": 1,
            "analysis": {"kind": "uniaxial_strain"},
            "grid": {"lower": [-5 * unit], "upper": [(cells - 5) * unit], "cell": unit},
            "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
            "heat": {"transfer": transfer or FLIP},
            "materials": materials,
            "bodies": members,
            "time": {"end": 1e6 * time, "step": step * time},
        } | keys
        self.simulation = Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), threads=1)
        self.X0 = self.ordered("X")[0]
        self._capacity = np.array([material["heat_capacity"] for material in materials.values()])
        self.heat = self._heat()

    @property
    def mass(self) -> np.ndarray:
        return self.ordered("mass")

    @property
    def T(self) -> np.ndarray:
        return self.ordered("T")

    def _heat(self) -> float:
        p = self.particles
        T = p.T if p.T_carried is None else p.T_carried
        return float((p.mass * self._capacity[p.material]) @ T)

    @property
    def drift(self) -> float:
        """Change of the heat over its start."""
        return abs(self._heat() / self.heat - 1)

    def steps(self, count: int) -> Bar:
        for _ in range(count):
            self.simulation.step()
        return self


@every_transfer
@pytest.mark.parametrize(
    "changes",
    [
        {"conductivity": 1e-6},
        {"conductivity": 0.0},
        {"heat_capacity": 1e6},
        {"heat_capacity": 1e6, "conductivity": 1e-6},
        {"heat_capacity": 1e6, "conductivity": 1e6},
    ],
    ids=str,
)
def test_ratios_of_a_million_across_a_body(transfer, changes, hold):
    for at in (0.0, 0.3):
        bar = Bar((6, 400, {}), (6, 300, changes), transfer=transfer, at=at, step=0.2).steps(300)
        what = ", ".join(f"{name.replace('_', ' ')} {value:g} beside 1" for name, value in changes.items())
        hold(what, named(transfer), "change of heat", bar.drift, 1e-12)
        margin = 0.0 if transfer is FLIP else 0.14  # overshoot at the interface
        beyond = max(300 - bar.T.min(), bar.T.max() - 400, 0.0) / 100
        hold(what, named(transfer), "beyond the start, of the jump", beyond, margin + 1e-10)
        # heat does go, or stays where nothing conducts
        far = bar.T[bar.X0 > at + 10]
        if changes == {"conductivity": 0.0} and transfer is FLIP:
            hold(
                what, named(transfer), "warming where nothing conducts, of the jump", np.ptp(far) / 100, 1e-12
            )


@pytest.mark.parametrize(
    "transfer", [FLIP, pytest.param(FMPM, marks=pytest.mark.slow)], ids=["flip", "fmpm4"]
)
@pytest.mark.parametrize(
    "contact", ["shared", "insulated", {"conductance": "perfect"}, {"conductance": 0.5}], ids=str
)
@pytest.mark.parametrize(
    "changes",
    [
        {"conductivity": 0.0},
        {"conductivity": 1e-6},
        {"heat_capacity": 1e6, "conductivity": 1e6},
        {"heat_capacity": 1e6, "conductivity": 1e-6},
    ],
    ids=str,
)
def test_ratios_of_a_million_across_a_contact(plain_python, transfer, contact, changes, hold):
    """Two bodies that touch keep their heat, and exchange none, a little or all that one body would."""
    kind = contact if isinstance(contact, str) else f"conductance {contact['conductance']}"
    what = f"conductivity, capacity, both 1e6 across a contact, {kind}"
    law = {"contact": {"law": {"kind": "perfect"}}}
    bodies, heat = ((5, 400, {}), (5, 300, changes)), {"transfer": transfer, "contact": contact}
    with plain_python():
        bar = Bar(*bodies, transfer=transfer, step=0.2, cells=20, heat=heat, **law)
        bar.steps(60)
        hold(what, named(transfer), "change of heat", bar.drift, 1e-12)
        margin = 0.0 if transfer is FLIP else 0.14  # overshoot at the interface
        beyond = max(300 - bar.T.min(), bar.T.max() - 400, 0.0) / 100
        hold(what, named(transfer), "beyond the start, of the jump", beyond, margin + 1e-10)
        if contact == {"conductance": "perfect"}:
            one = Bar(*bodies, transfer=transfer, step=0.2, cells=20).steps(60)
            hold(what, named(transfer), "from one body, of the jump", np.abs(bar.T - one.T).max() / 100, 1e-9)
    given = 400 * 5 - bar.mass[bar.X0 < 5] @ bar.T[bar.X0 < 5]
    if contact == "insulated":
        hold(what, named(transfer), "heat that crosses, of that of a body", abs(given) / 500, 1e-12)
    else:
        assert given > 0.0
    if contact == {"conductance": 0.5} and changes == {"heat_capacity": 1e6, "conductivity": 1e6}:
        # the other body stays at 300 K: a slab of 5 cells behind a film, insulated at its far end, with an error of
        # first order in the cell
        lost = 1 - exact.slab_film((np.arange(1000) + 0.5) / 1000, 60 * 0.2 / 25, 0.5 * 5).mean()
        off = abs(given / 500 / lost - 1)
        hold(what, named(transfer), "heat that crosses, from that through a film", off, 0.08)


@every_transfer
def test_one_particle_and_one_alone_in_its_cell(transfer, hold):
    for bodies in [((0.5, 321.0, {}),), ((4, 400, {}), (0.5, 321.0, {}))]:
        bar = Bar(*bodies, transfer=transfer, at=0.3, gap=4.0, velocity=0.03).steps(100)
        alone = bar.T[bar.X0 > bar.X0.max() - 0.4]
        assert alone.shape == (1,)
        off = abs(alone[0] / 321 - 1)
        hold("one particle in its cells", named(transfer), "change of its temperature, of it", off, 1e-13)


@every_transfer
@pytest.mark.parametrize("per", [1, pytest.param(64, marks=pytest.mark.slow)])
def test_one_and_many_particles_per_cell(transfer, per, hold):
    bar = Bar((10, "300 + 100*cos(pi*x/10)", {}), transfer=transfer, per=per)
    mode = np.cos(np.pi * bar.X0 / 10)
    bar.steps(100)
    found = exact.amplitude((bar.T - 300) / 100, mode) / exact.mode_amplitude(np.pi, 0.1) - 1
    hold(
        f"particles per cell: {per}", named(transfer), "amplitude of a cosine over 10 cells", abs(found), 0.02
    )
    hold(f"particles per cell: {per}", named(transfer), "change of heat", bar.drift, 1e-13)


def test_order_one_hundred(hold):
    bar = Bar((10, "300 + 100*cos(pi*x/10)", {}), transfer={"kind": "fmpm", "order": 100})
    mode = np.cos(np.pi * bar.X0 / 10)
    bar.steps(100)
    found = exact.amplitude((bar.T - 300) / 100, mode) / exact.mode_amplitude(np.pi, 0.1) - 1
    hold("FMPM(100) for heat", "FMPM(100)", "amplitude of a cosine over 10 cells", abs(found), 0.02)
    hold("FMPM(100) for heat", "FMPM(100)", "change of heat", bar.drift, 1e-12)


@every_transfer
@pytest.mark.parametrize("factor", [1e-3 / 300, 1e8 / 300])
def test_temperatures_from_a_millikelvin_to_a_hundred_megakelvin(transfer, factor, hold):
    def run(scale: float) -> np.ndarray:
        T0 = {"T0": 300 * scale}
        bodies = (5, 400 * scale, T0), (5, 300 * scale, T0)
        return Bar(*bodies, transfer=transfer, at=0.3).steps(100).T / scale

    off = np.abs(run(factor) / run(1.0) - 1).max()
    hold(f"temperatures of {300 * factor:.0e} K", named(transfer), "largest difference", off, 1e-12)


@every_transfer
@pytest.mark.parametrize(("unit", "time"), [(1e-9, 1e-9), (1e3, 86400.0)], ids=["nm-ns", "km-days"])
def test_units_of_heat(transfer, unit, time, hold):
    """Lengths and times in other units; mass stays: κ goes like L/t³, c_v like L²/t²."""

    def run(L: float, t: float) -> np.ndarray:
        units = {
            "density": L**-3,
            "E": 1 / (L * t * t),
            "heat_capacity": L * L / (t * t),
            "conductivity": L / t**3,
        }
        bar = Bar((5, 400, units), (5, 300, units), transfer=transfer, at=0.3, unit=L, time=t, velocity=0.1)
        return bar.steps(100).T

    off = np.abs(run(unit, time) / run(1.0, 1.0) - 1).max()
    hold(f"length and time in units {unit:g} and {time:g}", named(transfer), "largest difference", off, 1e-10)


@every_transfer
@pytest.mark.parametrize(
    ("unit", "time", "kelvin"),
    [(1e-9, 1e-9, 1.0), (1e3, 86400.0, 1.0), (1.0, 1.0, 1e-3 / 300), (1.0, 1.0, 1e8 / 300)],
    ids=["nm-ns", "km-days", "mK", "100 MK"],
)
def test_units_and_temperatures_of_bodies_that_expand_and_warm(
    plain_python, transfer, unit, time, kelvin, hold
):
    """The same with coupling: α goes like 1/T, c_v and κ, too."""

    def run(L: float, t: float, K: float) -> tuple[np.ndarray, np.ndarray]:
        coupled = {
            "density": L**-3,
            "E": 25 / (L * t * t),
            "heat_capacity": L * L / (t * t) / K,
            "conductivity": L / t**3 / K,
            "expansion": 1e-4 / K,
            "T0": 300 * K,
        }
        bar = Bar(
            (5, 400 * K, coupled), (5, 300 * K, coupled), transfer=transfer, at=0.3, unit=L, time=t, step=0.02
        )
        bar.steps(40)
        return bar.T / K, bar.ordered("V")[0] * t / L

    with plain_python():
        (T, V), (wanted, moved) = run(unit, time, kelvin), run(1.0, 1.0, 1.0)
    assert np.abs(moved).max() > 1e-3  # it moves by its own heat
    off = max(np.abs(T / wanted - 1).max(), np.abs(V - moved).max() / np.abs(moved).max())
    what = (
        f"temperatures of {300 * kelvin:.0e} K"
        if kelvin != 1
        else f"length and time in units {unit:g} and {time:g}"
    )
    hold(f"{what}, with expansion and heating", named(transfer), "largest difference", off, 1e-10)


@pytest.mark.parametrize("velocity", [0.0, 0.173])
@pytest.mark.parametrize("at", [0.0, 0.3])
@pytest.mark.parametrize("s", [0.01, 0.1, 0.5])
def test_flip_keeps_the_bounds_at_a_jump(velocity, at, s, hold):
    """10,000 K in one cell, both in the temperature that is seen and in the one that is carried."""
    bar = Bar((5, 10_300, {}), (5, 300, {}), at=at, velocity=velocity * 0.1 / s, step=s, cells=60)
    beyond = 0.0
    for _ in range(100):
        bar.steps(1)
        for T in (bar.particles.T, bar.particles.T_carried):
            beyond = max(beyond, T.max() - 10_300, 300 - T.min())
    how = "at rest" if velocity == 0 else "translating"
    hold(f"a jump of 10,000 K, {how}", "FLIP", "beyond the start, of the jump", beyond / 1e4, 1e-12)


@pytest.mark.parametrize(("order", "most"), [(2, 0.07), (4, 0.10), (8, 0.125)])
def test_overshoot_of_fmpm_at_a_jump(order, most, hold, breaks):
    beyond = 0.0
    for at in (0.0, 0.25, 0.5):
        transfer = {"kind": "fmpm", "order": order}
        bar = Bar((5, 30_000, {}), (5, 20_000, {}), transfer=transfer, step=0.01, at=at)
        for _ in range(100):
            bar.steps(1)
            beyond = max(beyond, bar.T.max() - 30_000, 20_000 - bar.T.min())
    hold("a jump of 10,000 K, at rest", f"FMPM({order})", "overshoot, of the jump", beyond / 1e4, most)
    breaks(
        "a jump of 10,000 K, at rest", f"FMPM({order})", "beyond the start, of the jump", beyond / 1e4, 0.03
    )


def test_an_interval_follows_a_body_that_starts_to_move(hold):
    """``auto`` waits 25 steps at rest, and less the faster the body moves: never more than half a cell."""
    keys = {
        "heat": {"interval": "auto"},
        "loads": [{"name": "pull", "kind": "gravity", "acceleration": [1.0]}],
    }
    bar = Bar((10, "300 + 100*cos(pi*x/10)", {}), step=0.01, cells=60, **keys)
    mode, moved, last, waits = np.cos(np.pi * bar.X0 / 10), 0.0, 0, []
    for step in range(1, 801):
        bar.steps(1)
        moved += 0.01 * bar.particles.V.max()
        if bar.simulation.heat.acted > len(waits):
            waits.append((step - last, moved))
            last, moved = step, 0.0
    assert waits[0][0] == 25
    assert waits[-1][0] <= 7
    what = "a body that starts to move, interval auto"
    hold(what, "FLIP", "way between two heat steps, cells", max(w[1] for w in waits), 0.55)
    left = exact.amplitude((bar.T - 300) / 100, mode)
    found = left / exact.mode_amplitude(np.pi, 0.08) - 1
    hold(what, "FLIP", "amplitude of a cosine over 10 cells", abs(found), 0.02)


@pytest.mark.slow
@every_transfer
def test_cells_stretched_ten_to_one(transfer, hold):
    """A cosine along the long or the short side of the cells, against that in cells of equal sides along it."""
    for long in (True, False):
        scene = {
            "version": 1,
            "analysis": {"kind": "plane_strain"},
            "grid": {"lower": [0, 0], "upper": [10, 1] if long else [1, 10], "cell": [1, 0.1] if long else [0.1, 1]},
            "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
            "heat": {"transfer": transfer},
            "materials": {"m": SOLID},
            "bodies": [
                {
                    "name": "b",
                    "material": "m",
                    "temperature": f"300 + 100*cos(pi*{'x' if long else 'y'}/10)",
                    "region": {"kind": "box", "lower": [0, 0], "upper": [10, 1] if long else [1, 10]},
                }
            ],
            "time": {"end": 10, "step": 0.0025},
        }  # fmt: skip
        s = Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), threads=1)
        mode = np.cos(np.pi * s.particles.X[0 if long else 1] / 10)
        order = s.particles.id.copy()
        of_id = np.empty_like(mode)
        of_id[order] = mode
        for _ in range(1000):
            s.step()
        left = exact.amplitude((s.particles.T - 300) / 100, of_id[s.particles.id])
        wanted = exact.mode_amplitude(np.pi, 2.5 / 100)
        hold(
            "cells stretched 10 to 1",
            named(transfer),
            "amplitude of a cosine over 10 cells",
            abs(left / wanted - 1),
            0.02,
        )


@pytest.mark.slow
@every_transfer
def test_equilibrium_for_a_hundred_thousand_steps(transfer, hold):
    bar = Bar((5, 321, {}), transfer=transfer, at=0.3, velocity=1e-5).steps(100_000)
    hold(
        "1e5 steps of equilibrium",
        named(transfer),
        "change of temperatures, of them",
        np.abs(bar.T / 321 - 1).max(),
        1e-10,
    )


@pytest.mark.slow
def test_noise_of_the_carried_temperature_never_grows(hold):
    """What nodes do not see stays with FLIP; it must not grow in a bar that drifts across the cells."""
    bar = Bar((5, 321, {}), transfer=FLIP, at=0.3, velocity=1e-5)
    p = bar.particles
    p.T_carried += np.random.default_rng(7).uniform(-1.0, 1.0, len(p.T_carried))
    bar.heat = bar._heat()
    mean = bar.heat / float(p.mass @ bar._capacity[p.material])
    start = np.abs(p.T_carried - mean).max()
    bar.steps(100_000)
    what = "1e5 steps from noise of 1 K"
    hold(
        what,
        named(FLIP),
        "largest carried noise over that of the start",
        np.abs(p.T_carried - mean).max() / start,
        1.0,
    )
    hold(
        what, named(FLIP), "noise that is seen, of that of the start", np.abs(bar.T - mean).max() / start, 0.1
    )
    hold(what, named(FLIP), "change of heat", bar.drift, 1e-12)
