"""Task 3.b: grid velocities from momenta: lumped, by the FMPM loop, or filtered for XPIC."""

from __future__ import annotations

import numpy as np

from mpmcli.core import nodes
from mpmcli.core.step import Step
from mpmcli.solver.parts import Parts

Array = np.ndarray


def add_full_mass_increments(s: Parts, step: Step, v: Array, counts_reactions: bool) -> int:
    """Turn lumped velocities v⁺(1) into v⁺(k) (the "FMPM loop", Table 1 of Nairn 2026); overwrites ``v`` (n, d).

    ``counts_reactions`` adds the impulse of the conditions on each increment to their reactions. Returns k.
    """
    grid, active, plan = s.grid, s.grid.active, step.plan
    dv, out = s.arrays.dv, s.arrays.out
    nodes.start_increments[s.parallel](active, v, dv, out)
    order = 1
    while order < plan.order:
        order += 1
        s.transfer.project(dv, out, -1.0 if counts_reactions else 0.0, first=order == 2)
        nodes.next_increment[s.parallel](active, grid.mp, out, plan.blend_scale(order), dv)
        if plan.zeroes_increments and s.conditions is not None:
            s.conditions.zero_increment(dv, counts_reactions)  # (1)
        if s.contact is not None:
            s.contact.correct_increment(step, dv, counts_reactions)  # (2)
        nodes.add_increment[s.parallel](active, dv, v)
        if plan.dynamic is not None and has_converged(s, plan.dynamic, dv, v):  # (3)
            break
    return order


def has_converged(s: Parts, rule: tuple[str, float], dv: Array, v: Array) -> bool:
    """Whether the last increment is small by the metric of the scene (Nairn 2026, section 3.4), all fields together."""
    metric, tolerance = rule
    grid, sums = s.grid, s.arrays.node_sums
    nodes.sum_magnitudes[s.parallel](grid.active, grid.mp, dv, v, sums)
    change, size, _, count = sums.sum(axis=0)
    if metric == "means":
        return bool(change <= tolerance * size)
    epsilon = 0.01 * float(sums[:, 2].max())
    nodes.sum_changes[s.parallel](grid.active, grid.mp, dv, v, epsilon, sums)
    return bool(epsilon == 0.0 or sums[:, 0].sum() <= tolerance * count)


def add_filtered_velocities(s: Parts, step: Step, w: Array) -> None:
    """XPIC(m): w = a Δt + u with the filtered velocity u, from accelerations in ``w`` (n, d).

    u = Σ_j (I − S⁺S)ʲ v⁰ + (I − S⁺S)^(m−1) Δv for j = 0 … m − 1, with v⁰ extrapolated and Δv = v − v⁰ what contact
    corrected (Nairn et al. 2020, Eq. 37), by u ← v⁰ + (I − S⁺S) u, which begins with u = v.
    """
    grid, active, order = s.grid, s.grid.active, step.plan.order
    u, out, p_start = s.arrays.dv, s.arrays.out, s.arrays.p_start
    nodes.start_projection[s.parallel](active, grid.mp, p_start, u, out)
    if step.plan.corrects_filter and s.contact is not None:
        s.contact.take_out_start(p_start)
    for m in range(2, order + 1):
        # only the last pass changes the particles' velocities
        s.transfer.project(u, out, -1.0 if m == order else 0.0, first=m == 2)
        nodes.next_projection[s.parallel](active, grid.mp, p_start, out, u)
    nodes.add_projected[s.parallel](active, step.dt, u, s.arrays.v, w, s.arrays.start)
