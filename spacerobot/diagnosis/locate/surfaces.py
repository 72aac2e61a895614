"""Residual force binned against what it may depend on, by least squares over all trials."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from spacerobot.diagnosis.locate.balances import LAW, STILL, Balance
from spacerobot.diagnosis.locate.laws import depth_of
from spacerobot.diagnosis.locate.located import BINS, Surface
from spacerobot.diagnosis.locate.prepared import Prepared

USEFUL = 1e-3
"""Bins with less than this share of the median bin's information are left out."""


def surfaces(prepared: Mapping[str, Prepared], names: Sequence[str]) -> tuple[Surface, ...]:
    """Every balance against displacement and velocity (a contact against penetration, a still port against force)."""
    out = []
    for name in names:
        first = next(p for p in prepared.values() if name in p.found)
        balance = first.found[name]
        for quantity, unit in _quantities(balance):
            found = _surface(prepared, name, quantity)
            if found is not None:
                out.append(Surface(name, quantity, unit, *found, balance.unit))
    return tuple(out)


def _quantities(balance: Balance) -> list[tuple[str, str]]:
    if balance.kind == LAW:
        return [("displacement", "m")]
    if balance.kind == STILL:
        return [("force", "N")]
    length = "rad" if balance.unit == "N m" else "m"
    return [("displacement", length), ("velocity", f"{length}/s"), ("force", "N")]


def _of(one: Prepared, balance: Balance, quantity: str) -> np.ndarray:
    weak = one.weak
    if quantity == "force" or balance.kind == LAW:
        force = weak.pressing(weak.nodes)
        if quantity == "force":
            return np.asarray(force)
        contact = one.mechanism.contact
        assert contact is not None  # it is the contact's own law that is balanced
        return depth_of(contact.kernel, contact.p)(force)
    state = weak.port_state(balance.row, weak.nodes)
    return np.asarray(state.moved if quantity == "displacement" else state.moving)


def _surface(
    prepared: Mapping[str, Prepared], name: str, quantity: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    present = [p for p in prepared.values() if name in p.found]
    x = [_of(p, p.found[name], quantity) for p in present]
    low, high = min(float(q.min()) for q in x), max(float(q.max()) for q in x)
    if not high > low:
        return None
    edges = np.linspace(low, high, BINS + 1)
    gram, right = np.zeros((BINS, BINS)), np.zeros(BINS)
    weight, mean = np.zeros(BINS), np.zeros(BINS)
    for one, q in zip(present, x, strict=True):
        tested = one.tested(name)
        index = np.clip(np.searchsorted(edges, q, side="right") - 1, 0, BINS - 1)
        member = np.zeros((q.size, BINS))
        member[np.arange(q.size), index] = 1.0
        columns = tested.exact(one.seen(name, member))
        gram += columns.T @ columns
        right += columns.T @ tested.exact(tested.residual.value)
        np.add.at(mean, index, q)
        np.add.at(weight, index, 1.0)
    power = np.diag(gram)
    useful = power > USEFUL * np.median(power[power > 0.0]) if np.any(power > 0.0) else power > 0.0
    if useful.sum() < 2:
        return None
    inverse = np.linalg.pinv(gram[np.ix_(useful, useful)], rcond=1e-10, hermitian=True)
    return (mean / np.maximum(weight, 1.0))[useful], inverse @ right[useful], np.sqrt(np.diag(inverse))
