"""Bodies that slide along curved joints go into each other; ``overlap_removal`` takes that back."""

from __future__ import annotations

import numpy as np
import pytest
import yaml

from mpmcli.contact.overlap import volume_of_node
from mpmcli.study.overlap import find_overlapping

DISK = {"kind": "disk", "center": [0.47, 0.52], "radius": 0.31}


def full_box(region, contact, analysis="plane_strain", side=1, **changes):
    """Scene text: a body in a hole of another that fills the box, pressed down between smooth walls."""
    axes = "xyz" if analysis == "3d" else "xy"
    lower, upper = [0] * len(axes), [side] * len(axes)
    box = {"kind": "box", "lower": lower, "upper": upper}
    top, middle = (axes[-1], side), ("x", 0) if analysis == "axisymmetric" else None
    faces = [(axis, at) for axis in axes for at in (0, side) if (axis, at) not in (top, middle)]
    metal = {"kind": "neo_hookean", "density": 2.78e-3, "K": 78090, "G": 27600, "split": "isochoric"}
    hole = {"kind": "difference", "region": box, "subtract": [region]}
    scene = {
        "version": 1,
        "constants": {"speed": 100, "height": side},
        "analysis": {"kind": analysis},
        "grid": {"lower": lower, "upper": upper, "cell": 0.125},
        "method": {"shape": "lcpdi", "transfer": {"kind": "fmpm", "order": 4}},
        "materials": {"metal": metal},
        "bodies": [
            {"name": "inner", "material": "metal", "region": region},
            {"name": "outer", "material": "metal", "region": hole},
        ],
        "contact": {"law": {"kind": "frictionless"}} | contact,
        "boundary": [
            {"name": f"{axis} {at}", "kind": "symmetry", "plane": {"axis": axis, "at": at}}
            for axis, at in faces
        ]
        + [
            {
                "name": "piston",
                "kind": "wall",
                "normal": [0] * (len(axes) - 1) + [-1],
                "position": "height - speed*t",
                "velocity": "-speed",
                "gradient": "-speed/(height - speed*t)",
            }
        ],
        "time": {"end": 0.008, "courant": 0.2},
    }
    return yaml.safe_dump(scene | changes, sort_keys=False)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("analysis", "region", "error"),
    [
        ("plane_strain", DISK, 1e-12),
        ("3d", {"kind": "sphere", "center": [0.5, 0.5, 0.5], "radius": 0.3}, 1e-12),
        ("axisymmetric", {"kind": "disk", "center": [0, 0.5], "radius": 0.3}, 1e-12),
    ],
)
def test_bodies_that_fill_space_have_the_volume_of_the_node(start, analysis, region, error):
    """At the start nothing overlaps, however jagged the joint is; on the axis the volume is an upper bound."""
    run = start(full_box(region, {"overlap_removal": 0.05}, analysis), threads=1)
    run.simulation.step()
    grid, contacts = run.simulation.grid, run.simulation.contact.contacts
    clouds = contacts.clouds
    first = clouds.first[: clouds.count + 1]
    there = np.add.reduceat(contacts.volume[: first[-1]], first[:-1])
    x = grid.coordinates(clouds.node[: clouds.count])
    inside = ((x > -1e-9) & (x < 1 - 0.1)).all(axis=0)
    axis = (np.abs(x[0]) < 1e-9) & (analysis == "axisymmetric")
    ring = True if analysis == "axisymmetric" else None
    origin = tuple(float(a) for a in grid.lower - grid.pad * grid.cell)
    cell = tuple(float(a) for a in grid.cell)
    axes = (0.0,) * len(cell)
    whole = np.array(
        [volume_of_node(axes, i, grid.shape, origin, cell, ring) for i in clouds.node[: clouds.count]]
    )
    ratio = there / whole
    assert (inside & ~axis).sum() > 10
    np.testing.assert_allclose(ratio[inside & ~axis], 1.0, rtol=error)
    assert (ratio[inside & axis] < 1.0).all()
    assert (
        contacts.drive[: contacts.count].max()
        <= 1e-12 * grid.mp[:, 0].max() * grid.cell[0] / run.simulation.dt
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    "transfer", [{"kind": "fmpm", "order": 4}, {"kind": "xpic", "order": 5}], ids=["fmpm", "xpic"]
)
def test_a_disk_in_a_matrix_keeps_out_of_it(start, transfer):
    """Pressed by 30 % the bodies have 3 % more volume than the box; driven apart they fill it, and press more."""
    filled, inside, momentum = [], [], []
    for removal in (0.0, 0.05):
        method = {"shape": "lcpdi", "transfer": transfer}
        run = start(full_box(DISK, {"overlap_removal": removal}, method=method), threads=1)
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
