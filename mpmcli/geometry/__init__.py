"""Regions of space, one kind per file, and filling them with particles; importing it registers all kinds."""

from mpmcli.core.plugins import load_plugins
from mpmcli.core.registry import discover
from mpmcli.geometry.base import REGIONS, Region, complete_regions
from mpmcli.geometry.faces import surface_faces
from mpmcli.geometry.fill import BodyParticles, fill_bodies
from mpmcli.geometry.report import BodyReport, body_report, report_table

discover(__name__, __path__)
load_plugins("regions", REGIONS, Region)
complete_regions()

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
