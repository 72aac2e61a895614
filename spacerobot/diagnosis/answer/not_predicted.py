"""Channels that were recorded, and that no model of the study predicts or takes as given."""

from __future__ import annotations

from collections.abc import Set as AbstractSet

from spacerobot.diagnosis.answer.record import NotPredicted
from spacerobot.recordings.study import Study


def not_predicted(study: Study, known: AbstractSet[str]) -> list[NotPredicted]:
    """What nothing that is said rests on, in the order of the streams.

    Args:
        study: with its recordings.
        known: channels that some model predicts, or takes as given (a drive, a motion that is followed).

    Returns:
        channel, unit (SI), use ("output", or "input" for a recorded input that nothing takes), stream, and in how many
        trials it was recorded.
    """
    found: dict[str, NotPredicted] = {}
    for trial in study.trials:
        for name, series in study.recording(trial).items():
            if name not in known:
                before = found.get(name)
                found[name] = NotPredicted(
                    channel=name,
                    unit=series.unit if before is None else before.unit,
                    use=series.use if before is None else before.use,
                    stream=series.stream if before is None else before.stream,
                    trials=1 if before is None else before.trials + 1,
                )
    order = {name: place for place, name in enumerate(study.channels())}
    return sorted(found.values(), key=lambda entry: order.get(entry.channel, len(order)))
