"""Channels: what a recorded column measures, under one canonical name, in SI units."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from spacerobot.recordings import units
from spacerobot.recordings.sensor_filter import SensorFilter
from spacerobot.simulation.parts.checks import LARGEST, SMALLEST
from spacerobot.support.errors import InputError, NotFoundError

_LINEAR, _ANGULAR = ("length",), ("angle",)
_BODY = r"(?:target|hand|wrist|base|body|link\.[^.]+|marker\.[^.]+)"

_PATTERNS: tuple[tuple[str, tuple[str, ...]], ...] = (
    (rf"{_BODY}\.[xyz]", _LINEAR),
    (rf"{_BODY}\.(?:yaw|pitch|roll)", _ANGULAR),
    (r"contact\.force", ("force",)),
    (r"(?:target|hand|wrist|base|body)\.(?:force|effort)\.[xyz]", ("force",)),
    (r"(?:target|hand|wrist|base|body)\.torque\.(?:[xyz]|yaw)", ("torque",)),
    (r"joint\.[^.]+\.position", ("angle", "length")),
    (r"joint\.[^.]+\.velocity", ("angular_velocity", "velocity")),
    (r"joint\.[^.]+\.acceleration", ("angular_acceleration", "acceleration")),
    (r"joint\.[^.]+\.torque", ("torque", "force")),
    (r"joint\.[^.]+\.reference", ("angle", "length")),
    (r"joint\.[^.]+\.voltage", ("voltage",)),
    (r"joint\.[^.]+\.current", ("current",)),
    (rf"{_BODY}\.position\.[xyz]", _LINEAR),
    (rf"{_BODY}\.orientation\.[wxyz]", ("ratio",)),
    (rf"{_BODY}\.velocity\.[xyz]", ("velocity",)),
    (rf"{_BODY}\.velocity\.(?:yaw|pitch|roll)", ("angular_velocity",)),
    (rf"{_BODY}\.angular_velocity\.[xyz]", ("angular_velocity",)),
    (rf"{_BODY}\.acceleration\.[xyz]", ("acceleration",)),
    (r"aux\.[^.]+", tuple(units.SI)),
)

EXAMPLES: tuple[str, ...] = (
    "target.x",
    "target.y",
    "target.yaw",
    "wrist.x",
    "hand.x",
    "contact.force",
    "joint.NAME.position",
    "joint.NAME.velocity",
    "joint.NAME.torque",
    "joint.NAME.voltage",
    "joint.NAME.reference",
    "base.position.x",
    "base.yaw",
    "base.velocity.x",
    "base.force.x",
    "base.torque.yaw",
    "target.position.x",
    "target.orientation.w",
    "target.angular_velocity.z",
    "body.position.x",
    "body.velocity.x",
    "body.orientation.w",
    "hand.position.x",
    "hand.force.x",
    "link.NAME.position.x",
    "marker.NAME.position.x",
    "aux.NAME",
)
"""One name of each kind of channel, for messages and documentation. `aux.NAME` is kept but never balanced."""

SLIDING = {"rad": "m", "rad/s": "m/s", "rad/s2": "m/s2", "Nm": "N"}
"""What a channel of a joint has where it slides, in the place of what it has where it turns."""

MOMENTS = ("before", "after", "event")
"""When a column of an events stream was taken, relative to the event."""

FRAMES = ("world", "body")

USES = ("output", "input")
"""`output`: measured, to be predicted. `input`: commanded or known, drives the prediction."""


def dimensions(name: str, *, where: str | None = None) -> tuple[str, ...]:
    """What the channel called `name` may measure, e.g. ("angle", "length") for a joint's position.

    Raises:
        NotFoundError: no such channel.
    """
    for pattern, found in _PATTERNS:
        if re.fullmatch(pattern, name):
            return found
    raise NotFoundError("channel", name, EXAMPLES, where=where)


def joint_of(name: str) -> str:
    """The joint whose channel this is; empty where it is no joint's."""
    return name.removeprefix("joint.").rpartition(".")[0] if name.startswith("joint.") else ""


@dataclass(frozen=True)
class ChannelSpec:
    """How columns become a channel: SI value = factor(unit) * (scale * raw + sum of factor * other + offset).

    Attributes:
        column: the column's name in the file, or its index from 0 as text.
        name: canonical channel, e.g. "target.x"; with the moment appended for events, as in
            "body.velocity.x.before".
        sigma: one standard deviation of the sensor's noise, SI; None where the study does not say.
        unit: unit of `scale * raw + offset`; None for SI.
        scale: dimensionless factor on the raw reading.
        offset: added after `scale`, in `unit`.
        offset_sigma: one standard deviation of where the channel's zero is, in `unit`; 0 where it is exact.
        use: "output" or "input".
        missing: raw readings that mean "no reading".
        unwrap: whether jumps of a turn are taken out of an angle.
        moment: "before", "after" or "event" for an events stream, else None.
        plus: other columns of the file, each with its factor: coupled gears, absolute angles, a command and its
            compensation, a direction between the axes.
        plus_sigma: those of them whose factor is known no better than this standard deviation: an axis that is mounted
            askew, a camera's axes, cross-talk.
        frame: "world", or "body" for a force along the axes of the body that it acts on; it is turned by the body's
            recorded yaw.
        filter: the low-pass filter that its sensor is known to have; None where none is stated.
    """

    column: str
    name: str
    sigma: float | None = None
    unit: str | None = None
    scale: float = 1.0
    offset: float = 0.0
    offset_sigma: float = 0.0
    use: str = "output"
    missing: tuple[float, ...] = ()
    unwrap: bool = False
    moment: str | None = None
    plus: tuple[tuple[str, float], ...] = ()
    plus_sigma: tuple[tuple[str, float], ...] = ()
    frame: str = "world"
    filter: SensorFilter | None = None
    where: str | None = None

    def __post_init__(self) -> None:
        measured = dimensions(self.quantity, where=self.where)
        if self.unit is not None:
            units.factor(self.unit, measured, where=self.where)
        if self.sigma is not None and not (math.isfinite(self.sigma) and self.sigma > 0):
            raise InputError("sigma of a channel must be positive", given=self.sigma, where=self.where)
        if self.sigma is not None and not SMALLEST <= self.sigma <= LARGEST:
            raise InputError(
                f"sigma of {self.name} is out of range",
                given=self.sigma,
                valid=f"{SMALLEST:g} to {LARGEST:g}, in SI",
                where=self.where,
            )
        if not (math.isfinite(self.scale) and self.scale != 0 and math.isfinite(self.offset)):
            raise InputError(
                "scale and offset must be finite, and scale not zero",
                given=f"scale {self.scale}, offset {self.offset}",
                where=self.where,
            )
        if not (math.isfinite(self.offset_sigma) and self.offset_sigma >= 0.0):
            raise InputError("offset_sigma must not be negative", given=self.offset_sigma, where=self.where)
        if self.unwrap and "angle" not in measured:
            raise InputError("only an angle can be unwrapped", given=self.name, where=self.where)
        if self.frame not in FRAMES:
            raise NotFoundError("frame of a channel", self.frame, FRAMES, where=self.where)
        if self.frame == "body" and not re.fullmatch(r"(?:target|base|body)\.(?:force|effort)\.[xy]", self.quantity):
            raise InputError(
                "only a force in the plane has a body's axes",
                given=self.name,
                valid="body.force.x or .y (of target, base or body)",
                where=self.where,
            )
        if self.frame == "body" and (self.plus_sigma or self.offset_sigma > 0.0):
            raise InputError(
                "a force along a body's axes is turned as it was read: no zero or factor of it can be doubted",
                given=self.name,
                valid='offset and plus as numbers, or frame = "world"',
                where=self.where,
            )
        if any(not math.isfinite(k) for _, k in self.plus):
            raise InputError("the factors of 'plus' must be finite", given=dict(self.plus), where=self.where)
        if any(not (math.isfinite(s) and s > 0.0) for _, s in self.plus_sigma):
            raise InputError("a factor's sigma must be above 0", given=dict(self.plus_sigma), where=self.where)
        if self.use not in USES:
            raise NotFoundError("use of a channel", self.use, USES, where=self.where)

    @property
    def quantity(self) -> str:
        """The canonical name without the moment."""
        if self.moment is None:
            return self.name
        return self.name.removesuffix(f".{self.moment}")

    @property
    def factor(self) -> float:
        """SI units per one `unit`."""
        return 1.0 if self.unit is None else units.unit(self.unit).factor

    @property
    def si_unit(self) -> str:
        """SI unit of the series, e.g. "m"; that of the first dimension where `unit` is silent, "" for aux."""
        measured = dimensions(self.quantity)
        if self.unit is None and self.name.startswith("aux."):
            return ""
        return units.SI[units.unit(self.unit).dimension if self.unit else measured[0]]
