"""Which robot the files speak of: a URDF beside them, or one whose name stands in theirs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from spacerobot.recordings.drafting.pendulum import GRAVITY
from spacerobot.support.errors import InputError

_CALLED = {"panda": "panda", "franka": "panda", "ur10": "ur10", "ur5": "ur5", "ur3": "ur3", "kinova": "kinova"}
"""Words in the names of files that mean a robot of example-robot-data."""


def joints_of(
    urdfs: Sequence[Path], folder: Path, names: Sequence[str], stated: str | None = None
) -> tuple[str | None, tuple[str, ...]]:
    """The robot as a study names it, and its joints from base to tip.

    Args:
        urdfs: URDFs in the folder, relative to it.
        folder: the folder.
        names: paths of the recordings.
        stated: a bundled robot or one of example-robot-data that the user names, None to find out.

    Raises:
        NotFoundError: no robot is called as stated.
    """
    from spacerobot.model.library import load  # half a second, and only where a robot is in question

    if stated is not None:
        return stated, tuple(load(stated, mend=True).chain)
    for urdf in urdfs:
        try:
            robot = load(folder / urdf, mend=True)
        except InputError:
            continue
        return str(urdf), tuple(robot.chain)
    text = " ".join([folder.resolve().name, *names]).lower()
    for word, name in _CALLED.items():
        if word in text:
            try:
                return name, tuple(load(name).chain)
            except InputError:
                continue
    return (str(urdfs[0]) if urdfs else None), ()


def hangs(urdf: Path, joint: str) -> float | None:
    """Where the only joint of a URDF hangs at rest [rad]; None where it slides, or no weight brings it back."""
    from spacerobot.dynamics.joint_kinds import joint_axis
    from spacerobot.dynamics.joint_weight import weight_of
    from spacerobot.model.library import load

    robot = load(urdf, mend=True)
    a, b = weight_of(robot, (0.0, 0.0, -GRAVITY), joint)
    turns = joint_axis(robot.model, robot.joint_id(joint))[0]
    return math.atan2(-b, a) if turns and math.hypot(a, b) > 0.0 else None
