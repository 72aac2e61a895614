"""Which effects may be missing, and where: the catalogue's places, less those a believed value already covers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from spacerobot.diagnosis.terms.hypothesis import Believed, Site
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.registry import all_effects

COVERED_BY: Mapping[tuple[str, str], tuple[str, ...]] = {
    ("viscous_friction", "wrist"): ("wrist.equivalent_damping", "wrist.damping"),
    ("payload", "wrist"): ("wrist.mass",),
    ("payload", "target"): ("target.mass",),
}
"""Effects that act exactly as a believed value does: no data tell the two apart, so the value stands for both."""

CONTAINS: frozenset[tuple[str, str]] = frozenset(
    {
        ("asymmetric_friction", "coulomb_friction"),
        ("stribeck_friction", "coulomb_friction"),
    }
)
"""(general, special): the general effect equals the special one at some of its values."""


def candidate_sites(mechanism: Mechanism, believed: Believed, without: Sequence[str] = ()) -> list[Site]:
    """Every effect at every place where it could sit in this mechanism.

    Args:
        mechanism: of the baseline.
        believed: values with a sigma cover the effects that act as they do.
        without: names of effects to leave out.
    """
    sites = []
    for effect in all_effects().values():
        if effect.name in without:
            continue
        for where in effect.places(mechanism):
            covering = COVERED_BY.get((effect.name, where), ())
            if not any(name in believed.sigma for name in covering):
                sites.append(Site(effect, where))
    return sites


def contains(general: Sequence[tuple[str, str]], special: Sequence[tuple[str, str]]) -> bool:
    """Whether one set of effects holds another as a special case: a superset, or general effects in their place."""
    if set(general) == set(special):
        return False
    left = list(general)
    for name, where in special:
        for other in left:
            if other == (name, where) or ((other[0], name) in CONTAINS and other[1] == where):
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
        out += [tuple(sorted([*rest, (special, where)])) for general, special in sorted(CONTAINS) if general == name]
        if rest:
            out.append(tuple(sorted(rest)))
    return out


def plausible(sites: Sequence[tuple[str, str]], values: Mapping[str, float]) -> bool:
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
    late = [(name, where) for name, where in known if name == "time_offset" and (name, where) not in early]
    if len(early) != 1 or len(late) != 1 or late[0] in label:
        return None
    keys = {f"{early[0][0]}@{early[0][1]}.delay_s": f"{late[0][0]}@{late[0][1]}.delay_s"}
    moved = {keys.get(k, k): -v if k in keys else v for k, v in values.items()}
    return tuple(sorted([*(one for one in label if one not in early), *late])), moved


def _early(name: str, where: str, values: Mapping[str, float]) -> bool:
    return name == "time_offset" and values.get(f"{name}@{where}.delay_s", 0.0) < 0.0
