"""The commands of NairnMPM that are known: their attributes, texts, and the commands inside them.

Kinds of values: ``n`` number, ``i`` whole number, ``c`` coordinate (also ``min-``, ``max+2``), ``d`` distance (also
``*0.5``, in cells), ``e`` expression or number, ``t`` text, ``0`` none. ``!`` marks an attribute that is needed.
"""

from __future__ import annotations

from dataclasses import dataclass

SHAPES = "Rect Oval Polygon Sphere Box Cylinder Polyhedron Torus Shell Line Arc"
_BOX = "xmin:c xmax:c ymin:c ymax:c zmin:c zmax:c x1:c x2:c y1:c y2:c z1:c z2:c units:t axis:t radius:n tolerance:d"
_LINE = "x1:c! x2:c! y1:c! y2:c! z1:c z2:c tolerance:d units:t"
_BCS = "DisBC TempBC ConcBC LoadBC TractionBC HeatFluxBC ConcFluxBC net perParticle"
_VALUE = "value:n time:n ftime:n style:i function:e"
_LOAD = f"dir:i! load:n stress:n {_VALUE}"

# name: (attributes, kind of text, commands inside)
_TABLE: dict[str, tuple[str, str, str]] = {
    "JANFEAInput": (
        "version:t",
        "0",
        "Header MPMHeader Mesh MaterialPoints CrackList Material GridBCs ParticleBCs Thermal Gravity CustomTasks"
        " Schedule Periodic",
    ),
    "Header": ("", "0", "Description Analysis DevelFlag ConsistentUnits"),
    "Description": ("", "t", ""),
    "Analysis": ("", "i", ""),
    "DevelFlag": ("Number:i", "n", ""),
    "ConsistentUnits": ("length:t mass:t time:t", "0", ""),
    "MPMHeader": (
        "",
        "0",
        "MPMMethod MatlPtsPerElement Timing TimeFactor TransTimeFactor MaxTime TimeStep ArchiveGroup ArchiveTime"
        " FirstArchiveTime GlobalArchiveTime GlobalArchive Damping PDamping FeedbackDamping PFeedbackDamping XPIC"
        " Diffusion DefGradTerms ExtrapolateRigid SkipPostExtrapolation TrackParticleSpin TrackGradV ExactTractions"
        " GIMP MultiMaterialMode ArchiveRoot MPMArchiveOrder MPMArchive CrackArchiveOrder StressFreeTemp LeaveLimit"
        " DeleteLimit Cracks NeedsMechanics ProgSteps FractionFLIP PlusXPIC RestartScaling Poroelasticity",
    ),
    "MPMMethod": ("", "i", ""),
    "MatlPtsPerElement": ("", "i", ""),
    "Timing": ("CFL:n step:n max:n units:t TransCFL:n", "0", ""),
    "TimeFactor": ("", "n", ""),
    "TransTimeFactor": ("", "n", ""),
    "MaxTime": ("units:t", "n", ""),
    "TimeStep": ("units:t", "n", ""),
    "ArchiveGroup": ("time:n! start:n maxProps:i units:t", "0", ""),
    "ArchiveTime": ("units:t maxProps:i", "n", ""),
    "FirstArchiveTime": ("units:t", "n", ""),
    "GlobalArchiveTime": ("units:t", "n", ""),
    "GlobalArchive": ("type:t! material:i mat:i matname:t", "0", ""),
    "Damping": ("function:e PIC:n", "n?", ""),
    "PDamping": ("function:e PIC:n", "n?", ""),
    "FeedbackDamping": ("target:e max:n", "n", ""),
    "PFeedbackDamping": ("target:e max:n", "n", ""),
    "XPIC": ("order:i", "0", ""),
    "FractionFLIP": ("", "n", ""),
    "Diffusion": ("reference:n style:i", "0", ""),
    "Poroelasticity": ("reference:n", "0", ""),
    "DefGradTerms": ("", "i", ""),
    "ExtrapolateRigid": ("", "0", ""),
    "SkipPostExtrapolation": ("", "0", ""),
    "TrackParticleSpin": ("", "0", ""),
    "TrackGradV": ("", "0", ""),
    "ExactTractions": ("", "0", ""),
    "NeedsMechanics": ("", "0", ""),
    "RestartScaling": ("CFL:n", "n", ""),
    "PlusXPIC": ("", "0", ""),
    "ProgSteps": ("", "i", ""),
    "GIMP": ("type:t", "0", ""),
    "MultiMaterialMode": (
        "Vmin:n Dcheck:n Normals:n RigidBias:n Polar:n Azimuth:n Lumping:i Contact:i",
        "0",
        "Friction ContactPosition",
    ),
    "ArchiveRoot": ("unique:i", "t", ""),
    "MPMArchiveOrder": ("", "t", ""),
    "MPMArchive": ("result:t! setting:t", "0", ""),
    "CrackArchiveOrder": ("", "t", ""),
    "StressFreeTemp": ("", "n", ""),
    "LeaveLimit": ("", "i", ""),
    "DeleteLimit": ("", "i", ""),
    "Cracks": (
        "",
        "0",
        "Friction Propagate AltPropagate PropagateLength MovePlane ContactPosition CrackParticleSize JContour",
    ),
    "Friction": ("Dn:n Dnt:n Dnc:n Dt:n mat:i matname:t law:i lawname:t", "n?", ""),
    "Propagate": ("criterion:i direction:i traction:i", "0", ""),
    "AltPropagate": ("criterion:i direction:i traction:i", "0", ""),
    "PropagateLength": ("", "n", ""),
    "MovePlane": ("type:t prevent:t", "0", ""),
    "ContactPosition": ("", "n", ""),
    "CrackParticleSize": ("", "n", ""),
    "JContour": ("type:i size:i terms:i gridenergy:i", "0", ""),
    "Mesh": ("output:t", "0", "Grid NodeList ElementList"),
    "NodeList": ("number:i", "0", "pt"),
    "ElementList": ("number:i form:t", "0", "elem"),
    "elem": ("type:i matl:i angle:n thick:n", "t", ""),
    "Grid": (
        "xmin:n! xmax:n! ymin:n! ymax:n! zmin:n zmax:n type:i thickness:n units:t style:i",
        "0",
        "Horiz Vert Depth Border AreaOfInterest",
    ),
    "Horiz": ("nx:i rx:n cellsize:n symmin:n symmax:n", "0", ""),
    "Vert": ("ny:i ry:n cellsize:n symmin:n symmax:n", "0", ""),
    "Depth": ("nz:i rz:n cellsize:n symmin:n symmax:n", "0", ""),
    "Border": ("xmin:n xmax:n ymin:n ymax:n zmin:n zmax:n", "0", ""),
    "AreaOfInterest": ("", "0", ""),
    "MaterialPoints": ("", "0", "Body Hole BMP PointList Membrane"),
    "Membrane": ("", "0", ""),
    "Body": (
        "mat:i matname:t angle:n thick:n vx:n vy:n vz:n conc:n wtconc:n temp:n rpm:n",
        "0",
        f"RotateX RotateY RotateZ Unrotate vel0X vel0Y vel0Z ss0XX ss0YY ss0ZZ ss0XY ss0YZ ss0XZ Lp0X Lp0Y Lp0Z Deform"
        " Transform"
        f" {SHAPES}",
    ),
    "Hole": ("", "0", SHAPES),
    "Deform": (" ".join(f"d{a}{b}:e" for a in "XYZ" for b in "XYZ"), "0", ""),
    "Transform": ("angle:n tx:n ty:n ox:n oy:n", "0", ""),
    **{f"Rotate{axis}": ("", "e", "") for axis in "XYZ"},
    "Unrotate": ("", "0", ""),
    **{f"{word}0{axis}": ("", "e", "") for word in ("vel", "Lp") for axis in "XYZ"},
    **{f"ss0{axes}": ("", "e", "") for axes in ("XX", "YY", "ZZ", "XY", "YZ", "XZ")},
    **dict.fromkeys(("Rect", "Box", "Cylinder", "Sphere", "Torus", "Shell"), (_BOX, "0", SHAPES)),
    "Oval": (_BOX, "0", f"arc {SHAPES}"),
    "arc": ("start:n end:n", "0", ""),
    "Polygon": ("np:i units:t", "0", f"pt {SHAPES}"),
    "Polyhedron": ("units:t", "0", f"faces {SHAPES}"),
    "faces": ("style:t units:t", "t", ""),
    "Line": (
        "xmin:n! xmax:n! ymin:n! ymax:n! zmin:n zmax:n resolution:i start_tip:i end_tip:i mat:i matname:t units:t"
        " tolerance:d",
        "0",
        "",
    ),
    "Circle": (
        "xmin:n! xmax:n! ymin:n! ymax:n! resolution:i start_angle:n end_angle:n start_tip:i end_tip:i mat:i matname:t"
        " units:t",
        "0",
        "",
    ),
    "Arc": ("xmin:c! xmax:c! ymin:c! ymax:c! start:n end:n tolerance:d units:t", "0", ""),
    "pt": ("x:c! y:c! z:c tip:i mat:i matname:t units:t", "0", ""),
    "BMP": (
        "name:t! width:n height:n units:t angles:t anglesX:t anglesY:t anglesZ:t",
        "0",
        "Origin Intensity RotateX RotateY RotateZ Unrotate",
    ),
    "Origin": ("x:n y:n z:n units:t flipped:t", "0", ""),
    "Intensity": (
        "mat:i matname:t imin:i! imax:i! minAngle:n maxAngle:n",
        "0",
        "Angle Thickness vel Temperature Concentration",
    ),
    "Angle": ("", "n", ""),
    "Thickness": ("units:t", "n", ""),
    "Temperature": ("", "n", ""),
    "Concentration": ("", "n", ""),
    "vel": ("x:n y:n z:n units:t", "0", ""),
    "PointList": ("", "0", "mp"),
    "mp": (
        "elem:i mat:i matl:i matname:t angle:n thick:n conc:n wtconc:n temp:n lpx:n lpy:n lpz:n",
        "0",
        "pt vel mass",
    ),
    "mass": ("m:n! units:t", "0", ""),
    "CrackList": (
        "type:t friction:n Dn:n Dnt:n Dnc:n Dt:n law:i lawname:t",
        "0",
        "pt Line Circle Thickness Plane",
    ),
    "Plane": ("", "0", ""),
    "GridBCs": ("", "0", "DisplacementBCs BCLine BCArc BCBox BCShape LdRect"),
    "ParticleBCs": ("", "0", "LoadBCs BCLine BCArc BCBox BCShape LdRect"),
    "DisplacementBCs": ("", "0", "fix"),
    "fix": ("node:i dof:i style:i time:n angle:n angle2:n id:i", "t", ""),
    "LoadBCs": ("", "0", "load"),
    "load": ("pt:i dof:i style:i", "t", ""),
    "BCLine": (_LINE, "0", _BCS),
    "BCArc": (f"{_LINE} start:n end:n".replace("!", ""), "0", _BCS),
    "BCBox": (_BOX, "0", _BCS),
    "LdRect": (_BOX, "0", _BCS),
    "BCShape": ("", "0", f"{_BCS} {SHAPES}"),
    "DisBC": (f"dir:i! disp:n vel:n angle:n angle2:n id:i depth:i {_VALUE}", "0", ""),
    "TempBC": (_VALUE, "0", ""),
    "ConcBC": (_VALUE, "0", ""),
    "LoadBC": (_LOAD, "0", ""),
    "TractionBC": (f"{_LOAD} face:i", "0", ""),
    "HeatFluxBC": (f"{_LOAD} face:i bath:n", "0", ""),
    "ConcFluxBC": (f"{_LOAD} face:i bath:n", "0", ""),
    "net": ("", "0", ""),
    "perParticle": ("", "0", ""),
    "Thermal": (
        "",
        "0",
        "Conduction CrackTipHeating CrackContactHeating ContactHeating FrictionalHeating EnergyCoupling NoAVHeating"
        " ContactHeatFlow Isothermal",
    ),
    **dict.fromkeys(
        (
            "Conduction",
            "CrackTipHeating",
            "CrackContactHeating",
            "ContactHeating",
            "FrictionalHeating",
            "EnergyCoupling",
            "NoAVHeating",
            "ContactHeatFlow",
        ),
        ("", "0", ""),
    ),
    "Isothermal": ("time:n start:n", "n", ""),
    "Gravity": ("", "0", "BodyXForce BodyYForce BodyZForce GridBodyXForce GridBodyYForce GridBodyZForce"),
    **{f"Body{axis}Force": ("", "n", "") for axis in "XYZ"},
    **{f"GridBody{axis}Force": ("", "e", "") for axis in "XYZ"},
    "CustomTasks": ("", "0", "Schedule"),
    "Schedule": ("name:t!", "0", "Parameter"),
    "Parameter": ("name:t!", "t", ""),
    "Material": ("Type:i! Name:t!", "0", "*"),
    "Periodic": ("", "0", "*"),
}

FRACTURE = frozenset(
    (
        "KIc",
        "KIIc",
        "JIc",
        "JIIc",
        "KIexp",
        "KIIexp",
        "delIc",
        "delIIc",
        "nmix",
        "maxLength",
        "initTime",
        "speed",
        "xGrow",
        "yGrow",
        "constantTip",
        "gain",
        "p",
    )
)
"""Properties of materials that only the growth of cracks uses."""
TRANSPORT = frozenset(
    (
        "D",
        "Dx",
        "Dy",
        "Dz",
        "DA",
        "DT",
        "DR",
        "DZ",
        "csat",
        "beta",
        "betax",
        "betay",
        "betaz",
        "betaA",
        "betaT",
        "Cp",
        "Cv",
        "kCond",
    )
)
"""Properties of materials that only conduction and diffusion use."""

# properties of materials that are no numbers
PROPERTIES = {
    "Hardening": "t",
    "color": "0",
    "SettingFunction": "e",
    "SettingFunction2": "e",
    "SettingFunction3": "e",
    "ValueFunction": "e",
    "StressFunction": "e",
    "InitialPressure": "e",
    "ArtificialVisc": "t?",
    "SetTemperature": "0",
    "SetConcentration": "0",
    "IdealRubber": "0",
    "reversible": "0",
    "irreversible": "0",
    "Softening": "t",
    "Initiation": "t",
    "SofteningI": "t",
    "SofteningII": "t",
    "transition": "t",
}


@dataclass(frozen=True)
class Known:
    """What may stand in a command."""

    attributes: dict[str, str]
    needed: frozenset[str]
    text: str
    inside: frozenset[str]


def known(attributes: str, text: str, inside: str) -> Known:
    pairs = dict(word.rstrip("!").split(":") for word in attributes.split())
    needed = frozenset(word.split(":")[0] for word in attributes.split() if word.endswith("!"))
    return Known(pairs, needed, text, frozenset(inside.split()))


COMMANDS = {name: known(*row) for name, row in _TABLE.items()}
