"""Running a rig in MuJoCo: Runge-Kutta steps, short ones in contact, every touch met exactly."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from spacerobot.proof.engine.arm import TARGET
from spacerobot.proof.engine.contact import EXACT, Contact, Planar, Spatial
from spacerobot.proof.engine.rig import Rig
from spacerobot.support.errors import SimulationError

CLEAR = 2e-3
"""Gap [m] from which on no step, however long, can hide a touch between its ends."""


@dataclass(frozen=True, eq=False)
class Log:
    """What happened, at every step. T steps; the moment of a touch is there twice, before and after.

    Attributes:
        time: shape (T,) [s].
        position, velocity: by joint, shape (T,) [m or rad].
        slider: world position and velocity of the slider along x, shape (T,) each.
        hand: world displacement along x of what carries the slider, shape (T,).
        force: contact force, positive in compression, shape (T,) [N].
        touches: times [s].
    """

    time: np.ndarray
    position: Mapping[str, np.ndarray]
    velocity: Mapping[str, np.ndarray]
    slider: tuple[np.ndarray, np.ndarray]
    hand: np.ndarray
    force: np.ndarray
    touches: tuple[float, ...]


class _Running:
    """One rig in MuJoCo, from start to end."""

    def __init__(self, rig: Rig, position: Mapping[str, float], velocity: Mapping[str, float]) -> None:
        import mujoco

        self.mujoco, self.rig = mujoco, rig
        self.model = rig.compile()
        self.data = mujoco.MjData(self.model)
        self.index = rig.index
        self.data.qpos[:] = self.model.qpos0
        self.spatial: Spatial | None = None
        if rig.tip is not None:
            self.spatial = Spatial(self.model, self.data, rig.tip, [self.index[n] for n in TARGET])
        self.contact = Contact(rig.contact, self.spatial or Planar(rig))
        for name, value in position.items():
            self.data.qpos[self.index[name]] += value
        for name, value in velocity.items():
            self.data.qvel[self.index[name]] = value
        self.hand = None if rig.mount is None else self.model.site(rig.mount).id
        self.times: list[float] = []
        self.states: list[list[float]] = []
        self.places: list[tuple[float, float, float]] = []
        self.forces: list[float] = []
        self.touches: list[float] = []
        self.smooth, self.called = rig.smooth, False

    def callback(self, _model: Any, _data: Any) -> None:
        """MuJoCo's passive forces: contact and explicit laws added to them."""
        q, v = self.data.qpos.tolist(), self.data.qvel.tolist()
        out = [0.0] * len(v)
        f = self.contact.force(q, v)
        if f:
            self.contact.geometry.apply(q, v, f, out)
        for law in self.rig.laws:
            law(q, v, self.data.time, f, out)
        passive = self.data.qfrc_passive
        for i, value in enumerate(out):
            if value:
                passive[i] += value

    def pace(self) -> float:
        """Length of the next step [s]; MuJoCo calls back only where a force of ours acts."""
        long, apart, pressed = self.rig.steps
        alone = self.smooth and not self.contact.pressed
        if self.called == alone:
            self.mujoco.set_mjcb_passive(None if alone else self.callback)
            self.called = not alone
        if self.contact.pressed:
            return pressed
        return long if alone and self.depth() < -CLEAR else apart

    def note(self) -> None:
        """Write down where things are."""
        self.refresh()
        q, v = self.data.qpos.tolist(), self.data.qvel.tolist()
        self.times.append(self.data.time)
        self.states.append(q + v)
        self.forces.append(self.contact.force(q, v))
        if self.spatial is not None:
            hand = 0.0 if self.hand is None else float(self.data.site_xpos[self.hand, 0])
            speed = float(self.spatial.row() @ self.data.qvel)
            self.places.append((self.spatial.tip(), speed, hand))

    def refresh(self) -> None:
        """Positions of bodies at the present state, where the contact needs them."""
        if self.spatial is not None:
            self.spatial.refresh()

    def depth(self) -> float:
        """Present penetration [m]."""
        self.refresh()
        return self.contact.geometry.depth(self.data.qpos.tolist())

    def step(self, h: float) -> None:
        """One Runge-Kutta step."""
        self.model.opt.timestep = h
        self.mujoco.mj_step(self.model, self.data)

    def levels(self) -> None:
        """Set the dry friction that changes with the motion."""
        f = self.contact.force(self.data.qpos.tolist(), self.data.qvel.tolist()) if self.rig.levels else 0.0
        for name, level in self.rig.levels.items():
            i = self.index[name]
            at, v, net = (float(x[i]) for x in (self.data.qpos, self.data.qvel, self.data.qfrc_passive))
            self.model.dof_frictionloss[i] = level(v, net, at, f)

    def tension(self) -> float:
        """Pull of the surfaces beyond what holds them [N]: positive once they part."""
        self.refresh()
        q, v = self.data.qpos.tolist(), self.data.qvel.tolist()
        geometry, law = self.contact.geometry, self.contact.law
        return -law.hold - law.force(geometry.depth(q), geometry.rate(q, v))

    def locate(self, before: tuple[float, np.ndarray, np.ndarray], h: float, measure: Callable[[], float]) -> None:
        """Step from `before` to where `measure` crosses zero: secant steps and bisection, ending past it."""
        low, high = 0.0, h
        past = measure()
        self.restore(before)
        short = measure()
        for k in range(12):
            at = low + (high - low) * (-short) / (past - short) if k % 3 < 2 else 0.5 * (low + high)
            self.restore(before)
            self.step(at)
            value = measure()
            if value > -EXACT:
                high, past = at, value
            else:
                low, short = at, value
            if abs(value) < EXACT:
                break
        self.restore(before)
        self.step(high)
        self.refresh()

    def restore(self, before: tuple[float, np.ndarray, np.ndarray]) -> None:
        """Back to an earlier state."""
        self.data.time = before[0]
        self.data.qpos[:] = before[1]
        self.data.qvel[:] = before[2]

    def log(self) -> Log:
        """What happened.

        Raises:
            SimulationError: the state stopped being finite.
        """
        table = np.array(self.states)
        bad = self.data.warning[self.mujoco.mjtWarning.mjWARN_BADQACC].number
        if bad or not np.isfinite(table).all():
            raise SimulationError("the rig in MuJoCo stopped being finite")
        n = len(self.states[0]) // 2
        position = {name: table[:, i] for name, i in self.index.items()}
        velocity = {name: table[:, n + i] for name, i in self.index.items()}
        if self.spatial is not None:
            x, v, hand = np.array(self.places).T
            slider, hand = (x, v), hand - hand[0]
        else:
            hand = position.get("hand", np.zeros(len(self.times)))
            slider = position["wrist"] + hand, velocity["wrist"] + velocity.get("hand", 0.0)
        return Log(np.array(self.times), position, velocity, slider, hand, np.array(self.forces), tuple(self.touches))


def run(rig: Rig, position: Mapping[str, float], velocity: Mapping[str, float], duration: float) -> Log:
    """Integrate from 0 to `duration` [s].

    Args:
        rig: what there is.
        position, velocity: initial values by joint, from its rest; zero where absent.
        duration: in s.

    Raises:
        SimulationError: the state stopped being finite.
    """
    import mujoco

    at = _Running(rig, position, velocity)
    data, contact = at.data, at.contact
    kicks = sorted(rig.kicks)
    mujoco.set_mju_user_warning(lambda text: None)  # it would write a file where the user stands; `log` checks
    try:
        at.pace()
        mujoco.mj_forward(at.model, data)
        at.note()
        while data.time < duration - 1e-12:
            at.levels()
            h = min(at.pace(), duration - data.time)
            if kicks:
                h = min(h, max(kicks[0][0] - data.time, 0.0))
            if h > 0.0:
                before = (data.time, data.qpos.copy(), data.qvel.copy())
                at.step(h)
                at.refresh()
                if not contact.pressed and contact.armed and at.depth() > 0.0:
                    at.locate(before, h, at.depth)
                    at.note()
                    contact.pressed = True
                    at.touches.append(data.time)
                else:
                    if contact.pressed and contact.law.hold > 0.0 and at.tension() > 0.0:
                        at.locate(before, h, at.tension)
                        at.note()
                        contact.part(data.qpos.tolist())
                    contact.settle(data.qpos.tolist(), data.qvel.tolist())
            if kicks and data.time >= kicks[0][0] - 1e-12:
                at.note()
                _, joint, momentum = kicks.pop(0)
                data.qvel[at.index[joint]] += momentum / rig.masses[joint.split(".")[0]]
            at.note()
    finally:
        mujoco.set_mjcb_passive(None)
        mujoco.set_mju_user_warning(None)
    return at.log()
