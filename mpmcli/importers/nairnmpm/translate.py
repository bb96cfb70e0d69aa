"""The translation of a command file: each part in the order of the scene, then what no part has read."""

from pathlib import Path
from typing import Any

from mpmcli.core.errors import Problem, SceneError
from mpmcli.importers.base import Translation, read_source
from mpmcli.importers.nairnmpm import (
    archive,
    conditions,
    contact,
    cracks,
    header,
    materials,
    ramps,
    reversal,
    scripts,
)
from mpmcli.importers.nairnmpm.bodies import Bodies
from mpmcli.importers.nairnmpm.checking import check, unread
from mpmcli.importers.nairnmpm.commands import Command, parse
from mpmcli.importers.nairnmpm.grammar import COMMANDS
from mpmcli.importers.nairnmpm.job import Job
from mpmcli.importers.nairnmpm.values import settle

_ORDER = (
    *("version", "title", "units", "analysis", "grid", "method", "heat", "materials", "bodies", "contact"),
    *("cracks", "fracture", "boundary", "loads", "time", "events", "domain", "archive"),
)
_BEFORE = b"\xef\xbb\xbf\xff\xfe\x00 \t\r\n"
"""What may precede XML: marks of UTF-8 and UTF-16, and spaces."""
_NEEDED = ("Header", "MPMHeader", "Mesh", "MaterialPoints", "Material")


def translate(path: Path, partial: bool) -> Translation:
    """Translate a command file of NairnMPM: XML, or a script that makes it."""
    contents = read_source(path)
    is_script = not contents.lstrip(_BEFORE).startswith(b"<")
    source = scripts.read(contents, path) if is_script else parse(contents, path)
    if source.root.name != "JANFEAInput":
        words = f"the file begins with <{source.root.name}>; files of NairnMPM begin with <JANFEAInput>"
        raise SceneError([Problem("", words, str(path), source.root.line, code="source")])
    made = Translation(path, "NairnMPM")
    check(source, made, partial)
    job = Job(source, made, {"version": 1})
    blocks = {name: source.root.last(name) for name in _NEEDED}
    for command in source.root.all("Material"):
        command.replaced = False  # each of them counts
    for name, block in blocks.items():
        if block is None:
            made.error(source.root.line, "<JANFEAInput>", f"the command <{name}> is missing")
    if any(block is None for block in blocks.values()) or made.errors:
        return made
    head = blocks["MPMHeader"]
    if is_script and head is not None and head.first("GIMP") is None:
        words = "without a shape function NairnFEAMPM takes Classic, as here; NairnFEAMPMViz takes uGIMP"
        job.changed(head, words)
    _translate(job, source.root, blocks)
    return made


def _keep_last(job: Job, head: Command) -> None:
    """Of repeated settings keep the last, as NairnMPM does."""
    last = {command.name: command for command in head.children}
    for command in head.children:
        if COMMANDS[command.name].text in {"n", "n?", "i", "t"} and last[command.name] is not command:
            job.ignored(command, "a later command of this name replaces it")
    head.children = [
        command for command in head.children if not command.handled or last[command.name] is command
    ]


def _translate(job: Job, root: Command, blocks: dict[str, Any]) -> None:
    root.handled = True
    head = blocks["MPMHeader"]
    _keep_last(job, head)
    header.header(job, blocks["Header"])
    symmetries = header.grid(job, blocks["Mesh"])
    if not job.cell:
        return
    materials.number_materials(job, root)
    job.scene["_cracks"] = any(child.name == "CrackList" for child in root.children)
    job.heats = archive.temperatures_matter(job, root, head)
    header.method(job, head)
    archive.heat(job, root)
    ramps.read_ramps(job, root)
    bodies = Bodies(job)
    bodies.read(blocks["MaterialPoints"])
    if not bodies.made and not job.made.errors:
        job.made.error(blocks["MaterialPoints"].line, "<MaterialPoints>", "there is no body")
    boundary = symmetries + contact.rigid(job, bodies)
    cracks.cracks(job, root, head, bodies)
    contact.contact(job, head, bodies)
    job.scene["materials"] = materials.materials(job)
    job.scene["bodies"] = bodies.made
    for block in root.all("GridBCs"):
        boundary += conditions.grid_conditions(job, block)
    if boundary:
        job.scene["boundary"] = boundary
    loads = [entry for block in root.all("Gravity") for entry in conditions.gravity(job, block)]
    for block in root.all("ParticleBCs"):
        loads += conditions.particle_loads(job, block, bodies)
    if not job.made.errors:
        loads += ramps.ramp_loads(job)
    if loads:
        job.scene["loads"] = loads
    archive.tasks(job, root)
    header.time(job, head)
    names = [(str(body["name"]), str(body["material"])) for body in bodies.made]
    archive.archive(job, head, names)
    reversal.reversal(job, root, names)
    header.display(job, head)
    for note in unread(root):
        job.note(*note)
    scene = {key: job.scene[key] for key in _ORDER if key in job.scene}
    job.made.scene.update(settle(scene, job.source, job.made))
