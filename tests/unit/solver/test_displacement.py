"""The displacement of a particle follows it through sorting and deletion, and costs nothing where nobody asks."""

import numpy as np
import pytest

from mpmcli.output.snapshot import Snapshot

FLIES = {
    "bodies": [
        {
            "name": "block",
            "material": "soft",
            "region": {"kind": "box", "lower": [-2, -3], "upper": [3, 1]},
            "velocity": ["20 + x", "2*y"],
        }
    ],
    "domain": {"on_exit": "delete"},
}
ARCHIVE = {"particles": {"every": 1.0}}
PROBE = {"name": "p", "kind": "particle", "body": "block", "near": [0, 0]}


def by_identity(run, values: np.ndarray) -> np.ndarray:
    return values[:, np.argsort(run.particles.id)]


def test_it_survives_sorting_and_deletion(block):
    run = block(**FLIES, archive=ARCHIVE)
    start, sorts = run.ordered("X").copy(), run.simulation.order.version
    assert not Snapshot(run.simulation.state).displacement.any()
    while run.particles.count == start.shape[1]:
        run.steps(1)
    assert run.simulation.order.version > sorts + 1
    assert not np.array_equal(run.particles.id, np.sort(run.particles.id))
    expected = run.ordered("X") - start[:, np.sort(run.particles.id)]
    found = by_identity(run, Snapshot(run.simulation.state).displacement)
    np.testing.assert_array_equal(found, expected)
    assert (found[0] > 1.0).all()


def test_it_survives_a_checkpoint(block):
    run = block(**FLIES, archive=ARCHIVE).steps(5)
    again = block(**FLIES, archive=ARCHIVE).simulation
    again.restore({name: np.copy(array) for name, array in run.simulation.state_arrays().items()})
    expected = Snapshot(run.simulation.state).displacement
    assert expected.any()
    np.testing.assert_array_equal(Snapshot(again.state).displacement, expected)


@pytest.mark.parametrize(
    ("asked", "is_kept"),
    [
        ({}, False),
        ({"archive": {"particles": {"every": 1.0, "fields": ["velocity"]}}}, False),
        ({"probes": [PROBE | {"columns": ["velocity"]}]}, False),
        ({"archive": ARCHIVE}, True),
        ({"probes": [PROBE | {"columns": ["displacement"]}]}, True),
    ],
    ids=["nothing", "other fields", "another probe", "archive", "probe"],
)
def test_positions_of_the_start_are_kept_only_where_asked_for(block, asked, is_kept):
    run = block(**asked)
    kept = run.simulation.state.X0
    assert (kept is not None) == is_kept
    assert run.particles.X0 is None
    assert not is_kept or kept.nbytes == 8 * 2 * run.particles.count
