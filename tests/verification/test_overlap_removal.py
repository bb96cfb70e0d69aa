"""Bodies that slide along curved joints go into each other; ``overlap_removal`` takes that back."""

import numpy as np
import pytest
import yaml
from overlap import find_overlapping

DISK = {"kind": "disk", "center": [0.47, 0.52], "radius": 0.31}
FMPM = {"kind": "fmpm", "order": 4}


def full_box(contact, transfer=FMPM):
    """Scene text: a disk in a hole of a body that fills the box, pressed down between smooth walls."""
    metal = {"kind": "neo_hookean", "density": 2.78e-3, "K": 78090, "G": 27600, "split": "isochoric"}
    box = {"kind": "box", "lower": [0, 0], "upper": [1, 1]}
    matrix = {"kind": "difference", "region": box, "subtract": [DISK]}
    faces = {"left": ("x", 0), "right": ("x", 1), "bottom": ("y", 0)}
    piston = {
        "name": "piston",
        "kind": "wall",
        "normal": [0, -1],
        "position": "1 - speed*t",
        "velocity": "-speed",
        "gradient": "-speed/(1 - speed*t)",
    }
    planes = [
        {"name": name, "kind": "symmetry", "plane": {"axis": axis, "at": at}}
        for name, (axis, at) in faces.items()
    ]
    return yaml.safe_dump(
        {
            "version": 1,
            "constants": {"speed": 100},
            "analysis": {"kind": "plane_strain"},
            "grid": {"lower": [0, 0], "upper": [1, 1], "cell": 0.125},
            "method": {"shape": "lcpdi", "transfer": transfer},
            "materials": {"metal": metal},
            "bodies": [
                {"name": "disk", "material": "metal", "region": DISK},
                {"name": "matrix", "material": "metal", "region": matrix},
            ],
            "contact": {"law": {"kind": "frictionless"}} | contact,
            "boundary": [*planes, piston],
            "time": {"end": 0.008, "courant": 0.2},
        },
        sort_keys=False,
    )


@pytest.mark.slow
def test_bodies_that_fill_space_are_not_driven(start):
    """At the start nothing overlaps, however jagged the joint is."""
    run = start(full_box({"overlap_removal": 0.05}), threads=1)
    run.simulation.step()
    grid, contacts = run.simulation.grid, run.simulation.contact.contacts
    first = contacts.nodes.first[: contacts.nodes.count + 1]
    there = np.add.reduceat(contacts.volume[: first[-1]], first[:-1])
    x = grid.coordinates(contacts.nodes.node[: contacts.nodes.count])
    inside = ((x > -1e-9) & (x < 0.9)).all(axis=0)
    assert inside.sum() > 10
    np.testing.assert_allclose(there[inside], 0.125**2, rtol=1e-12)
    impulse = grid.mp[:, 0].max() * 0.125 / run.time
    assert contacts.rows.drive[: contacts.count].max() <= 1e-12 * impulse


@pytest.mark.slow
@pytest.mark.parametrize("transfer", [FMPM, {"kind": "xpic", "order": 5}], ids=["fmpm", "xpic"])
def test_a_disk_in_a_matrix_keeps_out_of_it(start, transfer):
    """Pressed by 30 % the bodies have 3 % more volume than the box; driven apart they fill it, and press more."""
    filled, inside, momentum = [], [], []
    for removal in (0.0, 0.05):
        run = start(full_box({"overlap_removal": removal}, transfer), threads=1)
        run.to(0.003)
        p = run.particles
        F = np.stack([p.F[0:2], p.F[2:4]])
        inside.append(find_overlapping(p.X, F, p.size, p.body).mean())
        filled.append((run.ordered("vol0") * run.J).sum() / (1.0 - 100 * run.time))
        momentum.append(np.abs(run.simulation.contact.view.momentum_error).max())
    assert filled[0] > 1.02
    assert abs(filled[1] - 1.0) < 0.015
    assert inside[0] > 0.03
    assert inside[1] < 0.5 * inside[0]
    assert momentum == [0.0, 0.0]
