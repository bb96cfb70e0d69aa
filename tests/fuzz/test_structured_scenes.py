"""Scenes built at random from everything that a scene can name, with few particles, run for twenty steps.

Exit codes are 0, 3 and 4 only, tables of runs that end with 0 hold finite numbers, and no scene takes long. CI takes
some of them; all of 10,000 are taken by

    MPMCLI_STRUCTURED=10000 python -m pytest -n 2 -m long tests/fuzz/test_structured_scenes.py

Each part prints its counts. Scenes that ended otherwise are kept in the folder ``MPMCLI_CAMPAIGN``.
"""

import os
import shutil
from collections import Counter
from pathlib import Path
from typing import Any

import examples
import numpy as np
import pytest
import yaml
from commands import answered

from mpmcli.boundary.base import CONDITIONS, LOADS
from mpmcli.contact.laws import LAWS
from mpmcli.contact.normals import NORMALS
from mpmcli.contact.separation import SEPARATIONS
from mpmcli.core.analysis import ANALYSES
from mpmcli.geometry.base import REGIONS
from mpmcli.materials import MATERIALS
from mpmcli.scene.method import UPDATES
from mpmcli.shapes import SHAPES

STEPS = 20
SECONDS = 60.0
"""Nearly all of it to compile what no scene before has used."""
ALLOWED = {0, 3, 4}
PARTS = 20
PLAIN = int(os.environ.get("MPMCLI_PLAIN", "60"))
"""Scenes that run in plain Python."""
WORDS = {"x": ["0", "0.1*x*t", "sin(x)", "t"], "t": ["0.1*t", "sin(50*t)", "where(t>0.01, 1, 0)"]}


class Dice:
    """Choices by a seed."""

    def __init__(self, seed: int):
        self.rng = np.random.default_rng(seed)

    def one_of(self, choices: Any) -> Any:
        """One of some choices."""
        choices = list(choices)
        return choices[int(self.rng.integers(len(choices)))]

    def rarely(self, share: float = 0.2) -> bool:
        """True now and then."""
        return bool(self.rng.random() < share)

    def number(self, low: float, high: float) -> float:
        """A number between two."""
        return float(round(self.rng.uniform(low, high), 3))

    def size(self) -> float:
        """A positive number of any size, most of them ordinary."""
        return float(10.0 ** self.rng.uniform(-8, 8)) if self.rarely(0.1) else self.number(0.1, 5)


def transfer(dice: Dice) -> dict[str, Any]:
    """A transfer with some of its keys."""
    kind = dice.one_of(["flip", "xpic", "fmpm", "fmpm"])
    keys: dict[str, Any] = {"kind": kind}
    if dice.rarely():
        keys["velocity_gradient"] = True
    if dice.rarely():
        keys["alpha"] = dice.number(0, 1)
    if kind == "flip":
        return keys
    keys["order"] = dice.one_of([1, 2, 3, 4, 8])
    if dice.rarely():
        keys |= dice.one_of([{"every_steps": 3}, {"every_courant": 0.7}])
    if kind == "fmpm" and dice.rarely():
        keys |= dice.one_of(
            [
                {"blend": {"order": 2, "fraction": 0.8}},
                {"dynamic": {"metric": "means"}},
                {"dynamic": {"metric": "changes"}},
            ]
        )
    return keys


def method(dice: Dice) -> dict[str, Any]:
    """All of ``method``."""
    keys: dict[str, Any] = {
        "shape": dice.one_of(SHAPES),
        "update": dice.one_of(UPDATES),
        "transfer": transfer(dice),
    }
    if dice.rarely():
        keys["velocity_conditions"] = dice.one_of(["incremental", "lumped", "velocity", "combined"])
    if dice.rarely():
        keys["damping"] = {"particle": dice.number(0, 2), "grid": dice.number(0, 2)}
    if dice.rarely():
        keys["artificial_viscosity"] = {"linear": 0.2, "quadratic": 2.0}
    if dice.rarely(0.4):
        keys["heating"] = dice.one_of(["adiabatic", "adiabatic", "isothermal"])
    return keys


def region(dice: Dice, analysis: str, d: int) -> dict[str, Any]:
    """A region of a few particles somewhere in the grid of 8 cells per axis."""
    low = [dice.number(0.5, 5) for _ in range(d)]
    if analysis == "axisymmetric" and dice.rarely(0.5):
        low[0] = 0.0
    high = [x + dice.number(0.6, 1.9 if d == 3 else 2.9) for x in low]
    box = {"kind": "box", "lower": low, "upper": high}
    center, radius = [x + 0.8 for x in low], dice.number(0.6, 1.2)
    if d == 2 and analysis != "axisymmetric" and dice.rarely(0.3):
        return {"kind": "disk", "center": center, "radius": radius}
    if d == 3 and dice.rarely(0.3):
        return {"kind": "sphere", "center": center, "radius": radius}
    return box


def contact(dice: Dice, d: int, names: list[str]) -> dict[str, Any]:
    """All of ``contact``."""

    def law() -> dict[str, Any]:
        kind = dice.one_of([kind for kind in LAWS if not LAWS[kind].is_interface])
        several = [keys for keys in examples.LAWS[kind] if separation != "none" or "stiffness" not in keys]
        return {"kind": kind} | dice.one_of(several)

    normal, separation = dice.one_of(NORMALS), dice.one_of(SEPARATIONS)
    direction = {"vector": [1, 0.2, 0.1][:d]} if normal == "specified" else {}
    keys: dict[str, Any] = {
        "normal": {"kind": normal} | examples.NORMALS.get(normal, {}) | direction,
        "separation": {"kind": separation} | examples.SEPARATIONS.get(separation, {}),
        "law": law(),
    }
    if dice.rarely() and len(names) > 1:
        keys["pairs"] = [{"between": names[:2], "law": law()}]
    for key, choices in {
        "increments": ["net", "evolving", "lumped", "after", "combined"],
        "once": [True],
        "mass_ratio": [0, 0.1],
        "displacement_only": [True],
        "overlap_removal": [0.1, 1.0],
        "three_or_more": ["lumped", "pairs", "coupled"],
    }.items():
        if dice.rarely():
            keys[key] = dice.one_of(choices)
    return keys


def join(dice: Dice, scene: dict[str, Any], d: int) -> None:
    """Let the first two bodies share a face, with an interface law between them and choices of interfaces."""
    contact, (one, two) = scene["contact"], scene["bodies"][:2]
    cell = np.broadcast_to(scene["grid"]["cell"], d)
    axis, low, high = dice.one_of(range(d)), 2.0 * cell, 4.0 * cell
    step = cell * (np.arange(d) == axis)
    gap = dice.one_of([0.0, 0.0, 0.0, 0.05, 0.5]) * step
    one["region"] = {"kind": "box", "lower": low.tolist(), "upper": high.tolist()}
    moved = [low + 2.0 * step + gap, high + 2.0 * step + gap]
    two["region"] = {"kind": "box", "lower": moved[0].tolist(), "upper": moved[1].tolist()}
    if dice.rarely(0.8):  # what interface laws refuse
        for key in ("increments", "once", "three_or_more"):
            contact.pop(key, None)
    if dice.rarely(0.9) and contact["normal"]["kind"] == "own_gradient":
        contact["normal"] = {"kind": "average_gradient"}
    kind = dice.one_of([kind for kind in LAWS if LAWS[kind].is_interface])
    law = {"kind": kind} | dice.one_of(examples.LAWS[kind])
    if dice.rarely():
        law["bonded"] = dice.one_of(["x > 3", "1 + x", "sin(x)"])
    contact["pairs"] = [{"between": [one["name"], two["name"]], "law": law}]
    choices = {
        "jump": ["gradient", "extrapolated", "edges"],
        "step": ["implicit", "oscillator"],
        "area": ["opening", "volumes"],
        "initial_gap": [0, 0.1, 0.6],
    }
    contact["interface"] = {key: dice.one_of(these) for key, these in choices.items() if dice.rarely(0.5)}
    if contact["interface"].get("jump") == "edges" and contact["separation"]["kind"] == "none":
        contact["separation"] = {"kind": "regression"}
    scene["probes"] = [{"name": "joint", "kind": "pair", "between": [one["name"], two["name"]]}]
    if LAWS[kind].keeps_history:
        scene["archive"]["particles"] = {"every": 1e5, "fields": ["damage_of_bond"]}
    if dice.rarely(0.5):
        fields = ["interface_jump", "interface_traction", "interface_damage"]
        scene["archive"]["grid"] = {"every": 1e5, "fields": fields}


def condition(dice: Dice, d: int, body: str) -> dict[str, Any]:
    """A condition at the grid's lower end, or on the face of a body."""
    axis = dice.one_of("xyz"[:d])
    plane = {"plane": {"axis": axis, "at": 1, "side": "lower"}}
    face = {"body": body, "face": {"axis": axis, "side": dice.one_of(["lower", "upper"])}}
    normal = [float(name == axis) for name in "xyz"[:d]]
    return dice.one_of(
        [
            {"kind": "velocity", "on": dice.one_of([plane, face]), "direction": axis}
            | {"value": dice.one_of([0, 1, *WORDS["x"]])},
            {"kind": "wall", "normal": normal, "position": dice.one_of([1, "1+t"])}
            | {"velocity": dice.one_of([0, 1, *WORDS["t"]]), "gradient": dice.one_of([0, 0, 1])},
            {"kind": "symmetry", "plane": {"axis": axis, "at": 0}},
        ]
    )


def load(dice: Dice, d: int, body: str) -> dict[str, Any]:
    """A load of any kind."""
    vector = [dice.one_of([0, 0.5, *WORDS["t"]]) for _ in range(d)]
    face = {"axis": dice.one_of("xyz"[:d]), "side": dice.one_of(["lower", "upper"])}
    return dice.one_of(
        [
            {"kind": "gravity", "acceleration": vector},
            {"kind": "body_force", "acceleration": [dice.one_of(["x", *WORDS["x"]]) for _ in range(d)]},
            {"kind": "particle_force", "on": {"body": body}, "force": vector},
            {"kind": "traction", "on": {"body": body, "face": face}, "pressure": dice.size()},
        ]
    )


def heat(dice: Dice, has_contact: bool) -> dict[str, Any]:
    """All of ``heat``."""
    keys: dict[str, Any] = {}
    if dice.rarely(0.6):
        kind = dice.one_of(["flip", "fmpm"])
        keys["transfer"] = {"kind": kind, "order": dice.one_of([1, 2, 4, 8])}
        if kind == "fmpm" and dice.rarely():
            keys["transfer"]["every_steps"] = 3
    if dice.rarely(0.4):
        keys["interval"] = dice.one_of([1, 3, "auto"])
    if dice.rarely():
        keys["fourier"] = dice.number(0.05, 1)
    if has_contact and dice.rarely(0.6):
        keys["contact"] = dice.one_of(
            ["shared", "insulated", {"conductance": dice.size()}, {"conductance": "perfect"}]
        )
        keys["friction"] = dice.one_of([True, False])
    return keys


def warm_up(dice: Dice, scene: dict[str, Any], d: int) -> None:
    """Let a scene conduct heat, or at least expand and warm by itself."""
    has_heat = dice.rarely(0.8)
    if has_heat:
        scene["heat"] = heat(dice, "contact" in scene)
        if dice.rarely() and "grid" not in scene["archive"]:
            scene["archive"]["grid"] = {"every": 1e5, "fields": ["temperature", "heat_capacity"]}
        if scene["heat"].get("contact", "shared") != "shared":
            for pair in scene["contact"].get("pairs", ()):
                pair["heat"] = dice.one_of(
                    ["insulated", {"conductance": dice.size()}, {"conductance": "perfect"}]
                )
    for material in scene["materials"].values():
        if material["kind"] == "rigid":
            continue
        is_equation_of_state = "equation_of_state" in MATERIALS[material["kind"]].properties
        if material["kind"] != "ideal_gas":  # of equations of state, numbers that go together
            material.setdefault("heat_capacity", dice.size())
        if has_heat:
            material["conductivity"] = dice.one_of([0, dice.size(), [1, 0.1, 3]])
        if not is_equation_of_state and dice.rarely(0.5):
            material["expansion"] = dice.one_of([1e-5, 1e-3, 0.1])
        if dice.rarely():
            material["T0"] = dice.one_of([1e-3, 200, 1e8])
    for body in scene["bodies"]:
        if dice.rarely(0.5):
            body["temperature"] = dice.one_of([400, "300 + 50*x", "300*exp(x)"])
    if has_heat and dice.rarely(0.6):
        warm = {"name": "warm", "kind": "temperature", "value": dice.one_of([250, "300 + 100*t", "300 + x"])}
        scene.setdefault("boundary", []).append(warm | {"on": somewhere(dice, d)})
    if has_heat and dice.rarely(0.6):
        scene.setdefault("loads", []).append({"name": "fire"} | load_of_heat(dice, d))


def somewhere(dice: Dice, d: int) -> dict[str, Any]:
    """A plane, box, region, or the face of a body."""
    axis = dice.one_of("xyz"[:d])
    face = {"body": "a", "face": {"axis": axis, "side": dice.one_of(["lower", "upper"])}}
    plane = {"plane": {"axis": axis, "at": dice.number(1, 3), "side": "lower"}}
    box = {"lower": [0.0] * d, "upper": [dice.number(1, 3)] * d}
    return dice.one_of([plane, face, face, {"box": box}, {"region": {"kind": "box"} | box}])


def load_of_heat(dice: Dice, d: int) -> dict[str, Any]:
    """A load of any kind that heats."""
    on = {"body": "a", "face": {"axis": dice.one_of("xyz"[:d]), "side": dice.one_of(["lower", "upper"])}}
    return dice.one_of(
        [
            {"kind": "heat_flux", "on": on, "flux": dice.one_of([1, -0.5, "10*sin(t)"])},
            {"kind": "film", "on": on, "coefficient": dice.size(), "around": dice.one_of([4, 293, "300+t"])},
            {
                "kind": "radiation",
                "on": on,
                "emissivity": 0.8,
                "around": 4,
                "stefan_boltzmann": dice.one_of([1e-9, 1]),
            },
            {"kind": "heat_source", "on": {"body": "a"}, "power": dice.one_of([1, "x", -0.1])}
            | {"per": dice.one_of(["volume", "mass", "total"])},
        ]
    )


def crack(dice: Dice, scene: dict[str, Any], name: str) -> dict[str, Any]:
    """A crack through the first body, into it or within it, which may grow."""
    place = scene["bodies"][0]["region"]
    middle = np.array(place.get("center", [0.0, 0.0]))
    half = place.get("radius", 0.0)
    low, high = (
        np.array(place.get(key, middle + side * half)) for key, side in (("lower", -1), ("upper", 1))
    )
    points = low + (high - low) * dice.rng.uniform(0.15, 0.85, (dice.one_of([2, 2, 3]), 2))
    ends = {"start": dice.one_of(["tip", "mouth", "mouth"]), "end": dice.one_of(["tip", "tip", "mouth"])}
    axis = dice.one_of([0, 1])
    points = points[np.argsort(points[:, axis])]
    points[:, axis] = np.linspace(points[0, axis], points[-1, axis] + 0.3, len(points))
    if ends["start"] == "mouth":
        points[0, axis] = low[axis] - dice.one_of([0.0, 0.3])
    if ends["end"] == "mouth":
        points[-1, axis] = high[axis] + dice.one_of([0.0, 0.3])
    without_memory = [kind for kind in LAWS if kind not in ("cohesive", "adhesion_friction")]
    kind = dice.one_of(LAWS if dice.rarely(0.05) else without_memory)
    keys: dict[str, Any] = {
        "name": name,
        "ends": ends,
        "faces": {"law": {"kind": kind} | examples.LAWS[kind][0]},
    }
    keys["path"] = {"kind": "points", "points": np.round(points, 6).tolist()}
    if dice.rarely(0.1):
        keys["path"] = {"kind": "arc", "center": points[0].tolist(), "radius": dice.number(0.3, 2)}
        keys["path"] |= {"from": dice.number(-180, 180), "to": dice.number(-180, 180)}
    keys["spacing"] = dice.one_of([0.1, 0.1, 0.25, 0.5, 2])
    if dice.rarely():
        keys["pressure"] = dice.one_of([dice.size(), "x*t", "-1"])
    if dice.rarely():
        keys["traction"] = {"law": {"kind": "cohesive"} | examples.LAWS["cohesive"][0]}
    if dice.rarely(0.3):
        keys["moves"] = dice.one_of(["average", "mass", "fixed"])
    if dice.rarely():
        keys["cuts"] = [scene["bodies"][0]["name"]]
    tips = [end for end, what in ends.items() if what == "tip"]
    if tips and dice.rarely(0.5) and kind != "perfect":
        keys["growth"] = {dice.one_of(tips): growth(dice)}
    return keys


def growth(dice: Dice) -> dict[str, Any]:
    """When a tip grows, and where to."""
    kind = dice.one_of(examples.CRITERIA)
    keys: dict[str, Any] = {"criterion": {"kind": kind} | examples.CRITERIA[kind]}
    if dice.rarely(0.5):
        way = dice.one_of(examples.DIRECTIONS)
        keys["direction"] = {"kind": way} | examples.DIRECTIONS[way]
    if dice.rarely():
        keys["increment"] = dice.one_of([0.1, 1, 3])
    if dice.rarely():
        keys["max_length"] = dice.number(0.1, 4)
    if dice.rarely():
        keys["speed"] = {"max": dice.size()}
    return keys


def break_apart(dice: Dice, scene: dict[str, Any]) -> None:
    """Put cracks into a scene in the plane, with what can be asked of them."""
    scene["cracks"] = [crack(dice, scene, f"k{i}") for i in range(dice.one_of([1, 1, 1, 2, 3]))]
    ends = [
        (each["name"], end) for each in scene["cracks"] for end, what in each["ends"].items() if what == "tip"
    ]
    columns = ["default", "crack_length", "crack_force", "third_cracks"]
    if ends and (dice.rarely(0.6) or any("growth" in each for each in scene["cracks"])):
        scene["fracture"] = {"inner": dice.one_of([1, 2]), "outer": dice.one_of([3, 6])}
        scene["fracture"] |= {"terms": dice.one_of([1, 2]), "modes": dice.one_of(["interaction", "opening"])}
        columns += ["J", "K_I", "K_II", "tip"]
    scene["archive"]["globals"]["columns"] = columns
    if dice.rarely(0.5):
        scene["archive"] |= {"cracks": {"every": 1e5}, "particles": {"every": 1e5, "fields": ["crack_side"]}}
        scene["archive"]["grid"] = {"every": 1e5, "fields": ["mass_side_0", "velocity_side_1"]}
    if dice.rarely(0.5):
        probes = [{"name": "gap", "kind": "crack_opening", "crack": "k0"}]
        probes += [{"name": "tip", "kind": "crack_tip", "crack": name, "end": end} for name, end in ends[:1]]
        scene["probes"] = [*scene.get("probes", ()), *probes]


def structured_scene(seed: int) -> dict[str, Any]:
    """A scene of 2 to some 50 particles per body, built at random from what exists."""
    dice = Dice(seed)
    analysis = dice.one_of(ANALYSES)
    d = ANALYSES[analysis]().dimensions
    kinds = [kind for kind in MATERIALS if kind != "rigid"]
    if not dice.rarely(0.05):
        kinds = [kind for kind in kinds if analysis in MATERIALS[kind].analyses]
    has_contact = dice.rarely(0.5)
    materials: dict[str, Any] = {}
    for i in range(dice.one_of([1, 1, 2])):
        kind = dice.one_of(kinds)
        materials[f"m{i}"] = examples.material(kind, dice.one_of(examples.MATERIALS[kind]), dice.size())
    if has_contact and dice.rarely():
        materials["m1"] = {"kind": "rigid"}
    names = ["a", "b", "c"][: dice.one_of([2, 2, 3] if has_contact else [1, 2])]
    per_axis = dice.one_of([1, 2, 2] if d == 3 else [1, 2, 2, 3])
    bodies = [
        {
            "name": name,
            "material": dice.one_of(materials),
            "region": region(dice, analysis, d),
            "particles_per_axis": per_axis,
            "velocity": [dice.one_of([dice.number(-1, 1), "0.3*sin(x)", "x"]) for _ in range(d)],
            "overlap": dice.one_of(["keep", "replace"]),
        }
        for name in names
    ]
    scene: dict[str, Any] = {
        "version": 1,
        "analysis": {"kind": analysis},
        "grid": {"lower": [0] * d, "upper": [8] * d, "cell": dice.one_of([1, 1, 0.5, [1, 0.5, 0.8][:d]])},
        "method": method(dice),
        "materials": materials,
        "bodies": bodies,
        "time": dice.one_of([{"courant": 0.2}, {"courant": 0.9}, {"courant": "auto"}, {"step": 0.01}])
        | {"end": 1e6, "max_steps": STEPS},
        "domain": {"on_exit": dice.one_of(["error", "delete", "stop_at_wall"])},
        "archive": {"globals": {"every": 1e5}},
    }
    if has_contact:
        scene["contact"] = contact(dice, d, names)
        if dice.rarely(0.5):
            join(dice, scene, d)
    if dice.rarely(0.4):
        scene["boundary"] = [
            {"name": f"c{i}"} | condition(dice, d, names[0]) for i in range(dice.one_of([1, 2]))
        ]
    if dice.rarely(0.4):
        scene["loads"] = [{"name": f"l{i}"} | load(dice, d, names[0]) for i in range(dice.one_of([1, 2]))]
    if dice.rarely():
        scene["probes"] = [*scene.get("probes", ()), {
            "name": "p", "kind": "particle", "body": names[0],
            "near": bodies[0]["region"].get("lower", [4.0] * d), "columns": ["position", "velocity", "stress"],
        }]  # fmt: skip
    if dice.rarely(0.5):
        warm_up(dice, scene, d)
    elif d == 2 and dice.rarely(0.6):
        break_apart(dice, scene)
    add_rare_keys(Dice(seed + 1_000_000), scene, d)
    return scene


def add_rare_keys(dice: Dice, scene: dict[str, Any], d: int) -> None:
    """Keys that few scenes use, each of them now and then, so that most scenes stay valid."""
    loads, conditions = list(scene.get("loads", ())), list(scene.get("boundary", ()))
    axis, face = dice.one_of("xyz"[:d]), {"axis": dice.one_of("xyz"[:d]), "side": "lower"}
    if dice.rarely(0.1):
        scene["method"]["volumetric"] = "averaged"
    if dice.rarely(0.1):
        feedback = {"damps": dice.one_of(["grid", "particle"]), "gain": dice.size(), "target": "t"}
        scene["method"]["damping"] = dice.one_of(
            [{"local": 0.1}, {"local": "t"}, {"feedback": feedback}, {"grid": "0.1*t", "particle": "t"}]
        )
    if dice.rarely(0.15) and may_be_periodic(scene):
        scene["grid"]["periodic"] = [axis]
        face = {"axis": "x", "side": "lower"} if axis != "x" or d == 1 else {"axis": "y", "side": "lower"}
    if dice.rarely(0.1) and scene["grid"].get("periodic") != [face["axis"]]:
        plane = {"plane": {"axis": face["axis"], "at": dice.one_of([1, 3]), "side": "lower"}}
        on = dice.one_of([{"body": "a", "face": face}, plane])
        loads.append({"name": "rest", "kind": "absorbing", "on": on})
    if dice.rarely(0.1) and not any(load["kind"] == "gravity" for load in loads):
        loads.append({"name": "weight", "kind": "gravity", "acceleration": [0] * (d - 1) + [-1]})
        loads.append({"name": "water", "kind": "buoyancy", "level": dice.one_of([3, "3+t"]), "density": 0.5})
    if dice.rarely(0.1):
        at = [dice.one_of([0, 2.5, 3, 8]) for _ in range(d)]
        loads.append({"name": "point", "kind": "nodal_force", "at": at, "force": [dice.one_of([1, "t"])] * d})
    if dice.rarely(0.08):
        table = {"body": "a", "face": face}, "interpolate(t, 0, 0, 1, 1)"
        loads.append({"name": "table", "kind": "traction", "on": table[0], "pressure": table[1]})
    if dice.rarely(0.1) and "periodic" not in scene["grid"]:
        wall = {"name": "rough", "kind": "wall", "normal": [1] + [0] * (d - 1), "position": 1.5}
        conditions.append(wall | {"velocity": dice.one_of([0, "t"]), "friction": 0.1})
    is_free = scene["analysis"]["kind"].endswith("stress")
    pressed = dict.fromkeys(["xx"] if is_free else ["xx", "yy", "zz"], -0.01)
    for body in scene["bodies"]:
        if dice.rarely(0.05):
            body["stress"] = dice.one_of(
                [pressed | {"kind": "components"}, {"kind": "strain", "xx": "0.001*x"}]
            )
        uses_faces = any("face" in (entry.get("on") or {}) for entry in (*loads, *conditions))
        if dice.rarely(0.05) and d > 1 and body["region"]["kind"] == "box" and not uses_faces:
            body["region"]["rotate"] = {"angle": 30} if d == 2 else {"angle": 30, "axis": [0, 0, 1]}
            body["particles_along"] = "region"
        elif dice.rarely(0.15):
            body["region"] = rare_region(dice, body["region"], d)
    for chain in scene.get("cracks", ()):
        if dice.rarely():
            chain["respace"] = True
        if dice.rarely() and chain.get("moves") != "fixed":
            chain["keep_apart"] = True
    if dice.rarely(0.15):
        when = dice.one_of(["step > 1", "kinetic_energy > 0", {"condition": "step >= 1", "lasts": 1e-9}])
        scene["events"] = [{"name": "e", "when": when, "do": dice.one_of(["hold", "reverse", "stop"])}]
    if dice.rarely(0.1):
        scene["time"]["stop_when"] = dice.one_of(["step >= 2", "stress_work > 1e300"])
    if dice.rarely(0.1):
        scene["domain"]["volume_ratio"] = dice.one_of([[0.5, 2], [0.999, 1.001]])
    scene |= ({"loads": loads} if loads else {}) | ({"boundary": conditions} if conditions else {})
    rigid = [body for body in scene["bodies"] if scene["materials"][body["material"]]["kind"] == "rigid"]
    normal = scene["contact"]["normal"] if "contact" in scene else {}
    if rigid and normal and "rigid_normal" in NORMALS[normal["kind"]].model_fields and dice.rarely(0.5):
        normal["rigid_normal"] = "surface"
    if dice.rarely(0.05):
        scene["method"]["deformation_increment"] = "linear"


def may_be_periodic(scene: dict[str, Any]) -> bool:
    """Whether nothing in a scene goes without periodic axes only; of what else there is, some is refused as well."""
    method, conditions = scene["method"], scene.get("boundary", ())
    refused = {"contact", "heat", "cracks"} & scene.keys() or "dynamic" in method.get("transfer", {})
    return not refused and "local" not in method.get("damping", {}) and not conditions


def rare_region(dice: Dice, region: dict[str, Any], d: int) -> dict[str, Any]:
    """A region of another kind, near the one that a body has."""
    low = region.get("lower", [2.0] * d)
    middle = [x + 0.8 for x in low]
    half = {"kind": "half_space", "point": middle, "normal": [1] * d}
    kinds: list[dict[str, Any]] = [
        {"kind": "difference", "region": region, "subtract": [half]},
        {"kind": "intersection", "regions": [region, half]},
        {"kind": "union", "regions": [region, region]},
    ]
    if d == 2:
        x, y = low
        kinds += [
            {"kind": "polygon", "points": [[x, y], [x + 2, y], [x, y + 2]]},
            {"kind": "ellipse", "center": middle, "semi_axes": [1, 0.7]},
            {"kind": "disk", "center": middle, "radius": 0.9},
        ]
    if d == 3:
        kinds += [
            {"kind": "cylinder", "from": low, "to": [*low[:2], low[2] + 1.5], "radius": 0.8},
            {"kind": "sphere", "center": middle, "radius": 0.9},
            {"kind": "ellipsoid", "center": middle, "semi_axes": [1, 0.7, 0.8]},
        ]
    return dice.one_of(kinds)


def unfinished_numbers(results: Path) -> list[str]:
    """Tables that hold a number which is not finite; an empty field is a mean over nothing."""
    found = []
    for path in results.rglob("*.csv"):
        if path.name == "events.csv":  # has words
            continue
        header, *rows = path.read_text(encoding="utf-8").splitlines()
        for row in rows:
            for name, word in zip(header.split(","), row.split(","), strict=True):
                if word and not np.isfinite(float(word)):
                    found.append(f"{path.name}: {name} = {word}")
    return found


def take(seed: int, folder: Path) -> tuple[int, str]:
    """Run one scene; the exit code, and what is wrong with how it went, in words."""
    path, results = folder / "scene.yaml", folder / "results"
    path.write_text(yaml.safe_dump(structured_scene(seed), sort_keys=False), encoding="utf-8")
    command = ["run", str(path), "--threads", "1", "-q", "-o", str(results)]
    code, wrong = answered(command, ALLOWED, SECONDS)
    if code == 0 and not wrong:
        wrong = "; ".join(unfinished_numbers(results)[:5])
    shutil.rmtree(results, ignore_errors=True)
    return code, f"seed {seed}: {wrong}" if wrong else ""


def campaign(seeds: range, folder: Path) -> tuple[Counter[int], list[str]]:
    """Exit codes of some scenes, and what was wrong; scenes that went wrong are kept."""
    codes: Counter[int] = Counter()
    findings = []
    for seed in seeds:
        code, wrong = take(seed, folder)
        codes[code] += 1
        if wrong:
            findings.append(wrong)
            kept = Path(os.environ.get("MPMCLI_CAMPAIGN") or folder)
            kept.mkdir(parents=True, exist_ok=True)
            shutil.copy(folder / "scene.yaml", kept / f"structured_{seed}.yaml")
            (kept / f"structured_{seed}.txt").write_text(wrong, encoding="utf-8")
    return codes, findings


def test_scenes_are_as_they_should_be():
    """Most are valid, and the same seed gives the same scene."""
    assert structured_scene(3) == structured_scene(3)
    kinds = {structured_scene(seed)["analysis"]["kind"] for seed in range(60)}
    assert kinds == set(ANALYSES)


def kinds_in(value: Any) -> set[str]:
    """The words of all keys ``kind`` below a value."""
    if isinstance(value, dict):
        own = {value["kind"]} if isinstance(value.get("kind"), str) else set()
        return own.union(*(kinds_in(member) for member in value.values()))
    return set().union(*(kinds_in(member) for member in value)) if isinstance(value, list) else set()


FROM_FILES = {"bitmap", "mesh", "points"}
"""Regions that read a file, which ``test_damaged_files`` tries."""


def test_every_registered_kind_is_generated():
    """A new entry of a registry is missing here until scenes are built of it."""
    scenes = [structured_scene(seed) for seed in range(1500)]

    def found(*keys: str) -> set[str]:
        return set().union(*(kinds_in(scene.get(key, [])) for scene in scenes for key in keys))

    models = [model for scene in scenes for model in scene["materials"].values()]
    assert {model["kind"] for model in models} == set(MATERIALS)
    assert {scene["contact"]["normal"]["kind"] for scene in scenes if "contact" in scene} == set(NORMALS)
    assert {s["contact"]["separation"]["kind"] for s in scenes if "contact" in s} == set(SEPARATIONS)
    assert set(LAWS) <= found("contact")
    assert {scene["method"]["shape"] for scene in scenes} == set(SHAPES)
    assert {scene["method"]["update"] for scene in scenes} == set(UPDATES)
    assert {c["kind"] for scene in scenes for c in scene.get("boundary", ())} == set(CONDITIONS)
    assert {load["kind"] for scene in scenes for load in scene.get("loads", ())} == set(LOADS)
    regions = set().union(*(kinds_in(b["region"]) for scene in scenes for b in scene["bodies"]))
    assert regions == set(REGIONS) - FROM_FILES


@pytest.mark.slow
def test_structured_scenes(tmp_path, monkeypatch):
    monkeypatch.setenv("MPMCLI_DEBUG", "1")
    codes, findings = campaign(range(20), tmp_path)
    assert findings == []
    assert codes[0] >= 10


@pytest.mark.slow
def test_structured_scenes_in_plain_python(tmp_path, monkeypatch, plain_python):
    """Nothing is compiled, so that many kinds are seen in little time; divisions by zero raise here."""
    monkeypatch.setenv("MPMCLI_DEBUG", "1")
    monkeypatch.setitem(globals(), "STEPS", 3)
    with plain_python():
        codes, findings = campaign(range(10_000, 10_000 + PLAIN), tmp_path)
    print(f"exit codes {dict(sorted(codes.items()))}")
    assert findings == []
    assert codes[0] >= PLAIN // 4


@pytest.mark.long
@pytest.mark.timeout(0)
@pytest.mark.parametrize("part", range(PARTS))
def test_ten_thousand_structured_scenes(part, tmp_path, monkeypatch):
    monkeypatch.setenv("MPMCLI_DEBUG", "1")
    count = int(os.environ.get("MPMCLI_STRUCTURED", "10000")) // PARTS
    codes, findings = campaign(range(1000 + part * count, 1000 + (part + 1) * count), tmp_path)
    print(f"part {part}: exit codes {dict(sorted(codes.items()))}", flush=True)
    assert findings == []
