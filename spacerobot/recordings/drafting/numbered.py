"""Columns that are the same but for the number of a motor: the joints of a machine, in the order of their numbers."""

from __future__ import annotations

import re
from collections.abc import Sequence

_MOTOR = re.compile(r"(?:id|dxl|servo|motor|drive|actuator|axis|axle|a|m)(\d{1,3})")
"""How a logger numbers motors: "ID1 Present Position", "servo_12_current", "A1"."""


def motors(words: Sequence[Sequence[str]]) -> dict[int, tuple[int, int]]:
    """Column -> which of how many motors it is of, from 0; without columns that no other motor has the like of.

    Numbers need not begin at 1, nor be without gaps: those of servos on a bus are what somebody gave them.

    Args:
        words: of each column.
    """
    families: dict[tuple[str, ...], dict[int, int]] = {}
    for column, own in enumerate(words):
        for place, word in enumerate(own):
            if (found := _MOTOR.fullmatch(word)) and len(own) > 1:
                like = (*own[:place], word.rstrip("0123456789"), *own[place + 1 :])
                families.setdefault(like, {})[int(found.group(1))] = column
    alike = [members for members in families.values() if len(members) > 1]
    if not alike or len({tuple(sorted(members)) for members in alike}) > 1:
        return {}
    return {column: (n, len(members)) for members in alike for n, (_, column) in enumerate(sorted(members.items()))}


def joint_of(motor: tuple[int, int], joints: Sequence[str]) -> str:
    """The joint that a motor turns: the robot's in this place where it has as many, else one by its number.

    Args:
        motor: which of how many.
        joints: of the robot, from base to tip; empty where none is known.
    """
    place, many = motor
    return f"joint:{joints[place]}" if many == len(joints) else f"joint:joint{place + 1}"
