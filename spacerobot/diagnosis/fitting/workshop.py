"""One fit to make, and the workshop it is made in: the model, its trials, and fitters of them."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.fitting.adequacy import Left, left_over
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.labels import rightly_labelled
from spacerobot.diagnosis.fitting.spoiled import cleaned
from spacerobot.diagnosis.fitting.starts import fit_from, fit_near
from spacerobot.diagnosis.fitting.valleys import deepest
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.rig_channels import readable
from spacerobot.diagnosis.machines.whole_rig import rig_model
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.data import TrialData, trial_data
from spacerobot.diagnosis.terms.hypothesis import Label, Site
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import Study
from spacerobot.support.errors import InputError, SimulationError

Only = tuple[tuple[tuple[str, str], tuple[str, ...]], ...]
"""Effects and places that act in some trials alone, and which."""


MakeModel = Callable[[Study, tuple[TrialData, ...]], RigModel]
"""From a study and its trials, as fits read them, to the rig."""


@dataclass(frozen=True)
class Task:
    """One fit to make.

    Attributes:
        label: effects and places.
        start: start values by key.
        initials: start of the trials' initial values.
        near: a finished fit to begin at instead.
        loose: whether it may end on old derivatives.
        eager: whether it may be given up on what a step promises.
        patient: whether it is never given up.
        hopeless: cost above which it may be given up.
        max_iterations: of each fit.
        only: effects and places that act in some trials alone, and which; those of `near` are known by it.
        freed: believed values that are set free of what is stated of them.
        along: keys of values of `near` along which it is moved on to lower valleys, if there are any; nothing else is.
    """

    label: Label
    start: Mapping[str, float]
    initials: Mapping[str, np.ndarray] | None = None
    hopeless: float = np.inf
    max_iterations: int = 40
    near: Fit | None = None
    loose: bool = False
    eager: bool = False
    patient: bool = False
    only: Only = ()
    freed: tuple[str, ...] = ()
    along: tuple[str, ...] = ()

    def sites(self, model: Machine) -> list[Site]:
        """What is to be fitted."""
        near = () if self.near is None else self.near.hypothesis.sites
        some = {**{s.label: s.trials for s in near}, **dict(self.only)}
        return [model.site(effect(name), where, some.get((name, where), ())) for name, where in self.label]


@dataclass
class Workshop:
    """What a worker needs: the model, its trials, and a fitter."""

    study: Study
    make_model: MakeModel = rig_model
    made: Fitter | None = None

    def __post_init__(self) -> None:
        self.trials = rightly_labelled(cleaned(trial_data(self.study, readable(self.study))))
        self.model = self.make_model(self.study, self.trials)

    def fitter(self) -> Fitter:
        """A fitter of its trials; one for all that is asked of it."""
        if self.made is None:
            self.made = Fitter(self.model, self.trials, hasty=True)
        return self.made

    def but_for(self, out: Sequence[str]) -> Workshop:
        """The workshop as it is where some trials were never recorded."""
        rest = copy.copy(self)
        rest.trials = tuple(t for t in self.trials if t.id not in out)
        rest.made = None
        return rest

    def left_by(self, fit: Fit) -> Left:
        """What a finished fit leaves over."""
        touches = {}
        for trial in self.trials:
            mechanism = self.model.trial_mechanism(fit.hypothesis, fit.z, trial)
            seen = self.model.predict(mechanism, trial, fit.trials[trial.id].initial).touches
            touches[trial.id] = min(seen, default=float("inf"))
        return left_over(fit, self.trials, touches)

    def run(self, task: Task) -> Fit | None:
        """Do a task; None where it cannot be simulated."""
        sites, believed = task.sites(self.model), self.model.believed.free_of(task.freed)
        try:
            if task.near is not None and task.along:
                return deepest(
                    self.fitter(),
                    task.near,
                    task.along,
                    max_iterations=task.max_iterations,
                    hopeless=task.hopeless,
                )
            if task.near is not None:
                return fit_near(
                    self.fitter(),
                    believed,
                    sites,
                    task.near,
                    task.start,
                    task.max_iterations,
                    task.hopeless,
                    task.loose,
                    task.eager,
                )
            return fit_from(
                self.fitter(),
                believed,
                sites,
                task.start,
                task.initials,
                task.max_iterations,
                task.hopeless,
            )
        except (SimulationError, InputError):  # a start outside what the rig can be
            return None
