"""A plain loop: scipy's solve_ivp over Pinocchio's forward dynamics, as one would write it in an afternoon."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp

from benchmarks.engines.meeting import DURATION, SCENES, Outcome, read
from spacerobot.simulation.multibody.assembly import assemble_bodies
from spacerobot.simulation.scene import Scene

METHODS = ("RK45", "DOP853", "LSODA")
TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10)


class Loop:
    """Right-hand side in Python; the contact is max(0, k d) along the rod's axis."""

    def __init__(self, scene: Scene) -> None:
        assembly = assemble_bodies(scene, scene.mechanism("multibody"))
        self.scene, self.model = scene, assembly.model
        self.data = self.model.createData()
        self.target = assembly.target
        self.slider = self.model.joints[assembly.joints["slider"]].idx_v
        self.slider_q = self.model.joints[assembly.joints["slider"]].idx_q
        self.rod = int(assembly.joints["slider"])
        self.q, self.v = np.array(assembly.configuration), np.array(assembly.velocity)
        pin.forwardKinematics(self.model, self.data, self.q)
        approach = np.array(scene.approach)
        place = self.data.oMi[self.rod]
        self.normal = place.rotation.T @ approach
        self.tip = place.actInv(self.data.oMi[self.target].translation)
        self.free = [j for j in range(1, self.model.njoints) if self.model.joints[j].nq == 7]

    def depth(self) -> tuple[float, np.ndarray, np.ndarray]:
        """Penetration, normal and point in the world, after forwardKinematics."""
        place, centre = self.data.oMi[self.rod], self.data.oMi[self.target].translation
        normal = place.rotation @ self.normal
        return float(normal @ (centre - place.act(self.tip))), normal, centre

    def rate(self, _: float, y: np.ndarray) -> np.ndarray:
        """dy/dt of y = (q, v)."""
        q, v = y[: self.model.nq], y[self.model.nq :]
        pin.forwardKinematics(self.model, self.data, q)
        depth, normal, point = self.depth()
        tau = np.zeros(self.model.nv)
        wrist = self.scene.wrist
        tau[self.slider] = -wrist.stiffness * q[self.slider_q] - wrist.equivalent_damping * v[self.slider]
        forces = self._forces
        push = max(0.0, self.scene.contact.stiffness * depth)
        for joint, sign in ((self.target, -1.0), (self.rod, 1.0)):
            place = self.data.oMi[joint]
            force = place.rotation.T @ (sign * push * normal)
            forces[joint] = pin.Force(force, np.cross(place.actInv(point), force))
        a = pin.aba(self.model, self.data, q, v, tau, forces)
        return np.concatenate([self._moved(q, v), a])

    @property
    def _forces(self) -> Any:
        forces = pin.StdVec_Force()
        for _ in range(self.model.njoints):
            forces.append(pin.Force.Zero())
        return forces

    def _moved(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """dq/dt."""
        rate = np.empty(self.model.nq)
        for joint in self.model.joints[1:]:
            i, j = joint.idx_q, joint.idx_v
            if joint.nq == 7:
                unit = q[i + 3 : i + 7] / np.linalg.norm(q[i + 3 : i + 7])
                x, y, z, w = unit
                turn = pin.Quaternion(np.array(unit)).toRotationMatrix()
                rate[i : i + 3] = turn @ v[j : j + 3]
                a, b, c = v[j + 3 : j + 6]
                rate[i + 3 : i + 7] = 0.5 * np.array(
                    [w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a, -x * a - y * b - z * c]
                )
            else:
                rate[i : i + joint.nq] = v[j : j + joint.nv]
        return rate

    def collide(self, method: str, tolerance: float) -> Outcome:
        """One run."""
        y = np.concatenate([self.q, self.v])
        found = solve_ivp(self.rate, (0.0, DURATION), y, method=method, rtol=tolerance, atol=1e-3 * tolerance)
        depth = np.empty(found.t.size)
        for i, state in enumerate(found.y.T):
            pin.forwardKinematics(self.model, self.data, state[: self.model.nq])
            depth[i] = self.depth()[0]
        pin.forwardKinematics(self.model, self.data, found.y[: self.model.nq, -1], found.y[self.model.nq :, -1])
        motion = pin.getVelocity(self.model, self.data, self.target, pin.LOCAL_WORLD_ALIGNED)
        return read(self.scene, found.t, depth, float(motion.linear @ np.array(self.scene.approach)))


def runs(name: str, quick: bool) -> Iterator[tuple[str, str, Callable[[], Outcome]]]:
    """(engine, setting, run)."""
    loop = Loop(SCENES[name])
    for method in METHODS[:1] if quick else METHODS:
        for tolerance in TOLERANCES[1:2] if quick else TOLERANCES:
            yield f"scipy {method}", f"{tolerance:g}", lambda m=method, t=tolerance: loop.collide(m, t)
