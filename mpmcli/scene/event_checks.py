"""Whether events name what can be held and reversed."""

from typing import Any

from mpmcli.scene.parts import Parts
from mpmcli.scene.problems import Report


def check_events(parts: Parts, report: Report) -> None:
    """Refuse events of unknown names, and of what has no clock."""
    known = [name for name, _ in clocked(parts.boundary, parts.loads, parts.bodies, parts.materials)]
    others = {model.name for _, model in parts.acting + parts.bodies}
    for label, event in parts.events:
        for place, name in enumerate(event.to or ()):
            if name in others and name not in known:
                words = f"'{name}' has no clock; events act on velocity conditions, loads and rigid bodies"
                report(f"{label}.to.{place}", words, "unknown_reference")
            else:
                report.check_reference(f"{label}.to.{place}", name, known, "condition, load or rigid body")


def clocked(boundary: Any, loads: Any, bodies: Any, materials: dict[str, Any]) -> list[tuple[str, Any]]:
    """Name and model of everything that has a clock, from pairs of index and model."""
    found = [(m.name, m) for _, m in boundary if m.acts_on == "velocity" and m.kind != "symmetry"]
    found += [(m.name, m) for _, m in loads if m.acts_on == "velocity"]
    rigid = {name for name, material in materials.items() if material.kind == "rigid"}
    return found + [(body.name, body) for _, body in bodies if body.material in rigid]
