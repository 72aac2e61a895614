"""A wrist on a robot that moves: every joint, the base, the wrist and the target at once, as their sensors read them.

What a fit changes is linear about the pose of each trial: the robot moves little while it is watched. What it shows
beyond that is found with the whole robot and added (`selection/beyond.py`).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from spacerobot.diagnosis.machines.bent import NOTHING, Beyond, is_effect
from spacerobot.diagnosis.machines.contract import CLOCK, Nuisance
from spacerobot.diagnosis.machines.rig_trials import free_until, touch_time
from spacerobot.diagnosis.machines.rig_values import together
from spacerobot.diagnosis.machines.robot_channels import BASE_CHANNELS, is_rate, of_robot, robot_channels
from spacerobot.diagnosis.machines.robot_motions import RobotMotions
from spacerobot.diagnosis.machines.robot_sizes import sizes_at_places
from spacerobot.diagnosis.machines.sizes import scaled
from spacerobot.diagnosis.machines.wrist_rig import RigModel, RigPredicted
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Hypothesis, Site
from spacerobot.effects.effect import BASE_PORTS, Effect
from spacerobot.effects.laws import DAMPER, SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate, Force, Readout
from spacerobot.effects.sizes import Sizes
from spacerobot.recordings.study import Study
from spacerobot.simulation.parts.motion import Motion
from spacerobot.simulation.parts.servo import Servo
from spacerobot.simulation.rig import DEFAULTS, rig
from spacerobot.simulation.servo_arm import ServoArm

ZERO = "zero:"
"""Starts the name of a nuisance that is what a channel reads where the machine stands."""

SERVO = 3e3
"""Where the search for a servo's stiffness begins [N m/rad]."""

KEPT = 512
"""Mechanisms of which it is kept what values they were made with."""

SHIFTED = ("hand.x", "wrist.x")
"""Channels beside the robot's own whose zero a trial finds, where the robot drifts before the touch."""


def rig_model(study: Study, trials: tuple[TrialData, ...], *, beyond: Beyond = NOTHING) -> RigModel:
    """The machine of a study with a wrist: the whole robot where more of its motion was recorded than the hand's."""
    return WholeRig(study, trials, beyond=beyond) if robot_channels(study) else RigModel(study, trials)


class WholeRig(RigModel):
    """A wrist rig whose hand is the end of a robot that moves.

    Args:
        beyond: what the robot shows beyond its small motions, near what is fitted; see `selection/beyond.py`.
    """

    name = "robot with a wrist"
    learns = False
    """Ports are many and a simulation is dear: every kind of law at each of them would take an hour."""

    def __init__(
        self, study: Study, trials: tuple[TrialData, ...], *, tolerance: float = 1e-6, beyond: Beyond = NOTHING
    ) -> None:
        self.robot, self._beyond = RobotMotions(study), beyond
        self._shown: dict[str, tuple[Mechanism, tuple[float, ...], RigPredicted]] = {}  # what zeros alone do not change
        self._made: dict[int, tuple[Mechanism, dict[str, float]]] = {}
        self._at: dict[str, Sizes] | None = None
        self._base, self._joints = study.baseline.base, study.baseline.joints
        super().__init__(study, trials, tolerance=tolerance)

    def names(self, study: Study) -> Collection[str]:
        """The rig's values but for the hand's mass, which is the robot's; joints; masses of links that are stated."""
        own = [n for n in DEFAULTS if n != "hand.mass"]
        kinds = () if study.baseline.joints == "locked" else ("stiffness", "damping")
        joints = [f"joint.{j}.{kind}" for j in self.robot.chain for kind in kinds]
        return (*own, *joints, *(n for n in study.values() if _links(n)))

    def unstated(self, study: Study, known: Mapping[str, float], trials: tuple[TrialData, ...]) -> dict[str, float]:
        """Also the stiffness of servos."""
        servos = [f"joint.{j}.stiffness" for j in self.robot.chain] if self._joints == "servo" else []
        return super().unstated(study, known, trials) | {n: SERVO for n in servos if n not in known}

    def absent(self, known: Mapping[str, float]) -> dict[str, float]:
        """Also the damping of servos."""
        servos = [f"joint.{j}.damping" for j in self.robot.chain] if self._joints == "servo" else []
        return super().absent(known) | {n: 0.0 for n in servos if n not in known}

    def own(self, trial: TrialData) -> tuple[Nuisance, ...]:
        """Also where joints and base stand as they are read, and how fast they drift before the touch."""
        found = list(super().own(trial))
        clocks = [n for n in found if n.coordinate.startswith(CLOCK)]
        found = [n for n in found if n not in clocks]
        touch = touch_time(trial)
        for channel in trial.channels:
            if not (of_robot(channel) or channel in SHIFTED):
                continue
            time, value, weight = trial.channel(channel)
            early = free_until(time, touch)
            noise = 1.0 / float(np.median(weight))
            if is_rate(channel):
                continue
            slope, offset = np.polyfit(time[early] - trial.start, value[early], 1)
            zero = float(offset if self._drifting(channel) else value[early].mean())
            found.append(Nuisance(ZERO + channel, False, zero, noise, adds_to=channel))
            if self._drifting(channel):
                found.append(Nuisance(channel, True, float(slope), noise / max(float(np.ptp(time[early])), 1e-3)))
        found += clocks
        bent = self._beyond.get(trial.recorded)
        if bent is None or len(bent.initial) != len(found):
            return tuple(found)
        # what is added to small motions holds near where it was found: whatever is fitted begins there
        return tuple(replace(n, guess=float(x)) for n, x in zip(found, bent.initial, strict=True))

    def _drifting(self, channel: str) -> bool:
        """Whether what a channel shows may move before anything touches: what no servo holds."""
        joint = channel.startswith("joint.") and self._joints == "free"
        return joint or (channel.startswith("base.") and self._base == "free")

    def mechanism(self, values: Mapping[str, float], trial: TrialData | None = None) -> Mechanism:
        """Hand, wrist and target, with the robot's other motions about the pose of the trial."""
        arm = self._arm(values, trial)
        inside = together({n: v for n, v in values.items() if n in DEFAULTS}) | {"hand.mass": arm.mass}
        plain = rig(inside, lateral=self.sideways)
        coordinates = dict(plain.coordinates) | {n: Coordinate(n, 1.0) for n in arm.names[1:]}
        ports, readouts, forces = dict(plain.ports), dict(plain.readouts), list(plain.forces)
        for joint, rates in zip(self.robot.chain, arm.joints, strict=True):
            name = f"joint.{joint}"
            if self._joints == "locked":
                continue
            ports[name] = arm.row(rates)
            readouts |= {f"{name}.{kind}": Readout(f"{name}.{kind}", kind, name) for kind in ("position", "velocity")}
            for kind, law in (("stiffness", SPRING), ("damping", DAMPER)):
                size = values.get(f"{name}.{kind}", 0.0)
                if size or self._joints == "servo":
                    role = "spring" if law is SPRING else "damper"
                    forces.append(Force(f"{name}.servo_{role}", name, law, (size,), role=role))
        if self._base == "free":
            along = np.vstack([self.robot.axes.T @ arm.base[:3], self.robot.axes.T @ arm.base[3:]])
            ports |= {port: arm.row(rates) for port, rates in zip(BASE_PORTS, along, strict=True)}
            for port, shown in zip(BASE_PORTS, BASE_CHANNELS, strict=True):
                readouts[shown] = Readout(shown, "position", port)
            for axis, rates in zip("xyz", arm.base[:3], strict=True):
                ports[f"base.position.{axis}"] = arm.row(rates)
                for kind in ("position", "velocity"):
                    name = f"base.{kind}.{axis}"
                    readouts[name] = Readout(name, kind, f"base.position.{axis}")
            for axis, rates in zip("xyz", arm.base[3:], strict=True):
                ports[f"base.turn.{axis}"] = arm.row(rates)
                name = f"base.angular_velocity.{axis}"
                readouts[name] = Readout(name, "velocity", f"base.turn.{axis}")
        return replace(
            plain,
            coordinates=coordinates,
            ports=ports,
            readouts=readouts,
            forces=tuple(forces),
            sensors=self.sensors,
            maps=self.filters,
        )

    def trial_mechanism(self, hypothesis: Hypothesis, z: np.ndarray, trial: TrialData) -> Mechanism:
        """See RigModel; which values it was made with is kept: what is added to small motions hangs on them."""
        made = super().trial_mechanism(hypothesis, z, trial)
        if self._beyond and (id(made) not in self._made or self._made[id(made)][0] is not made):
            if len(self._made) >= KEPT:
                self._made.clear()
            values = hypothesis.trial_values(z, self.base, trial.condition, trial.overrides)
            effects = {k: v for k, v in hypothesis.values(z).items() if is_effect(k)}
            self._made[id(made)] = made, values | effects
        return made

    def start(
        self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray
    ) -> tuple[dict[str, float], dict[str, float]]:
        """The target's, and what joints and base drift by; the slider rests in its guide."""
        position, velocity = super().start(mechanism, trial, initial)
        rates = self._rates(trial, initial)
        if rates.any():
            arm = self._arm({}, trial)
            velocity |= arm.row(arm.of_rates @ rates)
            velocity["wrist"] = velocity["hand"]
        return position, velocity

    def _rates(self, trial: TrialData, initial: np.ndarray) -> np.ndarray:
        """Of joints, and of the base along and about the world's axes, at the start, shape (len(chain) + 6,)."""
        rates = np.zeros(len(self.robot.chain) + 6)
        for nuisance, value in zip(self._motion[trial.id], initial, strict=True):
            if nuisance.rate and of_robot(nuisance.coordinate):
                self._put(rates, nuisance.coordinate, float(value))
        return rates

    def robot_in(
        self, study: Study, values: Mapping[str, float], trial: TrialData, initial: np.ndarray
    ) -> dict[str, Any]:
        """Also its servos, its links' masses, and how it drifts at the start."""
        chain, rates = self.robot.chain, self._rates(trial, initial)
        found: dict[str, Any] = {
            **super().robot_in(study, values, trial, initial),
            "robot": self.robot.with_masses(_masses(values)),
        }
        if self._joints == "servo":
            held = [[values.get(f"joint.{j}.{kind}", 0.0) for j in chain] for kind in ("stiffness", "damping")]
            found["servo"] = Servo(*held)
        if rates.any():
            joints = {j: float(r) for j, r in zip(chain, rates, strict=False) if r}
            base = rates[len(chain) :].tolist()
            found["motion"] = Motion(tuple(base[:3]), tuple(base[3:]), joints)
        return found

    def _put(self, rates: np.ndarray, channel: str, rate: float) -> None:
        """A rate of what a channel shows among those of joints, and of the base along and about the world's axes."""
        chain = len(self.robot.chain)
        if channel.startswith("joint."):
            rates[self.robot.chain.index(channel.split(".")[1])] = rate
        elif channel.startswith("base.position."):
            rates[chain + "xyz".index(channel[-1])] += rate
        else:
            k = BASE_CHANNELS.index(channel)
            rates[chain + 3 * (k // 3) :][:3] += self.robot.axes[:, k % 3] * rate

    def predict(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray) -> RigPredicted:
        """With what channels read where the machine stands, and what the robot shows beyond its small motions."""
        own = self._motion[trial.id]
        zeros = {n.adds_to: float(v) for n, v in zip(own, initial, strict=True) if n.adds_to}
        moving = tuple(float(v) for n, v in zip(own, initial, strict=True) if not n.adds_to)
        kept = self._shown.get(trial.id)
        if kept is None or kept[0] is not mechanism or kept[1] != moving:
            kept = self._shown[trial.id] = mechanism, moving, super().predict(mechanism, trial, initial)
        blocks = tuple(block.copy() for block in kept[2].blocks)
        bent = self._beyond.get(trial.recorded)
        _, values = self._made.get(id(mechanism), (None, {}))
        weights = None if bent is None else bent.weights(values, initial)
        for block, shown, late in zip(trial.blocks, blocks, kept[2].late, strict=True):
            shown += np.array([zeros.get(channel, 0.0) for channel in block.channels])[:, None]
            if bent is not None and weights is not None:
                bent.add(block, late, weights, shown)
        touches = kept[2].touches if bent is None else bent.touches(kept[2].touches)
        return replace(kept[2], blocks=blocks, touches=touches)

    def sites(self, effects: Iterable[Effect] | None = None) -> list[Site]:
        """Of joints and base those that move, in the recordings or as believed."""
        known = self.places
        return [s for s in super().sites(effects) if s.where in known or not _in_robot(s.where)]

    def site(self, effect: Effect, where: str, trials: tuple[str, ...] = ()) -> Site:
        """At joints and base scaled to what is typical there."""
        size = self.places.get(where)
        return super().site(effect, where, trials) if size is None else Site(scaled(effect, size), where, trials)

    def size_at(self, where: str) -> Sizes:
        """Of joints and base their own, of everything else the wrist's."""
        return self.places.get(where, self._size)

    @property
    def places(self) -> dict[str, Sizes]:
        """Of joints and base those that move, and what is typical there."""
        if self._at is None:
            self._at = sizes_at_places(self)
        return self._at

    def turns(self, where: str) -> bool:
        """Joints that do not slide, and the base about its axes."""
        return where in self.robot.angles or where in BASE_PORTS[3:]

    def from_rest(self, trials: Sequence[TrialData]) -> tuple[TrialData, ...]:
        """Joints and base less what they read where the machine stands."""
        out = []
        for trial in trials:
            zeros = {n.adds_to: n.guess for n in self.nuisances(trial) if n.adds_to}
            blocks = []
            for block in trial.blocks:
                zero = np.array([zeros.get(c, 0.0) for c in block.channels])
                blocks.append(replace(block, value=np.where(block.weight > 0.0, block.value - zero[:, None], 0.0)))
            out.append(replace(trial, blocks=tuple(blocks)))
        return tuple(out)

    def _arm(self, values: Mapping[str, float], trial: TrialData | None) -> ServoArm:
        return self.robot.of("" if trial is None else trial.recorded, _masses(values))


def _in_robot(where: str) -> bool:
    return where.startswith("joint.") or where in BASE_PORTS


def _links(name: str) -> bool:
    return name.startswith("link.") and name.endswith(".mass")


def _masses(values: Mapping[str, float]) -> dict[str, float]:
    """Link -> mass, of the links whose mass is stated [kg]."""
    return {n.split(".")[1]: v for n, v in values.items() if _links(n)}
