"""The first diagnosis after an installation: a second process compiles a part while this one compiles the rest."""

from __future__ import annotations

import contextlib

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit, TrialFit
from spacerobot.diagnosis.fitting.workshop import Workshop
from spacerobot.diagnosis.selection.confirm import difference
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.support.errors import SpacerobotError
from spacerobot.support.jit import nothing_kept
from spacerobot.support.workers import begin, context, may_fork


def help_compiling(workshop: Workshop) -> None:
    """Begin such a process where nothing is compiled yet, and it can have this one's libraries."""
    if nothing_kept() and may_fork():
        context(fork=True).Process(target=_compile, args=(workshop,), daemon=True).start()


def _compile(workshop: Workshop) -> None:
    """What the integrator needs last, then what only the whole robot needs."""
    from spacerobot.simulation.reduced.ahead import compile_ahead

    begin()
    compile_ahead()
    trial = workshop.trials[0]
    with contextlib.suppress(SpacerobotError):  # whoever needs it will say so
        difference(workshop, as_believed(workshop), trial)


def as_believed(workshop: Workshop) -> Fit:
    """The baseline, not fitted."""
    made = hypothesis(workshop.model.believed, [])
    starts = workshop.fitter().guess()
    trials = {name: TrialFit(start, np.zeros(0)) for name, start in starts.items()}
    return Fit(made, made.start(), trials, 0.0, 0.0, 1, None, False, 0, False)
