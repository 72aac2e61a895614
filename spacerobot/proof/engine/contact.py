"""The explicit force of the tip on the target, in the plane of the air bed or through a whole arm."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from spacerobot.proof.engine.rig import ContactLaw, Rig

EXACT = 1e-11
"""A touch or a parting is met to within so much of its measure [m or N]."""

SLIDE_SPEED = 2e-4
"""Speed [m/s] over which friction across the contact changes its sign."""


class Geometry(Protocol):
    """How deep the tip is in the target, and what a force between them does to the degrees of freedom."""

    def depth(self, q: list[float]) -> float:
        """Penetration [m]."""

    def rate(self, q: list[float], v: list[float]) -> float:
        """Penetration rate [m/s]."""

    def apply(self, q: list[float], v: list[float], f: float, out: list[float]) -> None:
        """Add the share of a force [N], positive in compression, in every degree of freedom."""


class Planar:
    """Hand, slider and target on one line; a target that may turn and move sideways."""

    def __init__(self, rig: Rig) -> None:
        self.law, at = rig.contact, rig.index
        self.wrist, self.target = at["wrist"], at["target"]
        self.hand, self.across, self.yaw = at.get("hand"), at.get("target.y"), at.get("target.yaw")

    def depth(self, q: list[float]) -> float:
        """See Geometry."""
        d = q[self.target] - q[self.wrist]
        if self.hand is not None:
            d -= q[self.hand]
        if self.yaw is not None:
            psi = q[self.yaw]
            d += self.law.ahead * (math.cos(psi) - 1.0) - self.law.lateral * math.sin(psi)
        return d

    def rate(self, q: list[float], v: list[float]) -> float:
        """See Geometry."""
        r = v[self.target] - v[self.wrist]
        if self.hand is not None:
            r -= v[self.hand]
        if self.yaw is not None:
            psi = q[self.yaw]
            r -= (self.law.ahead * math.sin(psi) + self.law.lateral * math.cos(psi)) * v[self.yaw]
        return r

    def apply(self, q: list[float], v: list[float], f: float, out: list[float]) -> None:
        """See Geometry; with friction across the contact."""
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
            rub = -self.law.mu * f * math.tanh((v[self.across] + along * spin) / SLIDE_SPEED)
            out[self.across] += rub
            if self.yaw is not None:
                out[self.yaw] += along * rub


class Spatial:
    """A face at the tip of a whole arm, which turns with it, and a point of the target: both feel the force there.

    Args:
        model, data: MuJoCo's.
        site: the tip.
        target: degrees of freedom of the target along x, y and z.
    """

    def __init__(self, model: Any, data: Any, site: str, target: Sequence[int]) -> None:
        import mujoco

        self._mujoco, self._model, self._data = mujoco, model, data
        self._site, self._target = model.site(site).id, list(target)
        self._body = int(model.site_bodyid[self._site])
        self._row = np.zeros((3, model.nv))
        mujoco.mj_kinematics(model, data)
        self._rest = data.site_xpos[self._site].copy()
        self._ahead = self._turn().T[:, 0].copy()  # the approach, as the tip sees it

    def refresh(self) -> None:
        """Bring positions and Jacobian up to the present state; a step leaves those of its start."""
        self._mujoco.mj_kinematics(self._model, self._data)
        self._mujoco.mj_comPos(self._model, self._data)

    def tip(self) -> float:
        """How far the tip is along x from where it began [m]."""
        return float(self._data.site_xpos[self._site, 0] - self._rest[0])

    def row(self) -> np.ndarray:
        """Derivative of the tip's x, shape (nv,)."""
        self._mujoco.mj_jacSite(self._model, self._data, self._row, None, self._site)
        return self._row[0]

    def depth(self, q: list[float]) -> float:
        """See Geometry; of MuJoCo's present positions."""
        return float(self._normal() @ (self._point(q) - self._data.site_xpos[self._site]))

    def rate(self, q: list[float], v: list[float]) -> float:
        """See Geometry: the target's velocity less that of the face where the point is, along the face's normal."""
        speeds = np.array(v)
        return float(self._normal() @ speeds[self._target] - self._pushed(q) @ speeds)

    def apply(self, q: list[float], v: list[float], f: float, out: list[float]) -> None:
        """See Geometry; no friction across."""
        for i, share in enumerate(self._pushed(q)):
            out[i] += f * float(share)
        for i, share in zip(self._target, self._normal(), strict=True):
            out[i] -= f * float(share)

    def _turn(self) -> np.ndarray:
        return np.asarray(self._data.site_xmat[self._site]).reshape(3, 3)

    def _normal(self) -> np.ndarray:
        return self._turn() @ self._ahead

    def _point(self, q: list[float]) -> np.ndarray:
        return np.asarray(self._rest + [q[i] for i in self._target])

    def _pushed(self, q: list[float]) -> np.ndarray:
        """What the face at the point moves along its normal by each degree of freedom, shape (nv,)."""
        self._mujoco.mj_jac(self._model, self._data, self._row, None, self._point(q), self._body)
        return np.asarray(self._normal() @ self._row)


class Contact:
    """The contact's law and whether it is pressed."""

    def __init__(self, law: ContactLaw, geometry: Geometry) -> None:
        self.law, self.geometry = law, geometry
        self.pressed = False
        self.armed = True  # after the surfaces parted under tension they meet again only from apart

    def force(self, q: list[float], v: list[float]) -> float:
        """Force, positive in compression [N]."""
        if not self.pressed:
            return 0.0
        d = self.geometry.depth(q)
        if d <= -EXACT and self.law.hold == 0.0:  # a touch may be met from this side
            return 0.0
        return max(self.law.force(d, self.geometry.rate(q, v)), -self.law.hold)

    def part(self, q: list[float]) -> None:
        """The surfaces part; they can meet again once they are apart."""
        self.pressed, self.armed = False, self.geometry.depth(q) <= 0.0

    def settle(self, q: list[float], v: list[float]) -> None:
        """After a step: whether surfaces that do not hold each other still touch, and whether others are apart."""
        if self.pressed and self.law.hold == 0.0:
            if self.geometry.depth(q) <= 0.0:
                self.part(q)
        elif not self.pressed and not self.armed:
            self.armed = self.geometry.depth(q) <= 0.0
