"""Task 3.b: grid velocities from momenta: lumped, by the FMPM loop, or filtered for XPIC."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmcli.core import nodes

if TYPE_CHECKING:
    from mpmcli.solver.simulation import Simulation

Array = np.ndarray


def add_full_mass_increments(s: Simulation, v: Array, dt: float, counts_reactions: bool) -> None:
    """Turn lumped velocities v⁺(1) into v⁺(k) (the "FMPM loop", Table 1 of Nairn 2026); overwrites ``v`` (n, d).

    ``counts_reactions`` adds the impulse of the conditions on each increment to their reactions.
    """
    grid, active = s.grid, s.grid.active
    dv, out = s.arrays.dv, s.arrays.out
    nodes.start_increments[s.parallel](active, v, dv, out)
    order = 1
    while order < s.plan.order:
        order += 1
        s.transfer.project(dv, out, first=order == 2)
        s.conditions.fold_increment(out, -1.0 if counts_reactions else 0.0)
        nodes.next_increment[s.parallel](active, grid.mp, out, s.plan.blend_scale(order), dv)
        if s.plan.zeroes_increments:
            s.conditions.zero_increment(dv, grid.mp, counts_reactions)  # (1)
        s.contact.correct_increment(dv, dt, counts_reactions)  # (2)
        nodes.add_increment[s.parallel](active, dv, v)
        if s.plan.dynamic is not None and has_converged(s, dv, v):  # (3)
            break
    s.reached_order = order


def has_converged(s: Simulation, dv: Array, v: Array) -> bool:
    """Whether the last increment is small by the metric of the scene (Nairn 2026, section 3.4), all fields together."""
    metric, tolerance = s.plan.dynamic or ("means", 0.0)
    grid, sums = s.grid, s.arrays.node_sums
    nodes.sum_magnitudes[s.parallel](grid.active, grid.mp, dv, v, sums)
    change, size, _, count = sums.sum(axis=0)
    if metric == "means":
        return bool(change <= tolerance * size)
    epsilon = 0.01 * float(sums[:, 2].max())
    nodes.sum_changes[s.parallel](grid.active, grid.mp, dv, v, epsilon, sums)
    return bool(epsilon == 0.0 or sums[:, 0].sum() <= tolerance * count)


def add_filtered_velocities(s: Simulation, w: Array, dt: float) -> None:
    """XPIC(m): w = a Δt + u with the filtered velocity u, from accelerations in ``w`` (n, d).

    u = Σ_j (I − S⁺S)ʲ v⁰ + (I − S⁺S)^(m−1) Δv for j = 0 … m − 1, with v⁰ extrapolated and Δv = v − v⁰ what contact
    corrected (Nairn et al. 2020, Eq. 37), by u ← v⁰ + (I − S⁺S) u, which begins with u = v.
    """
    grid, active, order = s.grid, s.grid.active, s.plan.order
    u, out, p_start = s.arrays.dv, s.arrays.out, s.arrays.p_start
    nodes.start_projection[s.parallel](active, grid.mp, p_start, u, out)
    if s.plan.corrects_filter:
        s.contact.take_out_start(p_start)
    for m in range(2, order + 1):
        s.transfer.project(u, out, first=m == 2)
        s.conditions.fold_increment(
            out, -1.0 if m == order else 0.0
        )  # what passes filter out gives no momentum
        nodes.next_projection[s.parallel](active, grid.mp, p_start, out, u)
    nodes.add_projected[s.parallel](active, dt, u, s.arrays.v, w, s.arrays.start)
