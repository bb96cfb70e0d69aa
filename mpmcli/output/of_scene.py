"""What a scene has to show, and whether what it asks for is among it."""

import itertools
from collections.abc import Callable
from typing import Any

from mpmcli.core.errors import Problem, SceneError
from mpmcli.core.state import State
from mpmcli.output.columns import archived_names, resolve_columns, resolve_fields
from mpmcli.output.contact_quantities import pair_name
from mpmcli.output.criteria import check_conditions
from mpmcli.output.probes import make_probe, resolve_grid_fields
from mpmcli.output.quantities import Context
from mpmcli.scene.fields import law_table, owners_of_fields, velocity_fields

DELETED = ("deleted_particles", "deleted_mass")
"""Columns of scenes that delete particles which leave the grid."""


def _extra_columns(scene: Any) -> tuple[str, ...]:
    transfer = scene.method.transfer
    chooses = any(getattr(transfer, key, None) for key in ("dynamic", "every_courant", "every_steps"))
    deleted = (*DELETED, "deleted_heat") if scene.heat is not None else DELETED
    feedback = ("feedback_rate",) * (scene.method.damping.feedback is not None)
    rubs = any(getattr(condition, "rubs", False) for condition in scene.conditions_on("velocity"))
    feedback += ("boundary_friction_work",) * rubs
    return deleted * (scene.domain.on_exit == "delete") + ("mean_order",) * chooses + feedback


def context_of(scene: Any, state: State | None = None) -> Context:
    """What a scene has; with a state, its bodies and materials are those that were made."""
    models = list(scene.materials.values())
    damping = scene.method.damping
    rigid_materials = tuple(name for name, model in scene.materials.items() if model.kind == "rigid")
    contact = _contact_of(scene, rigid_materials)
    work = {
        "damping_work": damping.takes_energy,
        "boundary_work": bool(scene.conditions_on("velocity"))
        or scene.domain.on_exit != "error"
        or bool(contact.get("rigid_fields")),
        "external_work": bool(scene.loads_on("velocity"))
        or any(crack.pressure is not None for crack in scene.cracks),
        "contact_work": bool(contact) or bool(scene.cracks),
        "bath_heat": scene.heat is not None and not scene.is_adiabatic,
    }
    names = [name for name, used in work.items() if used]
    heating = (*scene.conditions_on("temperature"), *scene.loads_on("temperature"))
    return Context(
        analysis=scene.analysis.kind,
        bodies=tuple(state.bodies if state else (body.name for body in scene.bodies)),
        materials=tuple(state.materials if state else scene.materials),
        history=tuple(dict.fromkeys(name for model in models for name in model.history)),
        reactions=tuple(dict.fromkeys(condition.name for condition in scene.conditions_on("velocity"))),
        heated_by=tuple(dict.fromkeys(each.name for each in heating)),
        has_heat=scene.heat is not None,
        exchanges_heat=bool(contact) and scene.heat is not None and scene.heat.contact != "shared",
        has_friction_heat=bool(contact) and scene.heat is not None and scene.heat.friction,
        has_temperature=scene.has_temperature,
        work=tuple(names),
        has_viscosity=scene.method.artificial_viscosity is not None,
        extra=tuple(state.extra) if state else _extra_columns(scene),
        rigid_bodies=tuple(body.name for body in scene.bodies if body.material in rigid_materials),
        rigid_materials=rigid_materials,
        **contact,
        **_cracks_of(scene),
    )


def _cracks_of(scene: Any) -> dict[str, Any]:
    """What a ``Context`` says about cracks; nothing in scenes without them."""
    if not scene.cracks:
        return {}
    ends = [(crack, key) for crack in scene.cracks for key in ("start", "end")]
    return {
        "cracks": tuple(crack.name for crack in scene.cracks),
        "tips": tuple(f"{crack.name}:{key}" for crack, key in ends if getattr(crack.ends, key) == "tip"),
        "crack_interfaces": tuple(
            crack.name for crack in scene.cracks if crack.faces.law.is_interface or crack.carries_tractions
        ),
        "crack_tractions": tuple(crack.name for crack in scene.cracks if crack.carries_tractions),
        "has_fracture": scene.fracture is not None,
        "growing": tuple(f"{crack.name}:{key}" for crack, key in ends if _grows(crack, key)),
        "has_crack_events": any(_grows(crack, key) for crack, key in ends)
        or any(crack.carries_tractions for crack in scene.cracks),
    }


def _grows(crack: Any, end: str) -> bool:
    """Whether an end of a crack of the scene is a tip that may grow."""
    return crack.growth is not None and getattr(crack.growth, end) is not None


def _contact_of(scene: Any, rigid_materials: tuple[str, ...]) -> dict[str, Any]:
    """What a ``Context`` says about contact; nothing in scenes without it."""
    if scene.contact is None:
        return {}
    names, field_of_body = velocity_fields(scene)
    if len(names) == 1:
        return {}
    rigid = {
        names[f]
        for body, f in zip(scene.bodies, field_of_body, strict=True)
        if body.material in rigid_materials
    }
    laws, table = law_table(scene, names)
    law_of = {
        (names[a], names[b]): laws[table[a, b]] for a, b in itertools.combinations(range(len(names)), 2)
    }
    pairs = [pair for pair in law_of if not rigid.issuperset(pair)]
    interfaces = [pair for pair in pairs if law_of[pair].is_interface]
    return {
        "velocity_fields": tuple(names),
        "field_of": owners_of_fields(scene),
        "rigid_fields": tuple(name for name in names if name in rigid),
        "pairs": tuple(pair_name(pair) for pair in pairs),
        "interfaces": tuple(pair_name(pair) for pair in interfaces),
        "cohesive": tuple(pair_name(pair) for pair in interfaces if law_of[pair].keeps_history),
        "has_normals": any(law.needs_normal for law in laws),
        "creates_momentum": len(names) - len(rigid) > 2 or not scene.contact.normal.shares_normal,
    }


def check_output(scene: Any) -> None:
    """Raise SceneError if the scene asks for columns or fields that it cannot have."""
    context = context_of(scene)
    problems: list[Problem] = []

    def collect(check: Callable[..., object], *arguments: Any) -> None:
        try:
            check(*arguments)
        except SceneError as error:
            problems.extend(error.problems)

    collect(check_conditions, scene, context)
    archive = scene.archive
    if archive.globals is not None:
        collect(resolve_columns, archive.globals.columns, context)
    if archive.particles is not None:
        collect(resolve_fields, archived_names(archive.particles.fields, context), context)
    if archive.grid is not None:
        collect(resolve_grid_fields, archive.grid.fields, context)
    for index, probe in enumerate(scene.probes):
        collect(make_probe, probe, None, context, f"probes.{index}")
    if problems:
        raise SceneError(problems)
