"""Task 3.b: grid velocities from momenta: lumped, by the FMPM loop, or filtered for XPIC."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmcli.core import nodes

if TYPE_CHECKING:
    from mpmcli.solver.simulation import Simulation

Array = np.ndarray


def add_full_mass_increments(s: Simulation, v: Array, counts_reactions: bool) -> None:
    """Turn lumped velocities v⁺(1) into v⁺(k) (the "FMPM loop", Table 1 of Nairn 2026); overwrites ``v`` (n, d).

    ``counts_reactions`` adds the impulse of the conditions on each increment to their reactions.
    """
    grid, active = s.grid, s.grid.active
    dv, out = s.arrays.dv, s.arrays.out
    nodes.start_increments[s.parallel](active, v, dv, out)
    for _ in range(2, s.plan.order + 1):
        s.transfer.project(dv, out)
        s.conditions.fold_increment(out, -1.0 if counts_reactions else 0.0)
        nodes.next_increment[s.parallel](active, grid.mp, out, dv)
        if s.plan.zeroes_increments:
            s.conditions.zero_increment(dv, grid.mp, counts_reactions)
        nodes.add_increment[s.parallel](active, dv, v)


def add_filtered_velocities(s: Simulation, w: Array, dt: float) -> None:
    """XPIC(m): w = m(v − v*) + a Δt from accelerations in ``w`` (n, d) (Nairn et al. 2020, Eqs. 35–43)."""
    grid, active, order = s.grid, s.grid.active, s.plan.order
    dv, out = s.arrays.dv, s.arrays.out
    nodes.start_projection[s.parallel](active, grid.mp, s.arrays.p_start, float(order), dt, dv, w, out)
    scales = [(order + 1 - k) / k for k in range(2, order + 1)]
    terms = [-order * (-1.0) ** k for k in range(2, order + 1)]
    for scale, term, share in zip(scales, terms, _shares(scales, terms), strict=True):
        s.transfer.project(dv, out)
        s.conditions.fold_increment(out, share)
        nodes.add_projection[s.parallel](active, grid.mp, out, scale, term, dv, w)


def _shares(scales: list[float], terms: list[float]) -> list[float]:
    """How much of each pass of the XPIC filter ends up in the particles' velocity, later passes included."""
    shares = [0.0]
    for scale, term in zip(reversed(scales), reversed(terms), strict=True):
        shares.insert(0, scale * (term + shares[0]))
    return shares[:-1]
