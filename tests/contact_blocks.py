"""Scenes of soft blocks in contact, which tests move a few steps."""

from typing import Any


def blocks_in_contact(
    places: dict[str, Any],
    velocities: dict[str, Any],
    size: list[float],
    contact: dict[str, Any],
    **more: Any,
) -> dict[str, Any]:
    """Blocks by name, with lower and upper corner and velocity, in a grid of this size from the origin on."""
    return {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [0, 0], "upper": size, "cell": 1},
        "materials": {"soft": {"kind": "neo_hookean", "density": 1, "E": 100, "nu": 0.3}},
        "bodies": [
            {
                "name": name,
                "material": "soft",
                "region": {"kind": "box", "lower": lower, "upper": upper},
                "velocity": velocities[name],
            }
            for name, (lower, upper) in places.items()
        ],
        "contact": contact,
        **more,
    }
