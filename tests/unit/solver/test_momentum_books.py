"""The momentum balance: m V changes by the reactions times Δt."""

import numpy as np
import pytest

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SCENE = """
version: 1
analysis: {{kind: plane_strain}}
grid: {{lower: [0, 0], upper: [6, 8], cell: 1}}
method: {{shape: {shape}, update: {update}, transfer: {{kind: {transfer}}}}}
materials: {{soft: {{kind: neo_hookean, density: 1, E: 10, nu: 0.3}}}}
bodies:
  - {{name: low, material: soft, region: {{kind: box, lower: [2, 1], upper: [4, {middle}]}}, velocity: [0.2, -1]}}
  - {{name: high, material: soft, region: {{kind: box, lower: [2, {middle}], upper: [4, 6]}}, velocity: [0, -2]}}
contact: {{law: {{kind: coulomb, friction: 0.3}}}}
boundary:
  - {{name: floor, kind: symmetry, plane: {{axis: y, at: 1}}}}
  - {{name: piston, kind: velocity, on: {{plane: {{axis: y, at: 6}}}}, direction: y, value: -1}}
time: {{end: 10, courant: 0.3}}
"""


def check(text):
    """Some steps in which the reactions are the change of momentum."""
    simulation = Simulation(load_scene(text))
    p, state = simulation.particles, simulation.state
    for _ in range(3):
        before = (p.mass * p.V).sum(axis=1)
        simulation.step()
        given = sum(state.reactions.values()) * state.dt
        assert abs(given[1]) > 0.1
        assert (p.mass * p.V).sum(axis=1) - before == pytest.approx(given, abs=1e-12 * np.abs(before).max())


@pytest.mark.parametrize("transfer", ["flip", "fmpm, order: 2"])
@pytest.mark.parametrize("update", ["usl+", "usavg+"])
def test_momenta_extrapolated_again_are_no_reactions(update, transfer, plain_python):
    """Contact lets conditions hold momenta that are extrapolated again, for strains alone."""
    with plain_python():
        check(SCENE.format(update=update, transfer=transfer, shape="ugimp", middle=4))


@pytest.mark.parametrize("transfer", ["flip", "fmpm, order: 2"])
@pytest.mark.parametrize("shape", ["ugimp", "b2gimp"])
def test_symmetry_planes_react_to_contact_beside_them(shape, transfer, plain_python):
    """Images have another share of the nodes of the near body than of those of the far one."""
    with plain_python():
        check(SCENE.format(update="usl", transfer=transfer, shape=shape, middle=2))


def test_symmetry_planes_react_to_blended_increments(plain_python):
    """Of the passes of blended FMPM particles get what the blend leaves."""
    with plain_python():
        blended = "fmpm, order: 3, blend: {order: 2, fraction: 0.5}"
        check(SCENE.format(update="usl", transfer=blended, shape="ugimp", middle=4))


TOOL = """
version: 1
analysis: {{kind: plane_strain}}
grid: {{lower: [0, 0], upper: [6, 7], cell: 1}}
method: {{shape: ugimp, transfer: {{kind: {transfer}}}}}
materials: {{soft: {{kind: neo_hookean, density: 1, E: 10, nu: 0.3}}, tool: {{kind: rigid}}}}
bodies:
  - {{name: block, material: soft, region: {{kind: box, lower: [2, 1], upper: [4, 3]}}, velocity: [0.2, 0]}}
  - {{name: tool, material: tool, region: {{kind: box, lower: [2, 3], upper: [4, 5]}}, velocity: [0, 1]}}
contact: {{law: {{kind: perfect}}}}
time: {{end: 10, courant: 0.3}}
"""


@pytest.mark.parametrize("transfer", ["xpic, order: 2", "xpic, order: 3", "fmpm, order: 2"])
def test_the_force_of_a_bonded_tool_is_the_change_of_momentum(transfer, plain_python):
    """Of what passes of XPIC give to sides that are bonded for good, too."""
    with plain_python():
        simulation = Simulation(load_scene(TOOL.format(transfer=transfer)))
        p, state = simulation.particles, simulation.state
        for _ in range(3):
            before = (p.mass * p.V).sum(axis=1)
            simulation.step()
            given = state.contact.force[0] * state.dt
            assert abs(given[1]) > 0.01
            assert (p.mass * p.V).sum(axis=1) - before == pytest.approx(given, abs=1e-12)
