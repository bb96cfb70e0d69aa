"""What a scene asks for and could do without, the answer being the same; and what only runs can tell.

A hint is given only where it follows from the scene. What it says is tested by running scenes with and without.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcli.core.expressions import Expression
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles
from mpmcli.scene.fields import law_table
from mpmcli.solver.plan import Plan

Array = np.ndarray

TOLERANCE = 1e-9
"""Relative slack of comparisons of times."""
LOADED_BY = ("acceleration", "force", "traction")
"""Keys of loads that hold how much."""


@dataclass(frozen=True)
class Spare:
    """Something that could go.

    Attributes
    ----------
    path : key of the scene
    because : why the answer stays the same
    same : how exactly it does
    """

    path: str
    because: str
    same: str

    def __str__(self) -> str:
        return f"{self.path}: {self.because} ({self.same})"


BITS = "the same to the last digit"
ROUND_OFF = "the same but for round-off"


def find_spare(scene: Any, plan: Plan, grid: Grid, particles: Particles, dt: float) -> list[Spare]:
    """What could be dropped from a checked scene; ``dt`` is its first time step."""
    found = [
        *_fields(scene, plan, grid, particles, dt),
        *_pairs(scene, plan),
        *_orders(scene, plan),
        *_order_of_translation(scene, plan, grid, particles, dt),
        *_parts(scene),
        *_outputs(scene, dt),
    ]
    return found


def find_questions(scene: Any, plan: Plan) -> list[str]:
    """What nobody can know without runs: what to ask, and the keys that ``mpmcli tradeoff`` would vary."""
    transfer, questions = scene.method.transfer, []
    if transfer.kind != "flip" and transfer.order > 1 and plan.dynamic is None:
        orders = [k for k in (1, 2, 4, 8, 16, 32, 64) if k < transfer.order] + [transfer.order]
        ways = ",".join(["flip", *(f"{transfer.kind}:{k}" for k in orders)])
        questions.append(f"which order is enough: --vary method.transfer={ways}")
    if plan.update.again:
        questions.append(
            "whether momenta must be extrapolated again: "
            f"--vary method.update={scene.method.update.removesuffix('+')},{scene.method.update}"
        )
    if plan.velocity_gradient:
        questions.append(
            "whether velocity gradients pay: --vary method.transfer.velocity_gradient=false,true"
        )
    if plan.viscosity is not None and any(plan.viscosity):
        questions.append(
            "whether artificial viscosity matters: --vary method.artificial_viscosity=null,"
            f"{{linear: {plan.viscosity[0]:g}, quadratic: {plan.viscosity[1]:g}}}"
        )
    return questions


def _fields(scene: Any, plan: Plan, grid: Grid, particles: Particles, dt: float) -> Iterator[Spare]:
    """Velocity fields that are one, or that never meet."""
    if not plan.has_contact:
        return
    laws = law_table(scene, plan.fields)[0]
    if never_meet(scene, plan, grid, particles, scene.time.end + dt):
        words = "bodies only translate, and by their places and speeds no two fields ever see the same node"
        yield Spare("contact", f"{words}: one field is enough", ROUND_OFF)
    elif (
        len(plan.fields) == 2
        and not any(plan.rigid_fields)
        and all(law.kind == "perfect" for law in laws)
        and not scene.contact.once
        and scene.contact.increments == "net"
        and not plan.method.projects
        and plan.dynamic is None
    ):
        yield Spare(
            "contact", "both fields move as one under the law 'perfect': one field is enough", ROUND_OFF
        )


def never_meet(scene: Any, plan: Plan, grid: Grid, particles: Particles, end: float) -> bool:
    """Whether it is certain that no two velocity fields see the same node until ``end``.

    It is where every body moves at one velocity, nothing acts on it but gravity, and its materials have no stress at
    rest: then it is not strained, and boxes around fields, with the reach of the shape function, stay apart.
    """
    boxes = _translating_fields(scene, plan, particles)
    if boxes is None:
        return False
    reach = 2.0 * (grid.width - 1) * grid.cell
    return not any(_boxes_meet(*boxes[a], *boxes[b], reach, end) for a in range(len(boxes)) for b in range(a))


def _translating_fields(
    scene: Any, plan: Plan, particles: Particles
) -> list[tuple[Array, Array, Array]] | None:
    """Lowest and highest particle and the velocity of each field, if it is certain that they only translate alone."""
    materials = [scene.materials[body.material] for body in scene.bodies]
    if (
        plan.has_conditions
        or plan.viscosity is not None
        or scene.domain.on_exit != "error"
        or any(load.kind != "gravity" for load in scene.loads)
        or (scene.loads and any(plan.rigid_fields))
        or (any(plan.rigid_fields) and (plan.particle_damping or plan.grid_damping))
        or any("stress_free_at_rest" not in material.properties for material in materials)
        or any(component.variables for body in scene.bodies for component in body.velocity)
    ):
        return None
    boxes = []
    for field in range(len(plan.fields)):
        mine = particles.velocity_field == field
        V = particles.V[:, mine]
        if np.any(np.ptp(V, axis=1) != 0.0):
            return None
        X = particles.X[:, mine]
        boxes.append((X.min(axis=1), X.max(axis=1), V[:, 0]))
    return boxes


def _boxes_meet(
    low: Array,
    high: Array,
    V: Array,
    other_low: Array,
    other_high: Array,
    other_V: Array,
    reach: Array,
    end: float,
) -> bool:
    """Whether two moving boxes come as close as ``reach`` along all axes at once, between times 0 and ``end``."""
    first, last = 0.0, end
    for a in range(len(low)):
        # distances at time t are gap + rate t, one box on either side of the other
        for gap, rate in (
            (other_low[a] - high[a], other_V[a] - V[a]),
            (low[a] - other_high[a], V[a] - other_V[a]),
        ):
            room = reach[a] - gap
            if rate > 0.0:
                last = min(last, room / rate)
            elif rate < 0.0:
                first = max(first, room / rate)
            elif room < 0.0:
                return False
    return first <= last


def _pairs(scene: Any, plan: Plan) -> Iterator[Spare]:
    for index, pair in enumerate(scene.contact.pairs if plan.has_contact else ()):
        if pair.law == scene.contact.law:
            yield Spare(f"contact.pairs.{index}", "it has the law that all pairs have", BITS)


def _orders(scene: Any, plan: Plan) -> Iterator[Spare]:
    """Orders, blends, tolerances and periods that change nothing."""
    path, transfer = "method.transfer", scene.method.transfer
    if plan.blend is not None:
        m, fraction = plan.blend
        if fraction == 1.0 or 1 < m >= plan.order or plan.order == 1:
            yield Spare(f"{path}.blend", "it leaves every increment as it is", BITS)
        elif fraction == 0.0 and plan.order > m and plan.dynamic is None and not plan.has_contact:
            words = f"the blend has nothing but zeros above order {m}: order {m} without it is the same"
            yield Spare(f"{path}.order", words, BITS)
    if plan.dynamic is not None and plan.order <= 2:
        yield Spare(f"{path}.dynamic", f"there is no order to save with order {plan.order}", BITS)
    every, courant = plan.every_courant, scene.time.courant
    if plan.every_steps == 1:
        yield Spare(f"{path}.every_steps", "every step is every step", BITS)
    elif every is not None and isinstance(courant, float) and every <= courant:
        words = f"a step of Courant number {courant:g} is past it: every step takes the transfer"
        yield Spare(f"{path}.every_courant", words, BITS)
    steps = _most_steps(scene)
    if steps is not None and plan.every_steps is not None and plan.every_steps > steps:
        words = f"the run has {steps} steps at most and never takes it: write {{kind: flip}}"
        if transfer.alpha != 0.5:
            words = words.replace("flip}", f"flip, alpha: {transfer.alpha:g}}}")
        yield Spare(path, words, BITS)


def _order_of_translation(
    scene: Any, plan: Plan, grid: Grid, particles: Particles, dt: float
) -> Iterator[Spare]:
    """An order above 1 where all that moves has one velocity: every pass finds an increment of zero."""
    if plan.order == 1 or plan.dynamic is not None:
        return
    if _translating_fields(scene, plan, particles) is None:
        return
    if not plan.has_contact or never_meet(scene, plan, grid, particles, scene.time.end + dt):
        words = "bodies only translate, each at one velocity, which all orders carry alike: order 1 is enough"
        yield Spare("method.transfer.order", words, ROUND_OFF)


def _most_steps(scene: Any) -> int | None:
    """The largest number of steps that a run can have; None where that is not known beforehand."""
    known = [] if scene.time.max_steps is None else [scene.time.max_steps]
    if scene.time.step is not None:
        known.append(math.ceil(scene.time.end / scene.time.step * (1.0 - TOLERANCE)) + 1)
    return min(known, default=None)


def _parts(scene: Any) -> Iterator[Spare]:
    """Parts of the model whose numbers are all 0."""
    viscosity = scene.method.artificial_viscosity
    if viscosity is not None and viscosity.linear == viscosity.quadratic == 0.0:
        yield Spare("method.artificial_viscosity", "both coefficients are 0", BITS)
    for index, load in enumerate(scene.loads):
        values = [value for name in LOADED_BY for value in getattr(load, name, None) or ()]
        if values and all(
            isinstance(value, Expression) and value.is_constant and value() == 0.0 for value in values
        ):
            name = getattr(load, "name", None) or index
            yield Spare(f"loads.{name}", "it is 0 at all times", ROUND_OFF)


def _outputs(scene: Any, dt: float) -> Iterator[Spare]:
    """Intervals of output shorter than a step."""
    archive = scene.archive
    asked = [
        (f"archive.{name}", getattr(archive, name)) for name in ("particles", "globals", "grid", "checkpoint")
    ]
    asked += [(f"probes.{probe.name}", probe) for probe in scene.probes]
    for path, what in asked:
        every = getattr(what, "every", None)
        if every is not None and every < dt * (1.0 - TOLERANCE):
            words = (
                f"{every:g} is shorter than the time step, {dt:.4g} at the start, and is due at every step"
            )
            yield Spare(f"{path}.every", words, "no output changes the run")
