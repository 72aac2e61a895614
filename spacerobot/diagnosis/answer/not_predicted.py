"""Channels that were recorded, and that no model of the study predicts or takes as given."""

from __future__ import annotations

from collections.abc import Set as AbstractSet
from typing import Any

from spacerobot.recordings.study import Study


def not_predicted(study: Study, known: AbstractSet[str]) -> list[dict[str, Any]]:
    """What nothing that is said rests on, in the order of the streams.

    Args:
        study: with its recordings.
        known: channels that some model predicts, or takes as given (a drive, a motion that is followed).

    Returns:
        channel, unit (SI), use ("output", or "input" for a recorded input that nothing takes), stream, and in how many
        trials it was recorded.
    """
    found: dict[str, dict[str, Any]] = {}
    for trial in study.trials:
        for name, series in study.recording(trial).items():
            if name in known:
                continue
            entry = {"channel": name, "unit": series.unit, "use": series.use, "stream": series.stream, "trials": 0}
            found.setdefault(name, entry)["trials"] += 1
    order = {name: place for place, name in enumerate(study.channels())}
    return sorted(found.values(), key=lambda entry: order.get(entry["channel"], len(order)))
