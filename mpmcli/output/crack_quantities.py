"""Quantities of cracks and of their tips, in scenes with cracks; energies and forces of the full ring."""

from collections.abc import Callable, Mapping
from operator import attrgetter
from typing import Any

from mpmcli.core.state import TipValues
from mpmcli.output.global_quantities import never
from mpmcli.output.quantities import QUANTITIES, Context, Quantity
from mpmcli.output.snapshot import Snapshot

MOST_CRACKS = 10
"""Tables have columns of every crack without being asked in scenes with at most so many."""
ENDS = {"start": 0, "end": -1}
"""Places of the ends in a chain by the words of a scene."""


def place_of_tip(snapshot: Snapshot, tip: str) -> tuple[int, int]:
    """Return the index of the crack, and 0 or -1, of a tip ``"main:end"``."""
    name, _, end = tip.rpartition(":")
    index = next(k for k, chain in enumerate(snapshot.cracks.chains) if chain.name == name)
    return index, ENDS[end]


class AtTips(Mapping[str, Any]):
    """A number of each tip by name, found when it is read: an energy release rate takes time."""

    def __init__(self, snapshot: Snapshot, find: Callable[[Snapshot, int, int], Any]):
        self._snapshot, self._find = snapshot, find

    def __getitem__(self, tip: str) -> Any:
        return self._find(self._snapshot, *place_of_tip(self._snapshot, tip))

    def __iter__(self) -> Any:
        for chain in self._snapshot.cracks.chains:
            yield from (f"{chain.name}:{end}" for end in ENDS)

    def __len__(self) -> int:
        return 2 * len(self._snapshot.cracks.chains)


def _of_cracks(find: Callable[[Snapshot, int], Any]) -> Callable[[Snapshot], dict[str, Any]]:
    return lambda snapshot: {
        chain.name: find(snapshot, index) for index, chain in enumerate(snapshot.cracks.chains)
    }


def _of_tips(find: Callable[[Snapshot, int, int], Any]) -> Callable[[Snapshot], AtTips]:
    return lambda snapshot: AtTips(snapshot, find)


def _value(name: str) -> Callable[[Snapshot], AtTips]:
    assert name in TipValues._fields
    return _of_tips(lambda snapshot, crack, end: getattr(snapshot.cracks.tip(crack, end), name))


_CRACKS, _GROWING, _TRACTIONS = map(attrgetter, ("cracks", "growing", "crack_tractions"))


def _has_fracture(context: Context) -> bool:
    return context.has_fracture and bool(context.tips)


def _grow_few(context: Context) -> bool:
    return 0 < len(context.growing) <= MOST_CRACKS


def why_missing(quantity: Quantity, owner: str, context: Context) -> str:
    """Say what a scene lacks for a quantity of its cracks, of one ``owner`` or of all (``""``); nothing if none."""
    if not context.cracks:
        return "needs 'cracks', which this scene does not have"
    if quantity.where == "tip" and not context.tips:
        ends = "both ends of its crack are mouths" if len(context.cracks) == 1 else "all ends are mouths"
        return f"needs the tip of a crack, and {ends}"
    crack, _, end = owner.rpartition(":")
    if quantity.where == "tip" and crack in context.cracks and end in ENDS and owner not in context.tips:
        return f"needs the tip of a crack, and the {end} of '{crack}' is a mouth"
    if quantity.exists(context):
        return ""
    needed: dict[Any, str] = {_has_fracture: "the section 'fracture'", _TRACTIONS: "a crack with 'traction'"}
    return "needs " + needed.get(quantity.exists, "a crack with 'growth'")


QUANTITIES.add(
    Quantity("crack_length", "a", "length", "scalar", "crack",
             _of_cracks(lambda s, index: s.cracks.chains[index].length),
             "length of a crack along its plane; without being asked in tables of at most "
             f"{MOST_CRACKS} growing cracks",
             exists=_CRACKS, is_default=_grow_few),
    Quantity("crack_force", "F_f", "force", "vector", "crack",
             _of_cracks(lambda s, index: s.cracks.force[index] * s.full_ring),
             "force on the matter above a crack from the matter below it in the last step",
             exists=_CRACKS, is_default=lambda context: len(context.cracks) <= MOST_CRACKS),
    Quantity("released_energy", "W_g", "energy", "scalar", "crack",
             _of_cracks(lambda s, index: float(s.cracks.released[index]) * s.full_ring),
             "energy that the growth of a crack has released so far: sum of J times new area",
             exists=_GROWING, is_default=_grow_few,
             owners=lambda context: tuple(dict.fromkeys(tip.rpartition(":")[0] for tip in context.growing))),
    Quantity("J", "J", "energy/area", "scalar", "tip", _value("J"),
             "energy release rate at the tip of a crack; nan where it is not known",
             exists=_has_fracture, is_default=never),
    Quantity("K_I", "K_I", "pressure*length^0.5", "scalar", "tip", _value("K_I"),
             "stress intensity factor of opening at the tip of a crack; nan where it is not known",
             exists=_has_fracture, is_default=never),
    Quantity("K_II", "K_II", "pressure*length^0.5", "scalar", "tip", _value("K_II"),
             "stress intensity factor of sliding at the tip of a crack; nan where it is not known",
             exists=_has_fracture, is_default=never),
    Quantity("tip", "x_t", "length", "vector", "tip",
             _of_tips(lambda s, crack, end: s.cracks.chains[crack].X[:, end]),
             "position of the tip of a crack", exists=attrgetter("tips"), is_default=never),
    Quantity("tip_speed", "v_t", "velocity", "scalar", "tip",
             _of_tips(lambda s, crack, end: s.cracks.speed(crack, end)),
             "speed of the tip of a crack: the last increment of growth over the time since the one before; 0 "
             "where it is arrested",
             exists=_GROWING, is_default=never, owners=_GROWING),
    Quantity("interface_energy", "E_i", "energy", "scalar", "crack",
             _of_cracks(lambda s, index: float(s.cracks.interface_energy[index]) * s.full_ring),
             "energy stored in the springs and tractions between the faces of a crack",
             exists=attrgetter("crack_interfaces"), is_default=never, owners=attrgetter("crack_interfaces")),
    Quantity("cohesive_work", "D_i", "energy", "scalar", "crack",
             _of_cracks(lambda s, index: float(s.cracks.cohesive_work[index]) * s.full_ring),
             "energy spent by the tractions on the points of a crack, accumulated",
             exists=_TRACTIONS, owners=_TRACTIONS),
    Quantity("debonded_length", "a_d", "length", "scalar", "crack",
             _of_cracks(lambda s, index: float(s.cracks.debonded_length[index])),
             "length of a crack along which tractions have failed so far", exists=_TRACTIONS, owners=_TRACTIONS),
    Quantity("crack_nodes", "n_c", "1", "scalar", "global", lambda s: float(s.cracks.nodes),
             "number of nodes whose particles lie on several sides of cracks", exists=_CRACKS),
    Quantity("third_cracks", "n_3", "1", "scalar", "global", lambda s: float(s.cracks.third),
             "number of nodes at which a third crack was left out in the last step",
             exists=_CRACKS, is_default=lambda context: len(context.cracks) > 2),
    Quantity("crack_side", "s", "1", "scalar", "particle", lambda s: s.cracks.particle_side(),
             "side on which a particle lies of the node that it feeds most: 0 where no crack lies between them, 1 "
             "beyond the first crack of the node, 2 beyond its second, 3 beyond both; −1 in the step in which "
             "particles leave the grid",
             exists=_CRACKS),
)  # fmt: skip
