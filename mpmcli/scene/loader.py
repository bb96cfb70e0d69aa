"""From a scene file to a checked scene: every problem at once, with line and column."""

import hashlib
import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from mpmcli.core.errors import Problem, SceneError
from mpmcli.core.expressions import Expression
from mpmcli.core.files import NoPlainFile, TooLarge, read_at_most, read_plain
from mpmcli.core.suggest import few_suggestions
from mpmcli.scene.checks import check
from mpmcli.scene.constants import read_constants
from mpmcli.scene.contact_checks import check_contact
from mpmcli.scene.context import Context
from mpmcli.scene.heat_checks import check_heat
from mpmcli.scene.models import BaseUnits, Scene
from mpmcli.scene.override import apply_defines, apply_sets
from mpmcli.scene.parts import Parts
from mpmcli.scene.plugins import check_plugins, plugins_of
from mpmcli.scene.problems import Report
from mpmcli.scene.report import as_text, locate, ordered, translate
from mpmcli.scene.tree import Mark, Node, compose
from mpmcli.scene.units import BASE, Units, base_unit_size

MAX_BYTES = 10 * 1024**2
STANDARD_INPUT = "-"


@dataclass
class LoadedScene:
    """A checked scene.

    Attributes
    ----------
    scene : the models
    path : the scene's file, or None for text
    units : its units; ``units.label("pressure")`` names the unit of a quantity
    constants : values of its constants
    warnings : what is doubtful
    overrides : the options ``--set`` and ``-D`` that changed it
    allow_outside_files : whether it may name files outside its folder
    function_files : names of the files that its expressions read
    """

    scene: Scene
    path: Path | None
    units: Units
    constants: dict[str, float]
    warnings: list[Problem] = field(default_factory=list)
    overrides: dict[str, list[str]] = field(default_factory=dict)
    root: Node | None = None
    allow_outside_files: bool = False
    function_files: frozenset[str] = frozenset()

    def resolved(self, *, with_defaults: bool = True) -> dict[str, Any]:
        """The whole scene, numbers in the scene's units; ready for JSON."""
        contents = self.scene.model_dump(by_alias=True, exclude_none=True, exclude_defaults=not with_defaults)
        return _for_json(contents) | {"constants": dict(self.constants)}

    @cached_property
    def hash(self) -> str:
        """SHA-256 of the resolved scene and of the files that it names."""
        digest = hashlib.sha256(json.dumps(self.resolved(), sort_keys=True).encode())
        for found in self.file_digests.values():
            digest.update(bytes.fromhex(found))
        return digest.hexdigest()

    @cached_property
    def file_digests(self) -> dict[str, str]:
        """SHA-256 of each file that the scene names, by its name there."""
        base = self.path.parent if self.path is not None else Path.cwd()
        digests = {}
        named = [body.region for body in self.scene.bodies] + [crack.path for crack in self.scene.cracks]
        of_parts = {str(name) for each in named for name in each.files()}
        for name in sorted(of_parts | self.function_files):
            with (base / name).open("rb") as file:
                digests[name] = hashlib.file_digest(file, "sha256").hexdigest()
        return digests

    @cached_property
    def plugins(self) -> dict[str, dict[str, str]]:
        """Version and digest of the sources of each plugin that the scene uses, by its name."""
        found = plugins_of(self.scene)
        return {plugin.name: {"version": plugin.version, "digest": plugin.digest} for plugin in found}

    def locate(self, error: SceneError) -> SceneError:
        """The same error with file, line and column where its problems have only a path."""
        if self.root is None:
            return error
        located = []
        for p in error.problems:
            place = locate(self.root, p.path, p.message, p.code, p.severity)
            located.append(place if p.line is None and p.file is None else p)
        return scene_error(located)

    @contextmanager
    def located(self) -> Iterator[None]:
        """Raise a ``SceneError`` from inside with file, line and column."""
        try:
            yield
        except SceneError as error:
            raise self.locate(error) from None


def _for_json(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _for_json(member) for key, member in value.items()}
    if isinstance(value, list | tuple):
        return [_for_json(member) for member in value]
    if isinstance(value, Expression):
        return value.as_number_or_text()
    return value if isinstance(value, bool | int | float) else str(value)


def load_scene(
    source: str | Path,
    *,
    sets: tuple[str, ...] | list[str] = (),
    defines: tuple[str, ...] | list[str] = (),
    allow_outside_files: bool = False,
) -> LoadedScene:
    """Read and check a scene as ``run.load`` does, apart from the names of its columns and fields.

    Raises SceneError with every problem, ordered by line, and PluginError if an installed plugin that the scene uses
    is not complete.
    """
    with few_suggestions():
        return _load(source, tuple(sets), tuple(defines), allow_outside_files)


def _load(
    source: str | Path, sets: tuple[str, ...], defines: tuple[str, ...], allow_outside_files: bool
) -> LoadedScene:
    is_text = isinstance(source, str) and "\n" in source
    path = None if is_text or str(source) == STANDARD_INPUT else Path(source)
    text, file = (str(source), "scene") if is_text else (read_text(Path(source)), str(source))
    root = compose(text, file)
    if not root.is_mapping:
        raise root.mark.error("", "a scene must be a mapping, such as version: 1, title: …, grid: …", "type")
    root = apply_sets(apply_defines(root, defines), sets)
    base = path.resolve().parent if path is not None else Path.cwd()
    scene, context, problems = _read(root, base, allow_outside_files)
    problems = ordered(problems)
    if scene is None or any(problem.severity == "error" for problem in problems):
        raise scene_error(problems)
    check_plugins(scene)
    overrides = {"set": list(sets), "define": list(defines)}
    return LoadedScene(
        scene, path, context.units, context.constants, problems, overrides, root, allow_outside_files,
        frozenset(context.function_files),
    )  # fmt: skip


def scene_error(problems: list[Problem]) -> SceneError:
    """A SceneError whose text is cut short where there are very many problems."""
    error = SceneError(ordered(problems))
    error.args = (as_text(error.problems),)
    return error


def _read(root: Node, base: Path, allow_outside_files: bool) -> tuple[Scene | None, Context, list[Problem]]:
    units, unit_problems = _read_units(root)
    constants, constant_problems = read_constants(root.value.get("constants"), units)
    context = Context(units, constants, base, allow_outside_files)
    # a key with nothing behind it (all of its members commented out) is as good as absent
    plain = {key: value for key, value in root.plain().items() if value is not None} | {
        "constants": constants
    }
    scene, report = None, Report(root)
    problems: list[Problem] = []
    try:
        scene = Scene.model_validate(plain, context=context)
        parts = Parts.of(scene, report.label)
    except ValidationError as error:
        problems += translate(error, root, Scene)
        parts = Parts.salvage(plain, context, report.label)
    for find in (check, check_contact, _check_cracks, check_heat):
        find(parts, report)
    problems += report.problems
    if constant_problems or unit_problems:
        problems = [p for p in problems if not _is_echo(p, root, constants, bool(unit_problems))]
    return scene, context, [*unit_problems, *constant_problems, *problems]


def _check_cracks(parts: Parts, report: Report) -> None:
    """Report what cracks have against the rest, in scenes that name them."""
    asked = parts.fracture is not None or getattr(parts.archive, "cracks", None) is not None
    if asked or report.section("cracks") is not None:
        from mpmcli.scene.crack_checks import check_cracks

        check_cracks(parts, report)


def _is_echo(problem: Problem, root: Node, constants: dict[str, float], units_failed: bool) -> bool:
    """Whether a problem only says that a constant, or the units, reported already, are missing."""
    declared = root.value.get("constants")
    names = declared.value if declared is not None and declared.is_mapping else {}
    if any(name not in constants and problem.message.startswith(f"'{name}' is not known") for name in names):
        return True
    return units_failed and (problem.path.startswith("units") or "declares no units" in problem.message)


def _read_units(root: Node) -> tuple[Units, list[Problem]]:
    node = root.value.get("units")
    if node is None or node.value is None:
        return Units(), []
    problems: list[Problem] = []
    try:
        names = BaseUnits.model_validate(node.plain())
    except ValidationError as error:
        found = translate(error, node, BaseUnits)
        return Units(), [replace(p, path=f"units.{p.path}".rstrip(".")) for p in found]
    for base in BASE:
        try:
            base_unit_size(getattr(names, base), base)
        except ValueError as error:
            problems.append(locate(root, f"units.{base}", str(error), "unit"))
    return (Units() if problems else Units(**names.model_dump())), problems


def read_text(path: Path) -> str:
    """The text of a scene file, or of standard input (``-``); SceneError with words if it cannot be read."""
    place, words = Mark(str(path)), ""
    try:
        if str(path) == STANDARD_INPUT:
            if sys.stdin is None:
                raise OSError("standard input is closed")
            contents = read_at_most(sys.stdin.buffer, MAX_BYTES)
        elif path.is_dir():
            words = "is a folder, not a scene file"
        else:
            contents = read_plain(path, MAX_BYTES)
    except FileNotFoundError:
        words = "the file does not exist"
    except TooLarge as error:
        size = "" if error.size is None else f"{error.size / 1024**2:.0f} MiB, "
        words = f"is too large for a scene ({size}at most {MAX_BYTES // 1024**2} MiB)"
    except NoPlainFile:
        words = f"is not a regular file; use '{STANDARD_INPUT}' to read a scene from standard input"
    except (OSError, ValueError) as error:
        words = f"cannot be read: {getattr(error, 'strerror', None) or error}"
    if words:
        raise place.error("", words, "file")
    try:
        return contents.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = contents.count(b"\n", 0, error.start) + 1
        column = error.start - contents.rfind(b"\n", 0, error.start)
        words = f"the file is not UTF-8 text (byte 0x{contents[error.start]:02x})"
        raise place._replace(line=line, column=column).error("", words, "encoding") from None
