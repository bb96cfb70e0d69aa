"""Whether events name what can be held and reversed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmcli.core.suggest import did_you_mean, listing
from mpmcli.scene.parts import Parts
from mpmcli.scene.tree import Node, member_label


def check_events(parts: Parts, root: Node, report: Callable[..., None]) -> None:
    """Refuse events of unknown names, and of what has no clock."""
    known = [name for name, _ in clocked(parts.boundary, parts.loads, parts.bodies, parts.materials)]
    others = {model.name for key in ("boundary", "loads", "bodies") for _, model in getattr(parts, key)}
    for index, event in parts.events:
        label = f"events.{member_label(root.value['events'].value[index], index)}"
        for place, name in enumerate(event.to or ()):
            if name in known:
                continue
            if name in others:
                words = f"'{name}' has no clock; events act on velocity conditions, loads and rigid bodies"
            else:
                hint = did_you_mean(name, known) or (f" ({listing(known)})" if known else "")
                words = f"there is no condition, load or rigid body '{name}'{hint}"
            report(f"{label}.to.{place}", words, "unknown_reference")


def clocked(boundary: Any, loads: Any, bodies: Any, materials: dict[str, Any]) -> list[tuple[str, Any]]:
    """Name and model of everything that has a clock, from pairs of index and model."""
    found = [(m.name, m) for _, m in boundary if m.acts_on == "velocity" and m.kind != "symmetry"]
    found += [(m.name, m) for _, m in loads if m.acts_on == "velocity"]
    rigid = {name for name, material in materials.items() if material.kind == "rigid"}
    return found + [(body.name, body) for _, body in bodies if body.material in rigid]
