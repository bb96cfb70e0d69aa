"""NairnMPM's XML command files as scenes."""

from mpmcli.importers.nairnmpm.translate import translate

__all__ = ["translate"]
