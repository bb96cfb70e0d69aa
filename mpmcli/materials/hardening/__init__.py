"""Flow stress of metals against plastic strain, rate and temperature, chosen by ``kind``: one file per law."""

from typing import Annotated

from pydantic import Field

from mpmcli.materials.hardening.base import changes_stiffness, flow, flow_stress, stiffness_ratio
from mpmcli.materials.hardening.johnson_cook import JohnsonCook, JohnsonCookHardening
from mpmcli.materials.hardening.linear import Linear, LinearHardening
from mpmcli.materials.hardening.power_law import PowerLaw, PowerLawHardening
from mpmcli.materials.hardening.steinberg_cochran_guinan import (
    SteinbergCochranGuinan,
    SteinbergCochranGuinanHardening,
)
from mpmcli.materials.hardening.swift import Swift, SwiftHardening
from mpmcli.materials.hardening.voce import Voce, VoceHardening

Hardening = Annotated[
    LinearHardening
    | JohnsonCookHardening
    | PowerLawHardening
    | SteinbergCochranGuinanHardening
    | SwiftHardening
    | VoceHardening,
    Field(discriminator="kind"),
]
LAWS = (Linear, JohnsonCook, PowerLaw, SteinbergCochranGuinan, Swift, Voce)
"""The tuple of numbers of each."""

__all__ = [
    "LAWS",
    "Hardening",
    "JohnsonCook",
    "Linear",
    "changes_stiffness",
    "flow",
    "flow_stress",
    "stiffness_ratio",
]
