"""What a robot that moves shows beyond its small motions, found with the whole robot about a fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.mended_scene import scene_of
from spacerobot.diagnosis.fitting.workshop import Workshop
from spacerobot.diagnosis.machines.bent import NOTHING, Bent, Beyond, is_effect
from spacerobot.diagnosis.machines.contract import CLOCK
from spacerobot.diagnosis.machines.robot_channels import is_rate, of_robot
from spacerobot.diagnosis.machines.whole_rig import WholeRig
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.effects.effect import Effect
from spacerobot.simulation.multibody.run import integrate_scene
from spacerobot.simulation.sensors import read_channels

STEP = 0.1
"""Of a value, in units of its scale, by which its slope is found."""

FAINT = 0.3
"""Of an effect that is not in the fit, in units of its first start."""

TOLERANCE = 1e-7
"""Of the whole robot's run, relative to its motion."""


def beyond(workshop: Workshop, fit: Fit, slopes: Beyond = NOTHING) -> Beyond:
    """What the whole robot shows beyond the small motions, at the values, starts and effects of a fit.

    Args:
        workshop: of the study.
        fit: about which.
        slopes: how it changes with values and starts, found earlier near by; found here if there are none.

    Raises:
        SpacerobotError: the whole robot cannot be simulated there.
    """
    pair = _Pair(workshop, WholeRig(workshop.study, workshop.trials))
    return {t.recorded: pair.bent(fit, t, slopes.get(t.recorded)) for t in workshop.trials}


LEVEL = Bent({}, np.zeros(0), ())
"""Slopes of a trial of which none are wanted."""


class _Pair:
    """The whole robot beside its small motions."""

    def __init__(self, workshop: Workshop, small: WholeRig) -> None:
        self._workshop, self._small = workshop, small
        self._further = [s for s in small.sites() if s.where in small.places and _plain(s.effect)]

    def bent(self, fit: Fit, trial: TrialData, known: Bent | None) -> Bent:
        """What is to be added to the small motions of a trial."""
        values = self._values(fit, trial)
        initial = fit.trials[trial.id].initial
        here, later = self._more(fit, trial)
        if known is not None:
            names, own = tuple(known.values), known.own
            slopes = {c: known.shown[c][1][1:] if c in known.shown else np.zeros((0, m.size)) for c, m in here.items()}
        else:
            steps = self._steps(fit, trial, values)
            names, own = tuple(steps), self._own(trial)
            found = [self._slope(moved, trial, here, by) for moved, by in steps.values()]
            for n in own:
                by = STEP * self._small.nuisances(trial)[n].scale
                found.append(self._slope(_started(fit, trial, n, by), trial, here, by))
            slopes = {channel: np.array([f[channel] for f in found]) for channel in here}
        times = {c: block.time for block in trial.blocks for c in block.channels}
        shown = {c: (times[c], np.vstack([more[None, :], slopes[c]])) for c, more in here.items()}
        return Bent({n: values.get(n, 0.0) for n in names}, initial, own, shown, later)

    def _values(self, fit: Fit, trial: TrialData) -> dict[str, float]:
        """Of the rig in a trial, and of the effects by key."""
        rig = fit.hypothesis.trial_values(fit.z, self._small.base, trial.condition, trial.overrides)
        return rig | {k: v for k, v in fit.values().items() if is_effect(k)}

    def _steps(self, fit: Fit, trial: TrialData, values: Mapping[str, float]) -> dict[str, tuple[Fit, float]]:
        """Value of the rig -> the fit with that value moved, and by how much."""
        found: dict[str, tuple[Fit, float]] = {}
        for g, free in enumerate(fit.hypothesis.free):
            if free.kind == "zero":
                continue
            z = fit.z.copy()
            z[g] += STEP
            moved = replace(fit, z=z)
            for name, value in self._values(moved, trial).items():
                if value != values[name] and name not in found:
                    found[name] = moved, value - values[name]
        for site in self._further:
            (one,) = site.effect.parameters
            if (key := site.key(one.name)) not in values:
                size = FAINT * one.starts[0]
                made = hypothesis(self._small.believed, (*fit.hypothesis.sites, site), {})
                found[key] = replace(fit, hypothesis=made, z=made.start({**fit.values(), key: size})), size
        return found

    def _own(self, trial: TrialData) -> tuple[int, ...]:
        """A trial's own values along which the two may differ: no zeros, no clocks."""
        every = enumerate(self._small.nuisances(trial))
        return tuple(k for k, n in every if not (n.adds_to or n.coordinate.startswith(CLOCK)))

    def _slope(self, moved: Fit, trial: TrialData, here: Mapping[str, np.ndarray], by: float) -> dict[str, np.ndarray]:
        there, _ = self._more(moved, trial)
        return {channel: (more - here[channel]) / by for channel, more in there.items()}

    def _more(self, fit: Fit, trial: TrialData) -> tuple[dict[str, np.ndarray], tuple[float, ...]]:
        """Channel -> what the whole robot shows beyond the small motions, and how much later it touches."""
        scene = scene_of(self._workshop.study, self._workshop.model, fit, trial.id)
        run = integrate_scene(scene, trial.end - trial.start, tolerance=TOLERANCE)
        mechanism = self._small.trial_mechanism(fit.hypothesis, fit.z, trial)
        plain = replace(mechanism, maps=())  # sensors act on the sum
        zeros = [bool(n.adds_to) for n in self._small.nuisances(trial)]
        small = self._small.predict(plain, trial, np.where(zeros, 0.0, fit.trials[trial.id].initial))
        unmapped = replace(run.mechanism, maps=())
        found: dict[str, np.ndarray] = {}
        for block, values in zip(trial.blocks, small.blocks, strict=True):
            for channel, whole in read_channels(run, unmapped, block.channels, block.time - trial.start).items():
                more = whole - values[block.channels.index(channel)]
                found[channel] = np.asarray(more - (more[0] if of_robot(channel) and not is_rate(channel) else 0.0))
        touches = [e.time + trial.start for e in run.events if e.kind == "touch"]
        return found, tuple(w - s for w, s in zip(touches, small.touches, strict=False))


def _plain(effect: Effect) -> bool:
    """Whether an effect is a law of one strength."""
    return not effect.once and len(effect.parameters) == 1 and effect.parameters[0].null == 0.0


def _started(fit: Fit, trial: TrialData, which: int, by: float) -> Fit:
    """The fit with one of a trial's own values moved."""
    initial = fit.trials[trial.id].initial.copy()
    initial[which] += by
    return replace(fit, trials={**fit.trials, trial.id: replace(fit.trials[trial.id], initial=initial)})
