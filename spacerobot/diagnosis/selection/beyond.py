"""What a robot that moves shows beyond its small motions, found with the whole robot where a fit stands."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.mended_scene import scene_of
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.machines.robot_channels import is_rate
from spacerobot.diagnosis.machines.whole_rig import Beyond, WholeRig, rig_model
from spacerobot.diagnosis.selection.confirm import difference
from spacerobot.diagnosis.selection.precompile import as_believed
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.simulation.multibody.run import integrate_scene
from spacerobot.simulation.sensors import read_channels
from spacerobot.support.errors import SpacerobotError

TOLERANCE = 1e-7
"""Of the whole robot's run, relative to its motion."""

ROUNDS = 12
"""How often a fit and what the whole robot shows about it are found in turn; each leaves some half of the rest."""

NEAR = 0.1
"""Difference of the two in sensor sigmas, rms of the worst trial, that is left when they agree."""


def of_whole_robot(workshop: Workshop, near: Fit | None = None) -> Workshop:
    """The workshop whose machine bends as the whole robot does about a fit; of a plain rig the same.

    Args:
        workshop: of the study.
        near: the fit; that of the baseline where there is none.
    """
    if not isinstance(workshop.model, WholeRig):
        return workshop
    for _ in range(ROUNDS):
        try:
            near = _fitted(workshop, near)
            if near is None or apart(workshop, near) < NEAR:
                break
            workshop = _about(workshop, near)
        except SpacerobotError:  # nothing is known of the whole robot: its check will say so
            break
    return workshop


def as_whole_robot(workshop: Workshop) -> Workshop:
    """The workshop whose machine bends as the whole robot does as believed; of a plain rig the same."""
    if not isinstance(workshop.model, WholeRig):
        return workshop
    try:
        return _about(workshop, as_believed(workshop))
    except SpacerobotError:  # small motions are shown as they are
        return workshop


def _about(workshop: Workshop, fit: Fit) -> Workshop:
    return Workshop(workshop.study, partial(rig_model, beyond=beyond(workshop, fit)))


def apart(workshop: Workshop, fit: Fit) -> float:
    """By how much the machine and the whole robot differ at a fit, in sensor sigmas: rms of the worst trial.

    Nothing where the whole robot cannot be simulated there; its check says so (`confirm.py`).
    """
    if not isinstance(workshop.model, WholeRig):
        return 0.0
    try:
        return max(difference(workshop, fit, trial) for trial in workshop.trials)
    except SpacerobotError:
        return 0.0


def _fitted(workshop: Workshop, near: Fit | None) -> Fit | None:
    """The same hypothesis fitted again, or the baseline."""
    if near is None or not near.hypothesis.sites:
        warm, initials = (None, None) if near is None else (near.values(), near.initials())
        return workshop.fitter().fit(hypothesis(workshop.model.believed, []), warm=warm, initials=initials)
    return workshop.run(Task(near.hypothesis.label, near.values(), near=near))


def beyond(workshop: Workshop, fit: Fit) -> Beyond:
    """What the whole robot shows beyond the small motions, at the values, starts and effects of a fit.

    Of the contact's force nothing: what bends the motion shifts a touch, and a shifted touch is no difference that
    could be added.

    Raises:
        SpacerobotError: the whole robot cannot be simulated there.
    """
    small = rig_model(workshop.study, workshop.trials)
    found: dict[str, dict[str, tuple[np.ndarray, np.ndarray]]] = {}
    for trial in workshop.trials:
        scene = scene_of(workshop.study, workshop.model, fit, trial.id)
        run = integrate_scene(scene, trial.end - trial.start, tolerance=TOLERANCE)
        mechanism = small.trial_mechanism(fit.hypothesis, fit.z, trial)
        plain = replace(mechanism, maps=())  # sensors act on the sum
        shown = small.predict(plain, trial, fit.trials[trial.id].initial)
        unmapped = replace(run.mechanism, maps=())
        own = found.setdefault(trial.recorded, {})
        for block, values in zip(trial.blocks, shown.blocks, strict=True):
            channels = [c for c in block.channels if c != "contact.force"]
            for channel, whole in read_channels(run, unmapped, channels, block.time - trial.start).items():
                more = whole - values[block.channels.index(channel)]
                own[channel] = block.time, np.asarray(more - (0.0 if is_rate(channel) else more[0]))
    return found
