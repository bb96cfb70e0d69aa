"""The commands of NairnMPM that are known: their attributes, texts, and the commands inside them.

Kinds of values: ``n`` number, ``i`` whole number, ``c`` coordinate (also ``min-``, ``max+2``), ``d`` distance (also
``*0.5``, in cells), ``e`` expression or number, ``t`` text, ``0`` none. Attributes with ``!`` are needed, those with
``~`` have no effect on a scene.
"""

from dataclasses import dataclass

from mpmcli.importers.base import NoteKind

SHAPES = "Rect Oval Polygon Sphere Box Cylinder Polyhedron Torus Shell Line Arc"
_BOX = "xmin:c xmax:c ymin:c ymax:c zmin:c zmax:c x1:c x2:c y1:c y2:c z1:c z2:c units:t axis:t radius:n tolerance:d"
_LINE = "x1:c! x2:c! y1:c! y2:c! z1:c~ z2:c~ tolerance:d units:t"
_BCS = "DisBC TempBC ConcBC LoadBC TractionBC HeatFluxBC ConcFluxBC net perParticle"
_VALUE = "value:n time:n ftime:n style:i function:e"
_LOAD = f"dir:i! load:n stress:n {_VALUE}"

_TABLE = f"""
JANFEAInput | 0 | version:t~ | Header MPMHeader Mesh MaterialPoints CrackList Material GridBCs ParticleBCs
    Thermal Gravity CustomTasks Schedule Periodic
Header | 0 | - | Description Analysis DevelFlag ConsistentUnits Processors
Description MPMArchiveOrder CrackArchiveOrder | t
Analysis MPMMethod MatlPtsPerElement DefGradTerms ProgSteps Processors LeaveLimit DeleteLimit | i
DevelFlag | n | Number:i
ConsistentUnits | 0 | length:t mass:t time:t
MPMHeader | 0 | - | MPMMethod MatlPtsPerElement Timing TimeFactor TransTimeFactor MaxTime TimeStep
    ArchiveGroup ArchiveTime FirstArchiveTime GlobalArchiveTime GlobalArchive Damping PDamping
    FeedbackDamping PFeedbackDamping XPIC Diffusion DefGradTerms ExtrapolateRigid SkipPostExtrapolation
    TrackParticleSpin TrackGradV ExactTractions GIMP MultiMaterialMode ArchiveRoot MPMArchiveOrder
    MPMArchive CrackArchiveOrder StressFreeTemp LeaveLimit DeleteLimit Cracks NeedsMechanics ProgSteps
    FractionFLIP PlusXPIC RestartScaling Poroelasticity
Timing | 0 | CFL:n step:n max:n units:t TransCFL:n
TimeFactor TransTimeFactor FractionFLIP StressFreeTemp PropagateLength ContactPosition CrackParticleSize
    Angle Temperature Concentration BodyXForce BodyYForce BodyZForce | n
MaxTime TimeStep FirstArchiveTime GlobalArchiveTime Thickness | n | units:t
ArchiveGroup | 0 | time:n! start:n maxProps:i~ units:t
ArchiveTime | n | units:t maxProps:i~
GlobalArchive | 0 | type:t! material:i mat:i matname:t
Damping PDamping | n? | function:e PIC:n
FeedbackDamping PFeedbackDamping | n | target:e max:n
XPIC | 0 | order:i
Diffusion | 0 | reference:n style:i
Poroelasticity | 0 | reference:n
ExtrapolateRigid SkipPostExtrapolation TrackParticleSpin TrackGradV ExactTractions NeedsMechanics PlusXPIC
    AreaOfInterest Membrane Unrotate Plane net perParticle Conduction CrackTipHeating CrackContactHeating
    ContactHeating FrictionalHeating EnergyCoupling NoAVHeating ContactHeatFlow | 0
RestartScaling | n | CFL:n
GIMP | 0 | type:t
MultiMaterialMode | 0 | Vmin:n Dcheck:n Normals:n RigidBias:n Polar:n Azimuth:n Lumping:i Contact:i~ |
    Friction ContactPosition
ArchiveRoot | t | unique:i
MPMArchive | 0 | result:t! setting:t~
Cracks | 0 | - | Friction Propagate AltPropagate PropagateLength MovePlane ContactPosition CrackParticleSize
    JContour
Friction | n? | Dn:n Dnt:n Dnc:n Dt:n mat:i matname:t law:i lawname:t
Propagate AltPropagate | 0 | criterion:i~ direction:i~ traction:i~
MovePlane | 0 | type:t prevent:t
JContour | 0 | type:i~ size:i terms:i gridenergy:i~
Mesh | 0 | output:t~ | Grid NodeList ElementList
NodeList | 0 | number:i | pt
ElementList | 0 | number:i form:t | elem
elem | t | type:i matl:i angle:n thick:n
Grid | 0 | xmin:n! xmax:n! ymin:n! ymax:n! zmin:n zmax:n type:i~ thickness:n units:t style:i~ | Horiz Vert
    Depth Border AreaOfInterest
Horiz | 0 | nx:i rx:n cellsize:n symmin:n symmax:n
Vert | 0 | ny:i ry:n cellsize:n symmin:n symmax:n
Depth | 0 | nz:i rz:n cellsize:n symmin:n symmax:n
Border | 0 | xmin:n xmax:n ymin:n ymax:n zmin:n zmax:n
MaterialPoints | 0 | - | Body Hole BMP PointList Membrane
Body | 0 | mat:i matname:t angle:n thick:n vx:n vy:n vz:n conc:n wtconc:n temp:n rpm:n | RotateX RotateY
    RotateZ Unrotate vel0X vel0Y vel0Z ss0XX ss0YY ss0ZZ ss0XY ss0YZ ss0XZ Lp0X Lp0Y Lp0Z Deform Transform
    {SHAPES}
Hole | 0 | - | {SHAPES}
Deform | 0 | dXX:e dXY:e dXZ:e dYX:e dYY:e dYZ:e dZX:e dZY:e dZZ:e
Transform | 0 | angle:n tx:n ty:n ox:n oy:n
RotateX RotateY RotateZ vel0X vel0Y vel0Z Lp0X Lp0Y Lp0Z ss0XX ss0YY ss0ZZ ss0XY ss0YZ ss0XZ GridBodyXForce
    GridBodyYForce GridBodyZForce | e
Box Cylinder Sphere Torus Shell | 0 | {_BOX} | {SHAPES}
Rect Oval | 0 | {_BOX} | arc {SHAPES}
arc | 0 | start:n end:n
Polygon | 0 | np:i~ units:t | pt {SHAPES}
Polyhedron | 0 | units:t | faces {SHAPES}
faces | t | style:t units:t
Line | 0 | xmin:n! xmax:n! ymin:n! ymax:n! zmin:n zmax:n resolution:i start_tip:i end_tip:i mat:i matname:t
    units:t tolerance:d
Circle | 0 | xmin:n! xmax:n! ymin:n! ymax:n! resolution:i start_angle:n end_angle:n start_tip:i end_tip:i
    mat:i matname:t units:t
Arc | 0 | xmin:c! xmax:c! ymin:c! ymax:c! start:n end:n tolerance:d units:t
pt | 0 | x:c! y:c! z:c~ tip:i mat:i matname:t units:t
BMP | 0 | name:t! width:n height:n units:t angles:t anglesX:t anglesY:t anglesZ:t | Origin Intensity RotateX
    RotateY RotateZ Unrotate
Origin | 0 | x:n y:n z:n~ units:t flipped:t
Intensity | 0 | mat:i matname:t imin:i! imax:i! minAngle:n maxAngle:n | Angle Thickness vel Temperature
    Concentration
vel | 0 | x:n y:n z:n~ units:t
PointList | 0 | - | mp
mp | 0 | elem:i~ mat:i matl:i matname:t angle:n thick:n conc:n wtconc:n temp:n lpx:n lpy:n lpz:n | pt vel
    mass
mass | 0 | m:n! units:t
CrackList | 0 | type:t friction:n Dn:n Dnt:n Dnc:n Dt:n law:i lawname:t | pt Line Circle Thickness Plane
GridBCs | 0 | - | DisplacementBCs BCLine BCArc BCBox BCShape LdRect
ParticleBCs | 0 | - | LoadBCs BCLine BCArc BCBox BCShape LdRect
DisplacementBCs | 0 | - | fix
fix | t | node:i dof:i style:i time:n angle:n angle2:n id:i
LoadBCs | 0 | - | load
load | t | pt:i dof:i style:i
BCLine | 0 | {_LINE} | {_BCS}
BCArc | 0 | x1:c x2:c y1:c y2:c z1:c z2:c tolerance:d units:t start:n end:n | {_BCS}
BCBox LdRect | 0 | {_BOX} | {_BCS}
BCShape | 0 | - | {_BCS} {SHAPES}
DisBC | 0 | dir:i! disp:n vel:n angle:n angle2:n id:i depth:i~ {_VALUE}
TempBC ConcBC | 0 | {_VALUE}
LoadBC | 0 | {_LOAD}
TractionBC | 0 | {_LOAD} face:i
HeatFluxBC ConcFluxBC | 0 | {_LOAD} face:i bath:n
Thermal | 0 | - | Conduction CrackTipHeating CrackContactHeating ContactHeating FrictionalHeating
    EnergyCoupling NoAVHeating ContactHeatFlow Isothermal
Isothermal | n | time:n start:n
Gravity | 0 | - | BodyXForce BodyYForce BodyZForce GridBodyXForce GridBodyYForce GridBodyZForce
CustomTasks | 0 | - | Schedule
Schedule | 0 | name:t!~ | Parameter
Parameter | t | name:t!
Material | 0 | Type:i!~ Name:t!~ | *
Periodic | 0 | - | *
"""
"""Names of commands with one rule | their text | attributes | commands inside them; lines go on indented."""

FRACTURE = (
    "KIc KIIc JIc JIIc KIexp KIIexp delIc delIIc nmix maxLength initTime speed xGrow yGrow constantTip gain p"
)
"""Properties of materials that only the growth of cracks uses."""
TRANSPORT = "D Dx Dy Dz DA DT DR DZ csat beta betax betay betaz betaA betaT Cp Cv kCond"
"""Properties of materials that only conduction and diffusion use."""
CONDUCTIVITIES = "kCondA kCondT kCondx kCondy kCondz kCondR kCondZ"
"""Conductivities along the axes of a material."""

_PROPERTIES = {
    "t": "Hardening Softening Initiation SofteningI SofteningII transition",
    "0": "color SetTemperature SetConcentration IdealRubber reversible irreversible",
    "e": "SettingFunction SettingFunction2 SettingFunction3 ValueFunction StressFunction InitialPressure function",
    "t?": "ArtificialVisc",
}
PROPERTIES = {name: kind for kind, names in _PROPERTIES.items() for name in names.split()}
"""Properties of materials that are no numbers."""


_NOTES: dict[NoteKind, dict[str, str]] = {
    "not_supported": {
        "ArtificialVisc avA1 avA2": "artificial viscosity of one material; method.artificial_viscosity acts on all",
        "ContactHeatFlow": "its conductances; heat.contact has one",
        "DisplacementBCs": "conditions on numbered nodes",
        "Djc n2jc": "a second rate term of Johnson-Cook",
        "IdealRubber": "heat of an ideal rubber",
        "InitialPressure xi function": "an initial pressure",
        "LoadBCs": "loads on numbered particles",
        "Membrane": "membranes",
        "Periodic": "periodic boundaries",
        "logshearrate": "a viscosity that depends on the rate",
        "mass": "masses of single points",
    },
    "changed": {
        "ContactPosition CrackParticleSize": "faces of cracks are separated by displacements",
        "ExtrapolateRigid": "rigid bodies prescribe the velocity of the nodes that they cover",
    },
    "ignored": {
        "ArchiveRoot": "mpmcli run -o names the folder of results",
        "Cm1 Cm2": "no moisture in this file",
        "DefGradTerms": "increments of deformation are exact exponentials",
        "FirstArchiveTime": "archives begin at time 0",
        "NeedsMechanics": "mechanics is always solved",
        "NoAVHeating": "there is no artificial viscosity",
        "Processors": "mpmcli run -j gives the number of threads",
        "ProgSteps": "progress is displayed always",
        "TransTimeFactor RestartScaling": "steps of conduction follow their own stability limit",
        "coefVariationMode": "nothing varies",
        "color": "a colour of plots",
        "largeRotation UJOption_": "large rotations are always taken into account",
    },
}
NOTES = {
    name: (kind, words)
    for kind, rows in _NOTES.items()
    for names, words in rows.items()
    for name in names.split()
}
"""What is noted of commands that no part of a translation reads."""


@dataclass(frozen=True)
class Known:
    """What may stand in a command."""

    attributes: dict[str, str]
    needed: frozenset[str]
    idle: frozenset[str]
    text: str
    inside: frozenset[str]


def known(text: str, attributes: str = "", inside: str = "") -> Known:
    """What may stand in a command, by the words of the table."""
    words = attributes.replace("-", "").split()
    pairs = dict(word.rstrip("!~").split(":") for word in words)
    needed, idle = (frozenset(word.split(":")[0] for word in words if mark in word) for mark in "!~")
    return Known(pairs, needed, idle, text, frozenset(inside.split()))


def _read_table() -> dict[str, Known]:
    found = {}
    for row in _TABLE.replace("\n    ", " ").strip().splitlines():
        names, *rules = row.split(" | ")
        found.update(dict.fromkeys(names.split(), known(*rules)))
    return found


COMMANDS = _read_table()
"""What may stand in each command."""
