"""How fits of unlike size are weighed: what an effect's parameters cost, and what a further effect must earn."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from spacerobot.diagnosis.candidates import contains
from spacerobot.diagnosis.fitted import Fit

PENALTY = 8.0
"""Cost of one effect parameter: the look over forty effects finds a chance fall of chi-squared of this size."""

SMALL = 1e-3
"""Share of what the simpler model explains that a further effect must earn."""

SLIGHT = 0.05
"""That share where the simpler set leaves nothing but noise: what it lacks is then no more than a small defect of its
own law, which many a further effect can take up a little.
"""


def score(fit: Fit, inflation: float = 1.0) -> float:
    """Penalised cost in units of the noise as it is."""
    count = sum(1 for f in fit.hypothesis.free if f.kind == "effect")
    count += sum(1 for s in fit.hypothesis.sites if s.trials)  # which trial was a choice too
    count += len(fit.hypothesis.freed)  # a belief that is given up
    return fit.cost / inflation + PENALTY * count


def worth(explained: float, share: float = SMALL) -> float:
    """Fall of the penalised cost that a further effect must bring, beside one that explains so much."""
    return max(4.0, share * explained)


def simplest(
    ranked: Sequence[Fit],
    scores: Mapping[int, float],
    base: Fit,
    adequate: Callable[[Fit], bool] = lambda fit: False,
) -> Fit:
    """The best, unless a special case of it does nearly as well.

    What a further effect earns is also held against what the simpler model explains: with many samples a harmless
    defect of the first effect's law is always significant, and a second effect would be named for it.

    Args:
        ranked: fits, best first.
        scores: penalised costs by id(fit).
        base: the refitted baseline.
        adequate: whether a fit is known to leave nothing but noise.
    """
    best = ranked[0]
    for fit in ranked[1:]:
        if not contains(best.hypothesis.label, fit.hypothesis.label):
            continue
        fewer = len(fit.hypothesis.sites) < len(best.hypothesis.sites)
        share = SLIGHT if fewer and adequate(fit) else SMALL
        if scores[id(fit)] - scores[id(best)] < worth(scores[id(base)] - scores[id(fit)], share):
            best = fit
    return best
