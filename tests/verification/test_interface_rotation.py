"""Half disks that an interface joins, through a whole turn (L4)."""

import exact_interfaces as exact
import numpy as np
import pytest

pytestmark = [pytest.mark.slow, pytest.mark.timeout(900)]

DISK = (5.0, 1e-3, 2.0)
"""Radius, density and angular velocity of the disk."""
NU = 0.33
CENTRIFUGAL = 1e-3 * 2.0**2 * 5.0**2 / 3.0
"""Mean stress across a diameter of the disk that turns, ρ ω² R²/3 [MPa]."""
DRIFT = 4e-7
"""What positions that drift from F add to the energy of the joint in a turn, over the kinetic energy."""


def look(run):
    """Largest jump [cells], mean traction, energy of the interface over the kinetic one, and angular momentum."""
    parts = run.simulation.contact.interfaces
    p = run.particles
    jumps = np.linalg.norm(parts.ends.end[parts.rows()], axis=1)
    turning = np.sum(p.mass * (p.X[0] * p.V[1] - p.X[1] * p.V[0]))
    energy = parts.view.energy.sum() / max(run.kinetic_energy, 1e-9)
    return jumps.max() / run.simulation.grid.cell[0], parts.view.means().traction_normal[0], energy, turning


def turn(start, end, every, *sets):
    run = start("spinning_joint.yaml", *sets)
    run.to(0.32)
    seen = [look(run)]
    for time in np.arange(0.32 + every, end, every):
        run.to(time)
        seen.append(look(run))
    return np.array(seen).T


def check_turn(start, cell, *sets):
    """Energies of springs of D Δx/E = 1 through a turn, over the kinetic energy."""
    jump, traction, energy, turning = turn(start, 3.29, 0.25, f"constants.cell={cell}", *sets)
    D = 1000.0 / cell
    asked = exact.centrifugal_energy(D, *DISK, NU)
    assert exact.least_centrifugal_energy(D, *DISK) < asked
    assert jump.max() < 5e-4
    assert traction == pytest.approx(CENTRIFUGAL, rel=0.07)
    assert energy[:3] == pytest.approx(asked, rel=0.05)  # the disk vibrates a little
    assert np.all(energy > exact.least_centrifugal_energy(D, *DISK))
    assert np.all(energy - asked < DRIFT)
    assert turning == pytest.approx(turning[0], rel=1e-3)
    return energy


def test_centrifugal_stress():
    """Its mean is that of the balance of half of the disk; springs store a little more than under a uniform one."""
    x = np.linspace(-5.0, 5.0, 20001)
    assert exact.centrifugal_stress(x, *DISK, NU).mean() == pytest.approx(CENTRIFUGAL, rel=1e-3)
    assert exact.centrifugal_energy(2000.0, *DISK, NU) == pytest.approx(1.523e-6, rel=1e-3)
    assert exact.least_centrifugal_energy(2000.0, *DISK) == pytest.approx(1.415e-6, rel=1e-3)


def test_a_turn_opens_no_joint(start):
    """The jump is that of the centrifugal stress, and positions that drift from F by some 1e-4 cells in a turn."""
    check_turn(start, 0.5)


def test_with_fine_cells_it_stores_less_than_a_millionth(start):
    """For springs that are twice as stiff the centrifugal stress asks for half as much: 0.76e-6."""
    assert check_turn(start, 0.25, "time.courant=0.4").max() < 1e-6


@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.5, 0.0), (0.13, 0.31)])
def test_area_in_every_direction(start, offset):
    """Within 1 %, also where the joint is parallel to diagonals of cells, and nodes lie on it or half way between."""
    for angle in (0, 10, 20, 30, 40, 44, 44.8, 45, 45.2, 50, 70, 90, 135):
        run = start("spinning_joint.yaml", "constants.cell=0.25", "loads=[]")
        s, p, turned = run.simulation, run.particles, np.radians(angle)
        R = np.array([[np.cos(turned), -np.sin(turned)], [np.sin(turned), np.cos(turned)]])
        p.X[:] = R @ p.X0 + 0.25 * np.array(offset)[:, None]
        p.F[:4] = R.reshape(4, 1)
        s.transfer.order.forget()
        s.step()
        assert s.contact.view.interfaces.means().area[0] == pytest.approx(10.0, rel=0.01), angle


def opened(omega=2.0, size=0.05, until=0.1):
    """Halves that turn from the start, each particle on its circle, while the upper one moves off by ``size``."""
    phase = f"2*pi*min(t, {until})/{until}"
    speeding = f"{size}*2*pi/{until}**2*sin({phase})"
    across = f"2*{omega}*{size}/{until}*(1 - cos({phase}))"
    turn, velocity = f"{omega}*t", f"['-{omega}*y', '{omega}*x']"
    loads = (
        f"{{name: turn, kind: body_force, acceleration: ['-{omega**2}*x', '-{omega**2}*y']}}, "
        "{name: open, kind: body_force, on: {body: upper}, acceleration: "
        f"['-{speeding}*sin({turn}) - {across}*cos({turn})', '{speeding}*cos({turn}) - {across}*sin({turn})']}}"
    )
    bodies = (f"bodies.{name}.velocity={velocity}" for name in ("lower", "upper"))
    return ("constants.k=0", f"loads=[{loads}]", *bodies)


def motion(run, body):
    """A and c of the affine motion x = A X + c that fits a body best."""
    mine = run.ordered("body") == body
    X = np.vstack([run.X0[:, mine], np.ones(mine.sum())])
    found = np.linalg.lstsq(X.T, run.X[:, mine].T, rcond=None)[0].T
    return found[:, :2], found[:, 2]


def test_an_open_joint_turns_with_its_halves(start):
    """Its jump is that of the motions of the halves, which turn by 92°."""
    run = start("spinning_joint.yaml", *opened(), "time.courant=0.4")
    for time in (0.1, 0.4, 0.8):
        run.to(time)
        parts, contacts = run.simulation.contact.interfaces, run.simulation.contact.contacts
        rows = parts.rows()
        nodes = contacts.table.node[contacts.fields.slot[rows]]
        x = run.simulation.grid.coordinates(nodes)
        (A, a), (B, b) = motion(run, 0), motion(run, 1)
        mean = 0.5 * (A + B)
        wanted = (mean @ (np.linalg.solve(A, x - a[:, None]) - np.linalg.solve(B, x - b[:, None]))).T
        jumps = parts.ends.end[rows] * np.sign(contacts.geometry.normal[rows] @ wanted.mean(axis=0))[:, None]
        assert len(jumps) > 20
        assert np.linalg.norm(jumps - wanted, axis=1).max() < 0.005 * 0.05
        assert np.linalg.norm(jumps, axis=1) == pytest.approx(0.05, rel=0.01)  # the halves move, too
        assert np.arctan2(A[1, 0], A[0, 0]) == pytest.approx(2.0 * run.time, rel=0.002)
