"""Forces that are known along a body's own axes, turned into the world by the body's recorded yaw."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from spacerobot.recordings.channel import ChannelSpec
from spacerobot.recordings.series import Series
from spacerobot.support.errors import InputError


def turn_to_world(specs: Iterable[ChannelSpec], series: dict[str, Series]) -> None:
    """Turn every pair x, y of forces with frame = "body" in place; one that is absent counts as zero.

    Yaw is taken between its neighbouring readings at the times of the force. Without a yaw beside it a force has no
    direction and is refused.

    Raises:
        InputError: the trial records no yaw of the body, or x and y at other times.
    """
    bodies = dict.fromkeys(s.quantity.rpartition(".")[0] for s in specs if s.frame == "body")
    where = {s.quantity: s.where for s in specs}
    for name in bodies:
        x, y = series.get(f"{name}.x"), series.get(f"{name}.y")
        one = x if x is not None else y
        assert one is not None  # a spec of it was read
        spot = where[one.name]
        body = name.split(".")[0]
        yaw = series.get(f"{body}.yaw")
        if yaw is None:
            raise InputError(f"{name} is along the body's axes, and the trial has no {body}.yaw", where=spot)
        if x is not None and y is not None and not np.array_equal(x.time, y.time):
            raise InputError(f"{name}.x and .y have other times, and cannot be turned together", where=spot)
        time, angle = yaw.good()
        turn = np.interp(one.time, time, np.unwrap(angle))
        zero = np.zeros(len(one))
        ahead, aside = (s.value if s is not None else zero for s in (x, y))
        world = (
            np.cos(turn) * ahead - np.sin(turn) * aside,
            np.sin(turn) * ahead + np.cos(turn) * aside,
        )
        for axis, value in zip("xy", world, strict=True):
            series[f"{name}.{axis}"] = replace(
                one, name=f"{name}.{axis}", value=value, valid=np.isfinite(value), frame="body"
            )
