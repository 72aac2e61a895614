"""A saved trajectory, and what its viewers take for granted once it is loaded."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from fuzz.target import Target
from fuzz.targets.archives import WORDS, packed, spelled
from spacerobot.simulation.trajectory import Trajectory

_ABOUT = b"""{"format": 1, "backend": "reduced", "units": {"target.x": "m"}, "events": [["contact", "touch"]],
"restitution": {"target": 0.7, "hand": 0.7, "point": null, "first_touch": "inf", "last_separation": 1,
         "contact_time": 1,
"contact_time_summed": 1, "touches": 1}, "scene": "format = 1", "notes": ["a"]}"""
_T = np.arange(3.0)
_ARRAYS = {
    "time": _T, "channel/target.x": _T, "measured/target.x": _T, "ledger/time": _T, "ledger/kinetic": _T,
    "stored/spring": _T, "work/spring": _T, "event/time": np.array([0.5]), "about": np.frombuffer(_ABOUT,
    dtype=np.uint8),
}  # fmt: skip


def _prepare(folder: Path) -> Callable[[bytes], None]:
    file = folder / "trajectory.npz"

    def read(data: bytes) -> None:
        file.write_bytes(packed(data))
        found = Trajectory.load(file)
        for series in (*found.channels.values(), *found.measured.values()):
            assert series.shape == found.time.shape
        with np.errstate(all="ignore"):
            assert isinstance(found.ledger.closure, float)
        assert all(isinstance(f"{e.time:g} {e.element.upper()} {e.kind.upper()}", str) for e in found.events)
        assert f"{found.restitution.hand:g} {found.restitution.touches:d} {found.scene.lower()}"
        found.save(folder / "again.npz")

    return read


TARGET = Target(
    "trajectory",
    _prepare,
    (spelled(**_ARRAYS),),
    (*WORDS, '"format"', '"backend"', '"multibody"', '"units"', '"events"', '"restitution"', "null", "NaN",
    "[[", "{}", "[]",
     "channel/", "measured/", "stored/", "work/", "1e999", "true", "\\ud800"),
    longest=6000,
    cases=60_000,
)  # fmt: skip
