"""Criteria of crack growth, one per file; imported when a scene names them."""

from mpmcli.cracks.criteria.base import CRITERIA, Criterion

__all__ = ["CRITERIA", "Criterion"]
