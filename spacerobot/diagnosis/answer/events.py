"""What happened when: touches of an arm, and by how much a tracker's own clock differs from the arm's."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from spacerobot.diagnosis.answer.record import ClockOffset, Event, Value
from spacerobot.diagnosis.locate.velocity_jump import jump
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.touch import Moment
from spacerobot.recordings.recording import Recording
from spacerobot.recordings.series import Series
from spacerobot.recordings.study import Study

BALANCE, TRACK = "torque balance", "track"
"""What shows a touch: of an arm, and of a body that flies."""


@dataclass(frozen=True)
class Touch:
    """A moment at which something touched the arm, or was touched by a body, in one trial.

    Attributes:
        trial: its id.
        stream: whose clock the moment is told on.
        moment: when.
        seen_in: what shows it.
    """

    trial: str
    stream: str
    moment: Moment
    seen_in: str = BALANCE

    def entry(self) -> Event:
        """As in the verdict."""
        return Event(
            event="touch",
            trial=self.trial,
            seen_in=self.seen_in,
            clock=self.stream,
            time_s=_value(self.moment.time, self.moment.low, self.moment.high),
        )


def touches(models: Sequence[Machine]) -> list[Touch]:
    """Of every trial whose joints were logged, the moment at which its torque balance is first shaken."""
    found: dict[str, Touch] = {}
    done: set[tuple[object, ...]] = set()
    for model in models:
        log = (type(model), model.given, *dict.fromkeys(t.recorded for t in model.trials))
        if log not in done:  # the joints of one log share their shocks
            done.add(log)
            stream = model.trials[0].blocks[0].stream
            found |= {trial: Touch(trial, stream, moment) for trial, moment in model.shocks().items()}
    return list(found.values())


def meetings(models: Sequence[Machine]) -> list[Touch]:
    """When bodies that fly met what the baseline does not know."""
    return [
        Touch(trial, model.trials[0].blocks[0].stream, moment, TRACK)
        for model in models
        for trial, some in model.met.items()
        for moment in some
    ]


def clocks(study: Study, seen: Sequence[Touch]) -> list[ClockOffset]:
    """How late each tracker's own clock is: a body that is touched changes its velocity at that moment.

    Returns:
        Entries of the effect time_offset with its trial; positive: the reading is late.
    """
    out = []
    for touch in seen:
        recording = study.recording(study.trial(touch.trial))
        arm = next(s.clock for s in recording.series.values() if s.stream == touch.stream)
        for series in _velocities(recording):
            if series.clock == arm:
                continue
            at = jump(*series.good())
            if at is None:
                continue
            late = at.time - touch.moment.time
            low = late - math.hypot(at.time - at.low, touch.moment.high - touch.moment.time)
            high = late + math.hypot(at.high - at.time, touch.moment.time - touch.moment.low)
            out.append(
                ClockOffset(
                    effect="time_offset",
                    where=series.stream,
                    trial=touch.trial,
                    against=touch.stream,
                    parameters={"delay_s": _value(late, low, high)},
                    why=f"{series.name} jumps when the torque balance says that something touched",
                )
            )
    return out


def _velocities(recording: Recording) -> list[Series]:
    names = ("velocity", "angular_velocity")
    return [s for n, s in recording.series.items() if n.split(".")[0] in _BODIES and n.split(".")[1] in names]


_BODIES = ("target", "body")


def _value(value: float, low: float, high: float) -> Value:
    return Value(value=value, ci95=(low, high), unit="s")
