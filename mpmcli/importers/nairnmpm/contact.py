"""Contact between materials, rigid materials, and contact laws."""

from typing import Any

from mpmcli.importers.nairnmpm.bodies import Bodies
from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.job import Job, Material
from mpmcli.importers.nairnmpm.values import Value

_NORMALS = {
    0: "maximum_gradient",
    1: "maximum_volume",
    2: "average_gradient",
    3: "own_gradient",
    4: "specified",
    5: "linear_regression",
    6: "logistic_regression",
}
_STIFFNESSES = ("Dn", "Dnt", "Dnc", "Dt")


def law(job: Job, command: Command) -> dict[str, Any] | None:
    """The law of a Friction command or of the attributes of a CrackList, or None after a note."""
    for name in ("lawname", "law"):
        chosen = command.get(name)
        if chosen is not None:
            for listed in _STIFFNESSES:
                command.get(listed)
            return _named_law(job, command, name, job.source.plain(chosen).strip())
    is_crack = command.name == "CrackList"
    value = job.number(command, "friction" if is_crack else None)
    friction = 0.0 if value is None else value.number
    if friction > 10 or (is_crack and any(name in command.attributes for name in _STIFFNESSES)):
        tension = job.number(command, "Dnt") or job.number(command, "Dn")
        return _springs(tension, job.number(command, "Dnc"), job.number(command, "Dt"))
    for name in _STIFFNESSES:
        if command.get(name) is not None:
            job.note("ignored", command, f"attribute {name}: the friction coefficient is no more than 10")
    if friction < -10:
        return {"kind": "perfect"}
    if friction < 0:
        return {"kind": "stick"}
    return {"kind": "coulomb", "friction": value} if friction > 0 else {"kind": "frictionless"}


def _springs(tension: Value | None, compression: Value | None, tangential: Value | None) -> dict[str, Any]:
    def stiffness(value: Value | None) -> Any:
        return "perfect" if value is None or value.number < 0 else value

    normal, tangent = stiffness(tension), stiffness(tangential)
    closed = normal if compression is None else stiffness(compression)
    if normal == closed == tangent == "perfect":
        return {"kind": "perfect"}
    if normal == closed:
        return {"kind": "linear_interface", "normal": normal, "tangential": tangent}
    return {"kind": "bilinear_interface", "tension": normal, "compression": closed, "tangential": tangent}


def _named_law(job: Job, command: Command, attribute: str, chosen: str) -> dict[str, Any] | None:
    found: Material | None = None
    if attribute == "lawname":
        found = {material.title: material for material in job.materials}.get(chosen)
    else:
        index = int(float(chosen)) if chosen.replace(".", "").isdigit() else 0
        found = job.materials[index - 1] if 1 <= index <= len(job.materials) else None
    if found is None:
        job.error(command, f"no contact law '{chosen}'")
        return None
    material = found.command
    material.handled = True
    for inside in material.all("rho"):
        inside.handled = True
    if found.kind == 60:
        return {"kind": "perfect"}
    if found.kind == 61:
        friction, static = job.property(material, "coeff"), job.property(material, "coeffStatic")
        if friction is not None and friction.number < 0:
            return {"kind": "stick"}
        if (friction is None or friction.number == 0) and (static is None or static.number <= 0):
            return {"kind": "frictionless"}
        made: dict[str, Any] = {"kind": "coulomb", "friction": friction or Value(0.0)}
        if static is not None and static.number > 0:
            made["static_friction"] = static
        return made
    if found.kind == 62:
        tension = job.property(material, "Dnt") or job.property(material, "Dn")
        return _springs(tension, job.property(material, "Dnc"), job.property(material, "Dt"))
    job.unsupported(material, f"contact law of type {found.kind}")
    return None


def contact(job: Job, header: Command, bodies: Bodies) -> None:
    """The section of contact, if materials have velocity fields of their own."""
    rigid = [m for m in job.materials if m.used and m.is_rigid and m.direction == 8]
    mode = header.last("MultiMaterialMode")
    if mode is None:
        for material in rigid:
            job.error(material.command, "a rigid material in contact needs the command <MultiMaterialMode>")
        return
    made: dict[str, Any] = {"fields": "material"}
    normal = _normal(job, mode)
    separation = _separation(job, mode, str(normal["kind"]))
    friction = mode.last("Friction")
    found = law(job, friction) if friction is not None else {"kind": "frictionless"}
    vmin = job.plain(mode, "Vmin")
    if vmin > 0:
        words = "contact acts at nodes of any volume, except where mass_ratio leaves one out"
        job.changed(mode, f"Vmin {vmin:g}: {words}")
    fields = [m for m in job.materials if m.used and (not m.is_rigid or m.direction == 8)]
    pairs = _pairs(job, fields)
    three_or_more = _three_or_more(job, mode, fields)
    if len(fields) < 2:
        job.changed(mode, "one material only: no contact")
        return
    made |= {"normal": normal, "separation": separation, "law": found or {"kind": "frictionless"}}
    if pairs:
        made["pairs"] = pairs
    job.scene["contact"] = made | three_or_more


def _three_or_more(job: Job, mode: Command, fields: list[Material]) -> dict[str, Any]:
    """How nodes of three or more materials are handled: lumped unless the pairs are explicit."""
    code = round(job.plain(mode, "Lumping"))
    if code not in {0, 1}:
        job.note("not_supported", mode, f"Lumping {code}; 0 and 1 are lumped and pairs")
    if code == 1 and sum(not material.is_rigid for material in fields) < 3:
        job.note("ignored", mode, "attribute Lumping: there are fewer than three materials that deform")
        return {}
    return {"three_or_more": "pairs"} if code == 1 else {}


def _normal(job: Job, mode: Command) -> dict[str, Any]:
    code = round(job.plain(mode, "Normals", 2.0))
    if "Normals" not in mode.attributes:
        words = "average_gradient stands for the default, which newer versions changed to logistic regression"
        job.changed(mode, f"without Normals, {words}")
    bias = job.number(mode, "RigidBias")
    polar, azimuth = job.number(mode, "Polar"), job.number(mode, "Azimuth")
    if code not in _NORMALS:
        job.note("not_supported", mode, f"Normals {code}")
    made: dict[str, Any] = {"kind": _NORMALS.get(code, "average_gradient")}
    if made["kind"] == "specified":
        made["azimuth"] = azimuth or 0
        if job.analysis == "3d":
            made["polar"] = polar or 0
    elif bias is not None and bias.number > 1 and code not in {1, 3}:
        made["rigid_bias"] = bias
        bias = None
    if bias is not None:
        why = "1 or less has no effect" if bias.number <= 1 else f"Normals {code} have no bias"
        job.note("ignored", mode, f"attribute RigidBias: {why}")
    return made


def _separation(job: Job, mode: Command, normal: str) -> dict[str, Any]:
    check = job.plain(mode, "Dcheck", 1.0)
    position = mode.last("ContactPosition")
    offset = job.number(position, None) if position is not None else None
    if normal.endswith("_regression"):
        return {"kind": "regression"}
    if offset is not None and offset.number > 0:
        return {"kind": "position_offset", "offset": offset}
    if offset is not None and position is not None:
        job.changed(position, "the fitted positions of position_fit stand for a power law")
        return {"kind": "position_fit"}
    return {"kind": "displacement" if check else "none"}


def _pairs(job: Job, fields: list[Material]) -> list[dict[str, Any]]:
    pairs = []
    for material in job.materials:
        for command in material.command.all("Friction"):
            if not material.used:
                command.skip()
                continue
            other = job.material(command)
            found = law(job, command)
            if other is None or found is None:
                continue
            if other not in fields or material not in fields or other is material:
                job.note("ignored", command, "one of the two materials is in no body with a velocity field")
                continue
            pairs.append({"between": [material.key, other.key], "law": found})
    return pairs


def rigid(job: Job, bodies: Bodies) -> list[dict[str, Any]]:
    """Velocities of rigid bodies, and the conditions of those that prescribe velocities to nodes."""
    conditions: list[dict[str, Any]] = []
    for body, material in zip(bodies.made, bodies.materials, strict=True):
        if not material.is_rigid:
            continue
        command = material.command
        functions = {
            index: job.formula(inside, inside.text, "velocity")
            for index, name in enumerate(("SettingFunction", "SettingFunction2", "SettingFunction3"))
            if (inside := command.last(name)) is not None
        }
        job.unsupported(
            command,
            "rigid particles that set temperatures or concentrations",
            "SetTemperature SetConcentration ValueFunction",
        )
        for inside in command.all("mirrored"):
            if job.plain(inside, None):
                job.changed(inside, "velocities beyond the rigid body are not mirrored")
        job.ignored(command, "a property that rigid materials do not have", "rho E nu alpha kCond Cv Cp")
        velocity = list(body.get("velocity") or [0] * len(job.axes))
        if material.direction == 8:
            held, moved = [], list(functions)
        else:
            held = [axis for axis in range(len(job.axes)) if material.direction & (1 << axis)]
            if functions:  # those without a function are then free in NairnMPM, and all after them
                first = next(count for count in range(4) if count not in functions)
                held = held[:first]
                for index in list(functions)[first:]:
                    job.note("ignored", command, f"SettingFunction{index + 1}: one before it is missing")
            moved = held
            if not held:
                material.idle = True
                continue
        for axis, function in zip(moved, functions.values(), strict=False):
            if axis < len(job.axes) and function is not None:
                velocity[axis] = function
        if any(part != 0 for part in velocity):
            body["velocity"] = velocity
        for axis in held:
            on, along = {"covered_by": body["name"]}, job.axes[axis]
            made = {"kind": "velocity", "on": on, "direction": along, "value": velocity[axis]}
            conditions.append({"name": f"{body['name']}_{along}", **made})
    bodies.leave_out_idle()
    return conditions
