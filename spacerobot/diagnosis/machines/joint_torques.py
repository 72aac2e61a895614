"""Joint logs as a torque balance: what the arm's rigid-body model asks for, against what was measured.

tau = M(q) a + h(q, v) - (what acts at the joints), every term seen through the same test functions. The motion is
the recorded one, so nothing is simulated, nothing drifts, and most parameters enter linearly.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import partial

import numpy as np

from spacerobot.diagnosis.machines import torque_log
from spacerobot.diagnosis.machines.asked_torques import AskedTorques, own_inertia
from spacerobot.diagnosis.machines.body_columns import BodyColumns
from spacerobot.diagnosis.machines.clear_width import half_width, logged_noise
from spacerobot.diagnosis.machines.contract import FACTORS, Machine, Predicted, Variant, conditions_of
from spacerobot.diagnosis.machines.cut_logs import SHARP, LogCutter
from spacerobot.diagnosis.machines.doubted import NONE, Doubted, beyond
from spacerobot.diagnosis.machines.felt_bodies import FeltBodies
from spacerobot.diagnosis.machines.grid import Grid
from spacerobot.diagnosis.machines.joined_pieces import Joined, Rows
from spacerobot.diagnosis.machines.joint_log import (
    Motion,
    bent,
    kinematics,
    shifted,
    stated_friction,
    torque_sizes,
)
from spacerobot.diagnosis.machines.links import twice_as_heavy, weighed_links
from spacerobot.diagnosis.machines.measured import through_sensor
from spacerobot.diagnosis.machines.mechanism_cache import MechanismCache
from spacerobot.diagnosis.machines.rigid import Rigid
from spacerobot.diagnosis.machines.shared_columns import BASE, SharedColumns
from spacerobot.diagnosis.machines.silent_torque import asked_along, why_silent
from spacerobot.diagnosis.machines.stated_noise import StatedNoise, stated_noise
from spacerobot.diagnosis.machines.test_functions import Bump
from spacerobot.diagnosis.machines.torque_pieces import Cutter, standing
from spacerobot.diagnosis.machines.touch import CLEAR, Moment, first_shock
from spacerobot.diagnosis.machines.undriven import Undriven
from spacerobot.diagnosis.machines.windows import moment
from spacerobot.diagnosis.terms.candidates import stood_for
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed, Hypothesis, Site
from spacerobot.dynamics.joint_kinds import joint_axis
from spacerobot.effects.effect import Effect
from spacerobot.effects.laws import DAMPER, SPRING
from spacerobot.effects.learned import Variable
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import ChannelMap, Coordinate, Force, Readout
from spacerobot.model.robot import Robot

REST = 0.02
"""Share of a joint's typical speed below which it may as well stand still: above what noise leaves of a smoothed rate.
There friction takes what is asked of it, up to its level. Where it slides that slowly, that is the level itself."""


class InverseDynamics(Machine):
    """The torque balance of one joint, or of several, along the measured motion.

    Attributes:
        joints: the joints whose balance is compared.
    """

    metric = "torque balance"
    one_lag = True

    def __init__(
        self,
        robot: Robot,
        gravity: Sequence[float],
        grids: Mapping[str, tuple[Grid, str, Mapping[str, float]]],
        joints: Sequence[str],
        *,
        compared: Sequence[str] | None = None,
        values: Mapping[str, float] | None = None,
        unknown: Sequence[str] = (),
        sigma: Mapping[str, float] | None = None,
        absolute: Mapping[str, float] | None = None,
        sensor: str = "torques",
        motion_sensor: str = "",
        noise: Mapping[str, float] | None = None,
        idle: Sequence[str] = (),
        doubted: Doubted = NONE,
    ) -> None:
        """From joint logs.

        Args:
            robot: its Pinocchio model gives the rigid part; joints without a log are held at neutral.
            gravity: world axes [m/s^2].
            grids: trial -> (joint.NAME.position, .torque and perhaps .velocity on an even grid, condition, overrides).
            joints: names of the logged joints.
            compared: those whose balance counts; all if None.
            values: believed values, "joint.NAME.mass", ".damping", ".stiffness", ".armature", ".gain", ".bias",
                ".zero".
            unknown: names of values that are to be fitted.
            sigma: relative deviations of believed values; of a "joint.NAME.mass" that is not among the values it is
                that of the robot's own inertia about the joint, in its mean pose. A "link.NAME.mass" changes the
                link's weight and inertia as one; links that no compared joint carries are left out.
            absolute: deviations of values that are believed to be zero. "joint.NAME.zero" is what an encoder reads
                where the model has its zero.
            sensor: what verdicts call the torque sensors.
            motion_sensor: what they call the encoders, where these are a stream of their own. Of two clocks only the
                difference shows: torques that come early are positions that come late.
            noise: standard deviations by channel, of the torques and of what the motion is taken from, where the study
                states them all; see `Part.loudness`.
            idle: joints whose torque was not logged but is stated (zero, where nothing drives them): no sensor shows
                it.
            doubted: of the joints' channels, by the same trials.
        """
        self.joints = tuple(joints)
        self.compared = tuple(joints if compared is None else compared)
        self.name = self.compared[0] if len(self.compared) == 1 else "joints"
        self.sensor, self._encoders = sensor, motion_sensor
        motion = {c for grid, _, _ in grids.values() for c in grid.value}
        self.given = frozenset(motion - {f"joint.{j}.torque" for j in self.joints})
        self.driven = not any(j in idle for j in self.compared)
        self._turns = {j: bool(joint_axis(robot.model, robot.joint_id(j))[0]) for j in self.joints}
        link_mass = weighed_links(robot, sigma or {}, self.compared)
        self.links = tuple(link_mass)
        sigma = {n: s for n, s in (sigma or {}).items() if not n.startswith("link.") or n.split(".")[1] in self.links}
        heavier = [Rigid(r, gravity, self.joints) for r in twice_as_heavy(robot, link_mass).values()]
        moved = {n for n in {**sigma, **(absolute or {})} if n.endswith(".zero") and n.split(".")[1] in self.joints}
        self._zeros = sorted(n.removesuffix(".zero") for n in moved)
        sigma = {n: s for n, s in sigma.items() if not n.endswith(".zero") or n in moved}
        unfelt = {f"joint.{j}.torque" for j in self.joints if j not in self.compared}
        self.doubted = doubted.only(lambda channel: channel not in unfelt)
        believed_zeros = {j: (values or {}).get(f"joint.{j}.zero", 0.0) for j in self.joints}
        grids = {k: (shifted(g, believed_zeros), condition, own) for k, (g, condition, own) in grids.items()}
        logs = [g for g, _, _ in grids.values()]
        self._raw = raw = {k: kinematics(g, self.joints, SHARP) for k, (g, _, _) in grids.items()}
        self._arm = arm = Rigid(robot, gravity, self.joints)
        columns = BodyColumns(robot, arm)
        own = {j: torque_sizes(raw.values(), i, arm if j in idle else None) for i, j in enumerate(self.joints)}
        self.sizes = {f"joint.{j}": s for j, s in own.items()} | {"": own[self.compared[0]]}
        level = np.array([own[j].force for j in self.compared])
        resting = np.array([REST * own[j].length / own[j].time for j in self.joints])
        cutter = Cutter(self.joints, self.compared, level, resting, sensor)
        alone = self.joints if len(self.joints) == 1 else ()  # of several, what one hides behind it moves with all
        self._followed = {c: Readout(c, "position", f"joint.{j}") for j in alone for c in [f"joint.{j}.position"]}
        self._lately = MechanismCache()
        moving = arm.inertia(np.concatenate([log.position for log in raw.values()]))
        rows = {j: dict(zip(self.joints, moving[self.joints.index(j)].tolist(), strict=True)) for j in self.compared}
        for j, row in rows.items():
            row[j] = (values or {}).get(f"joint.{j}.mass", row[j]) + (values or {}).get(f"joint.{j}.armature", 0.0)
            if f"joint.{j}.mass" in unknown:
                row[j] = own[j].of("kg")
        pace = half_width(logs, rows, own, idle)
        cut = LogCutter(cutter, arm, heavier, self.doubted, noise or {}).cut(grids, raw, pace)
        trials, lenses, self._motion, self._bump = cut.trials, cut.lenses, cut.motion, cut.bump
        noisy = [logged_noise(logs, f"joint.{j}.position") for j in self.joints]
        far = np.maximum(REST * np.array([own[j].length for j in self.joints]), CLEAR * np.array(noisy))
        self.trials = standing(trials, {t.id: self._motion[t.id].position for t in trials}, far)
        felt, encoders = [self.joints.index(j) for j in self.compared], [f"joint.{j}" for j in self.joints]
        shared = SharedColumns(columns, columns.ends(self.joints, self.compared), encoders, felt, self._motion)
        x, y, z = gravity
        self._gravity = None if robot.floating else (float(x), float(y), float(z))
        # what floats is pulled with its base, and feels nothing; of its encoders' zeros little, and that costs much
        held = () if self._gravity is None else (BASE, *shared.joints)
        self.shared = (*shared.links, *held)
        self._rows = Rows({t.id: (self._motion[t.id], self._bump[t.id]) for t in trials})
        visited = np.concatenate([m.position[:: m.stride] for m in self._motion.values()])
        mean = arm.inertia(visited)
        mass = {f"joint.{j}": float(x) for j, x in zip(self.joints, np.diag(mean), strict=True)}
        self._level = tuple(f"joint.{j}" for j, so in zip(self.joints, arm.level(visited), strict=True) if so)
        self._inertia, self._stated = mean, stated_noise(noise or {}, self.joints, lenses)
        seen = {} if idle else {c: logged_noise(logs, c) for c in motion}
        self._logged = stated_noise({**seen, **(noise or {})}, self.joints, lenses)
        self.base = dict(values or {})
        centres = {n: own[n.split(".")[1]].of(_UNITS[n.split(".")[2]]) for n in unknown}
        sigma = {n: s for n, s in sigma.items() if n not in centres}
        self.base.update({f"link.{n}.mass": m for n, m in link_mass.items()})
        self.base.update({n: mass[n[: -len(".mass")]] for n in sigma if n.endswith(".mass") and n not in self.base})
        around = {n: s for n, s in (absolute or {}).items() if not n.endswith(".zero") or n in moved}
        self.moment = {}
        for joint in (j for j in self.compared if j not in idle):
            steps = (grid.step for grid, _, _ in grids.values())
            self.moment |= moment(f"joint.{joint}.delay", {*around, *self.base}, steps)
        self.base |= {n: 0.0 for n in (*around, *self.moment) if n not in self.base}
        undriven = Undriven(
            self.compared,
            np.array(felt),
            {j: self.base.get(f"joint.{j}.torque", 0.0) for j in self.compared if j in idle},
            self._motion,
            arm,
            np.array([own_inertia(self.base, mass, n) - mass[n] for n in (f"joint.{j}" for j in self.compared)]),
            dict(zip(self.links, heavier, strict=True)),
            shared.inertia,
        )
        self.proportional = self.driven
        self._felt = FeltBodies(shared, undriven, self._believed_torques)
        self._asks = AskedTorques(
            self.joints,
            self.compared,
            undriven,
            mass,
            link_mass,
            self.base,
            self._gravity,
            shared.numbers,
        )
        own_zeros = self.doubted.sigma
        self.believed = Believed(self.base, sigma, {}, conditions_of(trials), centres, absolute=around, zeros=own_zeros)
        self.not_measured = self._silence(unknown)

    def _silence(self, unknown: Sequence[str]) -> str:
        """Why the logged torque tells nothing of the one joint compared; empty where it does, or may."""
        own = {n.rsplit(".", 1)[1] for n in unknown}
        if len(self.compared) != 1 or not self.driven or own & {"gain", "stiffness"}:
            return ""
        (joint,) = self.compared
        weight = self._arm if "mass" in own else None
        asked = partial(asked_along, self._motion, self.joints.index(joint), weight)
        return why_silent(self.trials, asked, self.seen, "N m" if self.angular(joint) else "N")

    def sites(self, effects: Iterable[Effect] | None = None) -> list[Site]:
        """As everywhere; of one joint among several, those at it, at its sensors, and drives of others it turns too."""
        felt = {f"joint.{j}" for j in self.compared}
        fitted = {*self.believed.sigma, *self.believed.absolute, *self.believed.unknown}
        every = [s for s in super().sites(effects) if s.where not in felt or not stood_for(s.effect, s.where, fitted)]
        every = [s for s in every if s.where != self._encoders or s.effect.relative]
        if len(self.compared) == len(self.joints):
            return every
        twins = {word for s in every if s.where in felt for word in s.effect.same_as}  # a bias is a preload
        own = [s for s in every if s.where in felt or s.effect.together or "ports" in self.touched(s)]
        return own + [s for s in every if s.where in self._sensors() and s.effect.name not in twins]

    def trial_mechanism(self, hypothesis: Hypothesis, z: np.ndarray, trial: TrialData) -> Mechanism:
        """The edited mechanism of one trial, kept for the others of its condition."""
        make = partial(super().trial_mechanism, hypothesis, z, trial)
        return self._lately.mechanism(hypothesis, z, trial, make)

    def mechanism(self, values: Mapping[str, float], trial: TrialData) -> Mechanism:
        """Joints with their believed springs, dampers, inertia and torque logs; the coupling between is the rigid part.

        Links of doubted mass are coordinates without a port: nothing acts at them but their own weight.
        """
        coordinates = {f"link.{n}": Coordinate(f"link.{n}", values[f"link.{n}.mass"]) for n in self.links}
        forces = []
        for joint in self.joints:
            name = f"joint.{joint}"
            coordinates[name] = Coordinate(name, own_inertia(values, self._asks.mass, name), angular=self._turns[joint])
            if f"{name}.stiffness" in values:
                forces.append(Force(f"{name}.spring", name, SPRING, (values[f"{name}.stiffness"],), role="spring"))
            if values.get(f"{name}.damping"):
                forces.append(Force(f"{name}.damper", name, DAMPER, (values[f"{name}.damping"],), role="damper"))
        return Mechanism(
            coordinates=coordinates,
            ports={f"joint.{j}": {f"joint.{j}": 1.0} for j in self.joints},
            forces=tuple(forces),
            frictions=tuple(f for j in self.joints for f in stated_friction(values, f"joint.{j}")),
            readouts=self._followed,
            maps=(
                *(m for j in self.compared for m in torque_log.logged(values, j)),
                *(
                    ChannelMap(f"{n}.position", "offset", values[f"{n}.zero"] - self.base[f"{n}.zero"])
                    for n in self._zeros
                ),
            ),
            sensors=self._sensors(),
            links=self._felt.columns.links,
            level=self._level,
            gravity=self._gravity,
        )

    def _sensors(self) -> dict[str, tuple[str, ...]]:
        """Those whose readings a torque that was logged is compared by."""
        if not self.driven:
            return {}
        found = {self.sensor: tuple(f"joint.{j}.torque" for j in self.compared)}
        return found | ({self._encoders: tuple(f"joint.{j}.position" for j in self.compared)} if self._encoders else {})

    def shocks(self) -> dict[str, Moment]:
        """Of all joints together, at the logs' full rate; none where nothing drives: a free swing is let go of."""
        found: dict[str, Moment] = {}
        if not self.driven:
            return found
        for trial, log in self._raw.items():
            motion = (log.position, log.velocity, log.acceleration, log.turned(self._arm))
            asked = self._arm.torque(*motion)
            blurred = bent(self._arm.torque, asked, log.lens, log.wider, motion)
            moment = first_shock(log.time, log.torque - asked - blurred, SHARP * log.step, log.velocity, blurred)
            if moment is not None:
                found[trial] = moment
        return found

    def faster(self, factor: float) -> InverseDynamics:
        """The same paths at another speed: rates so many times, accelerations its square; weight stays."""
        other = copy(self)
        other._motion = {}
        for name, m in self._motion.items():
            speed, growth = factor * m.velocity, factor**2 * m.acceleration
            rigid = self._arm.torque(m.position, speed, growth)
            other._motion[name] = replace(
                m,
                velocity=speed,
                acceleration=growth,
                rigid=rigid,
                torque=None,
                run_up=factor**2 * m.run_up,
                onset=m.onset.times(factor),
                beside={},
            )
        other._felt = replace(self._felt, columns=self._felt.columns.along(other._motion))
        other._rows = Rows({name: (m, self._bump[name]) for name, m in other._motion.items() if name in self._bump})
        return other

    def variants(self, trial: TrialData) -> Iterator[Variant]:
        """Faster and slower motions along the same paths."""
        for factor in FACTORS:
            yield Variant({"speed": f"{factor:g} times that of the recorded motion"}, self.faster(factor))

    def angular(self, joint: str) -> bool:
        """Whether a logged joint turns, rather than slides."""
        return self._turns[joint]

    def visited(self, where: str) -> np.ndarray:
        """Of a joint, along the motion of all pieces."""
        joint = where.removeprefix("joint.")
        if joint not in self.joints:
            return np.zeros(0)
        index = self.joints.index(joint)
        return np.concatenate([self._motion[t.id].position[:, index] for t in self.trials])

    def travelled(
        self, port: str, mechanism: Mechanism, trial: TrialData, initial: np.ndarray
    ) -> Mapping[Variable, np.ndarray]:
        """Of a joint, along the measured motion."""
        joint = port.removeprefix("joint.")
        if joint not in self.compared:
            return {}
        index, motion = self.joints.index(joint), self._motion[trial.id]
        return {"d": motion.position[:, index], "v": motion.velocity[:, index]}

    def measured(self, trial: TrialData) -> Motion:
        """The motion that a piece's balance runs along."""
        return self._motion[trial.id]

    def expected(self, values: Mapping[str, float]) -> dict[str, float]:
        """A heavier rotor than believed makes more of the motion's noise."""
        return self._made_of(self._stated, values)

    def logged(self, values: Mapping[str, float]) -> dict[str, float]:
        """As the logs scatter from one sample to the next; none of a joint whose torque was not logged."""
        return self._made_of(self._logged, values)

    def _made_of(self, noise: StatedNoise | None, values: Mapping[str, float]) -> dict[str, float]:
        if noise is None:
            return {}
        out = {}
        for joint in self.compared:
            k, name = self.joints.index(joint), f"joint.{joint}"
            row = self._inertia[k].copy()
            row[k] = values.get(f"{name}.mass", self._asks.mass[name])
            out[f"{name}.torque"] = noise.of(joint, row)
        return out

    def felt(self, trial: TrialData, where: str) -> np.ndarray:
        """As the torque sensors would read it; none of a link that no compared joint carries."""
        if where not in self.shared:
            return super().felt(trial, where)
        return self._weighted(trial, self._felt.rises(trial.id, where))

    def _believed_torques(self, piece: str) -> np.ndarray:
        """What the machine as it is believed to be asks for along a piece, shape (T, C)."""
        trial = next(t for t in self.trials if t.id == piece)
        mechanism = self.mechanism({**self.base, **self.believed.unknown, **trial.overrides}, trial)
        motion = self._motion[piece]
        asked = self._asks.along(mechanism, motion, motion.lens, partial(self._felt.columns.asked, piece))
        return np.stack([asked[f"joint.{j}"] for j in self.compared], axis=1)

    def _weighted(self, trial: TrialData, read: np.ndarray) -> np.ndarray:
        """What is read along a trial, shape (T, C, N), as its weighted readings show it, shape (N, S)."""
        shown = self.seen(trial, read.reshape(read.shape[0], -1)).reshape(-1, *read.shape[1:])
        (block,) = trial.blocks
        return np.concatenate([w[:, None] * shown[:, c] for c, w in enumerate(block.weight)]).T

    def near(self, numbers: Mapping[str, np.ndarray]) -> InverseDynamics:
        """The arm with these bodies on its links, under this pull, its encoders' zeros there."""
        own = {where: x for where, x in numbers.items() if where in self.shared}
        if not own:
            return self
        other = copy(self)
        other._felt = self._felt.near(own)
        return other

    def bent(self, trial: TrialData) -> np.ndarray:
        """As the torque sensors would read it."""
        return np.asarray(self._weighted(trial, self._felt.bent(trial.id)[..., None])[0])

    def numbers(self, where: str, place: np.ndarray | None) -> np.ndarray:
        """As the columns of what it carries stand."""
        return self._felt.columns.numbers(where, place)

    def carried(self, where: str, place: np.ndarray | None) -> float:
        """As the arm is believed to be."""
        return self._felt.columns.carried(where, place)

    def bump(self, trial: TrialData) -> Bump:
        """The test function that a piece's balance is seen through."""
        return self._bump[trial.id]

    def seen(self, trial: TrialData, signal: np.ndarray) -> np.ndarray:
        """A signal along that motion, shape (T, ...), as the piece's readings show it: through its test functions."""
        return self._bump[trial.id].smooth(signal)[:: self._motion[trial.id].stride]

    def predict(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray) -> Predicted:
        """The torques that the model asks for along the measured motion, through the test functions."""
        if (found := self._rows.shown(trial.id, mechanism, self._of_all)) is not None:
            return Predicted((found,))
        read, bump = self._motion[trial.id], self._bump[trial.id]
        motion = read.told(partial(beyond, mechanism))
        names = [f"joint.{j}" for j in self.joints]
        torque, out = self._asks.along(mechanism, motion, motion.lens, partial(self._felt.columns.asked, trial.id)), []
        for joint in self.compared:
            name = f"joint.{joint}"
            maps = torque_log.beside_motion(mechanism.maps, name)
            log = None if motion.torque is None else motion.torque[:, names.index(name)]
            shown = torque_log.seen(maps, self._asks.read(mechanism, joint, trial.id, torque[name]), log, bump)
            for key, own in read.beside.items():
                shown = shown - beyond(mechanism, key) * bump.smooth(own.torque[:, names.index(name)])
            out.append(shown[:: motion.stride])
        return Predicted((np.array(out),))

    def _of_all(self, mechanism: Mechanism, joined: Joined) -> np.ndarray:
        """The same of all pieces of a row, shape (C, N), where every instant is its own."""
        torque, out = self._asks.along(mechanism, joined.motion, joined, partial(self._felt.columns.asked, joined)), []
        for joint in self.compared:
            maps = torque_log.beside_motion(mechanism.maps, f"joint.{joint}")
            read = self._asks.read(mechanism, joint, joined, torque[f"joint.{joint}"])
            out.append(joined.seen(through_sensor(maps, read, joined.motion.step)))
        return np.array(out)


_UNITS = {"mass": "kg", "armature": "kg", "damping": "N s/m", "stiffness": "N/m", "friction": "N"} | torque_log.UNITS
