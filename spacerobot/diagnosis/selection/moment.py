"""When an input acted: a log says it to within a sample, and where that is worth more than an effect it is free.

A command may have held until the next one, a reading may have been taken before its motion or after. Held at nothing a
moment is paid for by no effect's power; free everywhere it takes part of weak friction for its own. So it is with the
zero of an encoder at a joint that swings by itself: the weight that it misses is a constant force, and friction of one
level beside that is friction of two.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from spacerobot.diagnosis.fitting.fit_store import Kept
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.diagnosis.selection.model_choice import as_good, pays
from spacerobot.diagnosis.selection.nested_laws import level_of, special_sites
from spacerobot.diagnosis.terms.hypothesis import Site


def with_free_moment(growth: Growth, kept: Kept) -> Machine | None:
    """The machine with its input's moment free, where that predicts better than what was chosen without; else None.

    It may take the place of one of the chosen effects. A sensor's is given up for it where both predict as well: what
    a moment within a sample explains is no fault of a sensor. So is a general law for its special case, where that
    leaves no more than the law did, however little both leave of what the baseline does.

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

    def tried(sites: Sequence[Site], start: Mapping[str, float] = MappingProxyType({})) -> Candidate | None:
        if any(s.effect.relative for s in sites):
            return None  # its clock's offset holds the moment
        fit = bench.fitted_as(chosen.fit, sites, start)
        if fit is None or any(abs(fit.values()[n]) >= most for n, most in free.believed.within.items()):
            return None  # later than that a sensor is late
        return bench.tested(fit)

    whole = tried(chosen.sites)
    if whole is not None and pays(whole, chosen, bench.trials):
        return free
    for site in chosen.sites:
        rest = [s for s in chosen.sites if s is not site]
        less = tried(rest)
        fault = less is not None and site.effect.kind == "sensor" and as_good(less, chosen, growth.before)
        if fault or (less is not None and pays(less, chosen, bench.trials)):
            return free
        for plain in special_sites(site, {s.label: s for s in growth.sites}):
            plainer = tried([*rest, plain], level_of(plain, site, chosen.fit))
            if plainer is not None and as_good(plainer, chosen, chosen):
                return free
    return None
