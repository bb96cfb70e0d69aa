"""Run small scenes that come with mpmcli and draw them: the pictures and the text of ``docs/gallery/scenes.md``.

    python docs/make_gallery.py [--only NAME] [--results DIR [--reuse]]

Takes about a minute when the kernels are compiled. Pictures are made by ``mpmcli plot``, with a palette that keeps them
small. Without ``--results`` the results are thrown away.
"""

from __future__ import annotations

import argparse
import shlex
import tempfile
from dataclasses import dataclass
from pathlib import Path

from PIL import Image, ImageSequence

from mpmcli.cli.main import call
from mpmcli.scene.shipped import TEMPLATES, shipped

HERE = Path(__file__).parent
IMAGES = HERE / "images" / "gallery"
PAGE = HERE / "gallery" / "scenes.md"
WIDTH, COLORS = 720, 256
"""Most pixels across, and colours, of the pictures on the page."""
MOVING_WIDTH, MOVING_COLORS = 560, 160
"""The same of animations."""

INTRODUCTION = """\
# Small scenes

The commands beside each picture run and draw small scenes of mpmcli. `python docs/make_gallery.py` makes this page.
"""


@dataclass(frozen=True)
class Drawn:
    """One picture: its name, the options of ``mpmcli plot``, and what it shows."""

    name: str
    options: tuple[str, ...]
    words: str

    @property
    def file(self) -> str:
        """Name of the file."""
        return f"{self.name}.gif" if "--animate" in self.options else f"{self.name}.png"


@dataclass(frozen=True)
class Shown:
    """One scene: its file, the options of ``mpmcli run``, and its pictures."""

    scene: str
    title: str
    options: tuple[str, ...]
    pictures: tuple[Drawn, ...]

    @property
    def commands(self) -> list[list[str]]:
        """What writes the scene, if it is a template, and runs it."""
        if shipped()[self.scene].parent == TEMPLATES:
            file = f"{self.scene}.yaml"
            return [["mpmcli", "new", self.scene, "-o", file], ["mpmcli", "run", file, *self.options]]
        return [["mpmcli", "run", f"inputs/{self.scene}.yaml", *self.options]]


GALLERY = (
    Shown(
        "two_disks",
        "Two disks with friction",
        ("--set", "archive.particles.every=0.005", "-D", "cell=1"),
        (
            Drawn(
                "two_disks",
                ("--color", "pressure", "--animate", "gif"),
                "Two rubber disks collide with offset centres, slide along each other with friction, and separate.",
            ),
            Drawn(
                "two_disks_pressure",
                ("--color", "pressure", "--time", "0.09"),
                "Pressure during sliding. Each particle is drawn as its deformed domain.",
            ),
            Drawn(
                "two_disks_contact",
                ("--what", "contact"),
                "Friction work, force of the right disk on the left one, and number of contact nodes.",
            ),
        ),
    ),
    Shown(
        "taylor_bar",
        "Taylor bar",
        ("--set", "archive.particles.fields=[stress, equivalent_plastic_strain, deformation_gradient]"),
        (
            Drawn(
                "taylor_bar",
                ("--color", "equivalent_plastic_strain"),
                "Plastic strain of a copper bar after its impact on a rigid wall at 190 m/s, in the plane of r and z.",
            ),
        ),
    ),
    Shown(
        "mesh_3d",
        "A body from an STL file",
        (),
        (
            Drawn(
                "mesh_3d",
                ("--what", "particles", "--color", "velocity", "--time", "3"),
                "Speed of a rubber knot, read from an STL file, while it lands on a floor.",
            ),
        ),
    ),
    Shown(
        "indentation",
        "Indentation",
        (),
        (
            Drawn(
                "indentation",
                ("--what", "particles", "--color", "equivalent_plastic_strain"),
                "Plastic strain in a metal block after indentation by a rigid ball.",
            ),
            Drawn(
                "indentation_force",
                ("--column", "contact_force_y*"),
                "Force of the ball on the block over time.",
            ),
        ),
    ),
    Shown(
        "delamination",
        "Delamination",
        (),
        (
            Drawn(
                "delamination",
                ("--color", "damage_of_bond", "--time", "2.5"),
                "Damage of the joint between two arms that are moved apart: 1 where it has failed.",
            ),
            Drawn(
                "delamination_energy",
                ("--column", "*_work,interface_energy"),
                "Work of the grips, energy stored in and dissipated by the joint, over time.",
            ),
        ),
    ),
    Shown(
        "edge_crack",
        "A crack in a plate",
        (),
        (
            Drawn(
                "edge_crack_stress",
                ("--color", "stress_yy"),
                "Stress along the load around the tip of an edge crack, whose faces are drawn.",
            ),
            Drawn(
                "edge_crack_factors",
                ("--column", "K_I*,K_II*"),
                "Stress intensity factors over time; the load rises until 0.2 ms.",
            ),
        ),
    ),
    Shown(
        "double_cantilever",
        "A crack that grows and is arrested",
        (),
        (
            Drawn(
                "double_cantilever_stress",
                ("--color", "stress_xx", "--time", "3.5"),
                "Stress along a double cantilever whose ends are held apart, after its crack has been arrested.",
            ),
            Drawn(
                "double_cantilever_length",
                ("--column", "crack_length*"),
                "Length of the crack over time; the ends are held from 2.5 ms on.",
            ),
        ),
    ),
    Shown(
        "inclined_crack",
        "A crack that turns",
        ("-D", "growth=1", "--set", "time.end=0.56"),
        (
            Drawn(
                "inclined_crack_stress",
                ("--color", "stress_yy", "--time", "0.5"),
                "Stress along the load around an inclined crack, which has turned normal to the load.",
            ),
        ),
    ),
    Shown(
        "dam_break",
        "Dam break",
        (),
        (
            Drawn(
                "dam_break_pressure",
                ("--color", "pressure", "--time", "0.13"),
                "Pressure in a column of water that collapses on a smooth floor.",
            ),
        ),
    ),
    Shown(
        "granular_column",
        "Column collapse",
        ("-D", "aspect=4", "--set", "archive.particles.fields=[velocity, deformation_gradient]"),
        (
            Drawn(
                "granular_column",
                ("--what", "particles", "--color", "velocity", "--time", "0.2"),
                "Speed of a column of sand that collapses beside a plane of symmetry.",
            ),
        ),
    ),
    Shown(
        "snowballs",
        "Two snowballs",
        (),
        (
            Drawn(
                "snowballs",
                ("--what", "particles", "--color", "plastic_log_volume"),
                "Logarithm of the plastic volume ratio after the impact: compacted snow is blue, loosened snow red.",
            ),
        ),
    ),
    Shown(
        "notched_plate",
        "Crack between two notches",
        (),
        (
            Drawn(
                "notched_plate",
                ("--what", "particles", "--color", "damage"),
                "Damage of a plate that is drawn until a crack joins its two notches: 1 where it has failed.",
            ),
        ),
    ),
    Shown(
        "bitmap_grains",
        "Grains from a picture",
        (),
        (
            Drawn(
                "bitmap_grains_material",
                ("--color", "material", "--frame", "0"),
                "Grains and matrix, read from `inputs/bitmap_grains.png`.",
            ),
            Drawn(
                "bitmap_grains_stress",
                ("--color", "von_mises"),
                "Von Mises stress under compression of the box.",
            ),
        ),
    ),
    Shown(
        "kirsch_plate",
        "Plate with a hole",
        (),
        (
            Drawn(
                "kirsch_plate",
                ("--what", "particles", "--color", "stress_xx"),
                "Axial stress of a quarter of a plate with a hole under tension.",
            ),
        ),
    ),
    Shown(
        "rolling_disk",
        "Disk on an incline",
        (),
        (
            Drawn(
                "rolling_disk",
                ("--what", "particles", "--color", "velocity", "--time", "100"),
                "Speed of a disk that rolls on a rigid plane; the contact point is at rest.",
            ),
        ),
    ),
    Shown(
        "band_brake",
        "Band brake",
        (),
        (
            Drawn(
                "band_brake",
                ("--what", "particles", "--color", "von_mises", "--time", "300"),
                "Von Mises stress of a band around a turning drum: friction raises its tension towards the held end.",
            ),
        ),
    ),
    Shown(
        "squealing_block",
        "Squeal",
        (),
        (
            Drawn(
                "squealing_block",
                ("--column", "contact_force_x[block],contact_force_y[block]"),
                "Forces of a rigid floor on a block that slides: friction makes a vibration grow until it bounces.",
            ),
        ),
    ),
    Shown(
        "vortex",
        "Vortex",
        (),
        (
            Drawn(
                "vortex",
                ("--what", "particles", "--color", "displacement", "--time", "0.5"),
                "Displacement of a ring under the body force of a manufactured solution.",
            ),
        ),
    ),
    Shown(
        "heat_flying_disk",
        "Heat in a translating disk",
        (),
        (
            Drawn(
                "heat_flying_disk",
                ("--what", "particles", "--color", "temperature", "--time", "64"),
                "Temperature of an insulated disk that moves over the grid while heat flows to its cold side.",
            ),
        ),
    ),
    Shown(
        "heat_fin",
        "Cooling fin",
        (),
        (
            Drawn(
                "heat_fin",
                ("--what", "particles", "--color", "temperature"),
                "Temperature of half a fin, heated at its foot and cooled by air along its side.",
            ),
        ),
    ),
    Shown(
        "vibrating_bar",
        "Vibrating bar",
        (),
        (
            Drawn("vibrating_bar_energies", ("--what", "energies"), "Energies over ten periods."),
            Drawn("vibrating_bar_velocity", ("--color", "velocity_x"), "Velocity along the bar at the end."),
        ),
    ),
)


def page() -> str:
    """The text of the page."""
    lines = [INTRODUCTION]
    for shown in GALLERY:
        lines += [f"## {shown.title}", "", "```bash", *map(shlex.join, shown.commands), "```", ""]
        for picture in shown.pictures:
            plot = ["mpmcli", "plot", f"results/{shown.scene}", *picture.options]
            lines += [picture.words, "", "```bash", shlex.join(plot), "```", ""]
            lines += [f"```{{image}} ../images/gallery/{picture.file}", f":alt: {picture.words}", "```", ""]
    return "\n".join(lines).rstrip() + "\n"


def make(shown: Shown, results: Path, reuse: bool) -> None:
    """Run a scene, unless its results are there to be used again, and draw its pictures."""
    directory = results / shown.scene
    scene = str(shipped()[shown.scene])
    is_there = reuse and (directory / "run.json").exists()
    if not is_there and call(["run", scene, *shown.options, "-o", str(directory), "--overwrite", "-q"]):
        raise SystemExit(f"{shown.scene} failed")
    for picture in shown.pictures:
        path = IMAGES / picture.file
        if call(["plot", str(directory), *picture.options, "-o", str(path)]):
            raise SystemExit(f"{picture.name} failed")
        shrink(path)


def shrink(path: Path) -> None:
    """Make a picture no wider than the page, and give it a palette."""
    if path.suffix == ".gif":
        shrink_animation(path)
        return
    with Image.open(path) as image:
        small = image.convert("RGB")
    small.thumbnail((WIDTH, 10 * WIDTH), Image.Resampling.LANCZOS)
    small.quantize(COLORS, dither=Image.Dither.NONE).save(path, optimize=True)


def shrink_animation(path: Path) -> None:
    """Make an animation small: fewer pixels, and one palette for all frames."""
    with Image.open(path) as image:
        duration = image.info["duration"]
        frames = [frame.convert("RGB") for frame in ImageSequence.Iterator(image)]
    for frame in frames:
        frame.thumbnail((MOVING_WIDTH, 10 * MOVING_WIDTH), Image.Resampling.LANCZOS)
    width, height = frames[0].size
    every = Image.new("RGB", (width, height * len(frames)))
    for k, frame in enumerate(frames):
        every.paste(frame, (0, k * height))
    palette = every.quantize(MOVING_COLORS)
    first, *others = (frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames)
    first.save(path, save_all=True, append_images=others, duration=duration, loop=0, optimize=True)


def main() -> None:
    """Make the page and its pictures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", metavar="NAME", help="make the pictures of one scene")
    parser.add_argument("--results", metavar="DIR", type=Path, help="keep the results here")
    parser.add_argument("--reuse", action="store_true", help="draw the results that are kept already")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        for shown in GALLERY:
            if arguments.only in (None, shown.scene):
                make(shown, arguments.results or Path(temporary), arguments.reuse)
    PAGE.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
