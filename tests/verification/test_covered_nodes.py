"""A rigid body that prescribes the velocity of the nodes that it covers, without contact."""

import numpy as np
import pytest
import yaml

from mpmcli.core.errors import SceneError
from mpmcli.output.global_quantities import EnergyBalance
from mpmcli.output.of_scene import check_output
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation


def pulled_bar(transfer=None, **keys):
    """A bar that is held at its lower end, and pulled by a grip that covers its upper end."""
    box = lambda lower, upper: {"kind": "box", "lower": lower, "upper": upper}  # noqa: E731
    return {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-2, -2], "upper": [20, 6], "cell": 1},
        "method": {"shape": "ugimp", "transfer": transfer or {"kind": "flip"}, "damping": {"grid": 0.5}},
        "materials": {
            "soft": {"kind": "neo_hookean", "density": 1.0, "E": 100.0, "nu": 0.0},
            "tool": {"kind": "rigid"},
        },
        "bodies": [
            {"name": "bar", "material": "soft", "region": box([0, 0], [14, 4])},
            {
                "name": "grip",
                "material": "tool",
                "region": box([12, 0], [14, 4]),
                "velocity": ["0.02*ramp(t, 0, 4)", 0],
            },
        ],
        "boundary": [
            {
                "name": "base",
                "kind": "velocity",
                "on": {"plane": {"axis": "x", "at": 0}},
                "direction": "x",
                "value": 0,
            },
            {
                "name": "pull",
                "kind": "velocity",
                "on": {"covered_by": "grip"},
                "direction": "x",
                "value": "0.02*ramp(t, 0, 4)",
            },
        ],
        "time": {"end": 20, "courant": 0.3},
    } | keys


def run(scene, end=20.0):
    loaded = load_scene(yaml.safe_dump(scene))
    check_output(loaded.scene)
    s = Simulation(loaded)
    balance, error = EnergyBalance(), 0.0
    while s.time < end:
        s.step()
        error = balance.update(Snapshot(s.state))
    return s, error


@pytest.mark.slow
@pytest.mark.parametrize("transfer", [{"kind": "flip"}, {"kind": "fmpm", "order": 4}])
def test_a_grip_pulls_a_bar(transfer):
    """The particles under the grip move as it does; between the ends the bar is stretched evenly, and pulls back."""
    s, error = run(pulled_bar(transfer))
    p = s.particles
    grip, bar = p.body == 1, p.body == 0
    moved = 0.02 * (2.0 + 16.0)
    assert p.X[0, grip].max() == pytest.approx(13.75 + moved, rel=1e-3)
    under = bar & (p.X[0] > 12.6 + moved)
    assert p.V[0, under] == pytest.approx(0.02, rel=0.03)
    middle = bar & (p.X[0] > 4.0) & (p.X[0] < 8.0)
    reach = 11.0  # the grip sees nodes one cell beyond it
    stretch = p.F[0, middle].mean()
    assert stretch == pytest.approx(1.0 + moved / reach, rel=0.01)
    stress = 50.0 * (stretch - 1.0 / stretch)
    assert p.tau[0, middle].mean() / p.determinant()[middle].mean() == pytest.approx(stress, rel=1e-6)
    assert s.state.reactions["pull"][0] == pytest.approx(4.0 * stress, rel=0.02)
    assert s.state.reactions["base"][0] == pytest.approx(-4.0 * stress, rel=0.02)
    assert abs(error) < 0.01


@pytest.mark.slow
def test_a_held_direction_leaves_the_other_free():
    """Along y the nodes under the grip are free: the bar falls."""
    gravity = [{"name": "g", "kind": "gravity", "acceleration": [0, -0.01]}]
    s, _ = run(pulled_bar(loads=gravity, method={"shape": "ugimp", "transfer": {"kind": "flip"}}), 5.0)
    fall = s.particles.V[1, s.particles.body == 0]
    assert fall.mean() == pytest.approx(-0.01 * s.time, rel=1e-9)
    assert fall == pytest.approx(-0.01 * s.time, rel=0.05)
    assert np.abs(s.particles.V[1, s.particles.body == 1]).max() == 0.0


@pytest.mark.slow
def test_serial_and_parallel_kernels_agree_and_a_copy_goes_on(monkeypatch):
    from mpmcli.solver import simulation

    found = []
    for least in (0, 10**9):
        monkeypatch.setattr(simulation, "PARALLEL_FROM", least)
        s = Simulation(load_scene(yaml.safe_dump(pulled_bar({"kind": "fmpm", "order": 3}))), threads=2)
        for _ in range(3):
            s.step()
        kept = {name: np.array(array) for name, array in s.state_arrays().items()}
        s = Simulation(load_scene(yaml.safe_dump(pulled_bar({"kind": "fmpm", "order": 3}))), threads=2)
        s.restore(kept)
        for _ in range(3):
            s.step()
        found.append({name: np.asarray(array).tobytes() for name, array in s.state_arrays().items()})
    assert found[0] == found[1]


@pytest.mark.parametrize(
    ("change", "path", "words"),
    [
        ({"on": {"covered_by": "bar"}}, "boundary.pull.on.covered_by", "'bar' is not rigid"),
        ({"on": {"covered_by": "grp"}}, "boundary.pull.on.covered_by", "did you mean 'grip'?"),
        (
            {"on": {"covered_by": "grip", "box": {"lower": [0, 0], "upper": [1, 1]}}},
            "boundary.pull.on",
            "give one of",
        ),
        ({"on": {"plane": {"axis": "x", "at": 14}}}, "bodies.grip.material", "covered_by: grip"),
    ],
)
def test_what_covers_no_nodes(change, path, words):
    scene = pulled_bar()
    scene["boundary"][1] |= change
    with pytest.raises(SceneError) as caught:
        load_scene(yaml.safe_dump(scene))
    assert any(p.path == path and words in p.message for p in caught.value.problems), caught.value.problems
