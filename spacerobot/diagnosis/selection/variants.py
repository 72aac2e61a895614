"""The chosen model in other words: what a search, effect by effect, does not come by."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.model_choice import ratio
from spacerobot.diagnosis.selection.nested_laws import inherited, wordings
from spacerobot.diagnosis.terms.candidates import plainer, redundant
from spacerobot.diagnosis.terms.decision import REWORDED, TIE
from spacerobot.diagnosis.terms.hypothesis import Site, label_of
from spacerobot.effects.registry import effect

Variant = tuple[list[Site], dict[str, float]]
"""A set of effects, and values at which its fit begins."""


class Variants:
    """Of models that a bench fits.

    Attributes:
        sites: effects and places on offer; those of a variant that is fitted come along.
    """

    def __init__(self, bench: Bench, sites: dict[tuple[str, str], Site]) -> None:
        """Of the models of a search that shares these sites."""
        self.bench, self.sites = bench, sites

    def varied(self, chosen: Candidate, tested: Sequence[Candidate], variants: Iterable[Variant]) -> list[Candidate]:
        """Of variants of the chosen model those that are new, fitted and tried on unseen trials."""
        known, out = {c.label for c in tested}, []
        for sites, start in variants:
            label = label_of(sites)
            if label in known or redundant(label):
                continue
            known.add(label)
            fit = self.bench.fitted_as(chosen.fit, sites, start)
            if fit is not None:
                for site in sites:
                    self.sites.setdefault(site.label, site)
                out.append(self.bench.tested(fit))
        return out

    def reworded(self, chosen: Candidate) -> Iterator[Variant]:
        """The chosen model said with a general effect in the place of its special case and of one effect more.

        Friction and a constant force may be one friction of two levels; sensitivities at one start do not see that.
        """
        for wording in wordings(chosen.sites, self.sites):
            start: dict[str, float] = {}
            for new, special in wording:
                start |= {} if special is None else inherited(new, special, chosen.fit)
            yield [s for s, _ in wording], start

    def parts(self, chosen: Candidate) -> Iterator[Variant]:
        """The model without each of its effects: what was found beside others may never have been tried alone."""
        for site in chosen.sites:
            if rest := [s for s in chosen.sites if s is not site]:
                yield rest, {}

    def exchanged(self, chosen: Candidate, tested: Sequence[Candidate]) -> Iterator[Variant]:
        """The chosen model with an effect that stood for one of its own beside others, and predicted the same there.

        More inertia and a torque that reads too much are one and the same also beside friction of which nobody knows
        how large it is, and a beam keeps only one of the two.
        """
        for site in chosen.sites:
            for other, twin in self.twins(site, tested):
                if other.label not in chosen.label:
                    start = {k: v for k, v in {**twin.fit.values(), **chosen.fit.values()}.items() if "@" in k}
                    yield [*(s for s in chosen.sites if s is not site), other], start

    def formed(self, chosen: Candidate) -> Iterator[Variant]:
        """The chosen model with an effect in another form in the place of its plain one, and of all that stands there.

        A filter of higher order is late as well: a plain filter and a delay make up for it. Friction that is smooth
        about rest is a sharp one, or what refines it, with what makes up for that.
        """
        for site in chosen.sites:
            others = [s for s in chosen.sites if s is not site]
            elsewhere = [s for s in others if s.where != site.where]
            for other in self.forms_of(site):
                start = inherited(other, site, chosen.fit)
                yield [*elsewhere, other], start
                yield [*others, other], start

    def forms_of(self, site: Site) -> Iterator[Site]:
        """Other forms of an effect at its place, and of those that it refines."""
        model = self.bench.model
        for plain in (site.effect, *(effect(n) for n in plainer(site.effect.name))):
            if not (any(p.reach for p in plain.parameters) or (plain.kind == "sensor" and model.one_lag)):
                yield from model.in_forms(plain, site.where)

    def twins(self, site: Site, tested: Sequence[Candidate]) -> Iterator[tuple[Site, Candidate]]:
        """Effects that predicted, beside others, what this one did there, where these alone did not; with that set."""
        by = {frozenset(c.label): c for c in tested}
        for own in (c for c in tested if site.label in c.label):
            rest = frozenset(own.label) - {site.label}
            plain = by.get(rest)
            if plain is None or ratio(own, plain) > 1.0 - TIE:
                continue
            for other in self.sites.values():
                twin = by.get(rest | {other.label})
                if other.label not in own.label and twin is not None and abs(ratio(twin, own) - 1.0) <= REWORDED:
                    yield other, twin
