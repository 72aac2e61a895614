"""Running a rig in MuJoCo: Runge-Kutta steps, short ones in contact, every touch met exactly."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spacerobot.proof.engine.rig import Rig
from spacerobot.support.errors import SimulationError

FREE_STEP = 2.5e-4
CONTACT_STEP = 5e-5
"""Steps [s] of the Runge-Kutta integration, apart and in contact."""

SLIDE_SPEED = 2e-4
"""Speed [m/s] over which friction across the contact changes its sign."""


@dataclass(frozen=True, eq=False)
class Log:
    """What happened, at every step. T steps; the moment of a touch is there twice, before and after."""

    time: np.ndarray  # (T,) s
    position: Mapping[str, np.ndarray]  # (T,) per joint, m or rad
    velocity: Mapping[str, np.ndarray]
    force: np.ndarray  # (T,) contact force, N, positive in compression
    touches: tuple[float, ...]

    def wrist(self) -> tuple[np.ndarray, np.ndarray]:
        """World position and velocity of the slider, shape (T,) each."""
        x, v = self.position["wrist"], self.velocity["wrist"]
        if "hand" in self.position:
            return x + self.position["hand"], v + self.velocity["hand"]
        return x, v


class _Contact:
    """The explicit force of the tip, and what it does to the degrees of freedom."""

    def __init__(self, rig: Rig) -> None:
        self.law = rig.contact
        at = rig.index
        self.wrist, self.target = at["wrist"], at["target"]
        self.hand, self.across, self.yaw = at.get("hand"), at.get("target.y"), at.get("target.yaw")
        self.pressed = False
        self.armed = True  # after the surfaces parted under tension they meet again only from apart

    def depth(self, q: list[float]) -> float:
        """Penetration [m]."""
        d = q[self.target] - q[self.wrist]
        if self.hand is not None:
            d -= q[self.hand]
        if self.yaw is not None:
            psi = q[self.yaw]
            d += self.law.ahead * (math.cos(psi) - 1.0) - self.law.lateral * math.sin(psi)
        return d

    def rate(self, q: list[float], v: list[float]) -> float:
        """Penetration rate [m/s]."""
        r = v[self.target] - v[self.wrist]
        if self.hand is not None:
            r -= v[self.hand]
        if self.yaw is not None:
            psi = q[self.yaw]
            r -= (self.law.ahead * math.sin(psi) + self.law.lateral * math.cos(psi)) * v[self.yaw]
        return r

    def force(self, q: list[float], v: list[float]) -> float:
        """Force, positive in compression [N]."""
        if not self.pressed:
            return 0.0
        d = self.depth(q)
        if d <= 0.0 and self.law.hold == 0.0:
            return 0.0
        return max(self.law.force(d, self.rate(q, v)), -self.law.hold)

    def apply(self, q: list[float], v: list[float], f: float, out: list[float]) -> None:
        """Add the force's share in every degree of freedom."""
        out[self.wrist] += f
        out[self.target] -= f
        if self.hand is not None:
            out[self.hand] += f
        along, across = self.law.ahead, self.law.lateral
        if self.yaw is not None:
            psi = q[self.yaw]
            along, across = (
                along * math.cos(psi) - across * math.sin(psi),
                along * math.sin(psi) + across * math.cos(psi),
            )
            out[self.yaw] += across * f
        if self.law.mu > 0.0 and self.across is not None and f > 0.0:
            spin = 0.0 if self.yaw is None else v[self.yaw]
            slide = v[self.across] + along * spin
            rub = -self.law.mu * f * math.tanh(slide / SLIDE_SPEED)
            out[self.across] += rub
            if self.yaw is not None:
                out[self.yaw] += along * rub

    def settle(self, q: list[float], v: list[float]) -> None:
        """After a step: whether the surfaces still touch."""
        d = self.depth(q)
        if self.pressed:
            parted = d <= 0.0 if self.law.hold == 0.0 else self.law.force(d, self.rate(q, v)) <= -self.law.hold
            if parted:
                self.pressed, self.armed = False, d <= 0.0
        elif not self.armed and d <= 0.0:
            self.armed = True


def run(rig: Rig, position: Mapping[str, float], velocity: Mapping[str, float], duration: float) -> Log:
    """Integrate from 0 to `duration` [s].

    Args:
        rig: what there is.
        position, velocity: initial values by joint; zero where absent.
        duration: in s.

    Raises:
        SimulationError: the state stopped being finite.
    """
    import mujoco

    model = mujoco.MjModel.from_xml_string(rig.xml())
    data = mujoco.MjData(model)
    index, contact = rig.index, _Contact(rig)
    for name, value in position.items():
        data.qpos[index[name]] = value
    for name, value in velocity.items():
        data.qvel[index[name]] = value
    qpos, qvel, passive, losses = data.qpos, data.qvel, data.qfrc_passive, model.dof_frictionloss
    laws, zeros = rig.laws, [0.0] * model.nv

    def callback(_model: object, at: object) -> None:
        q, v = qpos.tolist(), qvel.tolist()
        out = zeros.copy()
        f = contact.force(q, v)
        if f:
            contact.apply(q, v, f, out)
        for law in laws:
            law(q, v, data.time, f, out)
        for i, value in enumerate(out):
            if value:
                passive[i] += value

    times: list[float] = []
    states: list[list[float]] = []
    forces: list[float] = []
    touches: list[float] = []

    def note() -> None:
        q, v = qpos.tolist(), qvel.tolist()
        times.append(data.time)
        states.append(q + v)
        forces.append(contact.force(q, v))

    def step(h: float) -> None:
        model.opt.timestep = h
        mujoco.mj_step(model, data)

    def levels() -> None:
        for name, level in rig.levels.items():
            i = index[name]
            losses[i] = level(float(qvel[i]), float(data.qfrc_passive[i]))

    kicks = sorted(rig.kicks)
    mujoco.set_mjcb_passive(callback)
    try:
        mujoco.mj_forward(model, data)
        note()
        while data.time < duration - 1e-12:
            levels()
            h = min(CONTACT_STEP if contact.pressed else FREE_STEP, duration - data.time)
            if kicks:
                h = min(h, max(kicks[0][0] - data.time, 0.0))
            if h > 0.0:
                before = (data.time, qpos.copy(), qvel.copy())
                step(h)
                if not contact.pressed and contact.armed and contact.depth(qpos.tolist()) > 0.0:
                    _meet(contact, data, before, h, step)
                    note()
                    contact.pressed = True
                    touches.append(data.time)
                else:
                    contact.settle(qpos.tolist(), qvel.tolist())
            if kicks and data.time >= kicks[0][0] - 1e-12:
                note()
                _, joint, momentum = kicks.pop(0)
                qvel[index[joint]] += momentum / rig.masses[joint.split(".")[0]]
            note()
    finally:
        mujoco.set_mjcb_passive(None)
    table = np.array(states)
    if not np.isfinite(table).all() or data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
        raise SimulationError("the rig in MuJoCo stopped being finite")
    n = len(index)
    return Log(
        np.array(times),
        {name: table[:, i] for name, i in index.items()},
        {name: table[:, n + i] for name, i in index.items()},
        np.array(forces),
        tuple(touches),
    )


def _meet(contact: _Contact, data: object, before: tuple, h: float, step: object) -> None:  # type: ignore[type-arg]
    """Step from `before` to the touch itself: secant steps on the penetration, ending on its positive side."""
    low, high = 0.0, h
    q = data.qpos.tolist()  # type: ignore[attr-defined]
    deep = contact.depth(q)
    shallow = contact.depth(before[1].tolist())
    at = h
    for k in range(12):
        at = low + (high - low) * (-shallow) / (deep - shallow) if k % 3 < 2 else 0.5 * (low + high)
        _restore(data, before)
        step(at)  # type: ignore[operator]
        d = contact.depth(data.qpos.tolist())  # type: ignore[attr-defined]
        if abs(d) < 1e-11:
            return
        if d > 0.0:
            high, deep = at, d
        else:
            low, shallow = at, d
    _restore(data, before)
    step(high)  # type: ignore[operator]


def _restore(data: object, before: tuple) -> None:  # type: ignore[type-arg]
    data.time = before[0]  # type: ignore[attr-defined]
    data.qpos[:] = before[1]  # type: ignore[attr-defined]
    data.qvel[:] = before[2]  # type: ignore[attr-defined]
