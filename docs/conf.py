"""Configuration of the documentation: ``sphinx-build -W docs docs/_build``."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import generate_reference  # noqa: E402

import mpmcli  # noqa: E402

generate_reference.write()

project = "mpmcli"
author = "The mpmcli authors"
copyright = author
version = release = mpmcli.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.mathjax",
    "sphinx-mathjax-offline",  # formulas render without a network
    "sphinx_copybutton",
    "sphinx_design",
    "sphinxcontrib.bibtex",
]
myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
bibtex_bibfiles = ["references.bib"]
bibtex_reference_style = "author_year"
math_number_all = False
numfig = True
# the tables of quantities and shapes are included by other pages
exclude_patterns = ["_build", "_generated/*_quantities.md", "_generated/shapes.md"]

html_theme = "furo"
html_title = f"mpmcli {version}"
html_copy_source = False
html_static_path = ["_static"]
html_css_files = ["mpmcli.css"]
