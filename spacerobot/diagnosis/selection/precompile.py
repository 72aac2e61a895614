"""The first diagnosis after an installation: a second process compiles a part while this one compiles the rest."""

from __future__ import annotations

import contextlib

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit, TrialFit
from spacerobot.diagnosis.fitting.workshop import Workshop
from spacerobot.diagnosis.machines.whole_rig import WholeRig
from spacerobot.diagnosis.selection.confirm import by_whole_robot
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.simulation.sensors import read_channels
from spacerobot.support.errors import SpacerobotError
from spacerobot.support.jit import nothing_kept
from spacerobot.support.workers import begin, context, may_fork


def help_compiling(workshop: Workshop) -> None:
    """Begin such a process where nothing is compiled yet, and it can have this one's libraries."""
    if nothing_kept() and may_fork():
        context(fork=True).Process(target=_compile, args=(workshop,), daemon=True).start()


def _compile(workshop: Workshop) -> None:
    """What reads the integrator's record, then whichever of the two models the other process needs last."""
    from spacerobot.simulation.reduced.ahead import compile_ahead

    begin()
    compile_ahead()
    trial, fit = workshop.trials[0], as_believed(workshop)
    with contextlib.suppress(SpacerobotError):  # whoever needs it will say so
        if isinstance(workshop.model, WholeRig):
            workshop.model.predict(
                workshop.model.trial_mechanism(fit.hypothesis, fit.z, trial), trial, fit.trials[trial.id].initial
            )
            return
        run = by_whole_robot(workshop, fit, trial)
        read_channels(run, run.mechanism, trial.blocks[0].channels, trial.blocks[0].time - trial.start)


def as_believed(workshop: Workshop) -> Fit:
    """The baseline, not fitted."""
    made = hypothesis(workshop.model.believed, [])
    starts = workshop.fitter().guess()
    trials = {name: TrialFit(start, np.zeros(0)) for name, start in starts.items()}
    return Fit(made, made.start(), trials, 0.0, 0.0, 1, None, False, 0, False)
