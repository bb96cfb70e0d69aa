"""Exact fields of tips on particles."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from particles_at import particles_at

from mpmcli.core.analysis import Analysis, PlaneStrain, PlaneStress
from mpmcli.core.particles import Particles
from mpmcli.cracks.chain import Chain
from mpmcli.cracks.integrals.base import Frame
from mpmcli.cracks.integrals.elastic import PlaneElasticity, field_of_mode
from mpmcli.materials import MATERIALS

Array = np.ndarray

STEEL = MATERIALS["linear_elastic"].model_validate(
    {"kind": "linear_elastic", "density": 1.3, "E": 1000.0, "nu": 0.3}
)
PLANE_STRAIN = PlaneStrain()


class TipField(NamedTuple):
    """Stress and displacement gradients of a tip.

    stress : (3, n) 11, 22, 12 [pressure]
    slope : (2, n) u_1,1 and u_2,1 [-]
    """

    stress: Array
    slope: Array


def tip_field(x: Array, K_I: float, K_II: float, elasticity: PlaneElasticity) -> TipField:
    """Return the field of a tip (Williams 1957) at ``x`` (2, n) in its frame."""
    at = np.arctan2(x[1], x[0])
    half = 0.5 * np.exp(-0.5j * at) / np.sqrt(2.0 * np.pi * np.hypot(*x))
    one, two = (np.stack(field_of_mode(half, np.exp(2j * at), mode, elasticity.kappa)) for mode in (1, 2))
    field = K_I * one + K_II * two
    return TipField(field[:3], field[3:] / (2.0 * elasticity.shear))


def strain_of(stress: Array, elasticity: PlaneElasticity) -> Array:
    """Strain 11, 22, 12 in the plane of a stress (3, n)."""
    mean = 0.25 * (3.0 - elasticity.kappa) * (stress[0] + stress[1])
    return np.stack([stress[0] - mean, stress[1] - mean, stress[2]]) / (2.0 * elasticity.shear)


def mixed(stress: Array, strain: Array) -> Array:
    """σ:ε of components 11, 22, 12, each (3, n)."""
    return np.asarray(stress[0] * strain[0] + stress[1] * strain[1] + 2.0 * stress[2] * strain[2])


@dataclass
class Plate:
    """Particles, four per cell of size ``cell``, around a tip.

    ``T`` is a stress along the crack on top, ``pressed`` are 22 and 12 of another one, ``turn`` is a rotation of all of
    it afterwards.
    """

    K_I: float
    K_II: float
    elasticity: PlaneElasticity
    analysis: Analysis = PLANE_STRAIN
    tip: tuple[float, float] = (0.0, 0.0)
    angle: float = 0.0
    turn: float = 0.0
    cell: float = 0.1
    thickness: float = 2.0
    T: float = 0.0
    pressed: tuple[float, float] = (0.0, 0.0)

    @property
    def frame(self) -> Frame:
        """The tip after the rotation."""
        angle = self.angle + self.turn
        point = rotation(self.turn) @ np.array(self.tip)
        return Frame(point, np.array([np.cos(angle), np.sin(angle)]))

    def particles(self, cells: int = 9) -> Particles:
        """Return the particles."""
        places = (np.arange(-2 * cells, 2 * cells) + 0.5) * 0.5 * self.cell
        X = np.stack([a.ravel() for a in np.meshgrid(places, places)])
        count = X.shape[1]
        vol0 = 0.25 * self.cell**2 * self.thickness
        p = particles_at(self.analysis, X, 0.25 * self.cell, vol0, 1.3 * vol0)
        c, s = np.cos(self.angle), np.sin(self.angle)
        ahead = np.array([[c, s], [-s, c]])
        x = ahead @ (X - np.array(self.tip)[:, None])
        stress, slope = tip_field(x, self.K_I, self.K_II, self.elasticity)
        stress += np.array([[self.T], [self.pressed[0]], [self.pressed[1]]])
        slope[1] += self.pressed[1] / (2.0 * self.elasticity.shear)  # without rotation
        strain = strain_of(stress, self.elasticity)
        slope[0] = strain[0]
        gradient = np.array([[slope[0], 2.0 * strain[2] - slope[1]], [slope[1], strain[1]]])
        Q = rotation(self.turn) @ ahead.T
        G = np.einsum("ab,bcn,dc->adn", ahead.T, gradient, ahead.T)
        F = np.linalg.inv(np.eye(2)[:, :, None].transpose(2, 0, 1) - G.transpose(2, 0, 1))
        F = rotation(self.turn) @ F
        sigma = np.array([[stress[0], stress[2]], [stress[2], stress[1]]])
        sigma = np.einsum("ab,bcn,dc->adn", Q, sigma, Q)
        p.X[:] = rotation(self.turn) @ X
        p.F[:4] = F.reshape(count, 4).T
        J = p.determinant()
        szz = 0.0 if isinstance(self.analysis, PlaneStress) else 0.3 * (stress[0] + stress[1])
        p.tau[:] = np.stack([sigma[0, 0], sigma[1, 1], np.zeros(count) + szz, sigma[0, 1]]) * J
        p.stress_work[:] = 0.5 * mixed(stress, strain) * vol0 * J
        return p

    def crack(self, points: int = 20) -> Chain:
        """Return a crack that ends in the tip, in segments of half a cell; its faces are where the field has them."""
        r = 0.5 * self.cell * np.arange(points)[::-1]
        size = 8.0 * np.sqrt(r / (2.0 * np.pi)) / self.elasticity.modulus
        jump = np.stack([self.K_II * size, self.K_I * size])
        c, s = np.cos(self.angle), np.sin(self.angle)
        out = rotation(self.turn) @ np.array([[c, -s], [s, c]])
        X = self.frame.point[:, None] + out @ np.stack([-r, 0.0 * r])
        chain = Chain("main", 0, X, (False, True))
        chain.faces += 0.5 * np.stack([out @ jump, -(out @ jump)])
        return chain


def rotation(angle: float) -> np.ndarray:
    """(2, 2) rotation by an angle in radians."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])
