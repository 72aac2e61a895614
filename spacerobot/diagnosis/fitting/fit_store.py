"""Finished fits of a run, kept outside the process, so that a search that was interrupted goes on where it was."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit, TrialFit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.terms.hypothesis import Hypothesis
from spacerobot.support.runs import combined_hash


class Store(Protocol):
    """Where fits are kept: a `support.runs.RunFolder`, or anything that saves and loads by name."""

    def save(self, name: str, value: Any) -> None:
        """Keep a value that JSON can hold."""

    def load(self, name: str) -> Any | None:
        """The value, None where there is none."""


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
    prior = np.array([f.prior for f in made.free], dtype=float)
    return Fit(
        made,
        z,
        {k: TrialFit(state.own[k], np.where(state.keep[k], state.raw[k], 0.0)) for k in state.raw},
        state.chi2(),
        float(prior @ z**2),
        state.samples,
        None if said["covariance"] is None else np.array(said["covariance"], dtype=float),
        said["converged"],
        said["iterations"],
        said["given_up"],
    )
