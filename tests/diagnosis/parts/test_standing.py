"""An arm that stands still says what it says once: its pieces are kept aside together, and count as one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
from helpers_models import ARM, arm_log

from spacerobot.diagnosis.machines.grid import Grid
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.selection.held_out import folds
from spacerobot.diagnosis.selection.model_choice import groups
from spacerobot.model.library import load

GRAVITY = (0.0, 0.0, -9.81)
JOINTS = ("shoulder", "elbow")


def held(torque: float) -> Grid:
    """Of 16 s the arm moves for half of them at most, then stands, its elbow held by so much [N m]."""
    grid = arm_log(load(ARM), 3, {}, noise=0.02)
    last = int(np.argmax(grid.value["joint.elbow.position"][: grid.time.size // 2]))
    stands = grid.time >= grid.time[last]
    rest = load(ARM)
    value = {k: np.where(stands, v[last], v) for k, v in grid.value.items()}
    random = np.random.default_rng(5)
    at = np.array([value[f"joint.{j}.position"][-1] for j in JOINTS])
    weight = pin.rnea(rest.model, rest.model.createData(), at, np.zeros(2), np.zeros(2))
    for k, joint in enumerate(JOINTS):
        name = f"joint.{joint}.torque"
        noise = 0.02 * random.standard_normal(grid.time.size)
        value[name] = np.where(stands, weight[k] + (torque if joint == "elbow" else 0.0) + noise, value[name])
    return replace(grid, value=value)


def elbow(grid: Grid) -> InverseDynamics:
    return InverseDynamics(load(ARM), GRAVITY, {"run": (grid, "run", {})}, JOINTS, compared=["elbow"])


def test_pieces_in_which_an_arm_stands_are_one() -> None:
    model = elbow(held(0.0))
    names = {t.id: t.repeats for t in model.trials}
    standing = [t for t in model.trials if t.start > 8.0]
    first = standing[0].repeats or standing[0].id
    assert len(standing) >= 2
    assert {t.repeats or t.id for t in standing} == {first}
    assert not names[model.trials[0].id]
    apart = folds(model.trials)
    assert sorted(t for _, some in apart for t in some) == sorted(names)
    assert sum(any(t.id in some for t in standing) for _, some in apart) == 1
    assert len(set(groups(model.trials).tolist())) == len(names) - sum(map(bool, names.values()))


def test_an_arm_that_moves_throughout_has_no_such_pieces() -> None:
    model = elbow(arm_log(load(ARM), 3, {}))
    assert not any(t.repeats for t in model.trials)
