"""The parts of a saved trajectory, checked: whoever holds a Trajectory may rely on its shapes and types."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from spacerobot.simulation.energy import Ledger
from spacerobot.simulation.events import Event
from spacerobot.simulation.peaks import UNKNOWN, Peak
from spacerobot.simulation.restitution import Restitution
from spacerobot.simulation.scene import BACKENDS
from spacerobot.support.formats import require_format
from spacerobot.support.npz import read_npz

FORMAT = 1

_SPECIAL = {None: math.nan, "inf": math.inf, "-inf": -math.inf}


class NotATrajectory(ValueError):
    """What is wrong with a part."""


def read_parts(path: Path) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Arrays by name, and the object that says what they are.

    Raises:
        InputError: the archive is damaged, or too large.
        ValueError, KeyError, RecursionError: there is no such object in it.
    """
    arrays = {name: array for name, array in read_npz(path).items() if array is not None}
    about = json.loads(bytes(arrays["about"]).decode())
    if not isinstance(about, dict):
        raise NotATrajectory("no object says what it holds")
    require_format(about["format"], FORMAT, "trajectory", None)
    return arrays, about


def clock(arrays: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """Finite times that never run backwards, shape (T,), T > 0 [s]."""
    time = line(arrays[name], name, None)
    if not len(time) or not np.isfinite(time).all() or (np.diff(time) < 0).any():
        raise NotATrajectory(f"{name} is no clock")
    return time


def line(array: np.ndarray, name: str, length: int | None) -> np.ndarray:
    """Real numbers, shape (length,), of any length if None."""
    if array.ndim != 1 or array.dtype.kind not in "fiu" or length not in (None, len(array)):
        raise NotATrajectory(f"{name} is not {length or 'a row of'} numbers")
    return array.astype(float)


def group(arrays: Mapping[str, np.ndarray], prefix: str, length: int) -> dict[str, np.ndarray]:
    """The rows of numbers under a prefix by the rest of their name, each of shape (length,)."""
    return {
        key.removeprefix(f"{prefix}/"): line(value, key, length)
        for key, value in arrays.items()
        if key.startswith(f"{prefix}/")
    }


def ledger(arrays: Mapping[str, np.ndarray]) -> Ledger:
    """Energies on the integrator's own clock."""
    time = clock(arrays, "ledger/time")
    kinetic = line(arrays["ledger/kinetic"], "ledger/kinetic", len(time))
    return Ledger(time, kinetic, group(arrays, "stored", len(time)), group(arrays, "work", len(time)))


def events(times: np.ndarray, pairs: Any) -> tuple[Event, ...]:
    """What switched, and when."""
    if not isinstance(pairs, list) or len(pairs) != len(times):
        raise NotATrajectory("as many events as times are needed")
    for pair in pairs:
        if not isinstance(pair, list) or len(pair) != 2 or not all(isinstance(p, str) for p in pair):
            raise NotATrajectory("an event is a thing and what it did")
    return tuple(Event(float(t), str(what), str(did)) for t, (what, did) in zip(times, pairs, strict=True))


def restitution(said: Any) -> Restitution:
    """Numbers as JSON carries them: absent for NaN, "inf" for infinity."""
    if not isinstance(said, dict):
        raise NotATrajectory("restitution is no table")
    found: dict[str, Any] = {key: _number(value, key) for key, value in said.items()}
    if not isinstance(found.get("touches"), int) or found["touches"] < 0:
        raise NotATrajectory("touches is no count")
    return Restitution(**found)


def _number(value: Any, key: str) -> int | float:
    """A number as JSON carries it: absent for NaN, "inf" for infinity."""
    if value is None or isinstance(value, str):
        if value not in _SPECIAL:
            raise NotATrajectory(f"{key} is no number")
        value = _SPECIAL[value]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise NotATrajectory(f"{key} is no number")
    return value


def peaks(said: Any) -> tuple[Peak, Peak]:
    """Largest force and deflection; NaN in files that were written before there were any."""
    if said is None:
        return UNKNOWN, UNKNOWN
    if not isinstance(said, dict) or not all(isinstance(said.get(k), dict) for k in ("force", "deflection")):
        raise NotATrajectory("peaks is no table")
    force, deflection = (
        Peak(*(float(_number(said[name].get(k), f"{k} of the peak {name}")) for k in ("value", "time")))
        for name in ("force", "deflection")
    )
    return force, deflection


def words(about: Mapping[str, Any], channels: Mapping[str, Any]) -> tuple[dict[str, str], str, str, tuple[str, ...]]:
    """Units, backend, scene and notes."""
    units, backend, scene, notes = about["units"], about["backend"], about["scene"], about["notes"]
    if not isinstance(units, dict) or not all(isinstance(u, str) for u in units.values()) or set(channels) - set(units):
        raise NotATrajectory("every channel needs a unit")
    if backend not in BACKENDS:
        raise NotATrajectory(f"no such backend: {str(backend)[:40]}")
    if not isinstance(scene, str) or not isinstance(notes, list) or not all(isinstance(n, str) for n in notes):
        raise NotATrajectory("scene and notes are text")
    return units, backend, scene, tuple(notes)
