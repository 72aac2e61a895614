"""A robot in the browser, or in a notebook's cell, whose joints are dragged; each pose drawn is Pinocchio's."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import replace
from html import escape
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from spacerobot.dynamics.mobility import by_inverse
from spacerobot.dynamics.regime import regime_of
from spacerobot.dynamics.terms import terms_of
from spacerobot.model.library import load
from spacerobot.model.robot import Robot
from spacerobot.simulation.scene import Scene
from spacerobot.support.errors import InputError
from spacerobot.support.jsonio import dumps
from spacerobot.support.numbers import parse_numbers
from spacerobot.view.live.sliders import joint_sliders, positions_of, starting
from spacerobot.view.scene3d.film import Array, Film, Readout, View
from spacerobot.view.scene3d.masses import mass_along
from spacerobot.view.scene3d.page import page
from spacerobot.view.scene3d.robot_body import frame_poses, joint_poses
from spacerobot.view.scene3d.robot_film import motion_film, resting_pose
from spacerobot.view.scene3d.serve import PageServer
from spacerobot.view.scene3d.wrist_spring import wrist_spring


def live_view(
    what: str | Path | Robot | Scene, *, pose: ArrayLike | Mapping[str, float] | None = None, joints: str = "free"
) -> LiveView:
    """A robot with a slider for each joint, and the effective mass at its tip as they move.

    At the end of a notebook's cell it is a frame; elsewhere open its `url`. It is served on this machine's loopback
    address alone until `close`, so a notebook whose kernel runs on another machine does not show it.

    Args:
        what: a robot or its name or URDF; a scene, whose robot is shown at the scene's pose.
        pose: where the sliders begin, shape (len(chain),) or by joint [rad or m].
        joints: "free" or "locked", for the effective mass.

    Raises:
        InputError: no such robot, a pose outside the joints' limits, or a robot without joints.
    """
    if isinstance(what, Scene):
        start = positions_of(what.prepared, what.start)
        given = {} if pose is None else _by_joint(what.prepared, pose)
        return LiveView(what.prepared, pose={**start, **given}, joints=joints, approach=np.array(what.approach))
    if isinstance(what, str | Path | Robot):
        return LiveView(what if isinstance(what, Robot) else load(what), pose=pose, joints=joints)
    raise InputError("no live view of this", given=type(what).__name__, valid="a robot or scene")


class LiveView:
    """A robot whose joints a person drags.

    Args:
        robot: with joints that move.
        pose: where the sliders begin, shape (len(chain),) or by joint [rad or m]; the robot's resting pose if None.
        joints: "free" or "locked", for the effective mass.
        approach: shape (3,), a direction along which the effective mass is told too, or None.

    Attributes:
        robot: the robot.
        sliders: one for each joint.
        film: what is drawn, at the pose where the sliders began.
    """

    def __init__(
        self,
        robot: Robot,
        *,
        pose: ArrayLike | Mapping[str, float] | None = None,
        joints: str = "free",
        approach: Array | None = None,
    ) -> None:
        if joints not in ("free", "locked"):
            raise InputError("unknown joints regime", given=joints, valid="free or locked", where="joints")
        self.robot = robot
        self.sliders = joint_sliders(robot)
        self._regime = regime_of(robot, None, joints)
        self._approach = approach
        self._lock = threading.Lock()
        self._version = 0
        self._server: PageServer | None = None
        self._positions = starting(self.sliders, _by_joint(robot, resting_pose(robot) if pose is None else pose))
        self._start = dict(self._positions)
        self.film = self._first()

    @property
    def pose(self) -> Array:
        """Positions of the arm's joints as the sliders stand, shape (len(chain),) [rad or m].

        It can be set, to such an array or by joint; the page follows.
        """
        return np.array([self._positions[name] for name in self.robot.chain])

    @pose.setter
    def pose(self, value: ArrayLike | Mapping[str, float]) -> None:
        found = starting(self.sliders, {**self._positions, **_by_joint(self.robot, value)})
        with self._lock:
            self._positions, self._version = found, self._version + 1

    @property
    def positions(self) -> dict[str, float]:
        """Joint -> position as the sliders stand, of every joint [rad or m]."""
        return dict(self._positions)

    @property
    def url(self) -> str:
        """Where the page is; it is served from the first time that this is asked for."""
        if self._server is None:
            self._server = self.server()
            self._server.start()
        return self._server.url

    def close(self) -> None:
        """Serve no longer."""
        if self._server is not None:
            self._server.close()
            self._server = None

    def server(self) -> PageServer:
        """A server of the page and of the poses that it asks for, not yet started."""
        return PageServer(self.page, answers={"pose": self._answer}, framed=True)

    def page(self) -> str:
        """The page as HTML; its sliders need the server."""
        joints = [
            {"name": s.name, "low": s.low, "high": s.high, "turns": s.turns, "arm": s.name in self.robot.chain}
            for s in self.sliders
        ]
        start = [self._start[s.name] for s in self.sliders]
        return page(self.film, live={"joints": joints, "start": start, "still": self.still()})

    def still(self) -> dict[str, Any]:
        """What the page draws at the sliders' pose: poses of the film's bodies, mass, numbers beside it."""
        with self._lock:
            positions, version = self._positions, self._version
        robot, film = self.robot, self.film
        q = robot.configuration(others=positions)
        at = joint_poses(robot, q[None])[:, 0]
        placed = {f"robot/{name if i else 'base'}": (at[i], None) for i, name in enumerate(robot.model.names)}
        for body in wrist_spring(robot, q[None]):
            placed[body.name] = (body.poses[0], None if body.stretch is None else body.stretch[0])
        found: dict[str, Any] = {
            "version": version,
            "positions": [positions[s.name] for s in self.sliders],
            "poses": [placed[body.name][0] for body in film.bodies],
            "stretch": [placed[body.name][1] for body in film.bodies],
            "centreOfMass": pin.centerOfMass(robot.model, robot.model.createData(), q),
            "readouts": [r.values[0] for r in self._readouts(q, film)],
        }
        if film.ellipsoid is not None:
            found["centre"] = frame_poses(robot, q[None], robot.tip)[0, :3]
            found["mobility"] = self._mobility(q)
        return found

    def _mobility(self, q: Array) -> Array:
        found: Array = by_inverse(terms_of(self.robot, q, self._regime))[:3, :3]
        return found

    def _first(self) -> Film:
        robot = self.robot
        q = robot.configuration(others=self._positions)
        film = motion_film(robot, np.zeros(1), q[None], joints=self._regime.joints)
        base = "floating" if robot.floating else "fixed"
        tip = frame_poses(robot, q[None], robot.contact or robot.tip)[0, :3]
        return replace(
            film,
            subtitle=f"{len(self.sliders)} joints, {base} base; effective mass with the joints {self._regime.joints}",
            description=f"The robot {robot.name} at the pose that the sliders set.",
            trails=(),
            views=(*film.views, View("Hand", tip, min(film.reach, 0.8), film.views[0].direction)),
            readouts=self._readouts(q, film),
        )

    def _readouts(self, q: Array, film: Film) -> tuple[Readout, ...]:
        tip = frame_poses(self.robot, q[None], self.robot.contact or self.robot.tip)[0, :3]
        found = []
        if film.ellipsoid is not None:
            mobility = self._mobility(q)[None]
            axes = dict(zip("xyz", np.eye(3), strict=True))
            if self._approach is not None:
                axes["the approach"] = self._approach
            found = [Readout(f"effective mass along {n}", "kg", mass_along(mobility, a)) for n, a in axes.items()]
        return (*found, *(Readout(f"tip {n}", "m", np.array([v]), 3) for n, v in zip("xyz", tip, strict=True)))

    def _answer(self, query: str) -> str | None:
        """To `q=...`, positions of all sliders: what is drawn then. To `since=N`: the same, None if nothing changed."""
        asked = parse_qs(query)
        if "q" in asked:
            values = parse_numbers(asked["q"][0], "q", count=len(self.sliders), names=[s.name for s in self.sliders])
            self.pose = dict(zip((s.name for s in self.sliders), values, strict=True))  # type: ignore[assignment]
        elif asked.get("since") == [str(self._version)]:
            return None
        return dumps(self.still(), indent=None)

    def __enter__(self) -> LiveView:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"LiveView({self.robot.name!r}, {len(self.sliders)} sliders)"

    def _repr_html_(self) -> str:
        return (
            f'<iframe src="{escape(self.url)}" title="{escape(self.film.description)}" '
            'style="width: 100%; height: 560px; border: 1px solid #ccc"></iframe>'
        )


def _by_joint(robot: Robot, pose: ArrayLike | Mapping[str, float]) -> dict[str, float]:
    """Joint -> position [rad or m], of a pose of the chain or of a mapping."""
    try:
        if isinstance(pose, Mapping):
            return {str(name): float(value) for name, value in pose.items()}
        row = np.asarray(pose, dtype=float)
    except (TypeError, ValueError):
        raise InputError("not numbers", given=pose, valid="a position for each joint", where="pose") from None
    if row.shape != (len(robot.chain),):
        valid = f"{len(robot.chain)} numbers, one each for {', '.join(robot.chain)}"
        raise InputError("wrong length", given=f"shape {row.shape}", valid=valid, where="pose")
    return dict(zip(robot.chain, row.tolist(), strict=True))
