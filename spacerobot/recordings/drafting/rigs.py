"""The kinds of rig that a draft may be of."""

from __future__ import annotations

RIGS = {
    "wrist": "a wrist rig",
    "arm": "an arm with joint logs",
    "platform": "a floating platform with an arm",
    "body": "a free body",
    "axis": "one driven axis",
    "pendulum": "a pendulum that swings freely",
}
"""Kind, as `study new --rig` takes it -> what it is."""

UNKNOWN = "a rig of which no column was recognised"
