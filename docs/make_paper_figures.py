"""Make figures of papers again: the pictures, tables and pages of ``docs/gallery``.

    python docs/make_paper_figures.py NAME… [--results DIR] [--list]

NAME is a figure of ``docs/figures``, or ``all``, or ``pages`` to write the texts only. Results are kept
in ``--results`` and used again; they are found by their scene, so that figures share them.
"""

from __future__ import annotations

import argparse
import sys
from itertools import groupby
from pathlib import Path

import figures
from figures.base import IMAGES, PAGES, PAPERS, Figure, Runs, write_table
from make_studies import draw_study

sys.path.append(str(Path(__file__).parents[1] / "tests"))  # overlap.py, which one of the figures imports

INDEX = """\
# Gallery

The gallery contains [pictures of small scenes](scenes.md) and figures of three papers computed again. One command
makes each figure from a scene of `inputs/`. Each page shows the figure, the numbers of mpmcli beside the published
ones, and the differences with their reasons. Published numbers are those in the text of the papers, not read from
curves.
"""


def index(all_figures: list[Figure]) -> str:
    """The text of the page that leads to all others."""
    lines = [INDEX, "```{toctree}", ":hidden:", "", "scenes", *(each.name for each in all_figures), "```", ""]
    for paper, group in groupby(all_figures, key=lambda each: each.paper):
        lines += [f"## {PAPERS[paper][1]}", "", f"{{cite:t}}`{paper}`:", ""]
        lines += ["| figure | | here |", "| --- | --- | --- |"]
        lines += [f"| [{each.number}]({each.name}.md) | {each.title} | {each.verdict} |" for each in group]
        lines += [""]
    return "\n".join(lines).rstrip() + "\n"


def make(figure: Figure, results: Path) -> None:
    """Run what is not done yet, and write table and picture."""
    runs = Runs(results)
    if figure.measure is not None:
        write_table(figure.table, figure.measure(runs))
        print(figure.table.read_text(encoding="utf-8"))
    if figure.draw is not None:
        figure.draw(runs, IMAGES / "papers" / f"{figure.name}.png")
    for name in figure.studies:
        draw_study(name, runs.trade(name))


def write_pages(all_figures: list[Figure]) -> None:
    """Write the texts of all pages."""
    for each in all_figures:
        (PAGES / f"{each.name}.md").write_text(each.page(), encoding="utf-8")
    (PAGES / "index.md").write_text(index(all_figures), encoding="utf-8")


def main() -> None:
    """Make what is asked for."""
    all_figures = [figures.figure(name) for name in figures.names()]
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="+", choices=["all", "pages", *figures.names()], metavar="NAME")
    parser.add_argument("--results", metavar="DIR", type=Path, default=Path("results") / "papers")
    parser.add_argument("--list", action="store_true", help="only print the commands")
    arguments = parser.parse_args()
    for each in all_figures:
        if each.name in arguments.names or "all" in arguments.names:
            if arguments.list:
                print(*each.commands(), sep="\n")
            else:
                make(each, arguments.results)
    if not arguments.list:
        write_pages(all_figures)


if __name__ == "__main__":
    main()
