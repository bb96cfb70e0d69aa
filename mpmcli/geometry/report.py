"""The set-up report: what became of every body."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mpmcli.core.analysis import Analysis, Axisymmetric
from mpmcli.geometry.base import Region
from mpmcli.geometry.bodies import BodyParticles, BodyRequest
from mpmcli.geometry.lattice import GridBox
from mpmcli.geometry.vectors import in_words

Array = np.ndarray

SAMPLES = 1_000_000
"""Points with which the size of a region is estimated where no closed form is known."""


@dataclass(frozen=True)
class BodyReport:
    """A body at set-up, in the units of the scene; volumes of the full ring where axisymmetric.

    Attributes
    ----------
    name : the body's
    particles : their number
    mass : [mass]; None of a rigid body, which has none
    volume : sum over the particles, thickness or area included [length³]
    center : (d,) centre of mass; of a rigid body that of its volume [length]
    lower, upper : (d,) bounds of the particles' domains [length]
    region_volume : the region's own volume [length³]
    exact : whether the region's volume is a closed form, or an estimate by sampling
    notes : what else there is to say, e.g. whether a mesh is closed, or along what the particles lie
    """

    name: str
    particles: int
    mass: float | None
    volume: float
    center: Array
    lower: Array
    upper: Array
    region_volume: float
    exact: bool
    notes: tuple[str, ...] = ()

    @property
    def difference(self) -> float:
        """How far the particles' volume is from the region's, relative to it."""
        return (self.volume - self.region_volume) / self.region_volume if self.region_volume else math.inf


def body_report(
    bodies: Sequence[BodyRequest],
    filled: Sequence[BodyParticles],
    densities: Sequence[float | None],
    grid: GridBox,
    analysis: Analysis,
    thickness: float = 1.0,
) -> list[BodyReport]:
    """Report on every body.

    Parameters
    ----------
    bodies, filled : the bodies and what ``fill_bodies`` made of them, in the same order
    densities : mass density of each body [mass/length³], None of a rigid one
    grid : object with ``lower``, ``upper``, ``cell`` (d,) [length]
    analysis : tuple of ``core.analysis``
    thickness : thickness of plane analyses or area of 1D ones; ignored in others
    """
    reports = []
    ring = isinstance(analysis, Axisymmetric)
    factor = thickness if analysis.dimensions < 3 and not ring else 1.0
    for body, particles, density in zip(bodies, filled, densities, strict=True):
        weight = particles.volume * (2 * math.pi * particles.X[0]) if ring else particles.volume * factor
        volume = float(weight.sum())
        mass, shares = None if density is None else density * volume, weight / volume
        if particles.density is not None:
            mass = float(particles.density @ weight)
            shares = particles.density * weight / mass
        own, exact = _region_volume(body.region, grid, ring)
        reports.append(
            BodyReport(
                name=body.name,
                particles=particles.count,
                mass=mass,
                volume=volume,
                center=particles.X @ shares,
                lower=(particles.X - particles.reach).min(axis=1),
                upper=(particles.X + particles.reach).max(axis=1),
                region_volume=own * factor,
                exact=exact,
                notes=(*body.region.notes(), *_lattice_notes(body, particles)),
            )
        )
    return reports


def _lattice_notes(body: BodyRequest, particles: BodyParticles) -> list[str]:
    """Edges of the particles that lie along their region's own sides, which are not those of sub-cells."""
    if body.particles_along != "region":
        return []
    edges = " × ".join(f"{2.0 * half:.5g}" for half in particles.size[:, 0])
    turned = "" if particles.turn is None else ", rotated with it"
    return [f"particles of {edges} along the region's own sides{turned}"]


def _region_volume(region: Region, grid: GridBox, ring: bool) -> tuple[float, bool]:
    """Length, area, volume or volume of the ring of a region, and whether it is exact."""
    d = len(grid.lower)
    lower, upper = region.bounds(d)
    size = region.measure(d)
    if not ring and size is not None:
        return size, True
    center = region.centroid(d)
    if ring and size is not None and center is not None and lower[0] >= -1e-9 * (upper[0] - lower[0]):
        return 2 * math.pi * float(center[0]) * size, True  # Pappus
    if ring:
        lower[0] = max(lower[0], 0.0)
    lower = np.where(np.isfinite(lower), lower, grid.lower)
    upper = np.where(np.isfinite(upper), upper, grid.upper)
    return sampled_measure(region, lower, upper, ring), False


def sampled_measure(
    region: Region, lower: Array, upper: Array, ring: bool = False, samples: int = SAMPLES
) -> float:
    """Estimate the measure of a region within a box by the midpoint rule on a regular lattice.

    Parameters
    ----------
    lower, upper : (d,) corners of the box [length]
    ring : weigh with 2πx (volume of the ring that the region sweeps about the y axis)
    samples : about how many points to test
    """
    extent = np.asarray(upper, dtype=float) - lower
    if not (extent > 0).all():
        return 0.0
    d = len(extent)
    edge = (np.prod(extent) / samples) ** (1 / d)
    count = np.maximum(np.ceil(extent / edge), 1).astype(np.int64)
    count = np.minimum(count, samples)
    step = extent / count
    axes = [low + (np.arange(n) + 0.5) * h for low, n, h in zip(lower, count, step, strict=True)]
    total = 0.0
    for along_last in np.array_split(axes[-1], max(1, math.ceil(np.prod(count) / 2**15))):
        if len(along_last):
            points = np.stack([x.ravel() for x in np.meshgrid(*axes[:-1], along_last, indexing="ij")])
            inside = region.contains(points)
            total += float((2 * math.pi * points[0, inside]).sum()) if ring else int(inside.sum())
    return total * float(np.prod(step))


def report_table(reports: Sequence[BodyReport], units: dict[str, str] | None = None) -> str:
    """The reports as a text table; ``units`` are the labels of ``length`` and ``mass`` for the headings."""
    length = (units or {}).get("length", "")
    mass = (units or {}).get("mass", "")
    heads = [
        "body",
        "particles",
        _head("mass", mass),
        _head("volume", f"{length}³" if length else ""),
        "off by",
        _head("centre of mass", length),
        _head("bounds", length),
    ]
    rows = [heads]
    for r in reports:
        rows.append(
            [
                r.name,
                str(r.particles),
                "rigid" if r.mass is None else f"{r.mass:.6g}",
                f"{r.volume:.6g}",
                f"{100 * r.difference:+.3f} %" if r.exact else f"~{100 * r.difference:+.2f} %",
                in_words(r.center, 5),
                f"{in_words(r.lower, 5)} to {in_words(r.upper, 5)}",
            ]
        )
    widths = [max(len(row[k]) for row in rows) for k in range(len(heads))]
    right = {1, 2, 3, 4}
    lines = [
        "  ".join(
            cell.rjust(width) if k in right else cell.ljust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]
    lines += [f"{r.name}: {note}" for r in reports for note in r.notes]
    return "\n".join(lines)


def _head(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name
