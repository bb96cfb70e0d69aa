"""How stiff interfaces are for the time step: φ² = D A Δt²/m_red at a node on the interface, by direction.

There each side has half a cell, so that m_red/A = ½ Δx ρ_α ρ_β/(ρ_α + ρ_β), ρΔx/4 for equal sides. With ``step:
implicit`` no φ is too large; ``step: oscillator`` needs Δt < √(m_red/(D A)), φ < 1 (Nairn 2023, Eq. 5.35).
"""

from __future__ import annotations

import math
from typing import Any

from mpmcli.core.errors import Problem, SceneError
from mpmcli.stability.models import largest_wave_speed
from mpmcli.stability.scene_limit import chosen_courant
from mpmcli.stability.speeds import largest_speed
from mpmcli.stability.springs import LARGEST_PHI, springs_of
from mpmcli.stability.tractions import limits_of_tractions


def warnings_of_interfaces(scene: Any) -> list[Problem]:
    """Warn of springs that oscillate too fast within a step; once per law and direction."""
    if scene.contact is None or scene.contact.interface.step != "oscillator":
        return []
    found: dict[str, Problem] = {}
    dt = first_step(scene)
    for spring in springs_of(scene):
        path = f"{spring.joint.path}.law"
        phi = spring.phi(dt)
        if phi > LARGEST_PHI:
            words = (
                f"is too stiff along the {spring.direction} for step 'oscillator': φ = {phi:.4g}, above 1. Use step "
                f"'implicit' (the default), a time step of at most {spring.longest_step():.3g}, or at most "
                f"{spring.largest_stiffness(dt):.3g} of stiffness"
            )
            key = f"{path}.{spring.direction}"
            has_key = spring.direction in type(spring.joint.law).model_fields
            found.setdefault(
                key, Problem(key if has_key else path, words, code="unstable", severity="warning")
            )
    return list(found.values())


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
