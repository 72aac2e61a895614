"""What a motion asks of the drives of some joints: the rigid body, what is heavier than it, and what acts beside."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.machines import torque_log
from spacerobot.diagnosis.machines.hidden_motion import hidden
from spacerobot.diagnosis.machines.joined_pieces import Joined
from spacerobot.diagnosis.machines.joint_log import Motion, Onset
from spacerobot.diagnosis.machines.measured import port_forces
from spacerobot.diagnosis.machines.shared_columns import BASE
from spacerobot.diagnosis.machines.test_functions import Bump
from spacerobot.diagnosis.machines.undriven import Undriven
from spacerobot.effects.mechanism import Mechanism

Asked = Callable[[Mapping[str, np.ndarray]], np.ndarray]
"""Numbers of what is at places that all joints share -> what it asks for, shape (T, C)."""


@dataclass(frozen=True, eq=False)
class AskedTorques:
    """Joints and their believed inertia.

    Attributes:
        joints: of the logs, in their order.
        compared: those whose drives are asked.
        undriven: those of them that nothing drives.
        mass: "joint.NAME" -> the rigid body's own inertia about it in the mean pose [kg m^2 or kg].
        link_mass: links of doubted mass -> what the robot's model has [kg].
        base: believed values by dotted name.
        gravity: that the rigid body is in [m/s^2]; None where it is not felt in space.
        numbers: of a link that may carry a load and a place in it, the load's ten numbers per kilogram, shape (10,).
    """

    joints: tuple[str, ...]
    compared: tuple[str, ...]
    undriven: Undriven
    mass: Mapping[str, float]
    link_mass: Mapping[str, float]
    base: Mapping[str, float]
    gravity: tuple[float, float, float] | None
    numbers: Callable[[str, np.ndarray | None], np.ndarray]

    def along(self, mechanism: Mechanism, motion: Motion, lens: Bump | Joined, shared: Asked) -> dict[str, np.ndarray]:
        """Torque that a motion asks of each compared joint's drive, shape (T,) each."""
        names = [f"joint.{j}" for j in self.joints]
        position = {n: motion.position[:, i] for i, n in enumerate(names)}
        velocity = {n: motion.velocity[:, i] for i, n in enumerate(names)}
        asked = {f"joint.{j}": self._asked(mechanism, motion, j) for j in self.compared}
        if beside := self._beside(mechanism):
            more = shared(beside)
            asked = {name: torque + own for (name, torque), own in zip(asked.items(), more.T, strict=True)}
        held = self._held(mechanism, motion, asked)
        if len(mechanism.coordinates) > len(names) + len(self.link_mass):
            before = motion.run_up.shape[0]
            whole = np.concatenate([motion.run_up, motion.acceleration])
            shaken = {n: whole[:, i] for i, n in enumerate(names)}
            rested = self._rested(mechanism, motion.onset)
            for name, (x, rate) in hidden(mechanism, shaken, motion.step, rested).items():
                carrier = str(mechanism.coordinates[name].carrier)
                position[name] = position[carrier] + x[before:]
                velocity[name] = velocity[carrier] + rate[before:]
        felt = [p for p, row in mechanism.ports.items() if any(row.get(n, 0.0) for n in asked)]
        for port, force in port_forces(mechanism, position, velocity, motion.step, lens, held, felt).items():
            # drives that see two joints act at both
            asked = {n: torque - mechanism.ports[port].get(n, 0.0) * force for n, torque in asked.items()}
        return asked

    def _rested(self, mechanism: Mechanism, onset: Onset) -> list[str]:
        """Riders whose carrier was at rest until the record began: nothing of them shows yet in its drive's torque.

        Amid a motion that is slow beside its resonance what rides on a joint is carried along, and asks for its share.
        """
        found = []
        for name, rider in mechanism.coordinates.items():
            carrier = rider.carrier or ""
            if carrier in self.mass:
                k = self.joints.index(carrier.removeprefix("joint."))
                a = float(onset.acceleration[k])
                alone = onset.rigid[k] + (mechanism.coordinates[carrier].mass - self.mass[carrier]) * a
                left = alone - onset.torque[k]
                if abs(left) < abs(left + rider.mass * a):
                    found.append(name)
        return found

    def _beside(self, mechanism: Mechanism) -> dict[str, np.ndarray]:
        """What all joints feel beside the rigid body as it is believed: by place, the numbers of it, shape (N,)."""
        out: dict[str, np.ndarray] = {}
        for load in mechanism.loads:
            place = None if load.place is None else np.array(load.place)
            out[load.link] = out.get(load.link, 0.0) + load.mass * self.numbers(load.link, place)
        if mechanism.gravity != self.gravity:
            out[BASE] = np.array(mechanism.gravity) - np.array(self.gravity)
        for m in mechanism.maps:
            joint = m.channel.removesuffix(".position")
            if m.kind == "offset" and joint in self.mass:
                out[joint] = out.get(joint, 0.0) + np.array([m.value])
        return {where: numbers for where, numbers in out.items() if numbers.any()}

    def read(self, mechanism: Mechanism, joint: str, along: str | Joined, asked: np.ndarray) -> np.ndarray:
        """What is asked for at a joint along a piece, or pieces in a row, as it is read where nothing drives it."""
        if joint not in self.undriven.stated:
            return asked
        name = f"joint.{joint}"
        own = mechanism.coordinates[name].mass - own_inertia(self.base, self.mass, name)
        heavier = {link: self._heavier(mechanism, link) for link in self.link_mass}
        return self.undriven.read(joint, along, asked, own, heavier, self._beside(mechanism))

    def _asked(self, mechanism: Mechanism, motion: Motion, joint: str) -> np.ndarray:
        """Torque that the motion asks for at a joint, shape (T,): of the rigid body, and of what is heavier than it."""
        k, name = self.joints.index(joint), f"joint.{joint}"
        # inertia beyond the rigid model's: a payload, a mass that is fitted
        asked = motion.rigid[:, k] + (mechanism.coordinates[name].mass - self.mass[name]) * motion.acceleration[:, k]
        if self.link_mass:
            asked = asked + np.array([self._heavier(mechanism, n) for n in self.link_mass]) @ motion.by_link[:, :, k]
        return np.asarray(asked)

    def _held(
        self, mechanism: Mechanism, motion: Motion, asked: Mapping[str, np.ndarray]
    ) -> dict[str, tuple[np.ndarray, float]]:
        """By joint whose drive was read, what must act at it beside the drive, and below which rate it may rest."""
        if motion.torque is None:
            return {}
        out = {}
        for joint in self.compared:
            if joint not in self.undriven.stated:
                name, i = f"joint.{joint}", self.joints.index(joint)
                maps = torque_log.beside_motion(mechanism.maps, name)
                drive = torque_log.inverse(maps, name, motion.torque[:, i], motion.step)
                out[name] = asked[name] - drive, float(motion.slow[i])
        return out

    def _heavier(self, mechanism: Mechanism, link: str) -> float:
        """By which share of its mass a link is heavier than the robot's."""
        return mechanism.coordinates[f"link.{link}"].mass / self.link_mass[link] - 1.0


def own_inertia(values: Mapping[str, float], mass: Mapping[str, float], name: str) -> float:
    """About a joint, "joint.NAME", as some values have it, else as the rigid body does [kg m^2 or kg]."""
    return values.get(f"{name}.mass", mass[name]) + values.get(f"{name}.armature", 0.0)
