"""A robot to look at: each joint of its arm in turn moves a little, and the effective mass at the tip with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin

from spacerobot.dynamics.hand_pose import chain_limits
from spacerobot.model.robot import Robot
from spacerobot.view.scene3d.extent import view_of, views_of
from spacerobot.view.scene3d.film import Array, Film, Mark, Readout, Trail
from spacerobot.view.scene3d.masses import mass_along, mass_ellipsoid
from spacerobot.view.scene3d.robot_body import frame_poses, robot_bodies
from spacerobot.view.scene3d.wrist_spring import DRAWN_BY, wrist_spring

SECONDS = 1.6
"""Of the film, for each joint."""

RATE = 30.0
"""Frames a second."""

SWING = 0.5
"""A joint moves by this much at most [rad]; a sliding one by a tenth of it [m]."""

PUSH = 0.035
"""The wrist's slider is pushed in by this much [m]."""


def robot_film(robot: Robot, pose: Array | None = None) -> Film:
    """A film of one robot.

    Args:
        robot: any that loads.
        pose: (len(chain),), about which it moves [rad or m]; a pose within all limits if None.
    """
    centre = resting_pose(robot) if pose is None else np.asarray(pose, dtype=float)
    kind = "on a floating base" if robot.floating else "on a fixed base"
    moves = f"its joints {', '.join(robot.chain)} move in turn" if robot.chain else "nothing moves"
    time, configurations, marks = _tour(robot, centre)
    film = motion_film(robot, time, configurations)
    return replace(
        film,
        subtitle=f"{len(robot.chain)} joints {kind}" + (", with a compliant wrist" if robot.slider else ""),
        description=f"The robot {robot.name} {kind}; {moves}, and the effective-mass ellipsoid at the tip follows.",
        marks=marks,
    )


def motion_film(
    robot: Robot, time: Array, configurations: Array, *, joints: str = "free", base: str | None = None
) -> Film:
    """A film of a robot in a given motion, with the effective mass at its tip.

    Args:
        robot: any that loads.
        time: (T,) [s].
        configurations: (T, nq).
        joints: "free" or "locked", for the effective mass.
        base: "fixed" or "free", alike; free where the robot floats if None.
    """
    bodies = robot_bodies(robot, configurations, hide=DRAWN_BY) + wrist_spring(robot, configurations)
    focus, reach, floor = view_of(bodies)
    tip = frame_poses(robot, configurations, robot.contact or robot.tip)[:, :3]
    ellipsoid = (
        mass_ellipsoid(robot, configurations, min(reach, 0.8), joints=joints, base=base) if robot.chain else None
    )
    data = robot.model.createData()
    com = np.array([pin.centerOfMass(robot.model, data, np.ascontiguousarray(q)) for q in configurations])
    readouts = []
    if ellipsoid is not None:
        for name, axis in zip("xyz", np.eye(3), strict=True):
            readouts.append(Readout(f"effective mass along {name}", "kg", mass_along(ellipsoid.mobility, axis)))
    total = float(pin.computeTotalMass(robot.model))
    readouts.append(Readout("mass of everything that moves", "kg", np.full(len(time), total)))
    return Film(
        title=robot.name,
        subtitle="",
        description=robot.name,
        time=time,
        bodies=bodies,
        focus=focus,
        reach=reach,
        views=views_of(focus, reach),
        floor=floor,
        trails=(Trail("tip", tip, (0.9, 0.35, 0.1)),) if robot.chain else (),
        readouts=tuple(readouts),
        ellipsoid=ellipsoid,
        centre_of_mass=com,
        place="space" if robot.floating else "ground",
    )


def resting_pose(robot: Robot) -> Array:
    """The rig's pose for the bundled arm; else zero, moved inside the limits where zero lies outside; (len(chain),)."""
    from spacerobot.simulation.scene import PA10_JOINTS, PA10_POSE

    if robot.chain == PA10_JOINTS:
        return np.array(PA10_POSE)
    pose = np.zeros(len(robot.chain))
    for i, (low, high) in enumerate(zip(*chain_limits(robot), strict=True)):
        room = 0.15 * (high - low) if np.isfinite(high - low) else 0.0
        pose[i] = min(max(0.0, low + room), high - room)
    return pose


def _tour(robot: Robot, centre: Array) -> tuple[Array, Array, tuple[Mark, ...]]:
    """Times, configurations (T, nq) and a mark where each joint begins."""
    names = [*robot.chain, *([robot.slider] if robot.slider else [])]
    if not names:
        return np.zeros(1), robot.configuration()[None, :], ()
    per = int(SECONDS * RATE)
    time = np.arange(len(names) * per + 1) / RATE
    poses = np.tile(centre, (len(time), 1))
    slider = np.zeros(len(time))
    swing = np.sin(2.0 * np.pi * np.arange(per) / per) * np.sin(np.pi * np.arange(per) / per) ** 2 * 1.54
    for i, (low, high) in enumerate(zip(*chain_limits(robot), strict=True)):
        joint = robot.model.joints[robot.joint_id(robot.chain[i])]
        size = SWING if "R" in joint.shortname() else 0.1 * SWING
        up, down = min(size, 0.9 * (high - centre[i])), min(size, 0.9 * (centre[i] - low))
        poses[i * per : (i + 1) * per, i] += np.where(swing > 0.0, max(up, 0.0), max(down, 0.0)) * swing
    if robot.slider:
        slider[-per - 1 : -1] = PUSH * np.sin(np.pi * np.arange(per) / per) ** 2
    configurations = np.array([robot.configuration(p, slider=s) for p, s in zip(poses, slider, strict=True)])
    return time, configurations, tuple(Mark(i * SECONDS, str(name)) for i, name in enumerate(names))
