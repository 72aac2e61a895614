"""Locate: which balance does not close, in which phase, and what its residual depends on."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence

from spacerobot.diagnosis.locate.beliefs import believed_values
from spacerobot.diagnosis.locate.dependence import extents
from spacerobot.diagnosis.locate.located import Located
from spacerobot.diagnosis.locate.prepared import Prepared
from spacerobot.diagnosis.locate.readings import NothingToBalance
from spacerobot.diagnosis.locate.search import Search
from spacerobot.diagnosis.locate.sensor_faults import clocks
from spacerobot.diagnosis.locate.surfaces import surfaces
from spacerobot.diagnosis.machines.contract import Baseline
from spacerobot.diagnosis.terms.data import TrialData


def locate(
    model: Baseline,
    trials: Sequence[TrialData],
    *,
    noise_known: bool = True,
) -> Located:
    """Test every balance that the channels allow against the sensors' noise.

    Patterns are sought beyond what a believed value within its stated sigma could do; a value that nobody states
    (or whose job is to absorb what is left out) can do almost anything.

    Args:
        model: a rig or another model with `mechanism`, `believed` and `base`.
        trials: the recordings.
        noise_known: whether the trials' weights state the sensors' noise; where they do not, the residual's own spread
            stands for it.

    Raises:
        NothingToBalance: every trial is too short for a balance, or without a channel that measures the model.
    """
    prepared: dict[str, Prepared] = {}
    for t in trials:
        with contextlib.suppress(NothingToBalance):  # the others say what they can
            prepared[t.id] = Prepared(model, t, believed_values(model, t), trials)
    if not prepared:
        raise NothingToBalance("every trial is too short for a balance", given=", ".join(t.id for t in trials))
    reach = extents(prepared)
    names = list(reach)
    search = Search()
    for name in names:
        search.balance(name, prepared, reach[name])
    search.sensors(prepared)
    return Located(
        search.rows(noise_known),
        surfaces(prepared, names),
        tuple(search.totals[name] for name in names),
        clocks(prepared),
        {k: p.weak.phases for k, p in prepared.items()},
    )
