"""The winner once more with the whole robot: does the multibody show what the fitted, reduced model shows?"""

from __future__ import annotations

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.mended_scene import scene_of
from spacerobot.diagnosis.fitting.workshop import Workshop
from spacerobot.diagnosis.machines.rig_trials import counted
from spacerobot.diagnosis.machines.robot_channels import of_robot
from spacerobot.diagnosis.selection.check import Check
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.parameters import zero_key
from spacerobot.simulation.multibody.run import MultibodyRun, integrate_scene
from spacerobot.simulation.sensors import read_channels
from spacerobot.support.errors import InputError, NotFoundError, SimulationError

MOST = 2
"""Conditions of which one trial each is simulated again."""

APART = 0.5
"""Difference of the two models in sensor sigmas (rms) above which the reduced one was too poor to fit with."""

COUNTED_FROM = ("target.y", "target.yaw")
"""Channels whose zero is the recording's own, as are those of joints and base."""

TOLERANCE = 1e-8


def confirm(workshop: Workshop, chosen: Fit) -> Check:
    """A check of the chosen fit: one trial of the first conditions in the full multibody, beside the reduced model."""
    seen: dict[str, TrialData] = {}
    for trial in workshop.trials:
        seen.setdefault(trial.condition, trial)
    worst, done = 0.0, []
    for trial in list(seen.values())[:MOST]:
        try:
            apart = difference(workshop, chosen, trial)
        except (InputError, NotFoundError, SimulationError) as error:
            return Check("multibody", True, f"not simulated with the whole robot: {error}")
        worst = max(worst, apart)
        done.append(trial.id)
    detail = f"with the whole robot, trials {', '.join(done)} differ by {worst:.2g} sensor sigmas (rms)"
    return Check("multibody", worst < APART, detail)


def by_whole_robot(workshop: Workshop, chosen: Fit, trial: TrialData) -> MultibodyRun:
    """A trial as the whole robot runs it with a fit's values."""
    scene = scene_of(workshop.study, workshop.model, chosen, trial.id)
    return integrate_scene(scene, trial.end - trial.start, tolerance=TOLERANCE)


def difference(workshop: Workshop, chosen: Fit, trial: TrialData) -> float:
    """Difference of what the two models show of a trial, in sensor sigmas (rms)."""
    run = by_whole_robot(workshop, chosen, trial)
    mechanism = workshop.model.trial_mechanism(chosen.hypothesis, chosen.z, trial)
    reduced = workshop.model.predict(mechanism, trial, chosen.trials[trial.id].initial)
    keep = counted(mechanism, trial, reduced)
    total, count, row = 0.0, 0, 0
    free = chosen.values()
    zeros = {n.adds_to for n in workshop.model.nuisances(trial)}
    beside = [np.zeros_like(shown) for shown in reduced.blocks]
    workshop.model.take_off_beside(beside, mechanism, trial)
    for block, shown, late, other in zip(trial.blocks, reduced.blocks, reduced.late, beside, strict=True):
        whole = read_channels(run, run.mechanism, block.channels, block.time - trial.start - late)
        for c, channel in enumerate(block.channels):
            apart = whole[channel] + free.get(zero_key(channel), 0.0) + other[c] - shown[c]
            if channel in COUNTED_FROM or channel in zeros or of_robot(channel):
                apart = apart - apart[0]
            good = keep[row : row + block.time.size]
            row += block.time.size
            total += float(np.square(apart[good] * block.weight[c][good]).sum())
            count += int(good.sum())
    return float(np.sqrt(total / max(count, 1)))
