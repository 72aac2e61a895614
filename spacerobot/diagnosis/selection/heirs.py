"""Richer laws from where the plainer ones of the same thing stand: what they are fitted as well as, at the least."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.workshop import Task
from spacerobot.diagnosis.selection.nested_laws import general_sites, inherited, smoother
from spacerobot.diagnosis.selection.search_state import WORTH_A_FIT, Found
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.effect import Effect

ITERATIONS = 30
"""Steps of such a fit: it begins where another ended."""


def heirs(found: Found, plain: Sequence[Fit], made: Callable[[Effect, str], Site]) -> list[Task]:
    """Every richer law that costs more than one of these which it could be: it is trapped, and begins there instead.

    Args:
        found: what was fitted so far.
        plain: fits of one effect each.
        made: a site, of an effect and its place.
    """
    known = {s.label: s for s in found.singles}
    tasks = []
    for fit in plain:
        special = fit.hypothesis.sites[0]
        if special.trials or found.baseline.cost - fit.cost < WORTH_A_FIT:
            continue
        for new in (*smoother(special, made), *general_sites(special, known)):
            own = found.fits.get((new.label,))
            if own is None or own.cost > fit.cost:
                tasks.append(Task((new.label,), inherited(new, special, fit), near=fit, max_iterations=ITERATIONS))
    return tasks
