"""Channels that show a robot behind its wrist: its joints, and a base that floats."""

from __future__ import annotations

import re

from spacerobot.recordings.study import Study

BASE_CHANNELS = ("base.x", "base.y", "base.z", "base.roll", "base.pitch", "base.yaw")
"""What shows the ports of a base, along and about approach, lateral and up."""

_JOINT = re.compile(r"joint\.[^.]+\.(?:position|velocity)")
_BASE = re.compile(r"base\.(?:[xyz]|roll|pitch|yaw|(?:position|velocity|angular_velocity)\.[xyz])")


def robot_channels(study: Study) -> frozenset[str]:
    """Those of a study, of what may move: joints that are not locked, a base that is free."""
    shown = []
    if study.baseline.joints != "locked":
        shown.append(_JOINT)
    if study.baseline.base == "free":
        shown.append(_BASE)
    return frozenset(c for c in study.channels() if any(p.fullmatch(c) for p in shown))


def of_robot(channel: str) -> bool:
    """Whether a channel shows a joint or the base."""
    return bool(_JOINT.fullmatch(channel) or _BASE.fullmatch(channel))


def is_rate(channel: str) -> bool:
    """Whether a channel shows a velocity."""
    return "velocity" in channel
