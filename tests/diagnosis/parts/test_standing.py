"""An arm that stands still says what it says once: its pieces are kept aside together, and count as one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from helpers_models import ARM, arm_log

from spacerobot.diagnosis.machines.grid import Grid
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.selection.held_out import folds
from spacerobot.diagnosis.selection.model_choice import groups
from spacerobot.model.library import load

GRAVITY = (0.0, 0.0, -9.81)
JOINTS = ("shoulder", "elbow")


def held() -> Grid:
    """Of 16 s the arm moves for half of them at most, then stands."""
    grid = arm_log(load(ARM), 3, {})
    last = int(np.argmax(grid.value["joint.elbow.position"][: grid.time.size // 2]))
    stands = grid.time >= grid.time[last]
    return replace(grid, value={k: np.where(stands, v[last], v) for k, v in grid.value.items()})


def elbow(grid: Grid) -> InverseDynamics:
    return InverseDynamics(load(ARM), GRAVITY, {"run": (grid, "run", {})}, JOINTS, compared=["elbow"])


def test_pieces_in_which_an_arm_stands_are_one() -> None:
    model = elbow(held())
    names = {t.id: t.repeats for t in model.trials}
    standing = [t for t in model.trials if t.start > 8.0]
    first = standing[0].told_by
    assert len(standing) >= 2
    assert {t.told_by for t in standing} == {first}
    assert not names[model.trials[0].id]
    apart = folds(model.trials)
    assert sorted(t for _, some in apart for t in some) == sorted(names)
    assert sum(any(t.id in some for t in standing) for _, some in apart) == 1
    assert len(set(groups(model.trials).tolist())) == len(names) - sum(map(bool, names.values()))


def test_an_arm_that_moves_throughout_has_no_such_pieces() -> None:
    model = elbow(arm_log(load(ARM), 3, {}))
    assert not any(t.repeats for t in model.trials)
