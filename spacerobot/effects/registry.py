"""All known effects, by name: the catalogue's files, installed entry points, and files that a user names aloud."""

from __future__ import annotations

import functools
import importlib
import importlib.metadata
import importlib.util
import inspect
import pkgutil
import sys
from pathlib import Path
from types import ModuleType

from spacerobot.effects import catalogue
from spacerobot.effects.effect import FORM, Effect
from spacerobot.effects.form import FormOf
from spacerobot.effects.formula import FORM as CLOSED
from spacerobot.effects.formula import FormulaLaw, spoken
from spacerobot.effects.learned import PREFIX, LearnedLaw, parsed
from spacerobot.effects.trend import SUFFIX, Trend
from spacerobot.support.errors import InputError, NotFoundError

ENTRY_POINT_GROUP = "spacerobot.effects"

_effects: dict[str, Effect] = {}


def _register(module: ModuleType) -> list[str]:
    names = []
    for _, kind in inspect.getmembers(module, inspect.isclass):
        if kind.__module__ != module.__name__ or inspect.isabstract(kind):
            continue
        if issubclass(kind, Effect) and not issubclass(kind, FormOf):  # a form is its effect's
            if kind.name in _effects and type(_effects[kind.name]).__module__ != module.__name__:
                raise InputError("an effect of this name exists already", given=kind.name, where=module.__name__)
            _effects[kind.name] = kind()
            names.append(kind.name)
    return names


def all_effects() -> dict[str, Effect]:
    """Every known effect by name, the catalogue's first."""
    if not _effects:
        for info in pkgutil.iter_modules(catalogue.__path__):
            _register(importlib.import_module(f"{catalogue.__name__}.{info.name}"))
        for point in importlib.metadata.entry_points(group=ENTRY_POINT_GROUP):
            _register(point.load())
    return dict(_effects)


def effect(name: str) -> Effect:
    """The effect of a name.

    Raises:
        NotFoundError: no such effect; names the nearest.
    """
    if name.startswith(PREFIX):
        return _learned(name)
    if name.endswith(SUFFIX):
        return _changing(name.removesuffix(SUFFIX))
    if FORM in name:
        return _in_form(*name.rsplit(FORM, 1))
    known = all_effects()
    if name not in known:
        raise NotFoundError("effect", name, sorted(known))
    return known[name]


@functools.cache
def _changing(name: str) -> Effect:
    return Trend(effect(name))


@functools.cache
def _in_form(name: str, form: str) -> Effect:
    return effect(name).in_form(form)


@functools.cache
def _learned(name: str) -> Effect:
    return FormulaLaw(spoken(name)) if name.startswith(CLOSED) else LearnedLaw(parsed(name))


def load_effects(path: str | Path) -> list[str]:
    """Add the effects that a Python file defines; this runs the file's code.

    Args:
        path: of the file.

    Returns:
        Names of the effects found.

    Raises:
        InputError: the file is missing, fails, or defines no effect.
    """
    all_effects()
    path = Path(path)
    if not path.is_file():
        raise InputError("no such file of effects", given=str(path))
    name = f"spacerobot_user_effects_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise InputError("not a Python file", given=str(path))
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except Exception as error:  # whatever the user's own code raises is the user's input failing
        raise InputError(f"the file of effects failed: {type(error).__name__}: {error}", where=str(path)) from error
    found = _register(module)
    if not found:
        raise InputError("the file defines no Effect", where=str(path))
    return found
