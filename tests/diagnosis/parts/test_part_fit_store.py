"""A search that was stopped goes on where it was, and ends where it would have ended."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from helpers_models import ARM, arm_log

from spacerobot.diagnosis.fitting.fit_store import Kept
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.effects.registry import effect
from spacerobot.model.library import load


class Drawer:
    """A store in memory; after so many things saved it stops the process, as Ctrl-C would."""

    def __init__(self) -> None:
        self.kept: dict[str, str] = {}
        self.loaded = 0
        self.left: float = np.inf

    def save(self, name: str, value: Any) -> None:
        self.kept[name] = json.dumps(value)
        self.left -= 1
        if self.left <= 0:
            raise KeyboardInterrupt

    def load(self, name: str) -> Any | None:
        self.loaded += name in self.kept
        return json.loads(self.kept[name]) if name in self.kept else None


def searched(store: Drawer | None) -> Growth:
    robot = load(ARM)
    grids = {
        f"run{n}": (arm_log(robot, n, {"shoulder": (1.2, 0.0, 0.0)}, seconds=8.0), f"motion {n}", {}) for n in range(2)
    }
    model = InverseDynamics(robot, (0.0, 0.0, -9.81), grids, ("shoulder", "elbow"), compared=["shoulder"])
    catalogue = [effect(n) for n in ("coulomb_friction", "viscous_friction", "preload")]
    return grow(model, effects=catalogue, kept=None if store is None else Kept(store, "shoulder"))


def test_a_stopped_search_goes_on_and_ends_where_it_would_have() -> None:
    store = Drawer()
    whole = searched(None)
    for patience in (4, 7):
        store.left = patience
        with pytest.raises(KeyboardInterrupt):
            searched(store)
    before = len(store.kept)
    assert before >= 8  # what was found before the first stop is not computed again
    store.left, store.loaded = np.inf, 0
    resumed = searched(store)
    assert store.loaded >= before
    assert resumed.after.label == whole.after.label == (("coulomb_friction", "joint.shoulder"),)
    np.testing.assert_array_equal(resumed.after.fit.z, whole.after.fit.z)
    assert [c.label for c in resumed.considered] == [c.label for c in whole.considered]
    assert resumed.after.error == whole.after.error

    store.loaded, size = 0, len(store.kept)
    again = searched(store)
    assert len(store.kept) == size  # nothing was computed
    np.testing.assert_array_equal(again.after.fit.z, whole.after.fit.z)
