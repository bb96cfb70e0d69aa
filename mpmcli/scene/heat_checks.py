"""What a scene says about heat, held against the rest of it."""

from typing import Any

import numpy as np

from mpmcli.core.expressions import Expression
from mpmcli.core.suggest import listing
from mpmcli.scene.contact_checks import read_fields
from mpmcli.scene.heat_contradictions import check_places
from mpmcli.scene.heat_of_scene import HeatOfScene
from mpmcli.scene.parts import Parts
from mpmcli.scene.problems import Report

ABSOLUTE = "temperatures are absolute and must be above 0"
LARGEST_STRAIN = 1.0
"""Thermal strain of a body at the start above which it is an error of units."""
LARGEST = 1e30
"""Temperatures, fluxes, coefficients and powers are below this."""


def check_heat(parts: Parts, report: Report) -> None:
    """Report everything that heat and temperatures have against the rest of a scene."""
    fields = read_fields(report)
    if fields.complete and all(member.is_rigid for member in fields.members):
        return  # reported already
    scene = HeatOfScene(parts, report, fields)
    _check_materials(scene, report)
    _check_body_temperatures(scene, report)
    _check_conditions(scene, report)
    _check_axis_faces(scene, report)
    check_places(scene, report)
    _check_pairs(scene, report)
    if scene.has_heat and parts.heat is not None:
        _check_heat_section(scene, report)
    if parts.method is not None and parts.method.heating == "adiabatic":
        _check_heating(scene, report)


# ---------------------------------------------------------------- materials and bodies


def _check_materials(scene: HeatOfScene, report: Report) -> None:
    for name, model in scene.deformable():
        if scene.has_heat:
            _check_conducting(scene, name, model, report)
            _check_stiffness(name, model, report)
        else:
            _check_idle(scene, name, model, report)
    conducting = [m.conductivity is None or any(m.conductivity) for _, m in scene.deformable()]
    if scene.has_heat and conducting and not any(conducting) and scene.fields.complete:
        words = "no material conducts heat: each conductivity is 0"
        report("heat", words, "no_effect", "warning")


def _check_conducting(scene: HeatOfScene, name: str, model: Any, report: Report) -> None:
    """What conduction needs of a material."""
    bodies = [f"'{body.name}'" for _, body in scene.parts.bodies if body.material == name]
    needs = [
        ("heat_capacity", model.specific_heat, ""),
        ("conductivity", model.conductivity, " (0 for an insulator)"),
    ]
    for key, value, hint in needs:
        if value is None:
            words = f"is missing; conduction of heat ('heat') in {listing(bodies, 4)} needs it{hint}"
            report(f"materials.{name}.{key}", words, "missing")


def _check_stiffness(name: str, model: Any, report: Report) -> None:
    """An equation of state must resist compression at constant temperature, too."""
    gamma, stiffness = getattr(model, "gamma0", 0.0), getattr(model, "bulk_modulus", 0.0)
    softening = gamma**2 * model.density * (model.specific_heat or 0.0) * model.T0
    if softening >= stiffness > 0.0:
        words = (
            f"is unstable at constant temperature: K = {stiffness:.3g} must be above "
            f"gamma0^2*density*heat_capacity*T0 = {softening:.3g}; check the units of heat_capacity"
        )
        report(f"materials.{name}", words, "unstable", "warning")


def _check_idle(scene: HeatOfScene, name: str, model: Any, report: Report) -> None:
    """Keys of a material that change nothing without conduction."""

    def no_effect(key: str, reason: str) -> None:
        if key in model.model_fields_set:
            report(f"materials.{name}.{key}", f"has no effect {reason}", "no_effect", "warning")

    no_effect("conductivity", "without 'heat', which switches conduction on")
    is_optional = not type(model).model_fields["heat_capacity"].is_required()
    if is_optional and not scene.is_adiabatic:
        no_effect("heat_capacity", "without 'heat' or 'method.heating: adiabatic'")
    if not scene.needs_temperature(model):
        no_effect("T0", "because nothing depends on the temperature of this material")
    if model.expansion > 0.0 and not scene.warms(model) and _all_at_start(scene, name, model):
        no_effect("expansion", f"because the temperature stays {model.T0:g} (T0) without 'heat'")


def _all_at_start(scene: HeatOfScene, name: str, model: Any) -> bool:
    """Whether all bodies of a material have its temperature without stress."""
    given = [body.temperature for _, body in scene.parts.bodies if body.material == name]
    return all(value is None or (value.is_constant and float(value()) == model.T0) for value in given)


def _check_heating(scene: HeatOfScene, report: Report) -> None:
    tracking = {"temperature", "internal_energy"}
    models = scene.parts.materials.values()
    if models and not any(scene.warms(model) or tracking & set(model.history) for model in models):
        report.no_effect("method.heating", "no material has a heat_capacity")


def _check_body_temperatures(scene: HeatOfScene, report: Report) -> None:
    for place, body in scene.parts.bodies:
        if body.temperature is None or body.material not in scene.parts.materials:
            continue
        path = f"{place}.temperature"
        material = scene.parts.materials[body.material]
        if material.kind == "rigid":
            if not _exchanges(scene):
                words = (
                    "has no effect; a rigid body exchanges heat only by 'heat.contact: {conductance: ...}'"
                )
                report(path, words, "no_effect", "warning")
        elif not scene.needs_temperature(material):
            report.no_effect(path, f"material '{body.material}' has no temperature")
        else:
            _check_stretch(scene, body, material, path, report)


def _check_stretch(scene: HeatOfScene, body: Any, material: Any, path: str, report: Report) -> None:
    """A body must not begin far from the temperature at which it is free of stress."""
    box = scene.box_of(body)
    if box is None or material.expansion == 0.0:
        return
    low, high = box
    points = np.stack([low, 0.5 * (low + high), high], axis=1)
    with np.errstate(all="ignore"):
        T = np.ravel(body.temperature(**dict(zip("xyz", points, strict=False))))
        strains = material.expansion * (T - material.T0)
    strain = float(strains[np.nanargmax(np.abs(strains))]) if np.isfinite(strains).any() else 0.0
    if abs(strain) > LARGEST_STRAIN:
        words = (
            f"the thermal strain expansion*(temperature - T0) is {strain:.3g} at the start; check expansion, T0 "
            "and the temperature"
        )
        report(path, words, "doubtful", "warning")


def _exchanges(scene: HeatOfScene) -> bool:
    """Whether velocity fields exchange heat by a conductance."""
    heat, contact = scene.parts.heat, scene.parts.contact
    if heat is None:
        return scene.has_heat
    pairs = () if contact is None else contact.pairs
    return any(hasattr(each, "conductance") for each in (heat.contact, *(pair.heat for pair in pairs)))


# ---------------------------------------------------------------- conditions and loads


def _check_conditions(scene: HeatOfScene, report: Report) -> None:
    for path, model in scene.acting():
        if not scene.has_heat:
            words = f"'{model.kind}' needs conduction of heat; add 'heat: {{}}' to the scene"
            report(f"{path}.kind", words, "needs_heat")
        for place, name in model.bodies():
            if name in scene.rigid:
                words = (
                    f"the body '{name}' is rigid, and heat does not enter it; its 'temperature' is its own"
                )
                report(f"{path}.{place}", words, "rigid")
        _check_sizes(path, model, report)
        value = getattr(model, "value", None)
        if isinstance(value, Expression) and value.variables <= {"t"}:
            start = float(value(t=model.begin))
            if start <= 0.0:
                report(f"{path}.value", f"is {start:g} at the start; {ABSOLUTE}", "range")


def _check_sizes(path: str, model: Any, report: Report) -> None:
    """Constants that nothing can be calculated with, and fluxes and powers that heat nothing."""
    for key in type(model).model_fields:
        value = getattr(model, key)
        if not isinstance(value, Expression) or not value.is_constant:
            continue
        if not abs(float(value())) < LARGEST:
            report(f"{path}.{key}", f"is {float(value()):g}; must be below {LARGEST:g}", "range")
        elif key in ("flux", "power") and float(value()) == 0.0:
            report.no_effect(f"{path}.{key}", "it is 0")


def _check_axis_faces(scene: HeatOfScene, report: Report) -> None:
    """Faces on the axis of an axisymmetric body have no area."""
    analysis = scene.parts.analysis
    if analysis is None or analysis.kind != "axisymmetric":
        return
    for path, model in scene.acting():
        place = model.held_face() if hasattr(model, "held_face") else model.loaded_face()
        if place is None or (place[1].axis, place[1].side) != ("x", "lower"):
            continue
        body = next((body for _, body in scene.parts.bodies if body.name == place[0]), None)
        box = None if body is None else scene.box_of(body)
        if box is not None and box[0][0] <= 0.0:
            report.no_effect(f"{path}.on", f"this face of '{place[0]}' is on the axis")


# ---------------------------------------------------------------- contact


def _check_pairs(scene: HeatOfScene, report: Report) -> None:
    heat, contact = scene.parts.heat, scene.parts.contact
    for index, pair in enumerate(() if contact is None else contact.pairs):
        path = f"contact.pairs.{index}.heat"
        if pair.heat is None:
            continue
        if not scene.has_heat:
            report(path, "has no effect without 'heat'", "no_effect", "warning")
        elif heat is not None and heat.contact == "shared":
            words = "needs temperatures of its own for each side; set heat.contact to insulated or {conductance: ...}"
            report(path, words, "combination")
        elif hasattr(pair.heat, "conductance"):
            _check_bath(scene, pair, path, report)


def _check_bath(scene: HeatOfScene, pair: Any, path: str, report: Report) -> None:
    """A rigid side conducts heat only where it has a temperature."""
    for name in pair.between:
        owners = [m.name for m in scene.fields.members if name in (m.owner, m.field) and m.is_rigid]
        given = {body.name for _, body in scene.parts.bodies if body.temperature is not None}
        if owners and not given & set(owners):
            report.no_effect(path, f"the rigid body '{owners[0]}' has no 'temperature'")


def _check_baths(scene: HeatOfScene, report: Report) -> None:
    """Rigid bodies that a conductance for all pairs passes over."""
    given = {body.name for _, body in scene.parts.bodies if body.temperature is not None}
    rigid = [member for member in scene.fields.members if member.is_rigid]
    baths = {member.field for member in rigid if member.name in given}
    cold = [member.name for member in rigid if member.field not in baths]
    if cold:
        names = listing([f"'{name}'" for name in cold], 4)
        words = f"has no effect on contact with {names}: a rigid body without 'temperature' exchanges no heat"
        report("heat.contact", words, "no_effect", "warning")


def _check_heat_section(scene: HeatOfScene, report: Report) -> None:
    """Choices of conduction that change nothing, or do not go together."""
    heat, time = scene.parts.heat, scene.parts.time
    given = heat.model_fields_set

    def no_effect(key: str, reason: str) -> None:
        report.no_effect(f"heat.{key}", reason)

    if scene.fields.complete and not scene.has_fields:
        for key in ("contact", "friction"):
            if key in given:
                no_effect(key, "the scene has a single velocity field")
    elif scene.has_fields and heat.friction and heat.interval != "auto" and heat.interval > 1:
        words = (
            "must be 1 or auto, because friction heats bodies in every step; or set heat.friction to false"
        )
        report("heat.interval", words, "combination")
    if hasattr(heat.contact, "conductance"):
        _check_baths(scene, report)
    if "fourier" in given and time is not None and time.step is not None and heat.interval != "auto":
        no_effect("fourier", "the time step and the interval are given")
