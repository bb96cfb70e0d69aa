"""The plugins that a scene uses, and whether what they bring is complete."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from pydantic import BaseModel

from mpmcli.contact.laws import LawModel
from mpmcli.contact.laws.impulse import (
    is_soft,
    law_impulse,
    law_impulse_at_end,
    pressed_impulse,
    sliding_traction,
)
from mpmcli.contact.normals import NormalModel, find_normal
from mpmcli.contact.separation import SeparationModel, find_separation
from mpmcli.core.errors import PluginError
from mpmcli.core.plugins import Plugin, installed, plugin_of
from mpmcli.core.transfer.stencil import fill, weigh, weigh_gathers
from mpmcli.materials import MaterialModel
from mpmcli.materials.base import (
    absorb_work,
    bulk_speed_squared,
    kirchhoff_stress,
    needs_increment,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.lateral import lateral_stretch, thickness_stretch
from mpmcli.shapes import SHAPES

OF_MATERIALS: tuple[Any, ...] = (
    kirchhoff_stress, strain_energy, wave_speed_squared, bulk_speed_squared,
    absorb_work, needs_increment, thickness_stretch, lateral_stretch,
)  # fmt: skip


def plugins_of(scene: Any) -> tuple[Plugin, ...]:
    """The plugins whose models, or whose shape function, a scene uses."""
    if not installed():
        return ()
    shape = SHAPES[scene.method.shape].parameters
    used = {plugin_of(type(each)) for each in (shape, *_models(scene))}
    return tuple(plugin for plugin in installed() if plugin in used)


def check_plugins(scene: Any) -> None:
    """Raise PluginError if what the scene uses of plugins has no numbers or lacks a compiled function."""
    if not installed():
        return
    shape = SHAPES[scene.method.shape].parameters
    if plugin := plugin_of(type(shape)):
        _require(
            plugin, f"the shape function '{scene.method.shape}'", lambda: shape, (fill, weigh, weigh_gathers)
        )
    for model in _models(scene):
        if plugin := plugin_of(type(model)):
            _check_model(plugin, model, scene)


def _check_model(plugin: Plugin, model: BaseModel, scene: Any) -> None:
    d, cell = scene.dimensions, scene.grid.cell
    arguments: tuple[Any, ...] = (d, cell)
    if isinstance(model, MaterialModel):
        arguments, needed = (scene.analysis.kind, scene.is_adiabatic), OF_MATERIALS
    elif isinstance(model, LawModel):
        arguments, needed = (), (law_impulse, law_impulse_at_end, is_soft)
    elif isinstance(model, NormalModel):
        needed = (find_normal,)
    elif isinstance(model, SeparationModel):
        arguments, needed = (d, cell, 2), (find_separation,)
    else:
        return
    _require(plugin, type(model).__name__, lambda: model.parameters(*arguments), needed)


def _require(plugin: Plugin, name: str, numbers_of: Callable[[], Any], needed: Iterable[Any]) -> None:
    fault = f"the plugin {plugin} cannot be used: {name}"
    try:
        numbers = numbers_of()
    except Exception as error:
        raise PluginError(f"{fault} gives no parameters ({type(error).__name__}: {error})") from error
    kind: Any = type(numbers)
    if not (isinstance(numbers, tuple) and hasattr(kind, "_fields")):
        raise PluginError(f"{fault}: its parameters must be a named tuple, not {kind.__name__}")
    missing = [each.__name__ for each in needed if kind not in each.implementations]
    if (
        law_impulse.implementations.get(kind) is pressed_impulse
        and kind not in sliding_traction.implementations
    ):
        missing.append(sliding_traction.__name__)
    if missing:
        raise PluginError(f"{fault}: no function is registered for {kind.__name__} as {', '.join(missing)}")


def _models(value: Any) -> Iterator[BaseModel]:
    """Every model in a scene."""
    if isinstance(value, BaseModel):
        yield value
        for name in type(value).model_fields:
            yield from _models(getattr(value, name))
    elif isinstance(value, dict):
        for member in value.values():
            yield from _models(member)
    elif isinstance(value, tuple | list) and value and isinstance(value[0], BaseModel):
        for member in value:
            yield from _models(member)
