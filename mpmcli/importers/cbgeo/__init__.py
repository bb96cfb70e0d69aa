"""Inputs of CB-Geo MPM (JSON with files of mesh, particles and sets) as scenes."""

from mpmcli.importers.cbgeo.translate import translate

__all__ = ["translate"]
