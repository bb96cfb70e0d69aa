"""The energy balance: K + stress_work + damping_work − boundary_work − external_work stays what it was."""

import pytest


def test_the_balance_of_flip_closes_as_the_step_shrinks(block):
    """FLIP loses nothing in the transfer: what is left is the error of the time integration."""
    errors = [block(time__courant=C).until(0.3).error for C in (0.2, 0.05)]
    assert errors[0] < 0.025
    assert errors[1] < 0.4 * errors[0]


def test_the_vibrating_bar_balances(bar):
    run = bar(method__transfer={"kind": "flip"}, time__courant=0.05).until(20.0)
    assert run.error < 2e-3
    assert run.simulation.state.work["boundary_work"] == pytest.approx(0.0, abs=1e-12)


def test_stress_work_becomes_strain_energy(bar):
    """Of a hyperelastic material, as the step shrinks."""
    run = bar(method__transfer={"kind": "flip"}, time__courant=0.05).until(15.0)
    stored = float((run.particles.vol0 * run.simulation.state.strain_energy_density()).sum())
    assert stored > 0.2 * run.kinetic_energy
    assert float(run.particles.stress_work.sum()) == pytest.approx(stored, rel=1e-4)


@pytest.mark.parametrize("transfer", [{"kind": "flip"}, {"kind": "fmpm", "order": 4}])
def test_work_of_a_pulling_support_is_the_energy_gained(transfer, bar):
    """A bar at rest is pulled at its left end: all energy comes from there."""
    run = bar(
        method__transfer=transfer,
        bodies__0__velocity=["0"],
        bodies__0__region={"kind": "box", "lower": [2], "upper": [20]},
        boundary=[
            {"name": "grip", "kind": "velocity", "on": {"plane": {"axis": "x", "at": 2}}, "direction": "x",
             "value": "-0.01*min(t/10, 1)"},
        ],
        time__courant=0.1,
    ).until(15.0)  # fmt: skip
    work = run.simulation.state.work["boundary_work"]
    assert work > 0
    assert run.energy == pytest.approx(work, rel=0.03)


def test_a_reaction_is_the_change_of_momentum(bar):
    """m V changes by the reaction of the support times Δt in every step, to round-off, at every order."""
    run = bar(method__transfer={"kind": "fmpm", "order": 4})
    for _ in range(10):
        before = run.momentum[0]
        run.steps(1)
        state = run.simulation.state
        assert run.momentum[0] - before == pytest.approx(state.reactions["support"][0] * state.dt, abs=1e-13)


def test_weight_does_work(block):
    """Gravity on a deforming block: external_work enters the balance with its sign."""
    weight = [{"name": "weight", "kind": "gravity", "acceleration": [0, -5]}]
    run = block(loads=weight, time__courant=0.05).until(0.3)
    assert run.simulation.state.work["external_work"] != 0
    assert run.error < 0.01


def test_looking_changes_nothing(block):
    """Energies, quantities and grid fields may be read at any time without changing a bit of the motion."""
    watched, alone = block(), block()
    for _ in range(8):
        watched.steps(1)
        for read in watched.simulation.state.grid.fields.values():
            read()
        alone.simulation.step()
    assert (watched.ordered("X") == alone.ordered("X")).all()
    assert (watched.ordered("tau") == alone.ordered("tau")).all()


def test_the_grid_shows_only_what_is_there(block):
    """Nodes that the body has left behind have no mass, momentum, force or velocity any more."""
    run = block(bodies__0__velocity=["30", "-20"], time__courant=0.5)
    moved = run.ordered("X").copy()
    while run.ordered("X")[0, 0] - moved[0, 0] < 3.0:
        run.steps(1)
    fields = run.simulation.state.grid.fields
    assert fields["mass"]().sum() == pytest.approx(run.particles.mass.sum(), rel=1e-12)
    momentum = fields["momentum"]()
    assert momentum.sum(axis=0) == pytest.approx(run.momentum, rel=1e-9)
    assert not fields["force"]()[fields["mass"]() == 0].any()


@pytest.mark.slow
@pytest.mark.parametrize("damping", [{"grid": 2.0}, {"local": 0.3, "grid": 1.0}], ids=["grid", "local"])
def test_damping_takes_a_quarter_of_the_energy_from_a_quarter(block, damping):
    """Between symmetry planes the mirrored particles' part is none of the scene's."""

    def run(lower, planes):
        return block(
            method__damping=damping,
            method__transfer={"kind": "fmpm", "order": 2},
            bodies__0__region={"kind": "box", "lower": [lower, lower], "upper": [3, 3]},
            bodies__0__velocity=["-0.8*x", "0.5*y"],
            boundary=[
                {"name": a, "kind": "symmetry", "plane": {"axis": a, "at": 0, "side": "lower"}}
                for a in planes
            ],
        ).steps(20)

    whole, quarter = run(-3, ""), run(0, "xy")
    taken = [run.simulation.state.work["damping_work"] for run in (whole, quarter)]
    assert taken[0] > 0.05 * whole.kinetic_energy
    assert taken[1] == pytest.approx(0.25 * taken[0], rel=1e-9)
    assert quarter.energy == pytest.approx(0.25 * whole.energy, rel=1e-9)
