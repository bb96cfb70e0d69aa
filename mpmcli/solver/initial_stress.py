"""Particles of bodies that have stress at the start."""

from typing import Any

import numpy as np

from mpmcli.core.analysis import F_COMPONENTS
from mpmcli.core.errors import SceneError
from mpmcli.core.particles import Particles
from mpmcli.materials.base import keeps_strain
from mpmcli.scene.initial_stress import find_start, start_stress
from mpmcli.solver.plan import PARALLEL_FROM, Plan


def set_initial_stress(scene: Any, plan: Plan, particles: Particles, models: list[Any]) -> None:
    """Give bodies the elastic strain of their stress; where they are and how large they are stays.

    Materials that keep their elastic strain in the history get it there. The deformation gradient of the others starts
    at the stretch; their initial volumes are those without stress. The density is that of the body as it is placed.

    Raises
    ------
    SceneError
        If a material cannot have the stress.
    """
    for i, body in enumerate(scene.bodies):
        if body.stress is None:
            continue
        mine = np.flatnonzero(particles.body == i)
        model = models[particles.material[mine[0]]]
        stress, problems = start_stress(scene, body, particles.X[:, mine])
        if problems:
            raise SceneError(problems)
        m, keeps = model.parameters(plan.analysis_name, plan.adiabatic), keeps_strain(model)
        H = particles.H[:, mine]
        parallel = len(mine) >= PARALLEL_FROM
        stretch, problems = find_start(body, particles.X[:, mine], stress, m, H, keeps, parallel)
        if problems:
            raise SceneError(problems)
        if keeps:
            particles.H[:, mine] = H
        else:
            _stretch(particles, mine, stretch)


def _stretch(particles: Particles, mine: np.ndarray, stretch: np.ndarray) -> None:
    """Let the particles ``mine`` (n,) have come to their place and size by the stretch (6, n)."""
    d = len(particles.X)
    xx, yy, zz, xy, yz, xz = stretch
    V = {"xx": xx, "yy": yy, "zz": zz, "xy": xy, "yx": xy, "yz": yz, "zy": yz, "xz": xz, "zx": xz}
    for row, name in enumerate(F_COMPONENTS[d]):
        particles.F[row, mine] = V[name]
    particles.vol0[mine] /= particles.determinant()[mine]
    for axis in range(d):
        edge = np.stack([V[other + "xyz"[axis]] for other in "xyz"[:d]])
        particles.size[axis, mine] /= np.linalg.norm(edge, axis=0)
