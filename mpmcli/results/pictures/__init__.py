"""Pictures of results: tables over time, particles at a time, animations, a script for ParaView."""

from mpmcli.results.pictures.request import Request, plot

__all__ = ["Request", "plot"]
