"""Values of a wrist rig that no study states: where their search begins; and what one falls short by."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from spacerobot.diagnosis.machines.rig_trials import nuisances_of
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.recordings.beliefs import ABSORBING

UNKNOWN_CENTRES = {
    "contact.damping": 40.0,
    "contact.stiffness": 5e4,
    "wrist.mass": 1.0,
    "wrist.stiffness": 1e3,
    "target.mass": 10.0,
}
"""Where the search for an unstated value begins, SI; that for the wrist's stiffness where the recordings say."""


def together(values: Mapping[str, float]) -> dict[str, float]:
    """A rig's values with no constant below zero: what it falls short by comes off the value that adds to it."""
    out = dict(values)
    for name, added in ABSORBING.items():
        below = min(out.get(name, 0.0), 0.0)
        if below < 0.0:
            out[name], out[added] = 0.0, max(out.get(added, 0.0) + below, 0.0)
    return out


def unknown_values(known: Mapping[str, float], trials: tuple[TrialData, ...]) -> dict[str, float]:
    """Values of the rig that the study does not state, with where their search begins."""
    stated = {*known, *(n for n in UNKNOWN_CENTRES if trials and all(n in t.overrides for t in trials))}
    unknown = {n: c for n, c in UNKNOWN_CENTRES.items() if n not in stated}
    seen = [k for t in trials if (k := _stiffness_seen(t, known)) is not None]
    if seen and "wrist.stiffness" in unknown:
        unknown["wrist.stiffness"] = float(np.median(seen))
    return unknown


def _stiffness_seen(trial: TrialData, known: Mapping[str, float]) -> float | None:
    """Stiffness that stops the target of a trial within the wrist's largest displacement: m (v / x)^2 [N/m]."""
    if "wrist.x" not in trial.channels:
        return None
    mass = {**UNKNOWN_CENTRES, **known, **trial.overrides}["target.mass"]
    furthest = float(trial.channel("wrist.x")[1].max())
    speed = next(n.guess for n in nuisances_of(trial, False, False) if n.coordinate == "target" and n.rate)
    return mass * (speed / furthest) ** 2 if furthest > 0.0 and speed > 0.0 else None
