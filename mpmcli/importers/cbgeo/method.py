"""Method, time span and archive."""

import re
from typing import Any

from mpmcli.importers.base import Expression
from mpmcli.importers.cbgeo.mesh import CELL_TYPES
from mpmcli.importers.cbgeo.work import Work
from mpmcli.materials import MATERIALS
from mpmcli.scene import archive

EXPLICIT = re.compile(r"MPMExplicit(USF|USL|MUSL)?([23])D\Z")
UPDATES = {"usf": "usf", "usl": "usl", "musl": "usl+"}
FIELDS = {
    "displacements": "displacement",
    "velocities": "velocity",
    "stresses": "stress",
    "strains": "strain",
}
STATES = {"pdstrain": "equivalent_plastic_strain", "pressure": "pressure"}


def add_method(work: Work) -> None:
    """Translate ``analysis``."""
    given = work.given.source.analysis
    kind = EXPLICIT.match(given.type)
    if kind is None:
        words = f"the analysis '{given.type}'; MPMExplicit2D and MPMExplicit3D are"
        work.lacks(("analysis", "type"), words)
    elif int(kind[2]) != work.grid.d:
        cell = work.given.source.mesh.cell_type
        work.fault(("analysis", "type"), f"'{given.type}' does not fit the {work.grid.d}D cells '{cell}'")
    stress_update = (kind[1] or given.stress_update).lower() if kind else given.stress_update.lower()
    update = UPDATES.get(stress_update)
    if update is None:
        work.lacks(("analysis", "stress_update"), f"'{given.stress_update}'; usf, usl and musl are")
    method: dict[str, Any] = {
        "shape": CELL_TYPES[work.given.source.mesh.cell_type][1],
        "update": update or "usf",
        "transfer": _transfer(work),
    }
    if given.pressure_smoothing:
        method["volumetric"] = "averaged"
        words = "volume changes and pressures are averaged with mpmcli's own method"
        work.note("changed", ("analysis", "pressure_smoothing"), words)
    if given.interface:
        words = "contact between materials; the section 'contact' with 'fields: material' is that"
        work.lacks(("analysis", "interface"), words)
    _add_damping(work, method)
    work.scene["method"] = method
    if given.resume.resume:
        words = "checkpoints of CB-Geo are not read; the scene starts at time 0"
        work.lacks(("analysis", "resume", "resume"), words)


def _transfer(work: Work) -> dict[str, Any]:
    given = work.given.source.analysis.velocity_update
    name = given if isinstance(given, str) else "pic" if given else "flip"
    words = "alpha 1: positions follow the new grid velocity, as in CB-Geo"
    if name == "flip":
        work.made.comment(("method", "transfer"), words)
        return {"kind": "flip", "alpha": 1}
    if name != "pic":
        work.lacks(("analysis", "velocity_update"), f"'{name}'; true, false, pic and flip are")
    else:
        work.made.comment(("method", "transfer"), "velocity_update true is PIC; order 4 dissipates far less")
    return {"kind": "fmpm", "order": 1, "alpha": 1}


def _add_damping(work: Work, method: dict[str, Any]) -> None:
    damping = work.given.source.analysis.damping
    if damping is None or damping.damping_factor == 0.0:
        return
    if damping.type != "Cundall":
        work.lacks(("analysis", "damping", "type"), f"damping of type '{damping.type}'; Cundall is")
    elif damping.damping_factor >= 1:
        work.fault(
            ("analysis", "damping"), f"a damping factor of {damping.damping_factor:g}; below 1 is needed"
        )
    else:
        words = "acts against the velocity vector; in CB-Geo against each of its components"
        work.note("changed", ("analysis", "damping"), words)
        method["damping"] = {"local": damping.damping_factor}


def add_time(work: Work) -> None:
    """Translate the time step, the number of steps, and what happens to particles that leave the mesh."""
    given = work.given.source.analysis
    work.constant("dt", given.dt)
    work.constant("steps", given.nsteps)
    work.scene["time"] = {"end": Expression("steps*dt"), "step": Expression("dt")}
    work.place(("time", "end"), ("analysis", "nsteps"))
    work.place(("time", "step"), ("analysis", "dt"))
    if not given.locate_particles:
        work.scene["domain"] = {"on_exit": "delete"}


def add_archive(work: Work) -> None:
    """Translate ``post_processing``."""
    given = work.given.source.post_processing
    work.constant("output_steps", given.output_steps)
    every = Expression("output_steps*dt")
    particles: dict[str, Any] = {"every": every}
    wanted = [FIELDS[name] for name in given.vtk if name in FIELDS]
    for name in given.vtk:
        if name not in (*FIELDS, "geometry"):
            work.note("ignored", ("post_processing", "vtk"), f"'{name}' is no quantity of mpmcli's archives")
    used = work.scene.get("materials", {}).values()
    known = {"pressure", *(row for made in used for row in getattr(MATERIALS[made["kind"]], "history", ()))}
    for name in _state_variables(work, given.vtk_statevars):
        if STATES.get(name) in known:
            wanted.append(STATES[name])
        else:
            words = f"'{name}' is no quantity of the scene's materials"
            work.note("ignored", ("post_processing", "vtk_statevars"), words)
    always = archive.FIELDS  # as CB-Geo's HDF5 files, which hold all of them
    if not set(wanted) <= set(always):
        particles["fields"] = list(dict.fromkeys([*always, *wanted]))
    work.scene["archive"] = {"particles": particles, "globals": {"every": every}}


def _state_variables(work: Work, given: tuple[Any, ...]) -> list[str]:
    """Names of state variables: single ones, and those listed by phase, of which the solid one is 0."""
    found: list[str] = []
    for entry in given:
        variables = entry.get("statevars") if isinstance(entry, dict) else [entry]
        if isinstance(entry, dict) and entry.get("phase_id", 0) != 0:
            words = f"the phase {entry['phase_id']}; there is one phase"
            work.note("ignored", ("post_processing", "vtk_statevars"), words)
        elif isinstance(variables, list) and all(isinstance(name, str) for name in variables):
            found += variables
        else:
            words = "no names of state variables; [{phase_id: 0, statevars: [...]}] is read"
            work.note("ignored", ("post_processing", "vtk_statevars"), words)
    return found
