"""Which effects may be missing, and where: the catalogue's places, less those a believed value already covers."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import replace

from spacerobot.diagnosis.terms.hypothesis import Believed, Site
from spacerobot.effects.effect import FORM, Effect, said_name
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.registry import all_effects, effect
from spacerobot.support.errors import InputError, NotFoundError


def stood_for(effect: Effect, where: str, fitted: Container[str]) -> bool:
    """Whether a value that is fitted acts exactly as this effect does: then the value stands for both.

    Args:
        effect: one of the catalogue.
        where: its place.
        fitted: names of the values that are fitted.
    """
    return any(f"{where}.{word}" in fitted for word in effect.same_as)


def acting_as(mechanism: Mechanism, name: str, larger: bool) -> list[tuple[Effect, str]]:
    """Effects and places that a believed value, larger or smaller than what is stated of it, stands for."""
    signed = [e for e in all_effects().values() if larger or e.two_sided]
    return [(e, where) for e in signed for where in e.places(mechanism) if stood_for(e, where, (name,))]


def refines(general: str, special: str) -> bool:
    """Whether one effect equals the other at some of its values."""
    known = _known(general)
    return known is not None and (special in known.refines or any(refines(own, special) for own in known.refines))


def plainer(name: str) -> tuple[str, ...]:
    """All that an effect refines, and what that does."""
    return tuple(dict.fromkeys(n for own in _special(name) for n in (own, *plainer(own))))


def plainest(label: Sequence[tuple[str, str]]) -> tuple[tuple[str, str], ...]:
    """A set with the plainest law of each thing in place of a richer one."""
    out = []
    for name, where in label:
        while special := _special(name):
            name = special[0]
        out.append((name, where))
    return tuple(sorted(out))


def one_of_each(
    labels: Iterable[Sequence[tuple[str, str]]], known: Container[tuple[tuple[str, str], ...]]
) -> list[tuple[tuple[str, str], ...]]:
    """Of several laws of one thing one, in the order of the first: the plainest where it is known, else the first."""
    kinds: dict[tuple[tuple[str, str], ...], tuple[tuple[str, str], ...]] = {}
    for label in labels:
        kind = plainest(label)
        kinds.setdefault(kind, kind if kind in known else tuple(label))
    return list(kinds.values())


def by_name(label: Sequence[tuple[str, str]]) -> tuple[tuple[str, str], ...]:
    """A set by the names that a verdict gives its effects, whatever form they are in."""
    return tuple(sorted((said_name(name), where) for name, where in label))


def exchanged(
    label: Sequence[tuple[str, str]], old: tuple[str, str], new: tuple[str, str]
) -> tuple[tuple[str, str], ...]:
    """A set with one effect in the place of another."""
    return tuple(sorted(new if one == old else one for one in label))


def redundant(label: Sequence[tuple[str, str]]) -> bool:
    """Whether one place has two laws of the same thing; so are two forms of one effect."""
    laws = [(name.split(FORM)[0], where) for name, where in plainest(label)]
    return len(laws) != len(set(laws))


def candidate_sites(mechanism: Mechanism, believed: Believed, effects: Iterable[Effect] | None = None) -> list[Site]:
    """Every effect at every place where it could sit in this mechanism.

    Args:
        mechanism: of the baseline.
        believed: values with a sigma cover the effects that act as they do.
        effects: those to place; the catalogue's where absent.
    """
    sites = []
    for one in (e for e in (all_effects().values() if effects is None else effects) if not e.together):
        for where in one.places(mechanism):
            if not stood_for(one, where, believed.fitted):
                sites.append(Site(one, where))
    return sites


def contains(general: Sequence[tuple[str, str]], special: Sequence[tuple[str, str]]) -> bool:
    """Whether one set of effects holds another as a special case: a superset, or general effects in their place."""
    if set(general) == set(special):
        return False
    left = list(general)
    for name, where in special:
        for other in left:
            if other == (name, where) or (other[1] == where and refines(other[0], name)):
                left.remove(other)
                break
        else:
            return False
    return True


def simpler(label: Sequence[tuple[str, str]]) -> list[tuple[tuple[str, str], ...]]:
    """The same set with one general effect replaced by its special case, or one effect left out."""
    out = []
    for i, (name, where) in enumerate(label):
        rest = [*label[:i], *label[i + 1 :]]
        out += [tuple(sorted([*rest, (special, where)])) for special in _special(name)]
        if rest:
            out.append(tuple(sorted(rest)))
    return out


def late(site: Site) -> Site:
    """A relative effect of a sensor beside another one that has it too: what is early here is late there."""
    strength = site.effect.strength
    own = replace(strength, lower=strength.null, starts=tuple(s for s in strength.starts if s > strength.null))
    return replace(site, effect=site.effect.with_parameters((own,)))


def means(sites: Sequence[tuple[str, str]], values: Mapping[str, float]) -> bool:
    """Whether signs make physical sense where two readings of one thing exist.

    Only the difference of two streams' delays shows in a free trial, so a stream that is early is the other that is
    late; the late one is meant.
    """
    return not any(_early(name, where, values) for name, where in sites)


def mirrored(
    label: Sequence[tuple[str, str]], values: Mapping[str, float], known: Sequence[tuple[str, str]]
) -> tuple[tuple[tuple[str, str], ...], dict[str, float]] | None:
    """The set that is meant by one in which a stream is early: the other stream late by as much.

    Args:
        label: effects and places.
        values: of their parameters, by key.
        known: every effect and place there is; the other stream must be the only other one.

    Returns:
        effects and places, and their values; None where no stream is early, or none other can be late.
    """
    early = [(name, where) for name, where in label if _early(name, where, values)]
    if len(early) != 1:
        return None
    late = [(name, where) for name, where in known if name == early[0][0] and (name, where) not in early]
    if len(late) != 1 or late[0] in label:
        return None
    keys = {_strength(*early[0]): _strength(*late[0])}
    moved = {keys.get(k, k): -v if k in keys else v for k, v in values.items()}
    return tuple(sorted([*(one for one in label if one not in early), *late])), moved


def _early(name: str, where: str, values: Mapping[str, float]) -> bool:
    known = _known(name)
    return known is not None and known.relative and values.get(_strength(name, where), 0.0) < 0.0


def _strength(name: str, where: str) -> str:
    return f"{name}@{where}.{effect(name).strength.name}"


def _known(name: str) -> Effect | None:
    try:
        return effect(name)
    except (NotFoundError, InputError):
        return None


def _special(name: str) -> tuple[str, ...]:
    known = _known(name)
    return () if known is None else tuple(sorted(known.refines))
