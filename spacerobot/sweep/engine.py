"""From numbers of collisions to what came of them: exactly and by the thousand where the rig is piecewise linear."""

from __future__ import annotations

import dataclasses
import threading
from collections import OrderedDict

import numpy as np

from spacerobot.simulation.exact.batch import Collisions, collide
from spacerobot.simulation.exact.structure import NotLinearError, piecewise_linear
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import default_duration, simulate
from spacerobot.support.errors import InputError, SimulationError
from spacerobot.sweep.affine import Affine, affine, not_affine
from spacerobot.sweep.keys import with_values
from spacerobot.sweep.plan import Plan

EXACT, ONE_BY_ONE, INTEGRATED = "exact", "exact, scenes one by one", "integrated"
"""How collisions are computed; see docs/sweep.md."""

RESULTS = {
    "restitution_target": "restitution_target",
    "restitution_hand": "restitution_hand",
    "restitution_point": "restitution_point",
    "first_touch": "first_touch_s",
    "contact_time": "contact_time_s",
    "contact_time_summed": "contact_time_summed_s",
    "touches": "touches",
    "peak_force": "peak_force_N",
    "peak_deflection": "peak_deflection_m",
    "target_velocity": "target_velocity_m_s",
    "hand_velocity": "hand_velocity_m_s",
}
"""Field of `Collisions` -> column."""

_REMEMBERED = 4096


class Engine:
    """Computes any stretch of a sweep; the same whoever does it and however it is cut."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.method, self._outer = _method(plan)
        self._functions: OrderedDict[tuple[float, ...], Affine] = OrderedDict()
        self._lock = threading.Lock()

    def columns(self, first: int, last: int) -> dict[str, np.ndarray]:
        """The table of collisions first to last - 1: what was varied, then what came of it.

        Raises:
            InputError: a collision that cannot be.
            SimulationError: one that could not be finished.
        """
        pose, values = self.plan.columns(first, last)
        mass, found = self._exact(pose, values) if self.method == EXACT else self._each(pose, values, first)
        table = {"collision": np.arange(first, last, dtype=np.int64), "pose": pose, **values, "hand_mass_kg": mass}
        table.update({column: getattr(found, field) for field, column in RESULTS.items()})
        return table

    def _exact(self, pose: np.ndarray, values: dict[str, np.ndarray]) -> tuple[np.ndarray, Collisions]:
        inner = [k for k in self.plan.keys if k not in self._outer]
        given = np.column_stack([values[k] for k in inner]) if inner else np.empty((len(pose), 0))
        groups, group = np.unique(
            np.column_stack([pose, *(values[k] for k in self._outer)]), axis=0, return_inverse=True
        )
        mass = np.empty(len(pose))
        found = []
        order = np.argsort(group, kind="stable")
        edges = np.searchsorted(group[order], np.arange(len(groups) + 1))
        for g in range(len(groups)):
            rows = order[edges[g] : edges[g + 1]]
            function = self._function(tuple(groups[g].tolist()), inner)
            mass[rows] = function.hand_mass
            found.append(collide(function.structure, function.numbers(given[rows]), self.plan.scene.duration))
        back = np.argsort(order, kind="stable")
        fields = [f.name for f in dataclasses.fields(Collisions)]
        return mass, Collisions(**{f: np.concatenate([getattr(c, f) for c in found])[back] for f in fields})

    def _function(self, key: tuple[float, ...], inner: list[str]) -> Affine:
        """The affine function of a pose and the outer keys' values; the latest are remembered."""
        with self._lock:
            if key not in self._functions:
                centre = self.plan.centre
                fixed = dict(zip(self._outer, key[1:], strict=True))
                pose = self.plan.poses[int(key[0])]
                self._functions[key] = affine(self.plan.scene, pose, fixed, {k: centre[k] for k in inner})
                if len(self._functions) > _REMEMBERED:
                    self._functions.popitem(last=False)
            return self._functions[key]

    def _each(self, pose: np.ndarray, values: dict[str, np.ndarray], first: int) -> tuple[np.ndarray, Collisions]:
        mass, found = [], []
        for i in range(len(pose)):
            try:
                own = {k: float(v[i]) for k, v in values.items()}
                scene = with_values(self.plan.scene, own, self.plan.poses[int(pose[i])])
                mass.append(scene.hand.mass)
                if self.method == ONE_BY_ONE:
                    structure, numbers = piecewise_linear(scene)
                    found.append(collide(structure, numbers[None], scene.duration))
                else:
                    found.append(_integrated(scene))
            except InputError as error:
                raise InputError(f"collision {first + i}: {error.what}", given=error.given, valid=error.valid) from None
            except SimulationError as error:
                raise SimulationError(f"collision {first + i}: {error}") from None
        fields = [f.name for f in dataclasses.fields(Collisions)]
        return np.array(mass), Collisions(**{f: np.concatenate([getattr(c, f) for c in found]) for f in fields})


def _method(plan: Plan) -> tuple[str, tuple[str, ...]]:
    """How the collisions of a plan are computed, and the keys for whose values scenes are made anew."""
    if plan.scene.backend == "multibody":
        return INTEGRATED, ()
    try:
        outer = not_affine(plan.scene, plan.poses[0], plan.centre)
    except NotLinearError:
        return INTEGRATED, ()
    if any(k in plan.scatter for k in outer):
        return ONE_BY_ONE, ()
    return EXACT, outer


def _integrated(scene: Scene) -> Collisions:
    end = default_duration(scene) if scene.duration is None else scene.duration
    trajectory = simulate(scene, duration=end, rate=2.0 / end, must_touch=False)  # only the last sample is read
    found = trajectory.restitution
    channels = trajectory.channels
    values = {
        "restitution_target": found.target,
        "restitution_hand": found.hand,
        "restitution_point": found.point,
        "first_touch": found.first_touch,
        "contact_time": found.contact_time,
        "contact_time_summed": found.contact_time_summed,
        "peak_force": trajectory.peak_force.value,
        "peak_deflection": trajectory.peak_deflection.value,
        "target_velocity": float(channels["target.x.velocity"][-1]),
        "hand_velocity": float(channels["hand.x.velocity"][-1]),
        "end": end,
    }
    touches = np.array([found.touches], dtype=np.int32)
    return Collisions(touches=touches, **{k: np.array([v]) for k, v in values.items()})
