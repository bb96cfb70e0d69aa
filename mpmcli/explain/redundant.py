"""Settings of a scene that have no effect, and questions that only runs can answer."""

from __future__ import annotations

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


def find_redundant(scene: Any, plan: Plan, dt: float) -> list[Redundant]:
    """Return the redundant settings of a checked scene; ``dt`` is its first time step."""
    return [*_of_transfer(scene, plan), *_of_models(scene, plan), *_of_output(scene, dt)]


def _of_transfer(scene: Any, plan: Plan) -> Iterator[Redundant]:
    path, courant = "method.transfer", scene.time.courant
    if plan.blend is not None and (
        plan.blend[1] == 1.0 or 1 < plan.blend[0] >= plan.order or plan.order == 1
    ):
        yield Redundant(f"{path}.blend", f"FMPM({plan.order}) has no increment that this blend changes")
    if plan.dynamic is not None and plan.order <= 2:
        yield Redundant(f"{path}.dynamic", f"order {plan.order} has no increment that can be left out")
    if plan.every_steps == 1:
        yield Redundant(f"{path}.every_steps", "every step uses the transfer without this key, too")
    if plan.heat is not None and getattr(plan.heat.transfer, "every_steps", None) == 1:
        yield Redundant(
            "heat.transfer.every_steps", "every heat step uses the transfer without this key, too"
        )
    if plan.every_courant is not None and isinstance(courant, float) and plan.every_courant <= courant:
        words = f"each step has Courant number {courant:g}, so every step uses the transfer"
        yield Redundant(f"{path}.every_courant", words)


def _of_models(scene: Any, plan: Plan) -> Iterator[Redundant]:
    viscosity = scene.method.artificial_viscosity
    if viscosity is not None and viscosity.linear == viscosity.quadratic == 0.0:
        yield Redundant("method.artificial_viscosity", "both coefficients are 0")
    for index, pair in enumerate(scene.contact.pairs if plan.has_contact else ()):
        if pair.law == scene.contact.law and pair.heat is None:
            yield Redundant(f"contact.pairs.{index}", "the pair has the law of 'contact.law'")


def _of_output(scene: Any, dt: float) -> Iterator[Redundant]:
    names = ("particles", "globals", "grid", "checkpoint")
    asked = [(f"archive.{name}", getattr(scene.archive, name)) for name in names]
    for path, what in asked + [(f"probes.{probe.name}", probe) for probe in scene.probes]:
        every = getattr(what, "every", None)
        if every is not None and every < dt * (1.0 - TOLERANCE):
            words = (
                f"{every:g} is shorter than the first time step, {dt:.4g}; output is written at every step"
            )
            yield Redundant(f"{path}.every", words)


def find_questions(scene: Any, plan: Plan) -> list[str]:
    """Return what only runs can tell, with the options of ``mpmcli tradeoff`` that tell it."""
    transfer, method, questions = scene.method.transfer, scene.method, []
    if transfer.kind != "flip" and transfer.order > 1 and plan.dynamic is None:
        orders = [k for k in (1, 2, 4, 8, 16, 32, 64) if k < transfer.order] + [transfer.order]
        ways = ",".join(["flip", *(f"{transfer.kind}:{k}" for k in orders)])
        questions.append(f"which order is sufficient: --vary method.transfer={ways}")
    if plan.update.again:
        ways = f"{method.update.removesuffix('+')},{method.update}"
        questions.append(f"whether the second extrapolation of momenta matters: --vary method.update={ways}")
    if plan.heat is not None and plan.heat.interval != "auto" and plan.heat.interval > 1:
        ways = f"--vary heat.interval=1,{plan.heat.interval}"
        questions.append(f"whether the interval of heat steps matters: {ways}")
    if plan.velocity_gradient:
        ways = "--vary method.transfer.velocity_gradient=false,true"
        questions.append(f"whether velocity gradients matter: {ways}")
    return questions
