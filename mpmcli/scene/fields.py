"""Which velocity field each body moves in, and which contact law holds between two fields."""

import itertools
from collections.abc import Iterable
from typing import Any

import numpy as np

from mpmcli.scene.models import Scene

ONE_FIELD = "all"
"""Name of the velocity field of a scene without contact."""


def velocity_fields(scene: Scene) -> tuple[list[str], list[int]]:
    """The velocity fields of a scene.

    Returns
    -------
    names : names of the fields, in the order of the first body in each; a single one without contact
    field_of_body : index of the field of each body
    """
    of_bodies = [field_name(scene, body) for body in scene.bodies]
    names = list(dict.fromkeys(of_bodies))
    return names, [names.index(name) for name in of_bodies]


def field_name(scene: Scene, body: Any) -> str:
    """Name of the velocity field of a body: that given for its owner, else the owner's own name."""
    if scene.contact is None:
        return body.name if scene.materials[body.material].kind == "rigid" else ONE_FIELD
    if scene.contact.fields == "material":
        return scene.materials[body.material].field or body.material
    return body.field or body.name


def covering(conditions: Iterable[Any]) -> frozenset[str]:
    """Names of the bodies that prescribe the velocity of the nodes that they cover, by boundary conditions."""
    places = (getattr(condition, "on", None) for condition in conditions)
    return frozenset(name for place in places if (name := getattr(place, "covered_by", None)) is not None)


def owners_of_fields(scene: Scene) -> dict[str, str]:
    """What the scene may call a velocity field: names of fields, and of the bodies or materials that own them."""
    by_material = scene.contact is not None and scene.contact.fields == "material"
    owners = {body.material if by_material else body.name: field_name(scene, body) for body in scene.bodies}
    return owners | {name: name for name in velocity_fields(scene)[0]}


def chosen_pairs(contact: Any, owners: dict[str, str]) -> dict[frozenset[str], tuple[str, Any]]:
    """Return path and model of the pairs of a contact by their two fields; ``owners`` as of ``owners_of_fields``.

    Pairs that name something else are left out.
    """
    return {
        frozenset(owners[name] for name in pair.between): (f"contact.pairs.{index}", pair)
        for index, pair in enumerate(contact.pairs)
        if owners.keys() >= set(pair.between)
    }


def places_of_laws(contact: Any) -> list[tuple[str, Any]]:
    """Return the laws of a contact, each with its key below ``contact``."""
    return [("law", contact.law), *((f"pairs.{i}.law", pair.law) for i, pair in enumerate(contact.pairs))]


def conductance_table(scene: Scene, fields: list[str]) -> np.ndarray:
    """Return the conductance (fields, fields) between velocity fields in contact; 0: insulated, infinite: perfect.

    ``fields`` are names from ``velocity_fields``. Meant for scenes in which ``heat.contact`` is not ``shared``.
    """
    n = len(fields)
    table = np.zeros((n, n))
    if scene.contact is None or scene.heat is None:
        return table
    chosen = chosen_pairs(scene.contact, owners_of_fields(scene))
    for a, b in itertools.combinations(range(n), 2):
        _, pair = chosen.get(frozenset((fields[a], fields[b])), ("", None))
        h = getattr(getattr(pair, "heat", None) or scene.heat.contact, "conductance", 0.0)
        table[a, b] = table[b, a] = np.inf if h == "perfect" else h
    return table


def exchanges_by_area(scene: Scene, fields: list[str]) -> bool:
    """Return whether bodies exchange heat in proportion to their area of contact."""
    if scene.heat is None or scene.heat.contact == "shared":
        return False
    table = conductance_table(scene, fields)
    return bool((np.isfinite(table) & (table > 0.0)).any())


def law_table(scene: Scene, fields: list[str]) -> tuple[list[Any], np.ndarray]:
    """The contact laws of a scene, and which of them holds between two velocity fields.

    Parameters
    ----------
    scene : a checked scene
    fields : names of its fields, from ``velocity_fields``

    Returns
    -------
    laws : law models, each once; only those of a pair that exists
    table : (fields, fields) index of the law of each pair, symmetric; -1 on the diagonal
    """
    n = len(fields)
    table = np.full((n, n), -1, dtype=np.int64)
    if scene.contact is None or n < 2:
        return [], table
    chosen = chosen_pairs(scene.contact, owners_of_fields(scene))
    laws: list[Any] = []
    for a in range(n):
        for b in range(a):  # in this order laws have their numbers
            law = chosen.get(frozenset((fields[a], fields[b])), ("", scene.contact))[1].law
            if law not in laws:
                laws.append(law)
            table[a, b] = table[b, a] = laws.index(law)
    return laws, table
