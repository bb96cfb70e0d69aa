"""How stiff interfaces are for the time step: φ² = D A Δt²/m_red at a node on the interface, by direction.

There each side has half a cell, so that m_red/A = ½ Δx ρ_α ρ_β/(ρ_α + ρ_β), ρΔx/4 for equal sides. With ``step:
implicit`` no φ is too large; ``step: oscillator`` needs Δt < √(m_red/(D A)), φ < 1 (Nairn 2023, Eq. 5.35).

The jump of ``jump: extrapolated`` contains the strain of 0.375 cells of each side (two particles per cell): its
interface has the compliance 1/D − Σ 0.375 Δx/M. Where that is negative, runs may be unstable at any time step.
"""

from __future__ import annotations

import math
from typing import Any

from mpmcli.core.errors import Problem, SceneError
from mpmcli.scene.fields import velocity_fields
from mpmcli.stability.models import largest_wave_speed
from mpmcli.stability.scene_limit import chosen_courant
from mpmcli.stability.speeds import largest_speed
from mpmcli.stability.springs import LARGEST_PHI, Spring, springs_of
from mpmcli.stability.tractions import limits_of_tractions

WITHIN = 0.375
"""Cells by which the matter at an edge, extrapolated to nodes, is inside it: two particles per cell."""


def warnings_of_interfaces(scene: Any) -> list[Problem]:
    """Warn of springs that oscillate too fast within a step; once per law and direction."""
    if scene.contact is None:
        return []
    words = scene.contact.interface
    found = _of_extrapolated_jumps(scene) if words.jump == "extrapolated" else {}
    if words.step != "oscillator":
        return list(found.values())
    dt = first_step(scene)
    for spring in springs_of(scene):
        path, phi = f"{spring.joint.path}.law", spring.phi(dt)
        if phi > LARGEST_PHI:
            words = (
                f"is too stiff along the {spring.direction} for step 'oscillator': φ = {phi:.4g}, above 1. Use step "
                f"'implicit' (the default), a time step of at most {spring.longest_step():.3g}, or at most "
                f"{spring.largest_stiffness(dt):.3g} of stiffness"
            )
            found.setdefault(f"{path}.{spring.direction}", _warning(spring, words))
    return list(found.values())


def _of_extrapolated_jumps(scene: Any) -> dict[str, Problem]:
    """Warnings of springs that are stiffer than the matter that their extrapolated jump contains."""
    found: dict[str, Problem] = {}
    names, field_of_body = velocity_fields(scene)
    for spring in springs_of(scene):
        softest: dict[str, float] = {}
        for body, field in zip(scene.bodies, field_of_body, strict=True):
            model, name = scene.materials[body.material], names[field]
            shear, lame = getattr(model, "shear_modulus", None), getattr(model, "lame_modulus", None)
            if name in (spring.joint.first, spring.joint.second) and shear is not None and lame is not None:
                modulus = float(lame + 2.0 * shear if spring.direction == "normal" else shear)
                softest[name] = min(softest.get(name, math.inf), modulus)
        compliance = sum(
            WITHIN * min(scene.grid.cell) / modulus for modulus in softest.values() if modulus > 0.0
        )
        if spring.stiffness * compliance > 1.0:
            words = (
                f"is too stiff along the {spring.direction} for jump 'extrapolated', which contains the strain of "
                f"{WITHIN:g} cells of each side: runs may be unstable at any time step. Use jump 'gradient' (the "
                f"default), or at most {1.0 / compliance:.3g} of stiffness"
            )
            found.setdefault(f"{spring.joint.path}.law.{spring.direction} jump", _warning(spring, words))
    return found


def _warning(spring: Spring, words: str) -> Problem:
    path = f"{spring.joint.path}.law"
    has_key = spring.direction in type(spring.joint.law).model_fields
    key = f"{path}.{spring.direction}" if has_key else path
    return Problem(key, words, code="unstable", severity="warning")


def check_tractions(scene: Any) -> None:
    """Refuse time steps that are too long for tractions on the points of cracks.

    Raises
    ------
    SceneError
        With the step that works.
    """
    dt, problems = first_step(scene), []
    for limit in limits_of_tractions(scene):
        if dt > limit.step:
            shorter = f"time.step: {rounded_down(limit.step):g}"
            if (courant := chosen_courant(scene)) is not None:
                shorter = f"time.courant: {rounded_down(courant * limit.step / dt):g}, or {shorter}"
            words = (
                f"the time step, {dt:.3g}, is too long for this traction, whose slope is {limit.slope:.3g} at most: "
                f"tractions on points need steps of at most {limit.step:.3g}. Use {shorter}, a lower strength or a "
                "larger peak"
            )
            problems.append(Problem(limit.path, words, code="unstable"))
    if problems:
        raise SceneError(problems)


def rounded_down(number: float) -> float:
    """Two digits of a number, not more than it."""
    size = 10.0 ** (math.floor(math.log10(number)) - 1)
    return math.floor(number / size * (1.0 + 1e-12)) * size


def first_step(scene: Any) -> float:
    """Return the time step at the start, as far as wave and initial speeds tell [time]."""
    try:
        courant = chosen_courant(scene)
    except SceneError:
        return math.nan
    if courant is None:
        return float(scene.time.step)
    fastest = max(largest_wave_speed(scene), largest_speed(scene))
    return courant * float(min(scene.grid.cell)) / fastest if fastest > 0.0 else math.nan
