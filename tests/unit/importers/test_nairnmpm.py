"""NairnMPM's commands one by one, broken sources, and mutated ones."""

import math
import random
import re
from pathlib import Path

import numpy as np
import pytest
from commands import spoken, unfit

from mpmcli.core.errors import SceneError
from mpmcli.importers.nairnmpm import expressions, translate
from mpmcli.importers.nairnmpm.commands import parse
from mpmcli.importers.nairnmpm.job import LEGACY
from mpmcli.importers.nairnmpm.language import run
from mpmcli.importers.scene_text import write
from mpmcli.materials.axes import rotation_matrix
from mpmcli.run.load import load
from mpmcli.scene.axes import start_axes
from mpmcli.scene.loader import load_scene
from mpmcli.scene.units import Units
from mpmcli.solver.simulation import Simulation

SOURCES = Path(__file__).parents[2] / "outside" / "nairnmpm" / "sources"

BODY = '<Body mat="1"><Rect xmin="0" xmax="4" ymin="0" ymax="4"/></Body>'
MATERIAL = '<Material Type="1" Name="Stuff"><rho>1</rho><E>100</E><nu>0.3</nu></Material>'
TIME = '<MaxTime units="ms">1</MaxTime>'


def source(
    *,
    head="",
    setup="",
    grid="",
    points=BODY,
    material=MATERIAL,
    more="",
    analysis=10,
    time=TIME,
    entities="",
):
    """A small source with some parts replaced."""
    return f"""<?xml version="1.0"?>
<!DOCTYPE JANFEAInput SYSTEM "NairnMPM.dtd" [{entities}]>
<JANFEAInput version="3">
<Header><Analysis>{analysis}</Analysis>{head}</Header>
<MPMHeader>{time}<GIMP/>{setup}</MPMHeader>
<Mesh><Grid xmin="-2" xmax="6" ymin="-2" ymax="6"{grid}><Horiz cellsize="1"/><Vert cellsize="1"/></Grid></Mesh>
<MaterialPoints>{points}</MaterialPoints>
{material}
{more}
</JANFEAInput>
"""


def translated(tmp_path, text, partial=False):
    path = tmp_path / "source.fmcmd"
    path.write_text(text)
    return translate(path, partial)


def sound(tmp_path, text):
    """The translation of a source, whose scene is valid and lacks nothing."""
    made = translated(tmp_path, text)
    assert made.problems(partial=False) == []
    load(write(made))
    return made


def scene_of(tmp_path, **parts):
    return sound(tmp_path, source(**parts)).scene


def assert_refused(tmp_path, words, **parts):
    problems = translated(tmp_path, source(**parts)).problems(partial=False)
    assert any(words in str(problem) for problem in problems), problems


# ------------------------------------------------------------------ expressions


@pytest.mark.parametrize(
    ("theirs", "values"),
    [
        ("sign(t-1)", {0.5: 0, 1.0: 0, 2.0: 1}),
        ("sgn(t-1)", {0.5: -1, 1.0: 0, 2.0: 1}),
        ("2^3^2", {0.0: 64}),
        ("-t^2", {3.0: -9}),
        ("ramp(5,t/2)", {-1.0: 0, 1.0: 2.5, 3.0: 5}),
        ("box(5,t)", {0.5: 5, 1.5: 0}),
        ("cosramp(2,t)", {0.5: 1, 2.0: 2}),
        ("sinbox(2,t)", {0.5: 2, 1.5: 0}),
        ("mod(t,2)", {5.0: 1, -5.0: -1}),
        ("tri(t)", {0.25: 0.75, 2.0: 0}),
        ("int(t)+erfc(0)", {1.5: 2}),
        ("2*sin(Pi*t)/4", {0.5: 0.5}),
    ],
)
def test_expressions_have_the_values_of_nairnmpm(theirs, values):
    from mpmcli.core.expressions import Expression

    ours = Expression(expressions.translate(theirs), {}, ("t",))
    for t, value in values.items():
        assert float(ours(t=t)) == pytest.approx(value)


@pytest.mark.parametrize(
    "text", ["", "1+", "2(3)", "sin 3", "q*t", "dt", "rand(1)", "(" * 99, "1" * 3000, "a.b", "t t"]
)
def test_expressions_that_cannot_be_translated(text):
    with pytest.raises(expressions.NotTranslated):
        expressions.translate(text)


# ------------------------------------------------------------ commands, one by one


def test_legacy_units(tmp_path):
    scene = scene_of(
        tmp_path,
        setup="<Damping>500</Damping>",
        time="<MaxTime>2e-3</MaxTime><TimeStep>1e-6</TimeStep>",
        more="<Gravity><BodyYForce>-9810</BodyYForce></Gravity>",
        material=MATERIAL.replace("<rho>1<", "<rho>1.5<"),
    )
    assert scene["units"] == {"length": "mm", "mass": "g", "time": "ms"}
    assert scene["time"] == {"end": 2, "step": 0.001}
    assert scene["method"]["damping"] == {"grid": 0.5}
    assert scene["loads"][0]["acceleration"] == [0, -9.81e-3]
    loaded = load(write(translated(tmp_path, source(material=MATERIAL.replace("<rho>1<", "<rho>1.5<")))))
    assert loaded.scene.materials["stuff"].density == pytest.approx(1.5e-3)


def test_consistent_units(tmp_path):
    scene = scene_of(
        tmp_path, head='<ConsistentUnits length="m" mass="kg" time="sec"/>', time="<MaxTime>0.01</MaxTime>"
    )
    assert scene["units"] == {"length": "m", "mass": "kg", "time": "s"}
    assert scene["materials"]["stuff"]["density"] == 1
    assert scene["time"]["end"] == 0.01
    assert "units" not in scene_of(tmp_path, head="<ConsistentUnits/>")


@pytest.mark.parametrize(
    ("words", "shape", "update"),
    [
        ("<MPMMethod>0</MPMMethod>", "ugimp", "usf"),
        ("<MPMMethod>3</MPMMethod><SkipPostExtrapolation/>", "ugimp", "usl"),
        ('<MPMMethod>2</MPMMethod><GIMP type="lCPDI"/>', "lcpdi", "usavg+"),
        ('<GIMP type="Classic"/>', "linear", "usavg+"),
    ],
)
def test_methods(tmp_path, words, shape, update):
    method = scene_of(tmp_path, setup=words)["method"]
    assert (method["shape"], method["update"]) == (shape, update)


def test_shapes_holes_and_nested_shapes(tmp_path):
    points = """<Hole><Oval xmin="1" xmax="3" ymin="1" ymax="3"/></Hole>
      <Body mat="1"><Rect xmin="0" xmax="4" ymin="0" ymax="4"><Oval xmin="0" xmax="1" ymin="0" ymax="2"/></Rect></Body>
      <Body mat="1" vx="10"><vel0Y>100*x</vel0Y>
        <Polygon><pt x="4" y="0"/><pt x="5" y="0"/><pt x="5" y="4"/><pt x="4" y="4"/></Polygon></Body>"""
    bodies = scene_of(tmp_path, points=points)["bodies"]
    assert [body["name"] for body in bodies] == ["stuff_left", "stuff_right"]
    assert bodies[0]["region"]["subtract"][0] == {"kind": "disk", "center": [2, 2], "radius": 1}
    assert bodies[0]["region"]["region"]["subtract"][0]["kind"] == "ellipse"
    assert bodies[1]["region"]["points"][2] == [5, 4]
    assert bodies[1]["velocity"] == [0.01, "0.1*x"]


POINT = '<PointList><mp mat="1"{}><pt x="5.25" y="5.25"/></mp></PointList>'


@pytest.mark.parametrize(
    ("grid", "one", "other", "thickness"),
    [
        ("", "", "", None),
        (' thickness="3"', "", "", 3),
        ("", ' thick="2"', ' thick="2"', 2),
        (' thickness="2"', "", ' thick="2"', 2),
        (' thickness="3"', ' thick="2"', ' thick="2"', 2),
        (' thickness="3"', ' thick="2"', "", "thickness 3, another than that of the bodies before"),
        ("", "", ' thick="2"', "thickness 2, another than that of the bodies before"),
    ],
)
def test_bodies_without_a_thickness_have_that_of_the_grid(tmp_path, grid, one, other, thickness):
    points = BODY.replace('mat="1"', f'mat="1"{one}') + POINT.format(other)
    made = translated(tmp_path, source(points=points, grid=grid))
    problems = [str(problem) for problem in made.problems(partial=False)]
    if isinstance(thickness, str):
        assert [thickness in problem for problem in problems] == [True]
        return
    assert problems == []
    assert made.scene["analysis"].get("thickness") == thickness


def test_overlapping_bodies_keep_the_first(tmp_path):
    bodies = scene_of(tmp_path, points=BODY + BODY.replace('xmax="4"', 'xmax="5"'))["bodies"]
    assert bodies[1]["overlap"] == "keep"


def test_a_picture_and_points(tmp_path):
    from PIL import Image

    Image.new("L", (8, 8), 200).save(tmp_path / "grey.bmp")
    points = """<BMP name="grey.bmp" width="4" height="4"><Origin x="0" y="0"/>
      <Intensity mat="1" imin="0" imax="100"/><Intensity mat="2" imin="101" imax="255"><vel x="5"/></Intensity></BMP>
      <PointList><mp elem="1" mat="1"><pt x="5.25" y="0.25"/><vel x="1000" y="0"/></mp></PointList>"""
    other = MATERIAL.replace("Stuff", "Other")
    made = translated(tmp_path, source(points=points, material=MATERIAL + other))
    assert made.problems(partial=False) == []
    bodies = made.scene["bodies"]
    assert bodies[1]["region"] == {
        "kind": "bitmap",
        "file": "grey.bmp",
        "size": [4, 4],
        "origin": [0, 0],
        "levels": [101, 255],
    }
    assert bodies[2]["velocity"] == [1, 0]
    assert made.files["points_1.csv"].splitlines() == ["x,y,volume", "5.25,0.25,0.25"]
    assert made.files["grey.bmp"].startswith(b"BM")


def material_of(tmp_path, kind, words):
    text = f'<Material Type="{kind}" Name="Stuff"><rho>1</rho>{words}</Material>'
    return scene_of(tmp_path, material=text)["materials"]["stuff"]


@pytest.mark.parametrize(
    ("kind", "words", "expected"),
    [
        (1, "<G>40</G><nu>0.25</nu>", {"kind": "linear_elastic", "E": 100, "nu": 0.25}),
        (8, "<K>100</K><G1>30</G1>", {"kind": "neo_hookean", "K": 100, "G": 30, "split": "isochoric"}),
        (8, "<K>100</K><G1>30</G1><G2>10</G2>", {"kind": "mooney_rivlin", "G1": 30, "G2": 10, "K": 100}),
        (28, "<E>100</E><nu>0.3</nu><UJOption>2</UJOption>", {"kind": "neo_hookean", "volumetric": "log"}),
        (
            7,
            "<K>100</K><G0>20</G0><ntaus>1</ntaus><Gk>30</Gk><tauk>2e-3</tauk>",
            {"kind": "viscoelastic", "G": 20, "terms": [{"time": "0.002 s", "G": 30}]},
        ),
        (27, "<K>2000</K>", {"kind": "tait_fluid", "K": 2000}),
        (
            25,
            "<C0>4000</C0><S1>1.2</S1><gamma0>1.5</gamma0><G>50</G>",
            {"kind": "mie_gruneisen", "C0": 4000, "G": 50},
        ),
        (
            2,
            "<EA>9</EA><ET>3</ET><GA>2</GA><nuA>.2</nuA><nuT>.3</nuT>",
            {"kind": "transversely_isotropic", "axis": "z"},
        ),
        (
            29,
            "<E>9</E><nu>.2</nu><CritComp>.02</CritComp><xihard>5</xihard><Elastic>1</Elastic>",
            {"kind": "clamped_neo_hookean", "compression": 0.02, "hardening": 5},
        ),
        (
            50,
            "<E>100</E><nu>.2</nu><largeRotation>1</largeRotation><sigmac>2</sigmac><I-Gc>900</I-Gc>",
            {"kind": "isotropic_softening", "strength": 2, "toughness": "900 J/m^2"},
        ),
        (
            50,
            "<E>100</E><nu>.2</nu><sigmac>2</sigmac><I-Gc>900</I-Gc><SofteningI>Exponential</SofteningI>",
            {"kind": "isotropic_softening", "softening": "exponential"},
        ),
    ],
)
def test_materials(tmp_path, kind, words, expected):
    made = material_of(tmp_path, kind, words)
    assert {key: made[key] for key in expected} == expected


ORTHOTROPIC = (
    "<Ex>9</Ex><Ey>8</Ey><Ez>7</Ez><Gxy>3</Gxy><Gxz>3</Gxz><Gyz>3</Gyz>"
    "<nuxy>.3</nuxy><nuxz>.3</nuxz><nuyz>.3</nuyz>"
)
FIBRES = "<EA>9</EA><ET>3</ET><GA>2</GA><nuA>.2</nuA><nuT>.3</nuT>"


@pytest.mark.parametrize(
    ("attribute", "words", "expected"),
    [
        ('angle="30"', "", [{"angle": -30}]),
        ('angle="30"', "<RotateZ>10*x</RotateZ>", [{"angle": "-(10*x)"}]),
        ("", "<RotateZ>-20</RotateZ>", [{"angle": 20}]),
        (
            "",
            "<RotateZ>20</RotateZ><Unrotate/><RotateZ>5</RotateZ><RotateZ>6</RotateZ>",
            [{"angle": -6}, {"angle": -5}],
        ),
        ("", "", None),
    ],
)
def test_axes_turn_clockwise(tmp_path, attribute, words, expected):
    body = BODY.replace('mat="1"', f'mat="1" {attribute}').replace("<Rect", f"{words}<Rect")
    material = f'<Material Type="3" Name="Stuff"><rho>1</rho>{FIBRES}</Material>'
    scene = scene_of(tmp_path, points=body.replace("</Body>", "<Unrotate/></Body>"), material=material)
    assert scene["bodies"][0].get("axes") == expected
    scene = scene_of(tmp_path, points=body)
    assert "axes" not in scene["bodies"][0]


def test_axes_in_space_are_those_of_nairnmpm(tmp_path):
    """Its matrix from material axes to those of the grid is Rz Ry Rx, each of them clockwise."""
    angles = {"Z": 20.0, "Y": -35.0, "X": 50.0}
    words = "".join(f"<Rotate{axis}>{angle}</Rotate{axis}>" for axis, angle in angles.items())
    text = source(
        analysis=12,
        grid=' zmin="-2" zmax="6"',
        points=f'<Body mat="1">{words}<Box xmin="0" xmax="1" ymin="0" ymax="1" zmin="0" zmax="1"/></Body>',
        material=f'<Material Type="2" Name="Stuff"><rho>1</rho>{FIBRES}</Material>',
    ).replace("</Grid>", '<Depth cellsize="1"/></Grid>')
    made = translated(tmp_path, text)
    assert made.problems(partial=False) == []
    q, problems = start_axes(load(write(made)).scene.bodies[0], np.zeros((3, 1)))
    assert problems == []
    z, y, x = np.radians(list(angles.values()))
    cx, cy, cz, sx, sy, sz = *np.cos([x, y, z]), *np.sin([x, y, z])
    theirs = [
        [cy * cz, cz * sx * sy + cx * sz, -cx * cz * sy + sx * sz],
        [-cy * sz, cx * cz - sx * sy * sz, cz * sx + cx * sy * sz],
        [sy, -cy * sx, cx * cy],
    ]
    assert np.array(rotation_matrix(q)).reshape(3, 3) == pytest.approx(np.array(theirs))


def test_hill_plasticity(tmp_path):
    elastic = (
        "<Ex>9</Ex><Ey>8</Ey><Ez>7</Ez><Gxy>3</Gxy><Gxz>3</Gxz><Gyz>3</Gyz><nuxy>.3</nuxy><nuxz>.3</nuxz>"
    )
    yields = "<yldxx>2</yldxx><yldyy>3</yldyy><yldzz>2.5</yldzz>"
    words = f"{elastic}<nuyz>.3</nuyz>{yields}<Khard>4</Khard><nhard>.5</nhard>"
    made = material_of(tmp_path, 15, f"{words}<yldxy>1</yldxy>")
    assert made["hardening"] == {"kind": "power_law", "yield_stress": 2, "B": 8, "n": 0.5}
    ratios = made["anisotropy"]
    assert (ratios["R22"], ratios["R33"]) == (1.5, 1.25)
    assert ratios["R12"] == pytest.approx(3**0.5 / 2)
    material = f'<Material Type="15" Name="A"><rho>1</rho>{words}</Material>'
    assert_refused(tmp_path, "without bound: yldxy", material=material)


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("<yield>5</yield><Khard>2</Khard>", {"kind": "linear", "yield_stress": 5, "modulus": 10}),
        ("<yield>5</yield><ET>50</ET>", {"kind": "linear", "yield_stress": 5, "modulus": 100}),
        (
            "<Hardening>Nonlinear</Hardening><yield>5</yield><Khard>4</Khard><nhard>.5</nhard>",
            {"kind": "swift", "yield_stress": 5, "eps0": 0.25, "n": 0.5},
        ),
        (
            "<Hardening>6</Hardening><yield>5</yield><Khard>4</Khard><nhard>.5</nhard>",
            {"kind": "power_law", "yield_stress": 5, "B": 20, "n": 0.5},
        ),
        (
            "<Hardening>3</Hardening><Ajc>90</Ajc><Bjc>292</Bjc><njc>.31</njc><Cjc>.025</Cjc><mjc>1</mjc>",
            {"kind": "johnson_cook", "A": 90, "B": 292, "n": 0.31, "C": 0.025, "eps0_dot": "1 1/s"},
        ),
    ],
)
def test_hardening(tmp_path, words, expected):
    assert material_of(tmp_path, 9, f"<E>100</E><nu>0.3</nu>{words}")["hardening"] == expected


def test_friction_of_pairs_and_laws(tmp_path):
    setup = '<MultiMaterialMode Normals="4" Azimuth="90"><Friction lawname="Rough"/></MultiMaterialMode>'
    pair = MATERIAL.replace("</Mat", '<Friction Dnt="9" Dnc="-1" Dt="3" matname="Other">11</Friction></Mat')
    law = '<Material Type="61" Name="Rough"><coeff>0.3</coeff></Material>'
    points = BODY + BODY.replace('mat="1"', 'matname="Other"').replace(
        'xmin="0" xmax="4"', 'xmin="4" xmax="5"'
    )
    points = points.replace('mat="1"', 'matname="Stuff"')
    scene = scene_of(
        tmp_path, setup=setup, points=points, material=pair + MATERIAL.replace("Stuff", "Other") + law
    )
    assert scene["contact"]["law"] == {"kind": "coulomb", "friction": 0.3}
    assert scene["contact"]["normal"] == {"kind": "specified", "azimuth": 90}
    assert scene["contact"]["pairs"] == [
        {
            "between": ["stuff", "other"],
            "law": {"kind": "bilinear_interface", "tension": 9, "compression": "perfect", "tangential": 3},
        }
    ]


TOOL = (
    BODY.replace('mat="1"', 'matname="Stuff"')
    + '<Body matname="Tool" vx="20" vy="30" temp="0"><Rect xmin="4" xmax="5" ymin="0" ymax="4"/></Body>'
)


@pytest.mark.parametrize(
    ("words", "held", "velocity"),
    [
        ("<SetDirection>1</SetDirection>", {"x": 0.02}, [0.02, 0.03]),
        ("<SetDirection>3</SetDirection>", {"x": 0.02, "y": 0.03}, [0.02, 0.03]),
        (
            "<SetDirection>3</SetDirection><SettingFunction>5*t</SettingFunction>",
            {"x": "0.005*t"},
            ["0.005*t", 0.03],
        ),
        (
            "<SetDirection>2</SetDirection><SettingFunction>-5</SettingFunction>",
            {"y": -0.005},
            [0.02, -0.005],
        ),
    ],
)
def test_rigid_materials_that_prescribe_velocities(tmp_path, words, held, velocity):
    """Directions without a function are free once there is one, as in NairnMPM."""
    tool = f'<Material Type="11" Name="Tool">{words}</Material>'
    setup = '<GlobalArchive type="temp" matname="Tool"/><GlobalArchive type="sxx"/>'
    scene = scene_of(
        tmp_path, setup=f"<ArchiveTime>1e-4</ArchiveTime>{setup}", points=TOOL, material=MATERIAL + tool
    )
    assert scene["materials"]["tool"] == {"kind": "rigid"}
    assert scene["bodies"][1]["velocity"] == velocity
    assert {c["direction"]: c["value"] for c in scene["boundary"]} == held
    assert all(c["on"] == {"covered_by": "tool"} for c in scene["boundary"])
    assert scene["archive"]["globals"]["columns"] == ["stress_xx[stuff]"]
    assert "temperature" not in scene["bodies"][1]


@pytest.mark.parametrize("words", ["<SetDirection>0</SetDirection>", "<SetDirection>4</SetDirection>", ""])
@pytest.mark.parametrize("setup", ["", "<MultiMaterialMode/>"])
def test_rigid_materials_that_hold_nothing(tmp_path, words, setup):
    """Such bodies have no effect, neither by conditions nor by contact."""
    tool = f'\n<Material Type="11" Name="Tool"><rho>1</rho>{words}</Material>'
    made = sound(tmp_path, source(setup=setup, points=TOOL, material=MATERIAL + tool))
    assert list(made.scene["materials"]) == ["stuff"]
    assert [body["name"] for body in made.scene["bodies"]] == ["stuff"]
    assert {"contact", "boundary"}.isdisjoint(made.scene)
    words = "line 9: <Material>: rigid bodies that hold no direction have no effect"
    assert words in [str(note) for note in made.of_kind("ignored")]


def test_names_without_letters(tmp_path):
    scene = scene_of(tmp_path, material=MATERIAL.replace("Stuff", ""))
    assert [body["material"] for body in scene["bodies"]] == list(scene["materials"])


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"points": BODY.replace('xmax="4"', 'xmax="0"')}, r":7 +bodies\.stuff\.region"),
        ({"material": MATERIAL.replace("0.3", "0.7")}, r":8 +materials\.stuff\.nu +0\.7 is out of range"),
        ({"material": MATERIAL.replace("<rho>1<", "<rho>&heavy;<"), "entities": '<!ENTITY heavy "-2">'},
         r":8 +materials\.stuff\.density +-0\.002 is out of range"),
        ({"material": MATERIAL.replace('1" ', '24" ').replace("<E>", "<yield>-1</yield><E>")},
         r":8 +materials\.stuff\.hardening\.yield_stress"),
    ],
)  # fmt: skip
def test_faults_of_the_scene_stand_at_lines_of_the_source(parts, words, tmp_path):
    path, scene = tmp_path / "x.fmcmd", tmp_path / "x.yaml"
    path.write_text(source(**parts))
    code, written, _ = spoken(["import", "nairnmpm", str(path), "-o", str(scene)])
    assert code == 3
    assert re.search(rf"x\.fmcmd{words}.*\({re.escape(str(scene))}, line \d+\)", written), written


def test_conditions_by_style(tmp_path):
    conditions = """<GridBCs>
      <BCLine x1="0" x2="0" y1="min-" y2="max+" tolerance=".1">
        <DisBC dir="1" style="2" vel="10"/><DisBC dir="2" style="3" vel="10" time="2"/></BCLine>
      <BCLine x1="0" x2="4" y1="0" y2="4"><DisBC dir="1" style="6" function="x*t"/></BCLine>
      <BCShape><Oval xmin="0" xmax="4" ymin="0" ymax="4"/><DisBC dir="12" vel="0"/></BCShape>
    </GridBCs>"""
    boundary = scene_of(tmp_path, more=conditions)["boundary"]
    assert [c["value"] for c in boundary] == ["0.01*t", "0.01*sin(2*t)", "0.001*(x*t)", 0]
    assert boundary[0]["on"] == {"box": {"lower": [0, -3], "upper": [0, 7]}}
    assert boundary[2]["on"]["region"]["kind"] == "polygon"
    assert boundary[3]["on"]["region"] == {"kind": "disk", "center": [2, 2], "radius": 2}


PULL = """<ParticleBCs><BCLine x1="0" x2="4" y1="4" y2="4" tolerance="*.3"><net/>
  <LoadBC dir="2" style="2" load="3"/></BCLine></ParticleBCs>"""


@pytest.mark.parametrize(
    ("xmin", "size", "upper", "cell"),
    [(-2, 'nx="8"', 6, 1), (-2, 'nx="16"', 6, [0.5, 1]), (-1, 'cellsize="1"', 6, 1), (-2, 'nx="5"', 0, 0)],
)
def test_cells_of_axisymmetric_grids_keep_their_size(tmp_path, xmin, size, upper, cell):
    """The part of the grid with r < 0 is cut off; NairnMPM, too, needs a line of the grid at r = 0."""
    text = source(analysis=13).replace('xmin="-2"', f'xmin="{xmin}"', 1)
    text = text.replace('<Horiz cellsize="1"', f"<Horiz {size}")
    if not cell:
        [problem] = translated(tmp_path, text).problems(partial=False)
        assert "r = 0 is not at a line of the grid" in str(problem)
        return
    grid = sound(tmp_path, text).scene["grid"]
    assert (grid["lower"], grid["upper"], grid["cell"]) == ([0, -2], [upper, 6], cell)


def test_axisymmetric_forces_are_those_on_the_ring(tmp_path):
    scene = scene_of(tmp_path, analysis=13, more=PULL)
    assert scene["grid"]["lower"] == [0, -2]
    assert scene["loads"][0]["force"] == [0, "2*pi*(3*t)"]


def reverse_load(**parameters):
    words = "".join(
        f'<Parameter name="{name.replace("_", " ")}">{v}</Parameter>' for name, v in parameters.items()
    )
    return f'<CustomTasks><Schedule name="ReverseLoad">{words}</Schedule></CustomTasks>'


@pytest.mark.parametrize(
    ("parameters", "event"),
    [
        ({"global_syy": 0, "maxValue": 2.5}, {"when": "stress_yy[stuff] >= 2.5", "do": "reverse"}),
        ({"global_syy": 0, "maxValue": -2.5, "style": 1}, {"when": "stress_yy[stuff] <= -2.5", "do": "hold"}),
        ({"global_syy": 0, "maxValue": -2.5, "style": "Hold"},
         {"when": "stress_yy[stuff] <= -2.5", "do": "hold"}),
        ({"global_Kinetic Energy": 0, "maxValue": 0.1, "style": 1},
         {"when": "kinetic_energy >= 100", "do": "hold"}),
    ],
)  # fmt: skip
def test_loads_reverse_or_hold(tmp_path, parameters, event):
    scene = scene_of(tmp_path, more=PULL + reverse_load(**parameters))
    assert scene["events"] == [{"name": "reversal", **event, "to": ["load_1"]}]


def test_rigid_bodies_reverse_with_what_they_hold(tmp_path):
    tool = '<Material Type="11" Name="Tool"><SetDirection>1</SetDirection></Material>'
    scene = scene_of(
        tmp_path, points=TOOL, material=MATERIAL + tool, more=reverse_load(global_velx=0, maxValue=50)
    )
    assert scene["events"][0]["when"] == "velocity_x[stuff] >= 0.05"
    assert scene["events"][0]["to"] == ["tool", "tool_x"]


def test_a_run_ends_at_a_value(tmp_path):
    scene = scene_of(tmp_path, more=PULL + reverse_load(global_syy=0, maxValue=2, style=3))
    assert scene == scene_of(tmp_path, more=PULL + reverse_load(global_syy=0, maxValue=2, style="abort"))
    assert_refused(tmp_path, "the style 'never'", more=PULL + reverse_load(global_syy=0, style="never"))
    assert scene["time"]["stop_when"] == "stress_yy[stuff] >= 2"
    assert "events" not in scene


CRACK = '<CrackList><pt x="-0.5" y="2.1" tip="-2"/><pt x="2" y="2.1" tip="1"/></CrackList>'
BRITTLE = MATERIAL.replace("</Mat", "<JIc>200</JIc></Mat")
GROWS = '<Cracks><Propagate criterion="7" direction="1"/></Cracks>'


def test_loads_reverse_when_a_crack_is_long(tmp_path):
    more = CRACK + PULL + reverse_load(crackNumber=1, maxLength=3)
    scene = scene_of(tmp_path, setup=GROWS, material=BRITTLE, more=more)
    assert scene["events"][0]["when"] == f"crack_length[{scene['cracks'][0]['name']}] > 3"
    assert_refused(tmp_path, "parameter 'other'", more=PULL + reverse_load(global_sxx=0, other=3))


def test_initial_stress(tmp_path):
    words = "<ss0XX>-2</ss0XX><ss0YY>-3*y</ss0YY><ss0XY>0</ss0XY>"
    body = scene_of(tmp_path, points=BODY.replace("<Rect", f"{words}<Rect"))["bodies"][0]
    assert body["stress"] == {"kind": "components", "xx": -2, "yy": "-3*y"}


def test_damping_of_the_only_material(tmp_path):
    text = MATERIAL.replace("</Mat", '<PDamping function="100*t">1</PDamping></Mat')
    assert scene_of(tmp_path, material=text)["method"]["damping"] == {"particle": "0.1*t"}


@pytest.mark.parametrize(("x", "axis", "side"), [("3.75", "x", "upper"), ("0.25", "x", "lower")])
def test_silent_conditions_absorb(tmp_path, x, axis, side):
    condition = f"""<ParticleBCs><BCLine x1="{x}" x2="{x}" y1="0" y2="4" tolerance=".1">
      <LoadBC dir="1" style="5" load="0"/></BCLine></ParticleBCs>"""
    face = {"body": "stuff", "face": {"axis": axis, "side": side}}
    loads = scene_of(tmp_path, more=condition)["loads"]
    assert loads == [{"name": "absorbing_stuff", "kind": "absorbing", "on": face}]
    assert_refused(tmp_path, "silent", more=condition.replace(x, "2.25"))


def test_relaxation_shifts_with_temperature(tmp_path):
    terms = "<K>100</K><G0>20</G0><ntaus>1</ntaus><Gk>30</Gk><tauk>2e-3</tauk>"
    text = f'<Material Type="7" Name="Stuff"><rho>1</rho>{terms}<Tref>320</Tref><C1>15</C1></Material>'
    scene = scene_of(tmp_path, setup="<StressFreeTemp>300</StressFreeTemp>", material=text)
    assert scene["materials"]["stuff"]["wlf"] == {"C1": 15, "T_ref": 320}
    assert scene["materials"]["stuff"]["T0"] == 300
    assert_refused(tmp_path, "StressFreeTemp", material=text)


def test_a_crack_that_slides_first_is_not_supported(tmp_path):
    words = "<E>100</E><nu>.2</nu><sigmac>2</sigmac><tauc>1</tauc><I-Gc>900</I-Gc>"
    material = f'<Material Type="50" Name="Stuff"><rho>1</rho>{words}</Material>'
    assert_refused(tmp_path, "tauc", material=material)


def test_heat(tmp_path):
    scene = scene_of(
        tmp_path,
        setup="<StressFreeTemp>300</StressFreeTemp>",
        points=BODY.replace('mat="1"', 'mat="1" temp="350"'),
        material=MATERIAL.replace("</Mat", "<alpha>60</alpha><Cv>400</Cv><kCond>2</kCond></Mat"),
        more="<Thermal><Conduction/><EnergyCoupling/></Thermal>",
    )
    assert scene["heat"] == {}
    assert scene["method"]["heating"] == "adiabatic"
    stuff = scene["materials"]["stuff"]
    assert stuff["expansion"] == pytest.approx(60e-6)
    assert (stuff["heat_capacity"], stuff["conductivity"], stuff["T0"]) == (400, "2 W/(m K)", 300)
    assert scene["bodies"][0]["temperature"] == 350


def test_conductivities_are_left_out_where_nothing_conducts(tmp_path):
    setup = (
        '<StressFreeTemp>300</StressFreeTemp><MPMArchive result="pressure"/><ArchiveTime>1e-4</ArchiveTime>'
    )
    material = MATERIAL.replace("</Mat", "<Cv>400</Cv><kCond>2</kCond></Mat")
    heat = "<Thermal><EnergyCoupling/></Thermal>"
    made = sound(tmp_path, source(setup=setup, material=material, more=heat))
    assert "conductivity" not in made.scene["materials"]["stuff"]
    assert any("nothing conducts heat" in str(note) for note in made.notes)
    assert "pressure" in made.scene["archive"]["particles"]["fields"]
    assert load(write(made)).warnings == []


def test_growth_of_cracks(tmp_path):
    setup = GROWS.replace("</Cracks>", '<Friction>0.2</Friction><MovePlane type="cm"/></Cracks>')
    crack = scene_of(tmp_path, setup=setup, material=BRITTLE, more=CRACK)["cracks"][0]
    assert crack["ends"] == {"start": "mouth"}
    assert crack["faces"] == {"law": {"kind": "coulomb", "friction": 0.2}}
    assert crack["growth"]["end"]["criterion"] == {"kind": "energy_release_rate", "J_c": "200 J/m^2"}
    assert crack["moves"] == "mass"


TOUGH = BRITTLE.replace("Stuff", "Tough").replace("<JIc>200<", "<JIc>900<")
HALVES = (
    BODY.replace('xmax="4"', 'xmax="2"')
    + BODY.replace('xmin="0"', 'xmin="2"').replace('mat="1"', 'mat="2"')
)  # fmt: skip


@pytest.mark.parametrize(
    ("points", "tips", "expected"),
    [
        (HALVES, (1, 2), {"start": 200, "end": 900}),
        (HALVES, (-1, 2), {"end": 900}),
        (HALVES.replace('mat="2"', 'matname="Tough"'), (-1, 1), {"end": 900}),  # names are numbered first
    ],
)
def test_tips_grow_as_their_materials(tmp_path, points, tips, expected):
    path = '<CrackList><pt x="1" y="2" tip="{}"/><pt x="3" y="2" tip="{}"/></CrackList>'.format(*tips)
    scene = scene_of(tmp_path, setup=GROWS, points=points, material=BRITTLE + TOUGH, more=path)
    growth = scene["cracks"][0]["growth"]
    assert {end: made["criterion"]["J_c"] for end, made in growth.items()} == {
        end: f"{J} J/m^2" for end, J in expected.items()
    }


def test_tips_of_materials_that_do_not_exist(tmp_path):
    path = '<CrackList><pt x="1" y="2"/><pt x="3" y="2" tip="2"/></CrackList>'
    assert_refused(
        tmp_path, "the tip has material 2; the file has 1", setup=GROWS, material=BRITTLE, more=path
    )


@pytest.mark.parametrize("tip", ["", ' tip="-1"', ' tip="0"'])
def test_ends_without_a_material_do_not_grow(tmp_path, tip):
    parts = {
        "setup": '<CrackArchiveOrder>iYYYN</CrackArchiveOrder><Cracks><JContour size="2"/>'
        '<Propagate criterion="7" direction="1"/></Cracks><ArchiveTime units="ms">1</ArchiveTime>',
        "material": BRITTLE,
    }
    path = f'<CrackList><pt x="0" y="2.1"{tip}/><pt x="2" y="2.1" tip="1"/></CrackList>'
    scene = scene_of(tmp_path, more=path, **parts)
    assert list(scene["cracks"][0]["growth"]) == ["end"]
    assert scene["archive"]["globals"]["columns"] == ["J[crack:end]", "K_I[crack:end]", "K_II[crack:end]"]
    alone = translated(tmp_path, source(more=path.replace(' tip="1"', ""), **parts))
    assert "growth" not in alone.scene["cracks"][0]
    assert "fracture" not in alone.scene
    assert any("no end of a crack has a material" in str(note) for note in alone.notes)
    load(write(alone))


@pytest.mark.parametrize(("hole", "is_loaded"), [("-1 1 -1 1", True), ("1 2 3 4.5", False)])
def test_faces_of_a_box_that_no_hole_touches_take_tractions(tmp_path, hole, is_loaded):
    ends = dict(zip(("xmin", "xmax", "ymin", "ymax"), hole.split(), strict=True))
    oval = " ".join(f'{word}="{value}"' for word, value in ends.items())
    parts = {
        "points": f"<Hole><Oval {oval}/></Hole>{BODY}",
        "more": """<ParticleBCs><BCBox xmin="0" xmax="4" ymin="3.7" ymax="4">
          <TractionBC dir="2" face="3" stress="3"/></BCBox></ParticleBCs>""",
    }
    if is_loaded:
        assert scene_of(tmp_path, **parts)["loads"][0]["traction"] == [0, 3]
    else:
        assert_refused(tmp_path, "not whole faces", **parts)


CUBE = """<?xml version="1.0"?>
<JANFEAInput version="3"><Header><Analysis>12</Analysis></Header>
<MPMHeader><MaxTime units="ms">1</MaxTime><GIMP/><MatlPtsPerElement>8</MatlPtsPerElement></MPMHeader>
<Mesh><Grid xmin="-2" xmax="6" ymin="-2" ymax="6" zmin="-2" zmax="6"><Horiz cellsize="1"/><Vert cellsize="1"/>
<Depth cellsize="1"/></Grid></Mesh>
<MaterialPoints><Body mat="1"><Box xmin="0" xmax="4" ymin="0" ymax="4" zmin="0" zmax="2"/></Body></MaterialPoints>
MATERIAL<ParticleBCs><BCBox PLACE>LOAD</BCBox></ParticleBCs></JANFEAInput>
""".replace("MATERIAL", MATERIAL)
TOP = 'xmin="-1" xmax="5" ymin="-1" ymax="5" zmin="1.7" zmax="3"'
BOTTOM = 'xmin="-1" xmax="5" ymin="-1" ymax="5" zmin="-1" zmax=".3"'
RIGHT = 'xmin="3.7" xmax="5" ymin="0" ymax="4" zmin="0" zmax="2"'


@pytest.mark.parametrize(
    ("place", "load", "expected"),
    [
        (TOP, 'dir="3" face="6" stress="3"', {"face": "z upper", "traction": [0, 0, 3]}),
        (TOP, 'dir="1" face="6" style="2" stress="3"', {"face": "z upper", "traction": ["3*t", 0, 0]}),
        (TOP, 'dir="11" face="6" stress="3"', {"face": "z upper", "pressure": -3}),
        (BOTTOM, 'dir="2" face="5" stress="1"', {"face": "z lower", "traction": [0, 1, 0]}),
        (RIGHT, 'dir="11" face="2" stress="2"', {"face": "x upper", "pressure": -2}),
        (TOP, 'dir="3" face="7" stress="3"', "direction 3 on face 7"),
        (TOP, 'dir="12" face="6" stress="3"', "direction 12 on face 6"),
        (TOP.replace('ymax="5"', 'ymax="2"'), 'dir="3" face="6" stress="3"', "not whole faces"),
        (TOP.replace("1.7", "1.2"), 'dir="3" face="6" stress="3"', "not whole faces"),
    ],
)  # fmt: skip
def test_tractions_in_space_are_on_six_faces(tmp_path, place, load, expected):
    text = CUBE.replace("PLACE", place).replace("LOAD", f"<TractionBC {load}/>")
    if isinstance(expected, str):
        problems = translated(tmp_path, text).problems(partial=False)
        assert any(expected in str(problem) for problem in problems)
        return
    [found] = sound(tmp_path, text).scene["loads"]
    axis, side = expected["face"].split()
    assert found["on"]["face"] == {"axis": axis, "side": side}
    for key in {"traction", "pressure"} & set(expected):
        assert found[key] == expected[key]


@pytest.mark.parametrize(
    ("shape", "direction", "words"),
    [
        ("uGIMP", 1, ""),
        ("uGIMP", 11, "follows the face"),
        ("lCPDI", 1, "acts on the initial area"),
        ("lCPDI", 11, ""),
    ],
)
def test_tractions_say_whether_their_area_is_that_of_nairnmpm(tmp_path, shape, direction, words):
    """NairnMPM integrates over the faces of particles, which deform with CPDI only."""
    load = f'<TractionBC dir="{direction}" face="2" stress="5"/>'
    box = f'<BCBox xmin="3.5" xmax="4" ymin="0" ymax="4">{load}</BCBox>'
    text = source(more=f"<ParticleBCs>{box}</ParticleBCs>").replace("<GIMP/>", f'<GIMP type="{shape}"/>')
    found = [str(note) for note in sound(tmp_path, text).notes if "TractionBC" in str(note)]
    assert len(found) == bool(words)
    assert all(words in note for note in found)


@pytest.mark.parametrize(
    ("share", "transfer"), [("1", {"kind": "flip"}), ("0", {"kind": "xpic", "order": 1}), ("0.5", None)]
)
def test_shares_of_flip(tmp_path, share, transfer):
    setup = f"<FractionFLIP>{share}</FractionFLIP>"
    if transfer is not None:
        assert scene_of(tmp_path, setup=setup)["method"]["transfer"] == transfer
        return
    [problem] = translated(tmp_path, source(setup=setup)).problems(partial=False)
    assert "not supported: 0.5 of FLIP mixed with PIC" in str(problem)


HELD = """<GridBCs><BCLine x1="-1" x2="5" y1="0" y2="0" tolerance=".1"><DisBC dir="2" id="-3" vel="0"/></BCLine>
  <BCLine x1="-1" x2="5" y1="4" y2="4" tolerance=".1"><DisBC dir="2" id="-4" vel="0"/></BCLine></GridBCs>"""


@pytest.mark.parametrize(
    ("attributes", "column", "words"),
    [
        ('type="reactiony" mat="-3"', "reaction_y[nodes_1]", ""),
        ('type="reactiony" material="4"', "reaction_y[nodes_2]", ""),
        ('type="reactiony"', None, "sum of the columns reaction_y[nodes_1], reaction_y[nodes_2]"),
        ('type="reactiony" mat="9"', None, "no condition has the id 9"),
        ('type="reactionz"', None, "there is no axis z"),
    ],
)
def test_reactions_are_those_of_conditions_by_their_number(tmp_path, attributes, column, words):
    setup = f'<GlobalArchive type="kinetic energy"/><GlobalArchive {attributes}/>'
    made = sound(tmp_path, source(setup=f"<GlobalArchiveTime>1</GlobalArchiveTime>{setup}", more=HELD))
    names = [condition["name"] for condition in made.scene["boundary"]]
    found = [each for each in made.scene["archive"]["globals"]["columns"] if each != "kinetic_energy"]
    for number, name in enumerate(names, start=1):
        column = column and column.replace(f"nodes_{number}", name)
        words = words.replace(f"nodes_{number}", name)
    assert found == ([] if column is None else [column])
    if words:
        assert any(words in str(note) for note in made.notes)


def ramp(name="ThermalRamp", **parameters):
    inside = "".join(f'<Parameter name="{key}">{value}</Parameter>' for key, value in parameters.items())
    return f'<CustomTasks><Schedule name="{name}">{inside}</Schedule></CustomTasks>'


HOT = {"setup": "<StressFreeTemp>300</StressFreeTemp>", "time": '<MaxTime units="ms">0.2</MaxTime>'}
WARMED = HOT | {"material": MATERIAL.replace("</Mat", "<alpha>60</alpha><Cv>400</Cv><kCond>2</kCond></Mat")}


@pytest.mark.parametrize(
    ("words", "share"),
    [
        (ramp(DeltaT=40, time=0.1, start=0.05), 1.0),
        ('<Thermal><Isothermal time="0.1" start="0.05">40</Isothermal></Thermal>', 1.0),
        ('<Thermal><Conduction/><Isothermal time="0.1">40</Isothermal></Thermal>', 1.0),
        (ramp(name="PropertyRamp", Delta=40, time=0.4), 0.5),
        (ramp(DeltaT=40, time=0.1, sigmoidal=1), 1.0),
        (ramp(DeltaT=40, time=0.1, exponential=2), 1 - math.exp(-2)),
        (ramp(DeltaT=40, time=0.1, scale="x/x"), 1.0),
        (ramp(DeltaT=40), 1.0),
    ],
    ids=["task", "isothermal", "conduction", "property", "sigmoidal", "exponential", "scale", "jump"],
)
def test_ramps_of_temperature_warm_all_particles(plain_python, tmp_path, words, share):
    """The temperature is within a step of the ramp, 1 K, of what NairnMPM reaches."""
    made = translated(tmp_path, source(**WARMED, points=BODY.replace('"4"', '"1"'), more=words))
    assert made.problems(partial=False) == []
    with plain_python():
        s = Simulation(load_scene(write(made), sets=("time={end: 0.2, step: 0.0025}",)))
        while s.time < 0.2 - 1e-9:
            s.step()
    T = s.particles.T
    assert T == pytest.approx(300 + 40 * share, abs=1.0)
    assert np.ptp(T) < 1e-9


def test_ramps_need_no_heat_capacity(tmp_path):
    made = sound(tmp_path, source(**HOT, more=ramp(DeltaT=40, time=0.1)))
    assert made.scene["materials"]["stuff"]["heat_capacity"] == 1
    assert any("NairnMPM's heat capacity is 1" in str(note) for note in made.notes)


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        (HOT | {"more": ramp(name="PropertyRamp", property=3, Delta=2)}, "supported: a ramp of strengths"),
        (HOT | {"more": ramp(DeltaT=2, time=1, file="a.bmp")}, "supported: ThermalRamp: a picture of changes"),
        (HOT | {"more": ramp(DeltaT=2, time=1, exponential=1, stretch=0.5)}, "a stretched exponential ramp"),
        (HOT | {"more": ramp(DeltaT=2, start=1)}, "a jump of temperatures during the run"),
        ({"more": ramp(DeltaT=2, time=1)}, "temperatures are absolute here"),
        ({"more": ramp(DeltaT=30)}, "temperatures are absolute here"),
        (HOT | {"more": "<Thermal><Conduction/></Thermal>" + CRACK}, "cracks together with conduction"),
        (HOT | {"more": HELD.replace('DisBC dir="2" id="-3" vel="0"', 'TempBC style="6" function="t" time="2"')},
         "a temperature that is 0 until its function begins"),
    ],
)  # fmt: skip
def test_what_has_no_counterpart_is_an_error_with_its_line(tmp_path, parts, words):
    [problem] = translated(tmp_path, source(**parts)).problems(partial=False)
    assert words in str(problem)
    assert problem.line > 1


@pytest.mark.parametrize(
    ("attributes", "keys"),
    [
        ('vel="3" time="2"', {"value": 0.003, "from": 2}),
        ('vel="3" style="2" ftime="0.5"', {"value": "0.003*(t - 0.5)", "from": 0.5}),
        ('vel="3" style="3" time="2"', {"value": "0.003*sin(2*t)"}),
        ('style="6" function="2*t" time="2"', {"value": "0.001*((2*(t - 2))*(t >= 2))"}),
    ],
)
def test_conditions_that_begin_later(tmp_path, attributes, keys):
    """Constant and linear ones hold no node before; functions hold the velocity 0, as NairnMPM does."""
    made = scene_of(tmp_path, more=HELD.replace('vel="0"', attributes, 1))
    late, ordinary = made["boundary"]
    assert {key: late[key] for key in ("value", "from") if key in late} == keys
    assert "from" not in ordinary


def test_loads_on_faces_that_begin_later(tmp_path):
    load = '<BCBox xmin="3.5" xmax="4" ymin="0" ymax="4"><TractionBC dir="1" face="2" stress="5" time="2"/></BCBox>'
    made = scene_of(tmp_path, more=f"<ParticleBCs>{load}</ParticleBCs>")
    assert made["loads"][0] | {"name": "", "on": {}} == {
        "name": "", "kind": "traction", "on": {}, "traction": [5, 0], "from": 2
    }  # fmt: skip


@pytest.mark.parametrize(
    ("attributes", "words"),
    [
        ('Normals="2" RigidBias="1"', "RigidBias: 1 or less has no effect"),
        ('Normals="3" RigidBias="10"', "RigidBias: Normals 3 have no bias"),
        ('Normals="2" RigidBias="10"', ""),
    ],
)
def test_a_bias_without_effect_is_ignored_in_words(tmp_path, attributes, words):
    made = translated(tmp_path, source(setup=f"<MultiMaterialMode {attributes}/>"))
    found = [str(note) for note in made.notes if "RigidBias" in str(note)]
    assert len(found) == bool(words)
    assert all(words in note for note in found)


@pytest.mark.parametrize(
    ("attributes", "direction"),
    [
        ('dir="12" angle="30"', [math.cos(math.pi / 6), -0.5]),
        ('dir="12" angle="0"', "x"),
        ('dir="12" angle="-90"', "y"),
        ('dir="12" angle="90"', [0, -1]),
    ],
)
def test_oblique_conditions_turn_clockwise(tmp_path, attributes, direction):
    condition = f"""<GridBCs><BCLine x1="-2" x2="6" y1="-2" y2="-2">
      <DisBC {attributes} vel="0"/></BCLine></GridBCs>"""
    [made] = scene_of(tmp_path, more=condition)["boundary"]
    assert made["direction"] == (direction if isinstance(direction, str) else pytest.approx(direction))


def test_a_force_on_each_particle_may_depend_on_its_place(tmp_path):
    box = """<ParticleBCs><BCBox xmin="0" xmax="4" ymin="3" ymax="4">{}
      <LoadBC dir="2" style="6" function="10*x*t"/></BCBox></ParticleBCs>"""
    [load] = scene_of(tmp_path, more=box.format(""))["loads"]
    assert load["per"] == "particle"
    assert load["force"] == [0, "10*x*t"]
    assert_refused(tmp_path, "net force", more=box.format("<net/>"))


def test_the_criterion_of_a_material_counts_before_that_of_all(tmp_path):
    material = BRITTLE.replace("</Mat", '<Propagate criterion="7" direction="1"/></Mat')
    setup = GROWS.replace('"7"', '"1"')
    made = sound(tmp_path, source(setup=setup, material=material, more=CRACK))
    assert made.scene["cracks"][0]["growth"]["end"]["criterion"]["kind"] == "energy_release_rate"
    assert any("the criterion of the material counts" in str(note) for note in made.notes)


def test_damping_may_be_a_function_without_a_text_and_steps_of_conduction_are_ignored(tmp_path):
    setup = '<PDamping function="100*t"/>'
    time = '<Timing CFL="0.4" TransCFL="0.5" max="1e-3"/>'
    scene = scene_of(tmp_path, setup=setup, time=time)
    assert scene["method"]["damping"] == {"particle": "0.1*t"}


@pytest.mark.parametrize(
    ("attributes", "size"),
    [
        ('width="8"', [8, 4]),
        ('height="8"', [16, 8]),
        ('width="-0.5"', [2, 1]),
        ('width="-0.5" height="-1"', [2, 2]),
        ('width="8" height="6"', [8, 6]),
    ],
)
def test_pictures_of_one_length_have_square_pixels(tmp_path, attributes, size):
    from PIL import Image

    Image.new("L", (4, 2), 200).save(tmp_path / "p.png")
    picture = f'<BMP name="p.png" {attributes}><Intensity mat="1" imin="100" imax="255"/></BMP>'
    made = translated(tmp_path, source(points=picture))
    assert made.problems(partial=False) == []
    assert made.scene["bodies"][0]["region"]["size"] == size


def test_partial_scenes_lack_what_is_not_known(tmp_path):
    text = source(
        setup="<Quantum>3</Quantum>",
        points=BODY.replace('mat="1"', 'mat="1" spin="3"').replace("<Rect", '<Deform dXX="1.1"/><Rect'),
        more="<GridBCs><TractionBC/></GridBCs>",
    )
    whole, made = translated(tmp_path, text), translated(tmp_path, text, partial=True)
    assert whole.errors
    assert made.problems(partial=True) == []
    load(write(made))
    notes = "\n".join(map(str, made.of_kind("not_supported")))
    for words in ("unknown command", "unknown attribute 'spin'", "does not belong", "a deformation at"):
        assert words in notes


def test_nothing_is_dropped_in_silence(tmp_path):
    """Each command and attribute of a source is read, or is in a note with its line."""
    made = translated(
        tmp_path,
        source(
            setup="<Diffusion/><ProgSteps>9</ProgSteps><Damping>1</Damping><Damping>2</Damping>",
            material=MATERIAL.replace("</Mat", "<gamma>3</gamma></Mat"),
            more='<CustomTasks><Schedule name="CarnotCycle"/></CustomTasks>',
        ),
    )
    words = "\n".join(map(str, made.notes))
    for name in ("Diffusion", "ProgSteps", "gamma", "Schedule", "Damping"):
        assert f"<{name}>" in words, name
    assert {problem.line for problem in made.problems(partial=False)} >= {5, 8, 9}
    assert made.problems(partial=True) == []
    assert "# Not supported" in write(made)
    load(write(made))


# --------------------------------------------------------------------------- scripts

SCRIPT = """! Two squares
Title "Two squares"
Header
A block ! with text
EndHeader
#cell = 0.5
#model$="soft"          ! or "hard"
if #model$="hard"
  #E = 1000
else if #model$="soft"
  #E = 100
else
  Stop "unknown model"
endif
#E *= 2
#pull$ = "*t"
Analysis "Plane Strain MPM"
MPMMethod "USAVG+","uGIMP"
MaximumTime 3/2
Archive "Results/"&#model$,.5
ToArchive velocity,stress
Material "left","Left half","Isotropic"
  E #E
  nu .33
  a 60
  rho 1.5
Done
Material "right","Right half","Neohookean"
  E #E
  nu .33
  rho sqrt(2.25)
Done
GridHoriz 8/#cell,0
GridVert 4/#cell
GridThickness 2
GridRect 0,8,0,4
Region "left",100,0,2
  Rect 1,1+2,1,3
EndRegion
Region "right","-100*x",0,2
  PolyPt 5,1
  PolyPt 7,1
  PolyPt 7,3
EndRegion
MoveLine 8,0,8,4
  Velocity x,constant,0
EndMoveLine
LoadRect 2.5,3,1,3
  LoadType net
  Load x,function,(#E/10)&#pull$
EndLoadRect
"""


def test_scripts(tmp_path):
    made = sound(tmp_path, SCRIPT)
    assert not any("later command" in str(note) for note in made.notes)
    scene = made.scene
    assert scene["title"] == "Two squares"
    assert scene["time"]["end"] == 1.5
    assert scene["grid"]["cell"] == 0.5
    assert scene["method"]["update"] == "usavg+"
    assert [body["name"] for body in scene["bodies"]] == ["left_half", "right_half"]
    assert [stuff["E"] for stuff in scene["materials"].values()] == [200, 200]
    assert scene["bodies"][1]["velocity"][0] == "-0.1*x"
    assert scene["bodies"][1]["region"]["kind"] == "polygon"
    assert {entry["kind"] for entry in scene["boundary"]} == {"symmetry", "velocity"}
    assert scene["loads"][0]["force"] == [20, 0] or "t" in str(scene["loads"][0]["force"][0])


def test_regions_are_turned_and_lines_of_nodes_held(tmp_path):
    text = SCRIPT.replace('Region "left",100,0,2', 'Region "left",100,0,2\n  Transform 30,0.5,0,1,2')
    text = text.replace("MoveLine 8,0,8,4", "GridBC\n  Line 0,1,2,2").replace("EndMoveLine", "EndGridBC")
    made = sound(tmp_path, text)
    body, other = load(write(made)).scene.bodies
    assert body.particles_along == "region"
    assert other.particles_along == "grid"
    held = next(entry for entry in made.scene["boundary"] if entry["kind"] == "velocity")
    assert held["on"]["box"] == {"lower": [0, 2], "upper": [1, 2]}
    lower, upper = body.region.bounds(2)
    # the middle of the square, (2, 2), is turned about (1, 2), then moved
    assert 0.5 * (lower + upper) == pytest.approx([1.5 + math.cos(math.pi / 6), 2.5])


LOOPS = """
Sub Widen,#to
  if #to>#most
    #most=#to
  endif
EndSub
#most=0
Repeat "#i",1,3
  #x[#i]=#i^2
  GoSub Widen,#x[#i]
EndRepeat
#n=0
While #n<10
  #n+=1
  Repeat "#j",1,0,-0.25
    if #j<0.5
      break
    endif
    #last=#j
  EndRepeat
  if #n=4
    break
  endif
EndWhile
Repeat "#k",3,1
  Stop "this loop has no turn"
EndRepeat
Values #most,#x[2]+#x[#i-2],#n,#last
"""


def test_loops_and_subroutines_of_scripts():
    lines = list(run(LOOPS))
    assert [(line.name, line.values) for line in lines] == [("values", (9.0, 8.0, 4.0, 0.5))]


def script_of(tmp_path, words, old="MaximumTime 3/2"):
    made = translated(tmp_path, SCRIPT.replace(old, f"{words}\n{old}"))
    assert made.problems(partial=False) == []
    load(write(made))
    return made


@pytest.mark.parametrize(("count", "per_axis"), [(1, 1), (2, 2), (3, 3), (4, 4), (9, 3), (16, 4)])
def test_scripts_count_particles_along_a_side_of_a_cell(tmp_path, count, per_axis):
    """As NairnFEAMPMViz does; more than 5 are the particles of a cell, as in old scripts."""
    body = script_of(tmp_path, f"PtsPerElement {count}").scene["bodies"][0]
    assert body.get("particles_per_axis", 2) == per_axis


def test_particles_of_one_region_of_a_script_are_not_those_of_all(tmp_path):
    with pytest.raises(SceneError, match="not supported: 'PtsPerElement' inside a region"):
        script_of(tmp_path, "PtsPerElement 3", "  PolyPt 5,1")


@pytest.mark.parametrize(
    ("words", "kind", "expected"),
    [
        ("Gravity", "gravity", [0, -9.80665e-3]),
        ("Gravity 100", "gravity", [1e-4, -9.80665e-3]),
        ("Gravity 100,0", "gravity", [1e-4, 0]),
        ('Gravity "100*t",0', "body_force", ["0.0001*t", 0]),
    ],
)
def test_gravity_of_scripts_is_by_default_that_of_the_earth(tmp_path, words, kind, expected):
    loads = script_of(tmp_path, words).scene["loads"]
    [load] = [load for load in loads if load["kind"] == kind]
    assert [getattr(part, "number", part) for part in load["acceleration"]] == (
        expected if kind == "body_force" else pytest.approx(expected)
    )


@pytest.mark.parametrize(
    ("words", "friction", "heating"),
    [
        ("Conduction yes", False, "isothermal"),
        ('Conduction yes,"isothermal","friction"', True, "isothermal"),
        ('Conduction yes,"friction","adiabatic"', True, "adiabatic"),
        ('Conduction no,"mechanical energy"', None, "adiabatic"),
    ],
)
def test_each_option_of_conduction_in_scripts_counts(tmp_path, words, friction, heating):
    heat = f"StressFreeTemp 300\nMultimaterialMode 0,enabled,avggrad\n{words}"
    scene = script_of(tmp_path, heat).scene
    assert scene["method"]["heating"] == heating
    assert scene.get("heat", {}).get("friction") is friction


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ('yes,"crack tips"', "not supported: no counterpart"),
        ('yes,"radiation"', "not supported: the option 'radiation' of 'Conduction'"),
        ("maybe", "'maybe' of 'Conduction' is neither yes nor no"),
    ],
)
def test_options_of_conduction_without_a_counterpart(tmp_path, option, words):
    text = SCRIPT.replace("MaximumTime", f"StressFreeTemp 300\nConduction {option}\nMaximumTime")
    try:
        [problem] = translated(tmp_path, text).problems(partial=False)
    except SceneError as error:
        problem = str(error)
    assert words in str(problem)


def test_heat_of_friction_without_an_effect_is_ignored_in_words(tmp_path):
    made = translated(tmp_path, source(more="<Thermal><ContactHeating/></Thermal>"))
    assert [str(note) for note in made.notes if "nothing conducts heat" in str(note)]


def test_scripts_without_a_shape_function_say_which_they_get(tmp_path):
    made = sound(tmp_path, SCRIPT.replace('MPMMethod "USAVG+","uGIMP"', 'MPMMethod "USL-"'))
    assert made.scene["method"] | {"transfer": {}} == {"shape": "linear", "update": "usl", "transfer": {}}
    assert any("NairnFEAMPMViz takes uGIMP" in str(note) for note in made.notes)


def test_contact_of_scripts(tmp_path):
    words = "MultimaterialMode 0,enabled,specify,90,30"
    text = SCRIPT.replace("  rho sqrt(2.25)", '  rho 1\n  friction .25,"left"')
    text = text.replace("MaximumTime", f"{words}\nMaximumTime")
    contact = sound(tmp_path, text).scene["contact"]
    assert contact["normal"] == {"kind": "specified", "azimuth": 90}
    [pair] = contact["pairs"]
    assert pair["law"] == {"kind": "coulomb", "friction": 0.25}
    with pytest.raises(SceneError, match="the value '3' of 'MultimaterialMode'"):
        translated(tmp_path, text.replace(words, "MultimaterialMode 0,yes,avggrad,2,3"))
    with pytest.raises(SceneError, match="the material 'top' of 'friction' is not defined"):
        translated(tmp_path, text.replace('.25,"left"', '.25,"top"'))


def test_a_reversal_of_scripts(tmp_path):
    task = """CustomTask ReverseLoad
Parameter quantity,"sxx"
Parameter material,"right"
Parameter maxValue,3
Parameter style,"hold"
"""
    scene = sound(tmp_path, SCRIPT + task).scene
    assert [(event["when"], event["do"]) for event in scene["events"]] == [
        ("stress_xx[right_half] >= 3", "hold")
    ]


def test_materials_of_scripts_in_xml_have_names_and_numbers(tmp_path):
    """The number of the tip's material counts the one in XML."""
    xml = """XMLData "Material","steel"
<Material Type="1" Name="Steel"><rho>8</rho><E>200000</E><nu>0.3</nu></Material>
EndXMLData
"""
    text = SCRIPT.replace('Material "left"', xml + 'Material "left"')
    text = text.replace("  a 60", '  a 60\n  criterion 7\n  direction "self similar"\n  JIc 3')
    text += 'Region "steel",0,0,2\n  Rect 4,4.5,1,3\nEndRegion\n'
    text = text.replace("  nu .33\n  rho sqrt", "  nu .33\n  criterion 7\n  JIc 8\n  rho sqrt")
    text += 'NewCrack 1,2\nGrowCrack 2,2,"left"\nJContour 2,1,yes\n'
    scene = sound(tmp_path, text).scene
    assert [body["name"] for body in scene["bodies"]] == ["left_half", "right_half", "steel"]
    growth = scene["cracks"][0]["growth"]["end"]
    assert growth["criterion"] == {"kind": "energy_release_rate", "J_c": "3 J/m^2"}
    assert growth["direction"] == {"kind": "self_similar"}
    with pytest.raises(SceneError, match="'XMLData' needs the name of its only material"):
        translated(tmp_path, text.replace('"Material","steel"', '"Material"'))


def test_scripts_with_units_but_no_words_are_in_meters(tmp_path):
    made = translated(tmp_path, SCRIPT.replace("#cell = 0.5", "#cell = 0.5\nConsistentUnits"))
    assert made.scene["units"] == {"length": "m", "mass": "kg", "time": "s"}


def test_damping_and_numbers_of_conditions_in_scripts(tmp_path):
    text = SCRIPT.replace(
        "MaximumTime", "Damping 5,0\nGlobalArchiveTime 1\nGlobalArchive reactionx,-3\nMaximumTime"
    )
    scene = sound(tmp_path, text.replace("MoveLine", "BoundaryID -3\nMoveLine", 1)).scene
    assert scene["method"]["damping"] == {"grid": 0.005}
    [column] = scene["archive"]["globals"]["columns"]
    held = next(entry for entry in scene["boundary"] if entry["kind"] == "velocity")
    assert column == f"reaction_x[{held['name']}]"
    found = translated(tmp_path, text.replace("Damping 5,0", "Damping 5,0.2"))
    assert any("PIC damping" in str(problem) for problem in found.problems(partial=False))


def test_times_of_scripts_with_their_own_units(tmp_path):
    made = translated(tmp_path, SCRIPT.replace("#cell = 0.5", '#cell = 0.5\nConsistentUnits "mm","g","ms"'))
    assert made.scene["time"]["end"] == 1.5


def test_sources_with_errors_of_scripts_name_their_lines(tmp_path):
    path = tmp_path / "run.fmcmd"
    path.write_text(SCRIPT.replace("MPMMethod", "MPMMehtod"))
    with pytest.raises(SceneError, match=r"run\.fmcmd:18 .*'MPMMehtod'"):
        translate(path, False)


# ------------------------------------------------------------------ broken sources

BOMB = '<!ENTITY a "0123456789">' + "".join(
    f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdefgh", "bcdefghi", strict=True)
)
BROKEN = {
    "empty": ("", "no element found|empty|not an XML"),
    "not_xml": ("<JANFEAInput><Header>", "not valid XML"),
    "script": ('Title "Disks"\nAnalysis "Plane Strain MPM"\nRotor 3\n', "script command 'Rotor'"),
    "script_variable": ("#a = 2\nCFLFactor #b\n", "variable #b has no value"),
    "script_loop": ("#a = 2\nRepeat\n", r"'Repeat \"#variable\",first,last' is expected"),
    "script_loop_end": ('Repeat "#i",1,2\n#a = #i\n', "'endrepeat' is missing"),
    "script_loop_without_end": ("#a = 1\nWhile #a>0\n#a += 1\nEndWhile\n", "more than 100000 lines are run"),
    "script_loop_crossed": ('Repeat "#i",1,2\nif 1=1\nEndRepeat\nendif\n', "'endif' is missing before"),
    "script_break": ("if 1=1\nbreak\nendif\n", "'break' outside a loop"),
    "script_for": ("For #i\n", "the loop 'for'"),
    "script_sub": ("GoSub Ends,1\n", "there is no subroutine 'Ends'"),
    "script_sub_values": ("Sub Ends,#a\nEndSub\nGoSub Ends\n", "'Ends' needs 1 values, not 0"),
    "script_sub_itself": ("Sub Ends\nGoSub Ends\nEndSub\nGoSub Ends\n", "more than 50 subroutines"),
    "script_index": ("#x[1] = 2\nMaximumTime #x[2]\n", r"variable #x\[2\] has no value"),
    "script_value": ("MaximumTime 1/(2-2)\n", "1 / 0 has no value"),
    "script_text": ('#a$="text"\n' + "#a$=#a$&#a$\n" * 40, "a text of more than 100000 characters"),
    "script_block": ('Material "a","A",1\nHeader\nEndHeader\n', "several values of 'header'"),
    "script_number": ("Analysis 1e400\n", "'1e400' is not a number"),
    "script_more": ("MaximumTime 1,2\n", "not supported: the value '2' of 'MaximumTime'"),
    "another_root": ("<html/>", "begins with <html>"),
    "no_blocks": ("<JANFEAInput/>", "<Header> is missing"),
    "unknown_command": (source(setup="<Dampig>1</Dampig>"), "did you mean 'Damping'"),
    "unknown_attribute": (source(grid=' thikness="2"'), "did you mean 'thickness'"),
    "misplaced": (source(head="<GIMP/>"), "does not belong in <Header>"),
    "missing_attribute": (source(setup="<GlobalArchive/>"), "'type' is missing"),
    "no_number": (source(time="<MaxTime>soon</MaxTime>"), "'soon' is not a number"),
    "no_value": (source(time="<MaxTime/>"), "a value is missing"),
    "unknown_material": (
        source(points=BODY.replace('mat="1"', 'matname="Steel"')),
        "no material 'Steel'.*Stuff",
    ),
    "material_number": (source(points=BODY.replace('mat="1"', 'mat="4"')), "no material 4; the file has 1"),
    "missing_modulus": (source(material=MATERIAL.replace("<E>100</E>", "")), "elastic constants are missing"),
    "analysis": (source(analysis=99), "analysis 99"),
    "shape_in_3d": (source(analysis=12), "<Depth> is missing"),
    "no_extent": (source().replace('xmax="6"', 'xmax="-2"'), "no extent along x"),
    "rigid_without_mode": (
        source(material=MATERIAL.replace('Type="1"', 'Type="35"')),
        "needs the command <MultiMaterialMode>",
    ),
    "contact_law_as_material": (
        source(points=BODY, material='<Material Type="61" Name="Rub"><coeff>0.3</coeff></Material>'),
        r":7 +<Body> +'Rub' is a law of contact or traction",
    ),
    "traction_law_as_material": (
        source(material='<Material Type="12" Name="Glue"><sigmaI>3</sigmaI></Material>'),
        r":7 +<Body> +'Glue' is a law of contact or traction",
    ),
    "bomb": (source(entities=BOMB), "characters when it is expanded"),
    "external": (source(entities='<!ENTITY e SYSTEM "file:///etc/passwd">'), "another file"),
    "undefined_entity": (source(time="<MaxTime>&end;</MaxTime>"), "entity"),
    "deep": ("<JANFEAInput>" + "<Header>" * 40, "nested more than"),
    "picture_outside": (
        source(
            points='<BMP name="../x.bmp" width="1" height="1"><Intensity mat="1" imin="0" imax="9"/></BMP>'
        ),
        "outside the folder",
    ),
    "expression": (
        source(
            more='<GridBCs><BCLine x1="0" x2="0" y1="0" y2="4">'
            '<DisBC dir="1" style="6" function="2*(t"/></BCLine></GridBCs>'
        ),
        r"'\)' is missing",
    ),
}


NOT_SUPPORTED = ("analysis", "unknown_command", "unknown_attribute", "misplaced")
"""Scenes without these are written with ``--partial``."""


@pytest.mark.parametrize("name", BROKEN)
def test_broken_sources(name, tmp_path):
    text, words = BROKEN[name]
    path = tmp_path / f"{name}.fmcmd"
    path.write_text(text)
    for options in ([], ["--partial"]):
        if name in NOT_SUPPORTED and options:
            continue
        code, written, seconds = spoken(["import", "nairnmpm", str(path), *options])
        assert code == 3, written
        assert re.search(words, written), written
        assert re.search(rf"{name}\.fmcmd:\d+ ", written), written
        assert not unfit(code, written)
        assert seconds < 2


def test_a_huge_file_is_refused(tmp_path):
    path = tmp_path / "huge.fmcmd"
    with path.open("wb") as file:
        file.truncate(60_000_000)
    with pytest.raises(SceneError, match="larger than 50 MB"):
        translate(path, False)


def test_numbers_are_read_as_nairnmpm_reads_them(tmp_path):
    made = translated(tmp_path, source(points=BODY.replace('ymax="4"', 'ymax="4.0;"')))
    assert made.scene["bodies"][0]["region"]["upper"] == [4, 4]
    assert "read as 4, as NairnMPM does" in str(made.notes)


def test_entities_of_other_encodings_are_expanded():
    text = source(entities='<!ENTITY end "2">', time="<MaxTime>&end;</MaxTime>")
    for encoding in ("utf-8", "iso-8859-1", "utf-16"):
        raw = text.replace('version="1.0"?', f'version="1.0" encoding="{encoding}"?').encode(encoding)
        found = parse(raw, Path("x"))
        (time,) = (c for c in found.root.walk() if c.name == "MaxTime")
        assert found.plain(time.text) == "2"


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_files_with_marks_of_their_encoding_are_xml(tmp_path, encoding):
    path = tmp_path / "marked.fmcmd"
    path.write_text(source(), encoding=encoding)
    assert translate(path, False).scene["bodies"][0]["name"] == "stuff"


@pytest.mark.parametrize("seed", range(6))
def test_mutated_sources_end_in_words(seed, tmp_path):
    """Translation of a damaged source gives a scene or problems, never another error."""
    chance = random.Random(seed)
    sources = sorted(SOURCES.glob("*.fmcmd"))
    for number in range(25):
        lines = chance.choice(sources).read_text().splitlines()
        for _ in range(chance.randint(1, 3)):
            _damage(chance, lines)
        path = tmp_path / f"{number}.fmcmd"
        path.write_text("\n".join(lines))
        try:
            made = translate(path, partial=chance.random() < 0.5)
        except SceneError:
            continue
        problems = made.problems(partial=False)
        assert all(problem.message and problem.line for problem in problems)
        if not problems:
            text = write(made)
            assert text == write(made)


def _damage(chance, lines):
    index = chance.randrange(len(lines))
    line = lines[index]
    what = chance.randrange(5)
    if what == 0:
        del lines[index]
    elif what == 1:
        lines.insert(index, chance.choice(lines))
    elif what == 2:
        values = ["", "1e400", "-1", "nan", "0", "x", "&a;", "9" * 50, "min-", "1e-300"]
        lines[index] = re.sub(r'"[^"]*"', f'"{chance.choice(values)}"', line, count=1)
    elif what == 3 and line:
        at = chance.randrange(len(line))
        lines[index] = line[:at] + chance.choice("<>&;\"'/-0 \x00é") + line[at + 1 :]
    else:
        lines[index] = re.sub(
            r">[^<]+<", f">{chance.choice(['-3', '', 'abc', '1e999', '7'])}<", line, count=1
        )


def test_units_of_the_source_are_units_of_scenes():
    units = Units("mm", "g", "ms")
    for unit in LEGACY.values():
        if unit.text:
            assert units.any_number(f"1 {unit.text}") == pytest.approx(unit.factor), unit.text


def test_conduction_without_properties_has_nairnmpms_defaults(tmp_path):
    """A material without Cv and kCond gave a scene that is not valid."""
    heat = "<Thermal><Conduction/></Thermal>"
    scene = scene_of(tmp_path, setup="<StressFreeTemp>300</StressFreeTemp>", more=heat)
    assert scene["materials"]["stuff"]["heat_capacity"] == 1
    assert scene["materials"]["stuff"]["conductivity"] == 0


@pytest.mark.parametrize(
    ("kind", "words", "key"),
    [
        (1, "<E>9</E><nu>-1</nu>", "nu"),
        (1, "<E>9</E><G>0</G>", "nu"),
        (8, "<E>9</E><nu>.5</nu><G2>1</G2>", "K"),
    ],
)
def test_elastic_constants_without_a_finite_modulus(tmp_path, kind, words, key):
    path = tmp_path / "x.fmcmd"
    path.write_text(source(material=f'<Material Type="{kind}" Name="Stuff"><rho>1</rho>{words}</Material>'))
    code, written, _ = spoken(["import", "nairnmpm", str(path)])
    assert code == 3
    assert re.search(rf"x\.fmcmd:8 +materials\.stuff\.{key} ", written), written


@pytest.mark.parametrize("units", ["", '<ConsistentUnits length="m" mass="kg" time="sec"/>'])
@pytest.mark.parametrize(("alpha", "expansion"), [("", 40e-6), ("<alpha>12</alpha>", 12e-6)])
def test_expansions_are_1e_6_per_kelvin_in_all_units(units, alpha, expansion, tmp_path):
    material = MATERIAL.replace("</Material>", f"{alpha}<Cv>1</Cv><kCond>1</kCond></Material>")
    setup = "<StressFreeTemp>300</StressFreeTemp>"
    more = "<Thermal><Conduction/></Thermal>"
    scene = scene_of(tmp_path, head=units, setup=setup, material=material, more=more)
    assert scene["materials"]["stuff"]["expansion"] == pytest.approx(expansion, rel=1e-12)


# ------------------------------------------- values that NairnMPM takes where a source gives none, and rare ones


@pytest.mark.parametrize(
    ("attributes", "value"),
    [
        ('style="2" vel="10" ftime="-0.5"', "0.01*(t + 0.5)"),
        ('style="6" function="t^2" ftime="-1"', "0.001*((t + 1)**2)"),
        ('style="1" vel="10" ftime="-1"', 0.01),
    ],
)
def test_values_that_began_before_the_run(tmp_path, attributes, value):
    """The time before the run was dropped without a word."""
    line = f'<BCLine x1="min" y1="min" x2="max" y2="min"><DisBC dir="2" {attributes}/></BCLine>'
    boundary = scene_of(tmp_path, more=f"<GridBCs>{line}</GridBCs>")["boundary"]
    assert boundary[0]["value"] == value
    assert "from" not in boundary[0]


@pytest.mark.parametrize(("count", "leaves"), [(-100, True), (100, True), (1, False), (0, False)])
def test_particles_that_may_leave(tmp_path, count, leaves):
    """A negative limit was dropped without a word."""
    made = sound(tmp_path, source(setup=f"<LeaveLimit>{count}</LeaveLimit>"))
    assert made.scene.get("domain") == ({"on_exit": "delete"} if leaves else None)
    assert bool(made.of_kind("changed")) == leaves


def test_the_limit_of_particles_without_a_number_deletes_none_that_leave(tmp_path):
    made = sound(tmp_path, source(setup="<DeleteLimit>100</DeleteLimit>"))
    assert "domain" not in made.scene
    assert "no number ends the run" in str(made.of_kind("changed")[0])


def test_steinberg_hardening_has_nairnmpms_defaults(tmp_path):
    """A source without betahard hardened, and one without GPpG0 did not stiffen."""
    elastic = "<E>100</E><nu>0.3</nu><Hardening>SCGL</Hardening>"
    made = material_of(tmp_path, 9, f"{elastic}<yield>5</yield><yieldMax>10</yieldMax>")["hardening"]
    assert made == {
        "kind": "steinberg_cochran_guinan",
        "yield_stress": 5,
        "Y_max": 10,
        "beta": 0,
        "n": 1,
        "A": 1e-5,
    }
    material = f'<Material Type="9" Name="A"><rho>1</rho>{elastic}</Material>'
    assert_refused(tmp_path, "<yieldMax> is missing", material=material)
    hot = scene_of(
        tmp_path,
        setup="<StressFreeTemp>400</StressFreeTemp>",
        points=BODY.replace('mat="1"', 'mat="1" temp="450"'),
        material=material.replace("</Mat", "<yieldMax>3e3</yieldMax></Mat"),
    )["materials"]["a"]["hardening"]
    assert (hot["yield_stress"], hot["B"], hot["T0"]) == (2200, 2.2e-4, 400)


@pytest.mark.parametrize(("capacity", "gamma"), [("", 5 / 3), ("<Cv>1</Cv>", 5 / 3), ("<Cv>20</Cv>", 1.4)])
@pytest.mark.parametrize("heat", ["", "<Thermal><Conduction/><EnergyCoupling/></Thermal>"])
def test_gas_begins_at_the_pressure_of_its_temperature(tmp_path, capacity, gamma, heat):
    """The pressure was P0 at any temperature, all gas had one atom per molecule, and Cv gave an invalid scene."""
    gas = f'<Material Type="22" Name="Air"><rho>1</rho><P0>0.1</P0><T0>250</T0>{capacity}</Material>'
    setup = "<StressFreeTemp>300</StressFreeTemp>"
    made = scene_of(tmp_path, setup=setup, material=gas, more=heat)["materials"]["air"]
    assert made["pressure"] == pytest.approx(0.12)
    assert (made["gamma"], made["T0"]) == (pytest.approx(gamma), 300)
    assert "heat_capacity" not in made


def test_equations_of_state_have_nairnmpms_defaults(tmp_path):
    made = material_of(tmp_path, 25, "<G1>5</G1>")
    assert (made["C0"], made["S1"], made["gamma0"]) == (4004, 1.35, 1.64)
    assert material_of(tmp_path, 17, "<G>5</G><S1>0</S1><gamma0>0</gamma0>")["S1"] == 0


def test_hyperelastic_plasticity_takes_its_shear_modulus_by_both_names(tmp_path):
    for name in ("G", "G1"):
        made = material_of(tmp_path, 24, f"<K>9</K><{name}>3</{name}><yield>1</yield>")
        assert (made["K"], made["G"]) == (9, 3)


@pytest.mark.parametrize(
    ("kind", "words", "expansion"),
    [
        (9, "<E>9</E><nu>.2</nu><yield>1</yield>", 40e-6),
        (24, "<K>9</K><G1>3</G1><yield>1</yield>", None),
        (8, "<K>9</K><G1>3</G1>", None),
        (7, "<K>9</K><G0>3</G0><ntaus>1</ntaus><Gk>1</Gk><tauk>1</tauk>", 40e-6),
        (3, f"{FIBRES}<alphaA>40</alphaA>", 40e-6),
        (4, ORTHOTROPIC + "<alphax>7</alphax><alphay>7</alphay><alphaz>7</alphaz>", 7e-6),
    ],
)
def test_materials_expand_without_alpha_as_in_nairnmpm(tmp_path, kind, words, expansion):
    """All but isotropic elastic ones did not expand; alphaA and others were said to have no effect."""
    scene = scene_of(
        tmp_path,
        setup="<StressFreeTemp>300</StressFreeTemp>",
        points=BODY.replace('mat="1"', 'mat="1" temp="350"'),
        material=f'<Material Type="{kind}" Name="A"><rho>1</rho>{words}</Material>',
    )
    found = scene["materials"]["a"].get("expansion")
    assert found == (expansion if expansion is None else pytest.approx(expansion))


def test_expansions_that_differ_along_axes_are_refused(tmp_path):
    assert_refused(
        tmp_path,
        "expansions that differ along axes: alphaA, alphaT",
        setup="<StressFreeTemp>300</StressFreeTemp>",
        points=BODY.replace('mat="1"', 'mat="1" temp="350"'),
        material=f'<Material Type="3" Name="A"><rho>1</rho>{FIBRES}<alphaA>5</alphaA></Material>',
    )


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("<ET>3</ET><GT>1.25</GT>", {"E_transverse": 3, "nu_transverse": 0.2}),
        ("<nuT>.2</nuT><GT>1.25</GT>", {"E_transverse": 3, "nu_transverse": 0.2}),
        ("<ET>3</ET><nuT>.2</nuT>", {"nu_axial": 0.33}),
    ],
)
def test_two_transverse_constants_of_three_are_enough(tmp_path, words, expected):
    """GT was said to have no counterpart and nuT to be missing."""
    made = material_of(tmp_path, 3, f"<EA>9</EA><GA>2</GA>{words}")
    assert {key: made[key] for key in expected} == pytest.approx(expected)


def test_constants_with_their_axes_the_other_way_round(tmp_path):
    words = ORTHOTROPIC.replace("Gxy", "Gyx").replace("nuxy", "nuyx")
    made = material_of(tmp_path, 4, words)
    assert made["G12"] == 3
    assert made["nu12"] == pytest.approx(0.3 * 9 / 8)
    material = f'<Material Type="4" Name="A"><rho>1</rho>{words}<nuxy>.3</nuxy></Material>'
    assert_refused(tmp_path, "nuxy and nuyx are given", material=material)


def test_viscoelasticity_without_relaxation_is_elastic(tmp_path):
    """It made a scene without the material."""
    made = material_of(tmp_path, 7, "<K>9</K><G0>3</G0><ntaus>0</ntaus>")
    assert (made["kind"], made["K"], made["G"]) == ("linear_elastic", 9, 3)


def test_consistent_units_may_be_without_names(tmp_path):
    scene = scene_of(tmp_path, head='<ConsistentUnits length="L" mass="M" time="T"/>')
    assert "units" not in scene


@pytest.mark.parametrize(
    ("parameters", "transfer", "heat"),
    [
        ({"periodicStepsConduction": 3}, {"kind": "flip"}, {"kind": "fmpm", "order": 2, "every_steps": 3}),
        ({"periodicSteps": 2, "periodicCFL": 5}, {"kind": "fmpm", "order": 2, "every_steps": 2}, None),
        ({"periodicCFL": 5}, {"kind": "fmpm", "order": 2, "every_courant": 5}, None),
    ],
)
def test_periodic_transfers_of_motion_and_heat(tmp_path, parameters, transfer, heat):
    """FMPM of temperatures alone made that of the motion too, and a Courant number came before steps."""
    words = "".join(f'<Parameter name="{name}">{value}</Parameter>' for name, value in parameters.items())
    task = f'<Schedule name="PeriodicXPIC"><Parameter name="FMPMOrder">2</Parameter>{words}</Schedule>'
    more = f"<Thermal><Conduction/></Thermal><CustomTasks>{task}</CustomTasks>"
    scene = scene_of(tmp_path, setup="<StressFreeTemp>300</StressFreeTemp>", more=more)
    assert scene["method"]["transfer"] == transfer
    assert scene["heat"].get("transfer") == heat


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("periodicCFLConduction", 2, "periodicCFLConduction; periodicStepsConduction is"),
        ("periodicTimeConduction", 2, "periodicTimeConduction; periodicStepsConduction is"),
        ("periodicStepsConduction", 0.5, "mixes FMPM and FLIP"),
    ],
)
def test_periodic_transfers_of_heat_that_are_not_supported(tmp_path, name, value, words):
    """They were dropped without a word."""
    task = f'<Parameter name="FMPMOrder">2</Parameter><Parameter name="{name}">{value}</Parameter>'
    more = f'<Thermal><Conduction/></Thermal><Schedule name="PeriodicXPIC">{task}</Schedule>'
    assert_refused(tmp_path, words, setup="<StressFreeTemp>300</StressFreeTemp>", more=more)


def test_listed_points_stay_in_holes(tmp_path):
    """Holes are for bodies and pictures only."""
    hole = '<Hole><Rect xmin="0" xmax="4" ymin="0" ymax="4"/></Hole>'
    points = f'{hole}<PointList><mp mat="1"><pt x="1.25" y="1.25"/></mp></PointList>'
    made = translated(tmp_path, source(points=points))
    assert made.scene["bodies"][0]["region"] == {"kind": "points", "file": "points_1.csv"}


def test_lengths_of_lines_and_circles_have_units(tmp_path):
    line = (
        '<BCLine x1="0" y1="0" x2=".2" y2=".2" units="cm" tolerance=".05"><DisBC dir="2" vel="0"/></BCLine>'
    )
    place = scene_of(tmp_path, more=f"<GridBCs>{line}</GridBCs>")["boundary"][0]["on"]["region"]
    assert math.dist(*(map(float, place["points"][i]) for i in (0, 3))) == pytest.approx(1.0)
    arc = 'units="cm" resolution="20" start_angle="0" end_angle="90"'
    crack = f'<CrackList><Circle xmin=".1" xmax=".3" ymin=".1" ymax=".3" {arc}/></CrackList>'
    path = scene_of(tmp_path, more=crack)["cracks"][0]["path"]
    assert (path["center"], path["radius"]) == (pytest.approx([2, 2]), pytest.approx(1))


def test_friction_that_only_holds(tmp_path):
    """Friction at rest without friction of sliding was dropped without a word."""
    friction = "<coeff>0</coeff><coeffStatic>.4</coeffStatic>"
    other = MATERIAL.replace("Stuff", "Other")
    two = '<Body matname="Other"><Rect xmin="0" xmax="4" ymin="4" ymax="6"/></Body>'
    scene = scene_of(
        tmp_path,
        setup='<MultiMaterialMode Normals="2"><Friction lawname="Rub"/></MultiMaterialMode>',
        points=BODY.replace('mat="1"', 'matname="Stuff"') + two,
        material=f'{MATERIAL}{other}<Material Type="61" Name="Rub">{friction}</Material>',
    )
    assert scene["contact"]["law"] == {"kind": "coulomb", "friction": 0, "static_friction": 0.4}


def test_functions_of_rigid_materials_after_a_gap_have_no_effect(tmp_path):
    words = "<SetDirection>3</SetDirection><SettingFunction>5</SettingFunction>"
    tool = f'<Material Type="11" Name="Tool">{words}<SettingFunction3>1</SettingFunction3></Material>'
    made = sound(tmp_path, source(points=TOOL, material=MATERIAL + tool))
    assert [c["direction"] for c in made.scene["boundary"]] == ["x"]
    assert any("SettingFunction3: one before it is missing" in str(note) for note in made.of_kind("ignored"))


def test_a_step_above_that_of_any_material_is_not_taken(tmp_path):
    """The wave speed of materials with axes was unknown, so that too large steps were taken."""
    material = f'<Material Type="3" Name="A"><rho>1</rho>{FIBRES}</Material>'
    time = '<Timing step="10" max="20" CFL="0.4" units="ms"/>'
    assert scene_of(tmp_path, time=time, material=material)["time"] == {"end": 20, "courant": 0.4}
    small = time.replace('step="10"', 'step="1e-4"')
    assert scene_of(tmp_path, time=small, material=material)["time"] == {"end": 20, "step": 1e-4}


@pytest.mark.parametrize(
    ("theirs", "column"),
    [
        ("sZZ", "stress_yy[stuff]"),
        ("sTT", "stress_zz[stuff]"),
        ("sRZ", "stress_xy[stuff]"),
        ("velZ", "velocity_y[stuff]"),
        ("szz", "stress_zz[stuff]"),
    ],
)
def test_quantities_along_the_axes_of_a_cylinder(tmp_path, theirs, column):
    """sZZ, along the axis, was read as szz, around it."""
    setup = f'<GlobalArchiveTime units="ms">1</GlobalArchiveTime><GlobalArchive type="{theirs}"/>'
    archive = scene_of(tmp_path, analysis=13, setup=setup)["archive"]
    assert archive["globals"]["columns"] == [column]


def test_conductivities_along_axes_have_no_effect_without_conduction(tmp_path):
    material = f'<Material Type="3" Name="A"><rho>1</rho>{FIBRES}<kCondA>3</kCondA></Material>'
    sound(tmp_path, source(material=material))


def of_script(tmp_path, words, old='Region "left",100,0,2\n  Rect 1,1+2,1,3\nEndRegion'):
    """The translation of the script with other words in place of its first region."""
    assert old in SCRIPT
    return sound(tmp_path, SCRIPT.replace(old, words))


def sampled(made, index=0):
    """Which points of the plane a body of a translation has, and the points."""
    x = np.random.default_rng(7).uniform([[0.0], [0.0]], [[8.0], [4.0]], (2, 4000))
    return load(write(made)).scene.bodies[index].region.contains(x), x


CUTS = """Region "left",0,0,2
  Rect 0,4,0,4
  Cut Oval 0.5,3.5,0.5,3.5
  Cut Cut PolyPt 1.5,1.5
  Cut Cut PolyPt 2.5,1.5
  Cut Cut PolyPt 2.5,2.5
  Cut PolyPt 0,0
  Cut PolyPt 0.4,0
  Cut PolyPt 0.4,0.4
EndRegion"""


def test_cuts_of_scripts_are_nested(tmp_path):
    inside, (x, y) = sampled(of_script(tmp_path, CUTS))
    oval = (x - 2) ** 2 + (y - 2) ** 2 < 1.5**2
    kept = (x > 1.5) & (x < 2.5) & (y > 1.5) & (y - 1.5 < x - 1.5)
    corner = (x < 0.4) & (y < x)
    assert (inside == (x < 4) & ~(oval & ~kept) & ~corner).all()


@pytest.mark.parametrize(
    "words", ["Cut", "Cut Rect 1,2,1,2", "Rect 0,4,0,4\n  Cut Cut Rect 1,2,1,2", "Cut Rotate z,3"]
)
def test_cuts_need_a_shape(tmp_path, words):
    text = SCRIPT.replace("  Rect 1,1+2,1,3", f"  {words}")
    with pytest.raises(SceneError, match="'Cut'"):
        translated(tmp_path, text)


@pytest.mark.parametrize("angles", [(0, 90), (30, 60), (0, 180), (0, 270), (90, 360), (350, 380), (100, 400)])
@pytest.mark.parametrize("shape", ["Rect", "Oval", "Arc"])
def test_sectors(tmp_path, shape, angles):
    start, end = angles
    words = f'Region "left",0,0,2\n  {shape} 0,4,0,4,{start},{end}{",0.5" * (shape == "Arc")}\nEndRegion'
    inside, (x, y) = sampled(of_script(tmp_path, words))
    r, angle = np.hypot(x - 2, y - 2), np.degrees(np.arctan2(y - 2, x - 2))
    whole = {"Rect": x < 4, "Oval": r < 2, "Arc": abs(r - 2) < 0.5}[shape]
    within = [(start <= angle + turn) & (angle + turn <= end) for turn in (-360, 0, 360)]
    assert (inside == whole & np.any(within, axis=0)).all()


def test_sectors_end_after_they_start(tmp_path):
    points = BODY.replace("/></Body>", '><arc start="90" end="0"/></Rect></Body>')
    assert_refused(tmp_path, "the end angle 0 is below the start angle 90", points=points)
    square = 'xmin="0" xmax="4" ymin="0" ymax="3"'
    points = f'<Body mat="1"><Arc {square} start="0" end="90"/></Body>'
    assert_refused(tmp_path, "arcs other than those of circles", points=points)


def test_conditions_on_arcs(tmp_path):
    words = "GridBC\n  Arc 1,3,1,3,0,180,0.2\n  Velocity x,constant,0\nEndGridBC\nMoveLine 8,0,8,4"
    made = sound(tmp_path, SCRIPT.replace("MoveLine 8,0,8,4", words))
    where = load(write(made)).scene.boundary[1].on.region
    places = np.array([[3.0, 2.0], [2.0, 3.0], [1.0, 2.0], [2.0, 1.0], [2.0, 2.0]]).T
    assert where.contains(places).tolist() == [True, True, True, False, False]


def test_axes_of_regions_of_scripts(tmp_path):
    fibre = (
        'Material "left","Left half","Transverse 2"\n  EA 200\n  GA 30\n  ET 20\n  nuT 0.3\n  rho 1.5\nDone'
    )
    stuff = SCRIPT[SCRIPT.index('Material "left"') : SCRIPT.index('Material "right"')]
    text = SCRIPT.replace(stuff, f"{fibre}\n").replace("  Rect 1,1+2", "  Rotate z,30\n  Rect 1,1+2")
    assert sound(tmp_path, text).scene["bodies"][0]["axes"] == [{"angle": -30}]


PICTURE = """BMPRegion "stuff.png",8
  Origin 0,0,0,"yes"
  Intensity "left",0,100,"vx",1000,"thick",2
  Intensity "right",101,200
EndRegion"""


def test_pictures_of_scripts(tmp_path):
    from PIL import Image

    Image.new("L", (16, 8), 50).save(tmp_path / "stuff.png")
    made = translated(
        tmp_path, SCRIPT.replace(SCRIPT[SCRIPT.index("Region") : SCRIPT.index("MoveLine") - 1], PICTURE)
    )
    first, second = (body["region"] for body in made.scene["bodies"])
    assert first == {
        "kind": "bitmap",
        "file": "stuff.png",
        "origin": [0, 0],
        "flip": "vertical",
        "size": [8, 4],
        "levels": [0, 100],
    }
    assert second["levels"] == [101, 200]
    assert made.scene["bodies"][0]["velocity"] == [1, 0]
    with pytest.raises(SceneError, match="belongs into a 'BMPRegion'"):
        translated(tmp_path, SCRIPT.replace("  Rect 1,1+2", "  Origin 0,0\n  Rect 1,1+2"))


def test_entities_of_scripts(tmp_path):
    xml = '<Body mat="1" vx="&speed;"><vel0Y>&up;</vel0Y><Rect xmin="1" xmax="&xmax;" ymin="1" ymax="3"/></Body>'
    words = f'Entity "speed",#cell*1000\nXMLData "MaterialPoints"\n{xml}\nEndXMLData\n'
    words += 'Entity "up","100*"&"x"\nEntity "xmax",3'
    scene = of_script(tmp_path, words).scene
    assert scene["constants"] == {"speed": "500 mm/s", "xmax": 3}
    body = scene["bodies"][0]
    assert body["velocity"] == ["speed", "0.1*x"]
    assert body["region"]["upper"] == ["xmax", 3]
    text = SCRIPT.replace("EndHeader", f'EndHeader\nXMLData "MaterialPoints"\n{xml}\nEndXMLData')
    problems = translated(tmp_path, text).problems(partial=False)
    assert any("'&xmax;' is not a number" in str(problem) for problem in problems)


def test_other_commands_of_scripts(tmp_path):
    made = script_of(tmp_path, 'PFeedbackDamping 2,"0.5",10\nExtrapolateRigid\nExtrapolateRigid no')
    damping = made.scene["method"]["damping"]["feedback"]
    assert (damping["damps"], damping["gain"]) == ("particle", 2)
    assert sum("<ExtrapolateRigid>" in str(note) for note in made.notes) == 1
    made = script_of(tmp_path, "MultimaterialMode 0,enabled,avggrad\nImperfectInterfaceMM 2,5")
    assert made.scene["contact"]["law"] == {"kind": "linear_interface", "normal": 5, "tangential": 2}
    made = script_of(tmp_path, "MultimaterialMode 0,enabled,avggrad\nImperfectInterfaceMM 2,5,8")
    law = {"kind": "bilinear_interface", "tension": 5, "compression": 8, "tangential": 2}
    assert made.scene["contact"]["law"] == law


def test_softening_of_scripts(tmp_path):
    """Names of properties may have a hyphen."""
    softening = 'Material "left","Left half","IsoSoftening"\n  E 100\n  nu 0.3\n  rho 1\n  sigmac 3\n  I-Gc 2*4\nDone\n'
    stuff = SCRIPT[SCRIPT.index('Material "left"') : SCRIPT.index('Material "right"')]
    made = sound(tmp_path, SCRIPT.replace(stuff, softening))
    assert made.scene["materials"]["left_half"]["toughness"] == "8 J/m^2"


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("heat energy", "heat_inflow: nothing conducts heat"),
        ("thermal energy", "thermal_energy: nothing conducts heat"),
        ("friction work", "contact_work: nothing is in contact"),
        ("interface energy", "interface_energy: there is no interface"),
        *((kind, f"'{kind}' is not archived") for kind in ("velz", "dispz", "sxz", "exz")),
    ],
)
def test_columns_that_the_scene_lacks(tmp_path, kind, words):
    setup = f'<GlobalArchiveTime units="ms">1</GlobalArchiveTime><GlobalArchive type="{kind}"/>'
    made = sound(tmp_path, source(setup=setup))
    assert any(words in str(note) for note in made.of_kind("ignored"))


def test_bodies_end_where_the_grid_ends(tmp_path):
    wide = '<Body mat="1"><Rect xmin="-3" xmax="1" ymin="0" ymax="9"/></Body>'
    round_one = '<Body mat="1"><Oval xmin="4" xmax="8" ymin="0" ymax="4"/></Body>'
    beyond = '<Body mat="1"><Rect xmin="6" xmax="9" ymin="0" ymax="4"/></Body>'
    made = sound(tmp_path, source(points="\n".join((wide, round_one, beyond))))
    first, second = (body["region"] for body in made.scene["bodies"])
    assert (first["lower"], first["upper"]) == ([-2, 0], [1, 6])
    assert second["kind"] == "intersection"
    assert second["regions"][1]["upper"] == [6, 6]
    notes = "\n".join(map(str, made.notes))
    assert notes.count("beyond the grid is left out") == 2
    assert notes.count("the body lies beyond the grid") == 1


def test_holes_after_all_bodies_are_noted(tmp_path):
    hole = '<Hole><Rect xmin="1" xmax="2" ymin="1" ymax="2"/></Hole>'
    made = sound(tmp_path, source(points=BODY + hole))
    assert any("there is none" in str(note) for note in made.of_kind("ignored"))
    assert not any("there is none" in str(note) for note in sound(tmp_path, source(points=hole + BODY)).notes)


MORE = "".join(
    f'<Material Type="1" Name="S{i}"><rho>1</rho><E>100</E><nu>0.3</nu></Material>' for i in range(2)
)
THREE = "".join(
    f'<Body mat="{i + 1}"><Rect xmin="{i}" xmax="{i + 1}" ymin="0" ymax="4"/></Body>' for i in range(3)
)


def test_nodes_of_three_materials(tmp_path):
    pairs = {"setup": '<MultiMaterialMode Normals="2" Lumping="1"/>'}
    three = {"points": THREE, "material": MATERIAL + MORE}
    assert scene_of(tmp_path, **pairs, **three)["contact"]["three_or_more"] == "pairs"
    lumped = scene_of(tmp_path, setup='<MultiMaterialMode Normals="2" Lumping="0"/>', **three)
    assert "three_or_more" not in lumped["contact"]
    two = {"points": THREE.replace('mat="3"', 'mat="2"'), "material": MATERIAL + MORE}
    made = sound(tmp_path, source(**pairs, **two))
    assert "three_or_more" not in made.scene["contact"]
    assert any("Lumping: there are fewer" in str(note) for note in made.of_kind("ignored"))
    assert_refused(tmp_path, "Lumping 2", setup='<MultiMaterialMode Normals="2" Lumping="2"/>', **three)


def test_commands_of_scripts_are_not_lost(tmp_path):
    words = 'Processors 4\nComment "Speed = ",3\nMultimaterialMode 0.8,disabled,avggrad'
    made = script_of(tmp_path, words)
    assert made.scene["contact"]["separation"] == {"kind": "none"}
    assert any("Vmin 0.8" in str(note) for note in made.of_kind("changed"))
    assert any("<Processors>: mpmcli run -j" in str(note) for note in made.of_kind("ignored"))
    assert "Comment: Speed = , 3" in made.comments["title",]
    colored = SCRIPT.replace("  rho 1.5", "  rho 1.5\n  color 1,0,0")
    assert any("<color>" in str(note) for note in sound(tmp_path, colored).of_kind("ignored"))


def test_cracks_in_axisymmetric_bodies_end_at_the_axis(tmp_path):
    text = source(
        analysis=13,
        points='<Body mat="1"><Rect xmin="0" xmax="4" ymin="0" ymax="4"/></Body>',
        more='<CrackList><pt x="2" y="2.1" tip="1"/><pt x="0.1" y="2.1" tip="-2"/></CrackList>',
    )
    made = sound(tmp_path, text)
    assert made.scene["cracks"][0]["path"]["points"] == [[2, 2.1], [0, 2.1]]
    assert any("to the axis" in str(note) for note in made.of_kind("changed"))


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ('<Body mat="1" vx="3" thick="1"><Line xmin="0" xmax="1" ymin="0" ymax="1"/></Body>', "shape"),
        ('<Body mat="7" vx="3"><Rect xmin="0" xmax="1" ymin="0" ymax="1"/></Body>', "no material 7"),
        ('<BMP name="none.png" width="3"><Intensity mat="1" imin="0" imax="9"/></BMP>', "cannot be read"),
    ],
)
def test_one_fault_of_a_body_is_one_problem(tmp_path, points, words):
    made = translated(tmp_path, source(points=BODY + points))
    assert [words in str(problem) for problem in made.problems(partial=False)] == [True]


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"setup": "<StressFreeTemp>300</StressFreeTemp>"}, "<StressFreeTemp>: no temperature changes"),
        ({"more": "<Gravity><BodyZForce>3</BodyZForce></Gravity>"}, "<BodyZForce>: there is no axis z"),
        ({"more": "<Gravity><GridBodyZForce>x</GridBodyZForce></Gravity>"}, "no axis z"),
        ({"points": BODY.replace('mat="1"', 'mat="1" vz="3"')}, "a velocity along z"),
        ({"material": MATERIAL.replace("<E>", "<G>3</G><K>4</K><E>")}, "G: E and nu are given"),
    ],
)
def test_what_has_no_effect_is_listed(tmp_path, parts, words):
    made = sound(tmp_path, source(**parts))
    assert any(words in str(note) for note in made.of_kind("ignored"))
