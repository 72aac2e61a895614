"""When an input acted: a log says it to within a sample, and where that is worth more than an effect it is free.

A command may have held until the next one, a reading may have been taken before its motion or after. Held at nothing a
moment is paid for by no effect's power; free everywhere it takes part of weak friction for its own.
"""

from __future__ import annotations

from collections.abc import Sequence

from spacerobot.diagnosis.fitting.fit_store import Kept
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.diagnosis.selection.model_choice import as_good, pays
from spacerobot.diagnosis.terms.decision import MOVED
from spacerobot.diagnosis.terms.hypothesis import Site


def with_free_moment(growth: Growth, kept: Kept) -> Machine | None:
    """The machine with its input's moment free, where that predicts better than what was chosen without; else None.

    It may take the place of one of the chosen effects. A sensor's is given up for it where both predict as well: what
    a moment within a sample explains is no fault of a sensor.

    Args:
        growth: what a search with the moment held at nothing led to.
        kept: holds what an earlier run had found.
    """
    model = growth.bench.model
    free = model.moment_free()
    if free is None:
        return None
    bench, chosen = Bench(free, growth.bench.threads, kept), growth.after
    bench.weights = growth.bench.weights

    def tried(sites: Sequence[Site]) -> Candidate | None:
        fit = bench.fitted_as(chosen.fit, sites, {})
        if fit is None or any(abs(fit.values()[n]) > MOVED * size for n, size in model.moment.items()):
            return None  # later than that a sensor is late
        return Candidate(fit, bench.held_out(fit))

    whole = tried(chosen.sites)
    if whole is not None and pays(whole, chosen, bench.trials):
        return free
    for site in chosen.sites:
        less = tried([s for s in chosen.sites if s is not site])
        if less is None:
            continue
        fault = site.effect.kind == "sensor" and as_good(less, chosen, growth.before)
        if fault or pays(less, chosen, bench.trials):
            return free
    return None
