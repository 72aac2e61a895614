"""A compliant wrist that a floating target hits."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from spacerobot.diagnosis.answer.spoiled import left_out, noise_told
from spacerobot.diagnosis.fitting.spoiled import cleaned
from spacerobot.diagnosis.fitting.workshop import Workshop
from spacerobot.diagnosis.forward.base import ForwardModel, TrialOverlay, Value, channels_of, overlaid, unit_of
from spacerobot.diagnosis.machines.rig_channels import readable
from spacerobot.diagnosis.machines.robot_channels import robot_channels
from spacerobot.diagnosis.machines.whole_rig import WholeRig
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.selection.admission import misplaced, questions
from spacerobot.diagnosis.selection.beyond import as_whole_robot
from spacerobot.diagnosis.terms.data import TrialData, trial_data
from spacerobot.dynamics.effective_mass import effective_mass
from spacerobot.recordings.rig_robot import study_robot
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial
from spacerobot.support.errors import InputError

BEFORE, AFTER = 0.1, 0.25
"""Seconds of the contact force that are worth seeing before the first and after the last touch."""


@dataclass(frozen=True, eq=False)
class WristRig(ForwardModel):
    """Hand, wrist and target of the reduced model, Eqs. 2 to 4 of Uyama et al. (2012).

    Attributes:
        study: whose baseline it is.
        model: the rig.
        trials: the recordings, by trial id.
        hand_mass: effective mass of an arm that is not held [kg]; infinite for one that is.
    """

    kind = "a compliant wrist and a floating target (reduced model)"

    study: Study
    model: RigModel
    trials: dict[str, TrialData]
    hand_mass: float

    @classmethod
    def applies(cls, study: Study) -> bool:
        """A target's track along the approach is recorded."""
        return "target.x" in channels_of(study)

    @classmethod
    def of(cls, study: Study) -> Self:
        """The rig as believed."""
        ask = questions(study, to_draw=True)
        for trial in study.trials:
            for refusal in ask(study.recording(trial)):
                raise refusal
        if robot_channels(study):
            whole = as_whole_robot(Workshop(study))
            return cls(study, whole.model, {t.id: t for t in whole.trials}, math.inf)
        trials = cleaned(trial_data(study, readable(study)))
        return cls(study, RigModel(study, trials), {t.id: t for t in trials}, _hand_mass(study))

    @property
    def values(self) -> tuple[Value, ...]:
        """The rig's values."""
        believed = [Value(name, value, unit_of(name)) for name, value in self._believed().items()]
        defaults = [Value(n, v, unit_of(n), "default: the study does not say") for n, v in self._defaults().items()]
        return (*believed, *defaults)

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What was taken for granted."""
        hand = (
            "The arm is held still."
            if math.isinf(self.hand_mass)
            else f"The arm moves as one hand of {self.hand_mass:.3g} kg."
        )
        if isinstance(self.model, WholeRig):
            hand = "The robot moves as a whole, joints and base as the study has them."
        said = [
            "Each trial starts from a straight line through the target's track before the first touch; the wrist "
            "starts at rest.",
            hand,
        ]
        first = self.study.recording(self.study.trials[0])
        said += [f"A diagnosis would refuse this: {refusal}." for refusal in misplaced(self.study, first, "")]
        said += [
            f"{word if '.' in word.split()[0] else word[0].upper() + word[1:]}." for word in self.model.beliefs.words()
        ]
        for stream, late in self._late().items():
            said.append(
                f"{stream} has a clock of its own, {min(late):.4g} to {max(late):.4g} s ahead: every trial of it is "
                "set where its touch is the track's."
            )
        used = tuple(self.trials.values())
        for one in left_out(self.study, used):
            said.append(f"Left out of {one.channel} in trial {one.trial}: {one.readings}, {one.why}.")
        for channel, noise in noise_told(self.study, used).items():
            said.append(
                f"The noise of {channel} is taken as {noise.sigma:.2g} {noise.unit}; stated {noise.stated:.2g}."
            )
        for name, value in self._defaults().items():
            said.append(f"{name} is not stated: {value:g} {unit_of(name)} for all trials.")
        unused = [name for name in self.study.values() if name not in self.model.names(self.study)]
        if unused:
            said.append(f"Stated, but no part of this simulation: {', '.join(unused)}.")
        return tuple(said)

    def simulate(self, trial: Trial) -> TrialOverlay:
        """One trial from its own approach."""
        data = self.trials[trial.id]
        values = {
            **self._believed(),
            **self._defaults(),
            **{n: v for n, v in trial.overrides.items() if n in self.model.names(self.study)},
        }
        start = np.array([nuisance.guess for nuisance in self.model.nuisances(data)])
        found = self.model.predict(self.model.mechanism(values, data), data, start)
        recording = self.study.recording(trial)
        contact = [e.time for e in found.run.events if e.element == "contact"]
        focus = (min(contact) - BEFORE, max(contact) + AFTER) if contact else None
        channels = [
            overlaid(
                replace(recording[name], time=block.time, value=block.value[c], valid=block.weight[c] > 0.0),
                rows[c],
                focus=focus if name == "contact.force" else None,
            )
            for block, rows in zip(data.blocks, found.blocks, strict=True)
            for c, name in enumerate(block.channels)
        ]
        return TrialOverlay(trial.id, self.study.condition(trial), tuple(channels), found.touches)

    def _late(self) -> dict[str, list[float]]:
        found: dict[str, list[float]] = {}
        for trial in self.trials.values():
            for block in trial.blocks:
                if block.clock:
                    found.setdefault(block.stream, []).append(block.late)
        return found

    def _believed(self) -> dict[str, float]:
        own = {} if math.isinf(self.hand_mass) else {"hand.mass": self.hand_mass}
        return {**self.model.base, **own}

    def _defaults(self) -> dict[str, float]:
        return dict(self.model.believed.unknown)


def _hand_mass(study: Study) -> float:
    """The arm's effective mass at the wrist along the approach [kg]; infinite where it is held."""
    baseline = study.baseline
    if baseline.base == "fixed" and baseline.joints == "locked":
        return math.inf
    if baseline.joints == "servo":
        raise InputError(
            "an arm on servos is simulated joint by joint, and none was recorded",
            given="joints servo",
            valid="joint.NAME.position of its joints among the channels, or joints locked or free",
            where=str(study.path),
        )
    robot = study_robot(study, default="pa10_wrist")
    if baseline.base == "free" and not robot.floating:
        robot = study_robot(study, floating=True, default="pa10_wrist")
    found = effective_mass(
        robot, np.array(study.pose()), np.array(baseline.approach), base=baseline.base, joints=baseline.joints
    )
    return float(found.effective_mass_kg)
