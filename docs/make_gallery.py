"""Run small scenes of ``inputs/`` and draw them: the pictures and the text of ``docs/gallery/scenes.md``.

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

from PIL import Image

from mpmcli.cli.main import call

HERE = Path(__file__).parent
IMAGES = HERE / "images" / "gallery"
PAGE = HERE / "gallery" / "scenes.md"
WIDTH, COLORS = 720, 256
"""Most pixels across, and colours, of the pictures on the page."""

FIELDS = ("--set", "archive.particles.fields=[velocity, stress, deformation_gradient]")

INTRODUCTION = """\
# Small scenes

Small scenes of `inputs/`, run and drawn by the commands beside each picture. `python docs/make_gallery.py` makes this
page.
"""


@dataclass(frozen=True)
class Drawn:
    """One picture: its name, the options of ``mpmcli plot``, and what it shows."""

    name: str
    options: tuple[str, ...]
    words: str


@dataclass(frozen=True)
class Shown:
    """One scene: its file, the options of ``mpmcli run``, and its pictures."""

    scene: str
    title: str
    options: tuple[str, ...]
    pictures: tuple[Drawn, ...]


GALLERY = (
    Shown(
        "two_disks",
        "Two disks with friction",
        (*FIELDS, "-D", "cell=1"),
        (
            Drawn(
                "two_disks_pressure",
                ("--color", "pressure", "--time", "0.09"),
                "Pressure while they slide along each other. Each particle is drawn as its deformed domain.",
            ),
            Drawn(
                "two_disks_contact",
                ("--what", "contact"),
                "Energy that friction takes, the force of the right disk on the left one, and the nodes they share.",
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
        "bitmap_grains",
        "Grains from a picture",
        FIELDS,
        (
            Drawn(
                "bitmap_grains_material",
                ("--color", "material", "--frame", "0"),
                "Grains and matrix, read from `inputs/bitmap_grains.png`.",
            ),
            Drawn(
                "bitmap_grains_stress", ("--color", "von_mises"), "Von Mises stress when the box is squeezed."
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
        run = ["mpmcli", "run", f"inputs/{shown.scene}.yaml", *shown.options]
        lines += [f"## {shown.title}", "", "```bash", shlex.join(run), "```", ""]
        for picture in shown.pictures:
            plot = ["mpmcli", "plot", f"results/{shown.scene}", *picture.options]
            lines += [picture.words, "", "```bash", shlex.join(plot), "```", ""]
            lines += [
                f"```{{image}} ../images/gallery/{picture.name}.png",
                f":alt: {picture.words}",
                "```",
                "",
            ]
    return "\n".join(lines).rstrip() + "\n"


def make(shown: Shown, results: Path, reuse: bool) -> None:
    """Run a scene, unless its results are there to be used again, and draw its pictures."""
    directory = results / shown.scene
    scene = str(HERE.parent / "inputs" / f"{shown.scene}.yaml")
    is_there = reuse and (directory / "run.json").exists()
    if not is_there and call(["run", scene, *shown.options, "-o", str(directory), "--overwrite", "-q"]):
        raise SystemExit(f"{shown.scene} failed")
    for picture in shown.pictures:
        path = IMAGES / f"{picture.name}.png"
        if call(["plot", str(directory), *picture.options, "-o", str(path)]):
            raise SystemExit(f"{picture.name} failed")
        shrink(path)


def shrink(path: Path) -> None:
    """Make a picture no wider than the page, and give it a palette."""
    with Image.open(path) as image:
        small = image.convert("RGB")
    small.thumbnail((WIDTH, 10 * WIDTH), Image.Resampling.LANCZOS)
    small.quantize(COLORS, dither=Image.Dither.NONE).save(path, optimize=True)


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
