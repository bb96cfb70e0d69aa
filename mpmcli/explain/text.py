"""What ``explain`` found, in words for people."""

import textwrap
from typing import Any

from mpmcli.core.suggest import listing
from mpmcli.explain.cracks import cracks_in_words
from mpmcli.explain.heat import heat_in_words
from mpmcli.explain.interfaces import interfaces_in_words

EXACT_MASS_RATIO = 1e-8
"""``contact.mass_ratio`` from which on it hardly matters (docs/verification/compression.md)."""


def as_text(facts: dict[str, Any]) -> str:
    unit = "" if facts["time_unit"] is None else f" {facts['time_unit']}"
    fields = facts["velocity_fields"]
    size = (facts["particle_bytes"] + facts["grid_bytes"]) / 2**20
    lines = [
        facts["title"] or "(no title)",
        f"{facts['analysis']}, {facts['particles']} particles, {facts['grid_nodes']} nodes with ghosts, "
        f"{facts['shape']}, {fields} velocity field{'s' * (fields > 1)}",
        *_contact_in_words(facts["contact"]),
        "",
        "Each step:",
        *_tasks_in_words(facts["kernels_of_tasks"]),
        "",
        "Not used (no arrays, no kernels):",
        *(f"  {name}" for name in facts["not_modelled"]),
        "",
        f"arrays     particles {facts['particle_bytes'] / 2**20:.1f} MiB, grid {facts['grid_bytes'] / 2**20:.1f} MiB "
        f"if all nodes are active ({', '.join(facts['arrays'])}); {size:.1f} MiB in total",
        f"time step  {facts['time_step']:.4g}{unit} at the start: {_courant_in_words(facts)}",
        *_labelled("interface", interfaces_in_words(facts["interfaces"])),
        *_labelled("cracks", cracks_in_words(facts["cracks"])),
        *_labelled("heat", heat_in_words(facts["heat"])),
        f"run        about {facts['steps']} steps, {_time_in_words(facts)}",
        *_measured_in_words(facts["measured"]),
        "",
        *(f"warning    {words}" for words in facts["warnings"]),
        "Redundant settings (remove them; the results stay the same):"
        if facts["redundant"]
        else "No redundant setting found.",
        *(f"  {found['path']}: {found['because']}" for found in facts["redundant"]),
        *(["Questions that mpmcli tradeoff can answer:"] if facts["questions"] else []),
        *(f"  {question}" for question in facts["questions"]),
    ]
    return "\n".join(lines)


def _labelled(label: str, lines: list[str]) -> list[str]:
    """Return lines beside a label, which stands before the first."""
    return [f"{label if number == 0 else '':<11}{line}" for number, line in enumerate(lines)]


def _tasks_in_words(kernels: dict[str, list[str]]) -> list[str]:
    """Return the tasks of a step, and below each the kernels that it runs."""
    lines = []
    for task, names in kernels.items():
        lines.append(f"  {task}")
        lines += textwrap.wrap(", ".join(names), 110, initial_indent="      ", subsequent_indent="      ")
    return lines


def _time_in_words(facts: dict[str, Any]) -> str:
    time = _duration(facts["estimated_seconds"])
    threads = (
        f"on {facts['threads']} threads"
        if facts["parallel"]
        else "on 1 thread (fewer particles than parallel runs need)"
    )
    measured = facts["measured"]
    if measured is None or measured["seconds_per_step"] is None:
        return f"roughly {time}, {threads} (--measure gives a better estimate)"
    return f"{time} by the measured steps, {threads}, without output"


def _measured_in_words(measured: dict[str, Any] | None) -> list[str]:
    if measured is None:
        return []
    if measured["seconds_per_step"] is None:
        return ["measured   nothing, because the run is too short"]
    lines = [
        f"measured   {measured['nanoseconds']:.3g} ns per particle and step, median of {measured['steps']} of the "
        f"first steps, {_duration(measured['seconds_per_step'])} each",
        *(f"  {share:6.1%}  {task}" for task, share in measured["tasks"].items()),
    ]
    if measured["parts"]:
        parts = ", ".join(f"{name} {share:.1%}" for name, share in measured["parts"].items())
        lines.append(f"  of which {parts}")
    if measured["contact_steps"] is not None:
        lines.append(f"  fields in contact in {100 * measured['contact_steps']:.0f} % of these steps")
    if measured["mean_order"] < measured["order"]:
        share = f"{100 * measured['transfer_steps']:.0f} % of the steps use the transfer, the others FLIP"
        lines.append(f"  mean order {measured['mean_order']:.3g} of {measured['order']}; {share}")
    if measured["F"] is None:
        return [*lines, f"  F of Eq. 3 of Nairn (2026) is unknown: {measured['without_F']}"]
    return [
        *lines,
        f"  one more order costs F = {measured['F']:.3g} of a FLIP step (Eq. 3 of Nairn 2026; {measured['F_of']} "
        "against FLIP)",
    ]


def _courant_in_words(facts: dict[str, Any]) -> str:
    stable, because = facts["stable_courant"], facts["stable_because"]
    chosen = f"Courant number {facts['courant']:.3g}"
    if stable is None:
        return f"{chosen}; the stability limit is unknown: {because}"
    if facts["courant_is_chosen"]:
        return f"{chosen} (auto: the stable Courant number; {because})"
    margin = facts["stability_margin"]
    side, warning = ("below", "") if margin >= 0.0 else ("above", "; the run may fail")
    verdict = f"{100 * abs(margin):.0f} % {side}"
    return f"{chosen}, {verdict} the stable Courant number {stable:.3g} ({because}){warning}"


def _contact_in_words(contact: dict[str, Any]) -> list[str]:
    if not contact:
        return []
    named = [f"{name} (rigid)" if name in contact["rigid_fields"] else name for name in contact["fields"]]
    of_rigid = " (of rigid bodies their surface)" if contact["rigid_surfaces"] else ""
    geometry = (
        f"normal {contact['normal']}{of_rigid}, separation {contact['separation']}"
        if contact["normal"]
        else "no normals"
    )
    laws = "law" if len(contact["laws"]) == 1 else "laws"
    screen = contact["mass_ratio"]
    hint = ""
    if screen > EXACT_MASS_RATIO:
        hint = f"; use {EXACT_MASS_RATIO:g} or less where interfaces cross grid lines"
    passed_over = (
        f"nodes where one side has less than {screen:g} of the mass have no contact (mass_ratio){hint}"
    )
    return [
        f"contact of {listing(named, 8)}: {geometry}, {laws} {', '.join(contact['laws'])}; in the first step "
        f"{contact['candidate_nodes']} nodes and {contact['candidate_particles']} particles are checked",
        *([passed_over] if screen > 0.0 else []),
    ]


def _duration(seconds: float) -> str:
    for unit, length in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 2 * length:
            return f"{seconds / length:.1f} {unit}"
    return f"{seconds:.2g} s"
