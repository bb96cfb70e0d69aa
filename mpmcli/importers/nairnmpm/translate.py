"""The translation of a command file."""

from __future__ import annotations

from pathlib import Path

from mpmcli.core.errors import Problem, SceneError
from mpmcli.importers.base import Translation, read_source
from mpmcli.importers.nairnmpm.commands import CommandFile, parse


def translate(path: Path, partial: bool) -> Translation:
    """Translate an XML command file of NairnMPM."""
    source = parse(read_source(path), path)
    if source.root.name != "JANFEAInput":
        words = f"the file begins with <{source.root.name}>; files of NairnMPM begin with <JANFEAInput>"
        raise SceneError([Problem("", words, str(path), source.root.line, code="source")])
    translation = Translation(path, "NairnMPM")
    _Translator(source, translation).run()
    return translation


class _Translator:
    def __init__(self, source: CommandFile, made: Translation):
        self.source = source
        self.made = made

    def run(self) -> None:
        self.made.scene["version"] = 1
        for block in self.source.root.children:
            self.made.note("not_supported", block.line, block.name, "no counterpart")
