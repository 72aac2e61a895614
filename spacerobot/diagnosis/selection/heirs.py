"""Richer laws from where the plainer ones of the same thing stand: what they are fitted as well as, at the least."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.workshop import Task
from spacerobot.diagnosis.selection.nested_laws import general_sites, inherited
from spacerobot.diagnosis.selection.search_state import WORTH_A_FIT, Found
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.effect import Effect
from spacerobot.effects.registry import effect

ITERATIONS = 30
"""Steps of such a fit: it begins where another ended."""


def heirs(found: Found, plain: Sequence[Fit], in_forms: Callable[[Effect, str], Iterable[Site]]) -> list[Task]:
    """Every richer law that costs more than one of these which it could be: it is trapped, and begins there instead.

    Args:
        found: what was fitted so far.
        plain: fits of one effect each.
        in_forms: an effect's other forms at a place; those that equal it in a limit are richer laws too.
    """
    known = {s.label: s for s in found.singles}
    tasks = []
    for fit in plain:
        special = fit.hypothesis.sites[0]
        if special.trials or found.baseline.cost - fit.cost < WORTH_A_FIT:
            continue
        smoother = (s for s in in_forms(effect(special.effect.name), special.where) if s.effect.limits)
        for new in (*smoother, *general_sites(special, known)):
            own = found.fits.get((new.label,))
            if own is None or own.cost > fit.cost:
                tasks.append(Task((new.label,), inherited(new, special, fit), near=fit, max_iterations=ITERATIONS))
    return tasks
