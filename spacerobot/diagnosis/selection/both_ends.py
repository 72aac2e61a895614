"""What loads two parts of a machine at once: what one names of it, the other must bear out.

The friction of a drive that two joints turn acts on both. Where it explains one joint's torque and says nothing of the
other's, it stands for something else: links that are not as the model has them move with two joints as well.
"""

from __future__ import annotations

from collections.abc import Sequence

from spacerobot.diagnosis.machines.contract import Refused
from spacerobot.diagnosis.selection.model_choice import pays
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.effect import Effect


def one_ended(parts: Sequence[Part]) -> dict[int, Refused]:
    """Part -> what it names that loads another part too, which does not bear it out; with it, all of its kind there but
    what is borne out: the next best would be as little.
    """
    out: dict[int, Refused] = {}
    for k, part in enumerate(parts):
        borne = {s.label: _borne_out(part, s, parts) for s in part.fit.hypothesis.sites}
        names = {label[0] for label, is_so in borne.items() if not is_so}
        refused = {s.label for s in part.growth.sites if s.effect.name in names and not borne.get(s.label, False)}
        if refused:
            out[k] = frozenset(refused)
    return out


def _borne_out(part: Part, site: Site, parts: Sequence[Part]) -> bool:
    """Whether nothing speaks against what a part names: it acts there alone, or nothing was read of the other end."""
    there = site.effect.elsewhere(part.model.plain(), site.where)
    other = None if there is None else _watching(parts, there[0])
    if there is None or other is None or other.model.not_measured:
        return True
    named = (s for s in other.fit.hypothesis.sites if s.label == site.label)
    ends = (s.effect.elsewhere(other.model.plain(), s.where) for s in named)
    if any(end is not None and _watching([part], end[0]) for end in ends):
        return True
    return _shows(other, there[1], site, part.fit.values())


def _shows(part: Part, effect: Effect, site: Site, values: dict[str, float]) -> bool:
    """Whether a part's unseen trials are predicted better with the effect that another part names."""
    there, bench = part.model.site(effect, site.where), part.growth.bench
    start = {there.key(p.name): values[site.key(p.name)] for p in site.effect.parameters}
    fit = bench.fitted_anyhow(part.fit, (*part.fit.hypothesis.sites, there), start)
    return fit is not None and pays(bench.tested(fit), part.chosen, part.trials)


def _watching(parts: Sequence[Part], port: str) -> Part | None:
    """The part whose torque at a port is compared."""
    return next((p for p in parts if f"{port}.torque" in p.trials[0].channels), None)
