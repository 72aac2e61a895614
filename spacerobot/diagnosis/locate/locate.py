"""Locate: which balance does not close, in which phase, and what its residual depends on."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence

from spacerobot.diagnosis.locate.clock import clocks
from spacerobot.diagnosis.locate.dependence import extents
from spacerobot.diagnosis.locate.located import Located
from spacerobot.diagnosis.locate.prepared import Prepared
from spacerobot.diagnosis.locate.readings import NothingToBalance
from spacerobot.diagnosis.locate.search import Search
from spacerobot.diagnosis.locate.surfaces import surfaces
from spacerobot.diagnosis.machines.contract import Baseline
from spacerobot.diagnosis.terms.data import TrialData


def believed_values(model: Baseline, trials: Sequence[TrialData]) -> dict[str, dict[str, float]]:
    """Trial id -> the values as believed, the trial's overrides on top."""
    return {t.id: {**model.believed.unknown, **model.base, **t.overrides} for t in trials}


def locate(
    model: Baseline,
    trials: Sequence[TrialData],
    values_by_trial: Mapping[str, Mapping[str, float]] | None = None,
    *,
    noise_known: bool = True,
    seed: int = 0,
) -> Located:
    """Test every balance that the channels allow against the sensors' noise.

    Patterns are sought beyond what a believed value within its stated sigma could do; a value that nobody states
    (or whose job is to absorb what is left out) can do almost anything.

    Args:
        model: a rig or another model with `mechanism`, `believed` and `base`.
        trials: the recordings.
        values_by_trial: trial id -> values to balance with, by dotted name (those of the refitted baseline); as
            believed where absent.
        noise_known: whether the trials' weights state the sensors' noise; where they do not, the residual's own spread
            stands for it.
        seed: of random sign flips.

    Raises:
        NothingToBalance: every trial is too short for a balance, or without a channel that measures the model.
    """
    values = values_by_trial if values_by_trial is not None else believed_values(model, trials)
    prepared: dict[str, Prepared] = {}
    for t in trials:
        with contextlib.suppress(NothingToBalance):  # the others say what they can
            prepared[t.id] = Prepared(model, t, values[t.id], trials)
    if not prepared:
        raise NothingToBalance("every trial is too short for a balance", given=", ".join(t.id for t in trials))
    reach = extents(prepared)
    names = list(reach)
    search = Search()
    for name in names:
        search.balance(name, prepared, reach[name])
    search.sensors(prepared)
    return Located(
        search.rows(seed, noise_known),
        surfaces(prepared, names),
        tuple(search.totals[name] for name in names),
        clocks(prepared),
        {k: p.weak.phases for k, p in prepared.items()},
    )
