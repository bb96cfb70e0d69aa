"""The parts of a scene that are valid, so that a fault in one does not hide those of the others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated, Any

from pydantic import TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from mpmcli.scene.context import Context
from mpmcli.scene.models import Scene

SINGLE = ("analysis", "grid", "method", "time", "archive", "contact", "heat", "fracture")
Label = Callable[[str, int], str]
"""Path of a member of a list of the scene, by the key of the list and its index."""
LISTS = ("bodies", "cracks", "boundary", "loads", "events", "probes")


@dataclass
class Parts:
    """Valid models of a scene; what is not valid is None or left out.

    The lists hold pairs of path in the scene and model; ``materials`` maps names to models.
    """

    analysis: Any = None
    grid: Any = None
    method: Any = None
    time: Any = None
    archive: Any = None
    contact: Any = None
    heat: Any = None
    fracture: Any = None
    materials: dict[str, Any] = field(default_factory=dict)
    bodies: list[tuple[str, Any]] = field(default_factory=list)
    cracks: list[tuple[str, Any]] = field(default_factory=list)
    boundary: list[tuple[str, Any]] = field(default_factory=list)
    loads: list[tuple[str, Any]] = field(default_factory=list)
    events: list[tuple[str, Any]] = field(default_factory=list)
    probes: list[tuple[str, Any]] = field(default_factory=list)

    @property
    def has_jumps(self) -> bool:
        """Whether displacement jumps between fields or faces are measured: at cracks and interfaces."""
        laws = [] if self.contact is None else [self.contact.law, *(pair.law for pair in self.contact.pairs)]
        return bool(self.cracks) or any(law.is_interface for law in laws)

    @property
    def acting(self) -> list[tuple[str, Any]]:
        """Conditions and loads."""
        return self.boundary + self.loads

    @classmethod
    def of(cls, scene: Scene, label: Label) -> Parts:
        """All parts of a valid scene."""
        single = {key: getattr(scene, key) for key in SINGLE}
        lists = {
            key: [(label(key, i), model) for i, model in enumerate(getattr(scene, key) or ())]
            for key in LISTS
        }
        return cls(**single, materials=dict(scene.materials), **lists)

    @classmethod
    def salvage(cls, plain: dict[str, Any], context: Context, label: Label) -> Parts:
        """The parts of an invalid scene that are valid by themselves."""
        parts = cls()
        for key in SINGLE:
            if isinstance(plain.get(key), dict):
                setattr(parts, key, _try(_adapter(Scene.model_fields[key]), plain[key], context))
        materials = plain.get("materials")
        if isinstance(materials, dict):
            member = _adapter(Scene.model_fields["materials"])
            for name, value in materials.items():
                made = _try(member, {name: value}, context)
                if made is not None:
                    parts.materials |= made
        for key in LISTS:
            if isinstance(plain.get(key), list):
                adapter = _adapter(Scene.model_fields[key])
                tried = [(label(key, i), _try(adapter, [each], context)) for i, each in enumerate(plain[key])]
                setattr(parts, key, [(path, made[0]) for path, made in tried if made is not None])
        return parts


def _adapter(info: FieldInfo) -> TypeAdapter[Any]:
    annotation: Any = Annotated[info.annotation, info]
    return TypeAdapter(annotation)


def _try(adapter: TypeAdapter[Any], value: Any, context: Context) -> Any:
    try:
        return adapter.validate_python(value, context=context)
    except ValidationError:
        return None
