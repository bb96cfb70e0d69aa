"""The translation of CB-Geo's main file and of the files that it names."""

import re
from pathlib import Path

from mpmcli.core.errors import SceneError
from mpmcli.importers.base import Translation
from mpmcli.importers.cbgeo.bodies import add_bodies
from mpmcli.importers.cbgeo.conditions import add_conditions
from mpmcli.importers.cbgeo.loads import add_loads
from mpmcli.importers.cbgeo.materials import add_materials
from mpmcli.importers.cbgeo.mesh import CELL_TYPES, OTHER_CELLS, read_grid
from mpmcli.importers.cbgeo.method import add_archive, add_method, add_time
from mpmcli.importers.cbgeo.particles import read_cloud
from mpmcli.importers.cbgeo.reading import Input, read_input
from mpmcli.importers.cbgeo.work import Work

PHASES = re.compile(r"\dP(HASE)?\Z")
"""The end of the names of types for several phases."""
DEAD_KEYS = {
    "set_id": "CB-Geo does not read it",
    "porosity": "CB-Geo does not read it in this material",
    "note": "CB-Geo does not read it",
    "_comment": "CB-Geo does not read it",
}
"""Keys of published inputs that no version of the reader looks at."""
IGNORED = {
    ("mesh", "check_duplicates"): "nodes and particles at one place are always refused here",
    ("mesh", "isoparametric"): "all cells are rectangles of one size",
    ("mesh", "node_type"): "there is one type of node",
    ("mesh", "particle_cells"): "where particles lie is found anew",
    ("analysis", "uuid"): "names files of results; mpmcli run -o names a folder",
    ("analysis", "nload_balance_steps"): "for several processes",
    ("post_processing", "path"): "mpmcli run -o names a folder",
}
"""Keys without effect on the motion."""
ORDER = (
    "version", "title", "units", "constants", "analysis", "grid", "method", "materials", "bodies",
    "boundary", "loads", "time", "domain", "archive",
)  # fmt: skip
"""Keys of the scene in the order of writing."""


def translate(path: Path, partial: bool) -> Translation:
    """Translate the main file of a source, often called mpm.json."""
    made = Translation(path, "CB-Geo MPM")
    given = read_input(path)
    for line, key, hint in given.unknown_keys():
        dead = DEAD_KEYS.get(key.rpartition(".")[2])
        if dead is not None:
            made.note("ignored", line, key, dead)
        else:
            made.note("not_supported", line, key, f"the key is not known{hint}")
    try:
        _run(_begun(given, made))
    except SceneError as error:
        made.refuse(error)
    made.scene = {key: made.scene[key] for key in ORDER if made.scene.get(key)}
    return made


def _begun(given: Input, made: Translation) -> Work:
    """The source's grid, sets and particles."""
    mesh = given.source.mesh
    if mesh.cell_type in OTHER_CELLS:
        words = f"not supported: {OTHER_CELLS[mesh.cell_type]}; the grid has rectangular cells"
        raise given.fault(words, "mesh", "cell_type")
    if mesh.cell_type not in CELL_TYPES:
        words = f"'{mesh.cell_type}' is no type of cell that is known ({', '.join(CELL_TYPES)})"
        raise given.fault(words, "mesh", "cell_type")
    d, shape = CELL_TYPES[mesh.cell_type]
    if mesh.io_type != f"Ascii{d}D":
        words = f"'{mesh.io_type}' does not fit the {d}D cells '{mesh.cell_type}'"
        raise given.fault(words, "mesh", "io_type")
    grid = read_grid(given.table(mesh.mesh, (2, d, 3, 2**d, 4**d), "mesh", "mesh"), d, shape)
    sets = given.sets()
    return Work(given, made, grid, sets, read_cloud(given, grid, sets))


def _run(work: Work) -> None:
    scene, given = work.scene, work.given
    scene["version"] = 1
    scene["title"] = given.source.title
    scene["units"] = {"length": "m", "mass": "kg", "time": "s"}
    work.made.comment(("units",), "CB-Geo takes any consistent units; these are those of its documentation")
    scene["analysis"] = {"kind": "plane_strain" if work.grid.d == 2 else "3d"}
    _add_grid(work)
    add_method(work)
    add_time(work)
    materials = add_materials(work)
    add_archive(work)
    bodies = add_bodies(work, materials)
    add_conditions(work)
    add_loads(work, bodies)
    _check_functions(work)
    _note_particles(work)
    _note_ignored(work)


def _check_functions(work: Work) -> None:
    """Functions of time have different numbers, and something depends on each."""
    seen: set[int] = set()
    for index, function in enumerate(work.given.source.math_functions):
        keys = ("math_functions", index)
        if function.id in seen:
            work.fault((*keys, "id"), f"the function {function.id} is already defined")
        elif function.id not in work.functions:
            work.note("ignored", keys, f"nothing depends on the function {function.id}")
        seen.add(function.id)


def _note_particles(work: Work) -> None:
    """Nodes and particles of two phases, and what has no effect on particles."""
    words = "two phases"
    if PHASES.search(work.given.source.mesh.node_type):
        work.lacks(("mesh", "node_type"), words)
    for index, entry in enumerate(work.given.source.particles):
        keys = ("particles", index, "generator")
        if PHASES.search(entry.generator.particle_type):
            work.lacks((*keys, "particle_type"), words)
        io_type = getattr(entry.generator, "io_type", None)
        if io_type not in {None, f"Ascii{work.grid.d}D"}:
            words = f"'{io_type}' does not fit the {work.grid.d}D cells '{work.given.source.mesh.cell_type}'"
            work.fault((*keys, "io_type"), words)
        if work.given.has(*keys, "check_duplicates"):
            work.note("ignored", (*keys, "check_duplicates"), IGNORED["mesh", "check_duplicates"])
        if isinstance(entry.generator.material_id, tuple) and len(entry.generator.material_id) > 1:
            work.lacks((*keys, "material_id"), "particles of several materials")


def _add_grid(work: Work) -> None:
    grid = work.grid
    cell = grid.cell.tolist()
    work.scene["grid"] = {
        "lower": grid.lower.tolist(),
        "upper": grid.upper.tolist(),
        "cell": cell[0] if len(set(cell)) == 1 else cell,
    }
    if not grid.is_turned:
        return
    if grid.d == 2:
        work.constant("turn", grid.angle)
        how = f"by {grid.angle:g} degrees"
        work.made.comment(("constants", "turn"), "degrees from x of CB-Geo's mesh file to x of this scene")
    else:
        rows = ", ".join("[" + ", ".join(f"{value:.6g}" for value in column) + "]" for column in grid.axes.T)
        how = f"with axes along {rows}"
    words = (
        f"the regular grid is turned {how}; the scene lies in the grid's axes, and gravity is turned instead"
    )
    work.note("changed", ("mesh", "mesh"), words)


def _note_ignored(work: Work) -> None:
    for keys, words in IGNORED.items():
        if work.given.has(*keys):
            work.note("ignored", keys, words)
    if work.given.has("analysis", "resume") and not work.given.source.analysis.resume.resume:
        work.note("ignored", ("analysis", "resume"), "switched off in the source")
    if work.given.has("analysis", "interface") and not work.given.source.analysis.interface:
        work.note("ignored", ("analysis", "interface"), "switched off in the source")
    if work.given.has("material_sets") and not work.given.source.mesh.update_materials:
        work.note(
            "ignored", ("material_sets",), "without mesh.update_materials CB-Geo does not use them, either"
        )
