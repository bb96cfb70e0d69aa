"""What particles that lie along their region's own sides do not go with."""

from typing import Any

import numpy as np

from mpmcli.geometry.lattice import is_by_right_angles
from mpmcli.scene.parts import Parts
from mpmcli.scene.problems import Report
from mpmcli.shapes import SHAPES


def check_lattices(parts: Parts, dimensions: int, report: Report) -> None:
    """Report bodies that have no sides of their own, and what needs sides along the grid."""
    turned = set()
    for path, body in parts.bodies:
        if body.particles_along != "region" or list(body.region.misfits(dimensions)):
            continue
        if body.region.gives_particles:
            words = (
                f"not allowed for a region of kind '{body.region.kind}', which is itself a list of particles"
            )
            report(f"{path}.particles_along", words, "lattice")
        elif not np.isfinite(body.region.own_bounds(dimensions)).all():
            words = (
                "the region is unbounded and has no sides; intersect it with a bounded region, or use 'grid'"
            )
            report(f"{path}.particles_along", words, "lattice")
        elif not is_by_right_angles(body.region.turn(dimensions)):
            turned.add(body.name)
            shape = None if parts.method is None else SHAPES[parts.method.shape]
            if shape is not None and shape.domain == "box":
                words = f"the particle domains of '{shape.name}' stay parallel to the grid and leave gaps"
                report(f"{path}.particles_along", f"{words}; use a CPDI shape function", "lattice", "warning")
    for path, model in parts.acting:
        on: Any = getattr(model, "on", None)
        if getattr(on, "face", None) is not None and on.body in turned:
            words = (
                f"the particles of body '{on.body}' are rotated, so none of their faces is normal to an axis"
            )
            report(f"{path}.on.face", f"{words}; use 'particles_along: grid', or hold a region", "lattice")
