"""Logs of motors, not of joints: `[gears]` turns their angles and currents into the joints' positions and torques.

With the motors' angles m = R q, the joints' are q = R^-1 m and their torques R^T times the motors'. R is diagonal where
each motor turns one joint; a wrist's are often coupled.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spacerobot.recordings.channel import ChannelSpec
from spacerobot.recordings.document import Document
from spacerobot.recordings.stream import StreamSpec
from spacerobot.recordings.units import SI
from spacerobot.support.errors import InputError, NotFoundError

_KEYS = ("streams", "joints", "ratio", "torque_per_ampere")
_MOTION = ("position", "velocity", "acceleration", "reference")
_DRIVE = ("torque", "current")


@dataclass(frozen=True)
class Gears:
    """Between motors and joints.

    Attributes:
        streams: those that log motors.
        joints: in the order of the ratio's rows and columns; motor k is logged under joint k's name.
        ratio: (J, J) turns of each motor per turn of each joint.
        torque_per_ampere: (J,) of each motor [N m/A]; None where no current is to become a torque.
    """

    streams: tuple[str, ...]
    joints: tuple[str, ...]
    ratio: np.ndarray
    torque_per_ampere: np.ndarray | None


def read_gears(document: Document, streams: Mapping[str, StreamSpec]) -> Gears | None:
    """The `[gears]` of a study, None where it has none.

    Raises:
        InputError: a ratio that cannot be undone, or lists of different length.
        NotFoundError: no such stream.
    """
    if "gears" not in document.data:
        return None
    table = document.table(document.data, "gears")
    document.check_keys(table, _KEYS, "gears")
    named = {key: _names(document, table, key) for key in ("streams", "joints")}
    for name in named["streams"]:
        if name not in streams:
            raise NotFoundError("stream", name, streams, where=document.where("gears", "streams"))
    count = len(named["joints"])
    where = document.where("gears", "ratio")
    rows = table.get("ratio", [])
    if isinstance(rows, list) and rows and all(isinstance(r, list) for r in rows):
        ratio = np.array([document.vector(r, count, "gears", "ratio") for r in rows])
    else:
        ratio = np.diag(document.vector(rows, count, "gears", "ratio"))
    if ratio.shape != (count, count):
        raise InputError("the ratio needs a row for each joint", given=len(ratio), valid=str(count), where=where)
    if not abs(np.linalg.det(ratio / max(np.abs(ratio).max(), 1e-300))) > 1e-12:
        raise InputError("the ratio cannot be undone: some joint turns no motor of its own", where=where)
    constant = None
    if "torque_per_ampere" in table:
        given = table["torque_per_ampere"]
        given = given if isinstance(given, list) else [given] * count
        constant = np.array(document.vector(given, count, "gears", "torque_per_ampere"))
    return Gears(named["streams"], named["joints"], ratio, constant)


def geared(streams: Mapping[str, StreamSpec], gears: Gears | None) -> dict[str, StreamSpec]:
    """The streams with joints' channels in place of motors'.

    Raises:
        InputError: a motor that is not logged beside the others, or other units.
    """
    if gears is None:
        return dict(streams)
    return {n: _at_joints(s, gears) if n in gears.streams else s for n, s in streams.items()}


def _at_joints(stream: StreamSpec, gears: Gears) -> StreamSpec:
    inverse = np.linalg.inv(gears.ratio)
    found = list(stream.channels)
    for quantity in (*_MOTION, *_DRIVE):
        own = {c.name: c for c in stream.channels if c.name.endswith(f".{quantity}")}
        motors = [own.get(f"joint.{j}.{quantity}") for j in gears.joints]
        logged = [m for m in motors if m is not None]
        if not logged or (quantity == "current" and gears.torque_per_ampere is None):
            continue
        if len({m.unit for m in logged}) > 1:
            raise InputError("the motors' channels need one unit", given=logged[0].name, where=logged[0].where)
        matrix = inverse if quantity in _MOTION else gears.ratio.T
        if quantity == "current" and gears.torque_per_ampere is not None:
            matrix = matrix * gears.torque_per_ampere  # below, a current's unit goes into its factor
        for k, motor in enumerate(motors):
            if motor is not None:
                found[found.index(motor)] = _joint(motor, motors, matrix[k], k, gears.joints, quantity)
    return replace(stream, channels=tuple(found))


def _joint(
    own: ChannelSpec,
    motors: Sequence[ChannelSpec | None],
    row: np.ndarray,
    index: int,
    joints: Sequence[str],
    quantity: str,
) -> ChannelSpec:
    """A joint's channel from its row of factors on the motors'."""
    plus: list[tuple[str, float]] = []
    doubts: dict[str, float] = {}
    square, offset, doubt = 0.0, 0.0, 0.0
    counted = own.factor if quantity == "current" else 1.0
    for k, (motor, factor) in enumerate(zip(motors, row.tolist(), strict=True)):
        if factor == 0.0:
            continue
        if motor is None:
            raise InputError(f"{own.name} needs the motor of {joints[k]}, which is not logged", where=own.where)
        square = square + (math.nan if motor.sigma is None else (factor * motor.sigma) ** 2)
        offset += counted * factor * motor.offset
        doubt += (counted * factor * motor.offset_sigma) ** 2
        plus += [(motor.column, counted * factor * motor.scale)] if k != index else []
        plus += [(column, counted * factor * share) for column, share in motor.plus]
        for column, sigma in motor.plus_sigma:
            doubts[column] = math.hypot(doubts.get(column, 0.0), counted * factor * sigma)
    return replace(
        own,
        name=own.name.removesuffix("current") + "torque" if quantity == "current" else own.name,
        unit=SI["torque"] if quantity == "current" else own.unit,
        scale=counted * float(row[index]) * own.scale,
        offset=offset,
        offset_sigma=math.sqrt(doubt),
        plus=tuple(plus),
        plus_sigma=tuple(doubts.items()),
        sigma=math.sqrt(square) if math.isfinite(square) else None,
    )


def _names(document: Document, table: Mapping[str, object], key: str) -> tuple[str, ...]:
    given = table.get(key)
    if not isinstance(given, list) or not given or not all(isinstance(n, str) for n in given):
        raise InputError(f"'{key}' must be a list of names", given=given, where=document.where("gears", key))
    return tuple(given)
