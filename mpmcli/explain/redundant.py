"""Settings of a scene that have no effect, and questions that only runs can answer."""

from collections.abc import Iterator
from typing import Any, NamedTuple

from mpmcli.solver.plan import Plan

TOLERANCE = 1e-9
"""Relative slack of comparisons of times."""


class Redundant(NamedTuple):
    """A setting that can be removed: the results stay the same to the last digit.

    Attributes
    ----------
    path : key of the scene
    because : why it has no effect
    """

    path: str
    because: str


def find_redundant(scene: Any, plan: Plan, dt: float) -> Iterator[Redundant]:
    """Yield the redundant settings of a checked scene; ``dt`` is its first time step."""
    path, courant = "method.transfer", scene.time.courant
    if plan.blend is not None and (
        plan.blend[1] == 1.0 or 1 < plan.blend[0] >= plan.order or plan.order == 1
    ):
        yield Redundant(f"{path}.blend", f"FMPM({plan.order}) has no increment that this blend changes")
    if plan.dynamic is not None and plan.order <= 2:
        yield Redundant(f"{path}.dynamic", f"order {plan.order} has no increment that can be left out")
    heat = None if plan.heat is None else plan.heat.transfer
    for key, transfer in ((path, scene.method.transfer), ("heat.transfer", heat)):
        if getattr(transfer, "every_steps", None) == 1:
            yield Redundant(f"{key}.every_steps", "every step uses the transfer without this key, too")
    if plan.every_courant is not None and isinstance(courant, float) and plan.every_courant <= courant:
        words = f"each step has Courant number {courant:g}, so every step uses the transfer"
        yield Redundant(f"{path}.every_courant", words)
    viscosity = scene.method.artificial_viscosity
    if viscosity is not None and viscosity.linear == viscosity.quadratic == 0.0:
        yield Redundant("method.artificial_viscosity", "both coefficients are 0")
    for index, pair in enumerate(scene.contact.pairs if plan.has_contact else ()):
        if pair.law == scene.contact.law and pair.heat is None:
            yield Redundant(f"contact.pairs.{index}", "the pair has the law of 'contact.law'")
    names = ("particles", "globals", "grid", "checkpoint")
    asked = [(f"archive.{name}", getattr(scene.archive, name)) for name in names]
    for path, what in asked + [(f"probes.{probe.name}", probe) for probe in scene.probes]:
        every = getattr(what, "every", None)
        if every is not None and every < dt * (1.0 - TOLERANCE):
            words = f"{every:g} is shorter than the first time step, {dt:.4g}"
            yield Redundant(f"{path}.every", f"{words}; output is written at every step")


def find_questions(scene: Any, plan: Plan) -> Iterator[str]:
    """Yield what only runs can tell, with the options of ``mpmcli tradeoff`` that tell it."""
    transfer, method = scene.method.transfer, scene.method
    if transfer.kind != "flip" and transfer.order > 1 and plan.dynamic is None:
        orders = [k for k in (1, 2, 4, 8, 16, 32, 64) if k < transfer.order] + [transfer.order]
        ways = ",".join(["flip", *(f"{transfer.kind}:{k}" for k in orders)])
        yield f"which order is sufficient: --vary method.transfer={ways}"
    if plan.update.again:
        ways = f"{method.update.removesuffix('+')},{method.update}"
        yield f"whether the second extrapolation of momenta matters: --vary method.update={ways}"
    if plan.heat is not None and plan.heat.interval != "auto" and plan.heat.interval > 1:
        yield f"whether the interval of heat steps matters: --vary heat.interval=1,{plan.heat.interval}"
    if plan.velocity_gradient:
        yield "whether velocity gradients matter: --vary method.transfer.velocity_gradient=false,true"
