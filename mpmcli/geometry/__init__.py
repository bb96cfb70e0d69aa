"""Regions of space, one kind per file, imported when a scene names it; and filling them with particles."""

from mpmcli.core.plugins import load_plugins
from mpmcli.geometry.base import REGIONS, Region
from mpmcli.geometry.bodies import BodyParticles
from mpmcli.geometry.faces import surface_faces
from mpmcli.geometry.fill import fill_bodies
from mpmcli.geometry.report import BodyReport, body_report, report_table

load_plugins("regions", REGIONS, Region)

__all__ = [
    "REGIONS",
    "BodyParticles",
    "BodyReport",
    "Region",
    "body_report",
    "fill_bodies",
    "report_table",
    "surface_faces",
]
