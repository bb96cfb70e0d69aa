"""One time step, in the order of Nairn (2026), section 2.1 and Fig. 1."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mpmcli.core import nodes
from mpmcli.solver.velocity import add_filtered_velocities, add_full_mass_increments

if TYPE_CHECKING:
    from mpmcli.solver.simulation import Simulation


def advance(s: Simulation, dt: float) -> None:
    """Advance the simulation from t to t + dt."""
    grid, plan, transfer, conditions = s.grid, s.plan, s.transfer, s.conditions
    a, clock = s.arrays, s.clock
    w: Any = None if plan.method.full_mass else a.w

    # 1  extrapolate mass and momentum to the grid (and task 2's forces, if the stress is final already)
    with clock("1 extrapolation"):
        transfer.begin_step()
        s.rigid.prepare(s.time, dt)
        transfer.extrapolate(grid.mp, grid.f if plan.has_final_stress else None)
        s.loads.collect(s.time)
        conditions.select(s.time, replaces_velocity=not plan.method.flip)
        s.contact.after_extrapolation(dt)  # 1.a

    if plan.update.first > 0.0:
        with clock("1 strain first"):
            _strain_from_momenta(s, dt)  # 1.b, 1.c
            s.averaging.average_rates()
            s.update_stress(plan.update.first * dt)  # 1.d

    # 2  forces from Kirchhoff stress on initial volume, and from loads
    with clock("2 forces"):
        if not plan.has_final_stress:
            s.averaging.average_stresses()
            transfer.internal_forces(s.averaging.tau, grid.f)
        s.loads.add_to(grid.f)
        conditions.fold_forces(grid.f, dt)

    # 3  update momenta; conditions act as reaction forces (2.a)
    with clock("3 momenta"):
        nodes.update_momenta[s.parallel](
            grid.active, grid.mp, grid.f, a.grid_damping, dt, a.p_start, a.node_work
        )
        if a.node_work is not None:
            a.node_work[0] -= conditions.damping_of_images(grid.mp, grid.f, a.grid_damping[0], dt)
        if plan.imposes_lumped:
            conditions.impose_on_momentum(grid.mp, grid.f, dt)
        s.contact.after_update(dt)  # 3.a

    # 3.b  grid velocities v⁺(k)
    with clock("3 velocities"):
        nodes.find_velocities[s.parallel](grid.active, grid.mp, grid.f, a.v, w)
        if plan.has_full_mass_loop:
            add_full_mass_increments(s, a.v, dt, counts_reactions=True)
            s.contact.after_velocities(a.v, dt)
        if plan.imposes_velocity:
            conditions.impose_on_velocity(a.v, grid.mp)
        if plan.method.projects:
            add_filtered_velocities(s, w, dt)
        s.account_for_work(dt)

    # 4  move particles (with USL, task 5's velocity gradients come from the same stencils)
    with clock("4 particles"):
        X_new = a.X_new if plan.keeps_positions else s.particles.X
        fused = plan.velocity_gradient or (plan.update.last > 0.0 and not plan.update.again)
        transfer.move(
            a.v, w, a.start if plan.method.projects else None, plan.method.flip, plan.alpha, plan.particle_damping, dt,
            X_new, fused, a.damped,
        )  # fmt: skip
        s.refuse_leaps()
        s.rigid.move(X_new)

    if plan.update.again:
        with clock("4 momenta again"):
            _strain_from_new_velocities(s, dt)  # 4.a–4.c

    # 5  particle strain and stress
    if plan.update.last > 0.0:
        with clock("5 stress"):
            s.averaging.average_rates()
            s.update_stress(plan.update.last * dt)
    if plan.keeps_positions:
        s.particles.X, a.X_new = a.X_new, s.particles.X

    # 6  final tasks
    with clock("6 final"):
        s.finish_step(dt)


def _strain_from_momenta(s: Simulation, dt: float) -> None:
    """Tasks 1.b–1.d: velocity gradients of the velocities that the momenta imply, conditions included."""
    grid, v = s.grid, s.arrays.v
    nodes.find_velocities[s.parallel](grid.active, grid.mp, grid.f, v, None)
    _find_gradients(s, v, dt)


def _strain_from_new_velocities(s: Simulation, dt: float) -> None:
    """Tasks 4.a–4.c: the same from particle velocities extrapolated again."""
    grid, v, p = s.grid, s.arrays.v, s.arrays.p_again
    nodes.clear_nodes[s.parallel](grid.active, p)
    s.transfer.add_velocities(p)
    s.conditions.fold_increment(p, weight=0.0)
    grid.mp[grid.active, 1:] = p[grid.active]
    s.contact.after_new_extrapolation(dt)  # 4.b
    nodes.find_velocities[s.parallel](grid.active, grid.mp, grid.f, v, None)
    _find_gradients(s, v, dt)


def _find_gradients(s: Simulation, v, dt: float) -> None:
    if s.plan.imposes_lumped:
        s.conditions.impose_on_velocity(v, s.grid.mp, counts_reactions=False)
    if s.plan.has_full_mass_loop:
        add_full_mass_increments(s, v, dt, counts_reactions=False)
        s.contact.after_velocities(v, dt)
    if s.plan.imposes_velocity:
        s.conditions.impose_on_velocity(v, s.grid.mp, counts_reactions=False)
    s.transfer.velocity_gradients(v)
