"""Finished fits of a run, kept outside the process, so that a search that was interrupted goes on where it was."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol, TypeVar, cast

import msgspec
import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit, TrialFit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.terms.hypothesis import Hypothesis
from spacerobot.support.runs import combined_hash

T = TypeVar("T")


class Store(Protocol):
    """Where fits are kept: a `support.runs.RunFolder`, or anything that saves and loads by name."""

    def save(self, name: str, value: Any) -> None:
        """Keep a value that JSON can hold."""

    def load(self, name: str) -> Any | None:
        """The value, None where there is none."""


class Apart:
    """A part of a store of its own: what is kept under a name here is not what the store keeps under it."""

    def __init__(self, store: Store, what: str) -> None:
        self._store, self._what = store, what

    def save(self, name: str, value: Any) -> None:
        """See Store."""
        self._store.save(f"{self._what}-{name}", value)

    def load(self, name: str) -> Any | None:
        """See Store."""
        return self._store.load(f"{self._what}-{name}")


def task_name(task: Any) -> str:
    """A name that only this very task has (`pool.Task`); fits that it begins at are known by where they ended."""
    near = task.near
    return "fit-" + combined_hash(
        task.label,
        sorted(task.start.items()),
        task.hopeless,
        task.max_iterations,
        task.loose,
        task.eager,
        task.patient,
        task.only,
        task.freed,
        task.along,
        None if near is None else [list(near.hypothesis.label), near.hypothesis.freed, near.z.tolist()],
        None if task.initials is None else sorted((k, v.tolist()) for k, v in task.initials.items()),
    )


def as_json(fit: Fit | None) -> dict[str, Any]:
    """A fit without what a simulation of its trials gives back."""
    if fit is None:
        return {"fit": None}
    return {
        "fit": {
            "z": fit.z.tolist(),
            "initials": {k: v.tolist() for k, v in fit.initials().items()},
            "covariance": None if fit.covariance is None else fit.covariance.tolist(),
            "converged": bool(fit.converged),
            "iterations": fit.iterations,
            "given_up": fit.given_up,
        }
    }


def from_json(kept: dict[str, Any], fitter: Fitter, made: Hypothesis) -> Fit | None:
    """The fit again, its trials simulated anew; None where it was none, or does not belong here.

    Args:
        kept: of `as_json`.
        fitter: of the trials it was fitted to.
        made: the hypothesis it was a fit of.
    """
    said = kept["fit"]
    if said is None:
        return None
    z = np.array(said["z"], dtype=float)
    state = fitter.state(made, z, {k: np.array(v, dtype=float) for k, v in said["initials"].items()})
    if state is None or z.size != len(made.free):
        return None
    return Fit(
        made,
        z,
        {k: TrialFit(state.own[k], np.where(state.keep[k], state.raw[k], 0.0)) for k in state.raw},
        state.chi2(),
        float(z @ made.precision @ z),
        state.samples,
        None if said["covariance"] is None else np.array(said["covariance"], dtype=float),
        said["converged"],
        said["iterations"],
        said["given_up"],
    )


def plainly(found: Any) -> Any:
    """What a store holds of typed records: tables and lists."""
    return msgspec.to_builtins(found, enc_hook=lambda array: array.tolist())


def again(kept: Any, of: Any) -> Any:
    """What was kept by `plainly`, of this type; to the last bit."""
    return msgspec.convert(kept, of, strict=False, dec_hook=lambda _, listed: np.array(listed))


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

    def values(
        self,
        kind: str,
        fit: Fit,
        about: Sequence[Any],
        compute: Callable[[], T],
        of: Any,
    ) -> T:
        """Whatever follows from a fit, kept or computed.

        Args:
            kind: a word for what it is.
            fit: that it follows from.
            about: whatever else decides it.
            compute: it.
            of: its type.
        """
        if self.store is None:
            return compute()
        name = self._name(kind, fit.hypothesis, [fit.z.tolist(), *about])
        kept = self.store.load(name)
        if kept is not None:
            return cast(T, again(kept, of))
        found = compute()
        self.store.save(name, plainly(found))
        return found

    def _name(self, kind: str, made: Hypothesis, about: Sequence[Any]) -> str:
        return f"{kind}-" + combined_hash(
            self.model, made.label, [(f.key, f.centre, f.step) for f in made.free], *about
        )


def of_fit(fit: Fit) -> list[Any]:
    """A fit as part of what decides another one."""
    return [fit.hypothesis.label, fit.hypothesis.freed, fit.z.tolist()]
