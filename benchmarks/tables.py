"""The figures of ``step_speed.py`` as text."""

from __future__ import annotations

import statistics
from typing import Any

SCALES = 1.8
"""Two threads on the scalar loop must be this much faster than one before scaling of a step is judged."""


def slope_of_orders(rows: list[dict[str, Any]], threads: int) -> list[dict[str, Any]]:
    """Eq. 3 of Nairn (2026) fitted: relative time = 1 + φ (k − 1) F, by update scheme.

    The cost of one more order is the slope of a straight line through the FMPM orders from 4 on. F is that of ``usl``,
    which finds grid velocities once per step, over the FLIP step of the scheme; φ the slope over that of ``usl``.
    """
    found: list[dict[str, Any]] = []
    once: dict[tuple[Any, ...], float] = {}
    kinds = dict.fromkeys((*_block(r), r["update"]) for r in rows if r["transfer"] == "fmpm")
    for *block, update in sorted(kinds, key=lambda kind: kind[-1] != "usl"):
        same = [r for r in rows if _block(r) == tuple(block) and r["update"] == update]
        at = {r["order"]: r["ns"][threads] for r in same if r["transfer"] == "fmpm" and r["order"] >= 4}
        flip = next((r["ns"][threads] for r in same if r["transfer"] == "flip"), None)
        if len(at) > 1 and flip is not None:
            slope = statistics.linear_regression(list(at), list(at.values())).slope
            if update == "usl":
                once[tuple(block)] = slope
            one = once.get(tuple(block), slope)
            d, shape, particles = block
            entry = {"case": f"{d}D {shape} {update} {particles // 1000}k", "ns": slope, "F": one / flip}
            entry |= {"phi": slope / one, "flip_ns": flip}
            found.append(entry | {"relative": {k: ns / flip for k, ns in at.items()}})
    return found


def _block(row: dict[str, Any]) -> tuple[Any, ...]:
    return row["dimensions"], row["shape"], row["particles"]


def report(result: dict[str, Any]) -> str:
    """The tables for people."""
    threads = result["threads"]
    triad, scalar = result["triad_GB_per_s"], result["scalar_ns"]
    several = [n for n in threads if n > 1]
    scaling = scalar[1] / scalar[several[0]] if several and 1 in threads else None
    can_scale = scaling is not None and scaling >= SCALES * several[0] / 2
    lines = [f"{result['machine']}, {result['processors']} processors, load {result['load']:.1f}"]
    for n in threads:
        lines.append(
            f"{_threads(n)}: triad {triad[n]:.1f} GB/s, scalar loop {scalar[n]:.3f} ns per operation"
        )
    if scaling is not None:
        words = "" if can_scale else ": scaling of steps is not measurable here and now"
        lines.append(f"scalar loop with {_threads(several[0])}: {scaling:.2f} times as fast as with 1{words}")
    lines += [
        "",
        "nanoseconds per particle and step: medians (in brackets half the spread of the samples)",
        "",
    ]
    head = f"{'case':<28}" + "".join(f"{_threads(n):>18}" for n in threads)
    lines.append(head + f"{'speed-up':>10}{'floor':>8}{'target':>9}")
    for row in result["cases"]:
        cells = "".join(f"{row['ns'][n]:>9.1f} (±{row['spread'][n] * 100:>3.0f} %)" for n in threads)
        gain = f"{row['ns'][1] / row['ns'][several[0]]:.2f}" if can_scale else "–"
        target = f"{row['target']:.0f}" if row["target"] else ""
        lines.append(f"{row['case']:<28}{cells}{gain:>10}{row['times_floor']:>8.1f}{target:>9}")
    lines += [
        "",
        f"floor: times the time in which the triad moves the bytes that the step must move ({_threads(max(threads))})",
        "target: for 2 threads, scaled by the triad of this run",
        "",
    ]
    for n in threads:
        for entry in result["slopes"][n]:
            words = f"{entry['ns']:.1f} ns per order, F = {entry['F']:.3f}, φ = {entry['phi']:.2f}; times over FLIP "
            words += ", ".join(f"{ratio:.2f} (k = {k})" for k, ratio in entry["relative"].items())
            lines.append(f"FMPM, {entry['case']}, {_threads(n)}: {words}")
    for shape, entry in result["memory"].items():
        lines.append(
            f"memory, 2D {shape} flip: {entry['bytes_per_particle']:.0f} bytes per particle between "
            f"{entry['from']} and {entry['to']}; time per particle there {entry['time_ratio']:.2f} times as long"
        )
    return "\n".join(lines)


def _threads(count: int) -> str:
    return f"{count} thread{'s' * (count > 1)}"
