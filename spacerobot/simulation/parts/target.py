"""The free-flying body of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from spacerobot.model.inertia import inertia_fault
from spacerobot.model.shapes import solid_box
from spacerobot.simulation.parts.checks import check_fields, number, vector
from spacerobot.support.errors import InputError

TARGET_EDGE = 0.30
"""Edge [m] of the uniform cube whose inertia a target has that states none."""


@dataclass(frozen=True)
class Target:
    """The free-flying body.

    With zero attitude its body axes are (approach, lateral, up), see `Scene.axes`.

    Attributes:
        mass: [kg].
        inertia: about the centre of mass in body axes [kg m^2]: three principal moments or 3 by 3; that of a
            uniform cube of 0.30 m if None and no yaw_inertia is given.
        yaw_inertia: all three moments alike [kg m^2]; instead of `inertia`.
        contact_point: (ahead, lateral) or (ahead, lateral, up) of the centre of mass, body axes [m].
        attitude: roll, pitch, yaw of the body in the approach axes at the start [rad].
        spin: angular velocity at the start, world axes [rad/s].
        speed: along `approach` at the start [m/s].
        drift: across it, along the lateral axis, at the start [m/s].
        gap: from the contact point to the tip of the wrist at rest, at the start and along `approach` [m].
    """

    mass: float = 9.0
    inertia: Any = None
    yaw_inertia: float | None = None
    contact_point: tuple[float, ...] = (0.0, 0.0, 0.0)
    attitude: tuple[float, ...] = (0.0, 0.0, 0.0)
    spin: tuple[float, ...] = (0.0, 0.0, 0.0)
    speed: float = 0.1
    drift: float = 0.0
    gap: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self, "target", mass=(0.0, True))
        put = lambda name, value: object.__setattr__(self, name, value)  # noqa: E731
        point = vector(self.contact_point, (2, 3), "target.contact_point", "ahead, lateral and perhaps up")
        put("contact_point", (*point, 0.0)[:3])
        put("attitude", vector(self.attitude, 3, "target.attitude", "roll, pitch, yaw"))
        put("spin", vector(self.spin, 3, "target.spin"))
        put("speed", number(self.speed, "target.speed"))
        put("drift", number(self.drift, "target.drift"))
        put("gap", number(self.gap, "target.gap"))
        if self.gap < 0.0:
            raise InputError(
                "the scene starts in penetration", given=self.gap, valid="a gap of zero or more", where="target.gap"
            )
        if self.yaw_inertia is not None:
            if self.inertia is not None:
                raise InputError("inertia and yaw_inertia are both given", valid="one of them", where="target")
            put("yaw_inertia", number(self.yaw_inertia, "target.yaw_inertia", minimum=0.0, strict=True))
        if self.inertia is not None:
            put("inertia", _inertia(self.inertia))
        fault = inertia_fault(self.mass, self.inertia_matrix())
        if fault:
            raise InputError(f"target cannot exist: {fault}", where="target.inertia")

    def inertia_matrix(self) -> np.ndarray:
        """Shape (3, 3), about the centre of mass, body axes [kg m^2]."""
        if self.inertia is not None:
            return np.array(self.inertia)
        if self.yaw_inertia is not None:
            return self.yaw_inertia * np.eye(3)
        return np.asarray(solid_box(self.mass, (TARGET_EDGE, TARGET_EDGE, TARGET_EDGE)))


def _inertia(given: Any) -> tuple[tuple[float, ...], ...]:
    where, valid = "target.inertia", "three moments, or three rows of three"
    if not isinstance(given, Sequence | np.ndarray) or isinstance(given, str) or len(given) != 3:
        raise InputError("inertia has the wrong shape", given=given, valid=valid, where=where)
    if all(isinstance(row, Sequence | np.ndarray) for row in given):
        rows = tuple(vector(row, 3, f"{where}[{i}]") for i, row in enumerate(given))
        if not np.allclose(rows, np.transpose(rows), rtol=1e-9, atol=0.0):
            raise InputError("inertia is not symmetric", given=rows, where=where)
        return rows
    return tuple(tuple(row) for row in np.diag(vector(given, 3, where, valid)).tolist())
