"""Laws that the points of a crack may have."""

from typing import Any


def of_points(law: Any) -> Any:
    """Refuse laws that points of a crack cannot have."""
    if law.kind != "cohesive":
        raise ValueError(
            f"points of a crack take a law of kind 'cohesive', not '{law.kind}', which faces may have"
        )
    for key in ("closed", "bonded"):
        if key in law.model_fields_set:
            raise ValueError(
                f"leave out '{key}': contact of the faces is 'faces.law', and 'along' says where it holds"
            )
    return law
