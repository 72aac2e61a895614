"""What a search of one model has found so far, kept outside the process: a search that was stopped goes on there."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from spacerobot.diagnosis.fitting.fit_store import Store, as_json, from_json
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.selection.part_held_out import HeldOut
from spacerobot.diagnosis.terms.hypothesis import Hypothesis
from spacerobot.support.runs import combined_hash


class Kept:
    """A store of one model's fits and predictions, each under everything that decides it.

    Everything that a search does follows from its input, so what is found again is what would be computed again.
    """

    def __init__(self, store: Store | None, model: str) -> None:
        """`model` tells this model from the study's others; without a store everything is computed."""
        self.store, self.model = store, model

    def within(self, what: str) -> Kept:
        """The same store, for a search of a part of the model's trials."""
        return Kept(self.store, f"{self.model} {what}")

    def fit(
        self, made: Hypothesis, fitter: Fitter, about: Sequence[Any], compute: Callable[[], Fit | None]
    ) -> Fit | None:
        """A fit of `made`, kept or computed; `about` holds whatever else decides it."""
        if self.store is None:
            return compute()
        name = self._name("fit", made, about)
        kept = self.store.load(name)
        if kept is not None:
            found = from_json(kept, fitter, made)
            if found is not None or kept["fit"] is None:
                return found
        fit = compute()
        self.store.save(name, as_json(fit))
        return fit

    def held_out(self, fit: Fit, about: Sequence[Any], compute: Callable[[], HeldOut | None]) -> HeldOut | None:
        """Predictions of unseen trials by a fit's hypothesis, kept or computed."""
        if self.store is None:
            return compute()
        name = self._name("held", fit.hypothesis, [fit.z.tolist(), *about])
        kept = self.store.load(name)
        if kept is not None:
            return (
                None if kept["residual"] is None else HeldOut(_arrays(kept["residual"]), _arrays(kept["counted"], bool))
            )
        found = compute()
        none = {"residual": None, "counted": None}
        self.store.save(
            name, none if found is None else {"residual": _lists(found.residual), "counted": _lists(found.counted)}
        )
        return found

    def values(self, kind: str, fit: Fit, about: Sequence[Any], compute: Callable[[], Any]) -> Any:
        """Anything that JSON can hold and that follows from a fit, kept or computed."""
        if self.store is None:
            return compute()
        name = self._name(kind, fit.hypothesis, [fit.z.tolist(), *about])
        kept = self.store.load(name)
        if kept is None:
            kept = compute()
            self.store.save(name, kept)
        return kept

    def _name(self, kind: str, made: Hypothesis, about: Sequence[Any]) -> str:
        return f"{kind}-" + combined_hash(
            self.model, made.label, [(f.key, f.centre, f.step) for f in made.free], *about
        )


def of_fit(fit: Fit) -> list[Any]:
    """A fit as part of what decides another one."""
    return [fit.hypothesis.label, fit.z.tolist()]


def _lists(arrays: Mapping[str, np.ndarray]) -> dict[str, Any]:
    return {k: v.tolist() for k, v in arrays.items()}


def _arrays(lists: Mapping[str, Any], kind: type = float) -> dict[str, np.ndarray]:
    return {k: np.array(v, dtype=kind) for k, v in lists.items()}
