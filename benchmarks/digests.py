"""Digests of what short runs write, to see that a change of the code leaves every bit as it was.

    python benchmarks/digests.py --write FILE [NAME ...]      before the change
    python benchmarks/digests.py --against FILE [NAME ...]    after it; ends with 1 where a digest differs

A digest covers the tables and the last archives of a run. Digests of two machines may differ.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

INPUTS = Path(__file__).parent.parent / "inputs"
FLIP = "method.transfer={kind: flip}"
XPIC3 = "method.transfer={kind: xpic, order: 3}"

RUNS: dict[str, list[str]] = {
    "flip_2d_large": ["vortex", FLIP, "grid.cell=0.03125", "method.shape=ugimp", "time.max_steps=30"],
    "fmpm_ring": ["taylor_bar", "time.max_steps=150"],
    "fmpm_1d_wall": ["drawn_bar", "time.max_steps=80"],
    "fmpm_1d_condition": ["vibrating_bar", "time.courant=0.5", "method.shape=bspline2", "time.max_steps=80"],
    "fmpm_3d_mirrors": ["elastic_sphere_3d", "time.max_steps=12"],
    "flip_3d_large": ["elastic_sphere_3d", FLIP, "grid.cell=0.06", "time.max_steps=8"],
    "usavg_shock": ["shock_nickel", "method.update=usavg+", FLIP, "time.max_steps=60"],
    "shock_mirrors": ["shock_nickel_symmetry", "time.max_steps=40"],
    "usf_loads": ["column_under_gravity", "method.update=usf", "time.max_steps=40"],
    "tractions_damping": ["axisymmetric_disk_pressure", "time.max_steps=40"],
    "traction_2d": ["kirsch_plate", "time.max_steps=20"],
    "averaged_fluid": ["dam_break", "time.max_steps=40"],
    "gradients_flip": ["spinning_disk", "time.max_steps=40"],
    "gradients_fmpm": ["spinning_disk", "method.transfer={kind: fmpm, order: 3, velocity_gradient: true}",
                       "method.update=usl+", "time.max_steps=40"],
    "periodic_fmpm": ["vortex", "method.transfer={kind: fmpm, order: 4, every_steps: 3}", "time.max_steps=40"],
    "blended_fmpm": ["vortex", "method.transfer={kind: fmpm, order: 5, blend: {order: 2, fraction: 0.5}}",
                     "time.max_steps=30"],
    "dynamic_fmpm": ["vortex", "method.transfer={kind: fmpm, order: 8, dynamic: {tolerance: 0.02}}",
                     "time.max_steps=30"],
    "xpic_walls": ["stretched_bar", "time.courant=0.2", XPIC3, "method.velocity_conditions=combined",
                   "time.max_steps=40"],
    "damped_bar": ["vibrating_bar_2d", "method.damping={particle: 0.2, grid: 0.1}", "time.max_steps=40"],
    "contact_disks": ["two_disks", "time.max_steps=600", "grid.cell=2"],
    "contact_ring_rigid": ["hertz_axisymmetric", "time.courant=0.34", "time.max_steps=60"],
    "contact_rigid_friction": ["rolling_disk", "time.courant=0.38", "contact.normal={kind: linear_regression}",
                               "time.max_steps=60"],
    "contact_specified": ["block_on_incline", "time.courant=0.38",
                          "contact.normal={kind: specified, vector: [0.3, -1]}", "time.max_steps=60"],
    "contact_stick_slip": ["stick_slip", "time.courant=0.38", FLIP, "time.max_steps=60"],
    "contact_compaction": ["ellipse_compaction", "grid.cell=[0.02857142857142857, 0.02857142857142857]",
                           "time.max_steps=40"],
    "contact_gradient_xpic": ["axial_compression", XPIC3, "contact.normal={kind: average_gradient}",
                              "contact.separation={kind: displacement}", "time.max_steps=60"],
    "contact_update_again": ["axial_compression", "method.update=usavg+",
                             "method.transfer={kind: fmpm, order: 3}", "contact.increments=evolving",
                             "contact.separation={kind: position_offset}", "time.max_steps=60"],
    "contact_perfect": ["shock_interface", "time.max_steps=40"],
    "contact_rigid": ["compressed_by_rigid", "time.courant=0.4", "contact.increments=combined", "time.max_steps=60"],
    "contact_resumed": ["axial_compression", "archive.checkpoint={every: 0.004}", "time.max_steps=60"],
    "fmpm_resumed": ["taylor_bar", "archive.checkpoint={every: 0.001}", "time.max_steps=150"],
    "interface_springs": ["interface_impact", "time.max_steps=80"],
    "interface_usf": ["spinning_joint", "method.update=usf", "time.max_steps=40"],
    "interface_ring": ["bonded_ring", "time.max_steps=40"],
    "interface_cohesive": ["delamination", "time.max_steps=60"],
    "interface_3d": ["two_ply_3d", "time.max_steps=8"],
    "crack_edge": ["edge_crack", "time.max_steps=40"],
    "crack_friction": ["closed_crack_friction", "time.max_steps=15"],
    "heat_flying": ["heat_flying_disk", "time.max_steps=40"],
    "heat_friction": ["friction_heating", "time.max_steps=60"],
    "heat_coupled": ["thermoelastic_bar", "time.max_steps=80"],
    "contact_3d": ["sphere_collision_3d", "time.courant=0.29", "time.max_steps=40"],
}  # fmt: skip
"""Scene of ``inputs/`` and the keys that a run sets."""


HALFWAY = {"contact_resumed": "0.012", "fmpm_resumed": "0.004"}
"""Of runs that stop and are resumed, when."""


def digest_of(name: str, keys: list[str], folder: Path) -> str:
    """Run a scene, and digest what it wrote."""
    scene, *sets = keys
    out = folder / name
    arguments = [str(INPUTS / f"{scene}.yaml"), "-o", str(out), "-q"]
    arguments += [word for key in sets for word in ("--set", key)]
    until = [["--until", HALFWAY[name]], ["--resume"]] if name in HALFWAY else [[]]
    for more in until:
        command = [sys.executable, "-m", "mpmcli", "run", *arguments, *more]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            return f"exit {done.returncode}: {(done.stderr or done.stdout).strip().splitlines()[-1][:160]}"
    found = hashlib.sha256()
    for path in sorted([*out.glob("*.csv"), *_last_archives(out)]):
        found.update(path.name.encode() + path.read_bytes())
    return found.hexdigest()[:16]


def _last_archives(out: Path) -> list[Path]:
    by_kind: dict[Path, Path] = {}
    for path in sorted([*out.rglob("*.vtu"), *out.rglob("*.vti"), *out.rglob("*.vts")]):
        by_kind[path.parent / path.name.rstrip("0123456789.vtuis")] = path
    return list(by_kind.values())


def main() -> int:
    """Write digests, or compare them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument("--write", type=Path, metavar="FILE")
    which.add_argument("--against", type=Path, metavar="FILE")
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(RUNS))
    options = parser.parse_args()
    chosen = options.names or list(RUNS)
    before = json.loads(options.against.read_text()) if options.against else {}
    found, differ = {}, 0
    with tempfile.TemporaryDirectory() as folder:
        for name in chosen:
            begin = time.perf_counter()
            found[name] = digest_of(name, RUNS[name], Path(folder))
            differs = bool(before) and before.get(name) != found[name]
            differ += differs
            print(
                f"{name:24s} {found[name]}  {time.perf_counter() - begin:5.1f} s{'  DIFFERS' * differs}",
                flush=True,
            )
    if options.write:
        options.write.write_text(json.dumps(found, indent=1) + "\n")
    return int(differ > 0)


if __name__ == "__main__":
    sys.exit(main())
