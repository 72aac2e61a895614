"""A simulated capture: arm, wrist, spring, target, force, momentum carriers and events along the time line."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin

from spacerobot.model.robot import Robot
from spacerobot.simulation.events import Event, contact_intervals
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.scene_file import scene_from_text
from spacerobot.simulation.trajectory import Trajectory
from spacerobot.view.scene3d.extent import round_scale, view_of, views_of
from spacerobot.view.scene3d.facing import NOTE, comes_through, half_turned, placed
from spacerobot.view.scene3d.film import Array, Arrow, Body, Film, Mark, Readout, Trail, View
from spacerobot.view.scene3d.masses import mass_along, mass_ellipsoid
from spacerobot.view.scene3d.poses import poses_of, shifted, turned_about
from spacerobot.view.scene3d.robot_body import frame_poses, robot_bodies
from spacerobot.view.scene3d.target_body import target_pieces
from spacerobot.view.scene3d.wrist_spring import DRAWN_BY, wrist_spring

FRAMES = 420
"""At which the film knows where everything is; a third of them while the contact carries force."""

_VERBS = {"stick": "sticks", "slip": "slips"}

ARROW = 0.2
"""Length of the force arrow at a force that only a tenth of the contact exceeds [m], roughly."""


def trajectory_film(trajectory: Trajectory, scene: Scene | None = None) -> Film:
    """A film of a simulation.

    Args:
        trajectory: of either backend.
        scene: that it is of; read from the trajectory itself if None.

    Raises:
        InputError: the trajectory carries no scene, or its robot cannot be loaded.
    """
    scene = scene or scene_from_text(trajectory.scene, where="the trajectory's scene")
    index = _frames(trajectory)
    time = trajectory.time[index]
    channel = {name: values[index] for name, values in trajectory.channels.items()}
    approach = np.array(scene.approach)
    robot, configurations = scene.prepared, _configurations(scene, channel, len(time))
    offset = _shift(scene, channel) * approach
    notes = _notes(scene, trajectory)
    held = scene.joints == "locked" and scene.base == "fixed"
    drawn, place = robot, np.eye(4)
    if held and comes_through(robot, np.array(scene.pose), approach):
        drawn, place = half_turned(robot, np.array(scene.pose), approach)
        notes = (*notes, NOTE)
    arm = robot_bodies(drawn, configurations, hide=DRAWN_BY) + wrist_spring(drawn, configurations)
    bodies = tuple(
        replace(b, poses=shifted(b.poses, offset) if np.any(offset) else b.poses)
        for b in (arm if drawn is robot else placed(arm, place))
    )
    tip = frame_poses(robot, configurations, str(robot.contact))[:, :3] + offset
    space = scene.base == "free"
    places, turns = _target_motion(scene, channel, tip[0], len(time))
    pieces = target_pieces(scene.attitude.T @ scene.lever, panels=space)
    bodies += (Body("target", pieces, poses_of(places, turns), kind="target"),)
    touch = tip[np.argmax(np.abs(channel["contact.force"]))]
    focus, reach, floor = view_of(bodies)
    force = channel["contact.force"]
    arrow = Arrow(force, tip, -approach, arrow_scale(force)) if np.any(force) else None
    joints = "free" if scene.joints == "servo" else scene.joints
    still = scene.joints == "locked" and not space
    ellipsoid = None if still else mass_ellipsoid(robot, configurations, 1.0, joints=joints, base=scene.base)
    readouts = _readouts(scene, channel)
    if ellipsoid is not None:
        along = mass_along(ellipsoid.mobility, approach)
        readouts.append(Readout("effective mass along the approach", "kg", along))
    return Film(
        title=scene.title or f"{robot.name} meets a {scene.target.mass:g} kg body",
        subtitle=_subtitle(scene, trajectory),
        description=_description(scene, trajectory),
        time=time,
        bodies=bodies,
        focus=focus,
        reach=reach,
        views=capture_views(touch, approach, focus, reach, space=space),
        floor=floor,
        trails=(
            Trail("tip", tip, (0.9, 0.35, 0.1)),
            Trail("target", places, (0.15, 0.6, 0.85)),
        ),
        readouts=tuple(readouts),
        marks=_marks(trajectory),
        arrow=arrow,
        ellipsoid=ellipsoid,
        centre_of_mass=_centre_of_mass(robot, configurations) if space else places,
        centre_label="of the chaser" if space else "of the target",
        chart="contact force",
        place="space" if space else "ground",
        notes=notes,
    )


def arrow_scale(force: Array) -> float:
    """Metres of arrow for a newton, from forces along the film (T,): by the usual force, not by a short peak."""
    pressed = np.abs(force[force != 0.0])
    usual = max(float(np.quantile(pressed, 0.9)), float(pressed.max()) / 4.0)
    return round_scale(usual, ARROW)


def capture_views(touch: Array, approach: Array, focus: Array, reach: float, *, space: bool) -> tuple[View, ...]:
    """The meeting first, then everything, then the contact from close by; the target comes from the right."""
    side = np.cross((0.0, 0.0, 1.0), approach)
    side = side / np.linalg.norm(side) if np.linalg.norm(side) > 1e-6 else np.array([0.0, -1.0, 0.0])
    oblique = 1.6 * side - 0.9 * approach + np.array([0.0, 0.0, 0.8])
    near = side - 0.35 * approach + np.array([0.0, 0.0, 0.4])
    meeting = View("Meeting", touch + 0.15 * approach, min(reach, 1.15), tuple(oblique.tolist()))
    close = View("Contact", touch, 0.32, tuple(near.tolist()))
    every = list(views_of(focus, reach))
    if side[1] > 0.0 and not space:  # the usual views see the target come from the left
        beside = 1.7 * side + 0.9 * approach + np.array([0.0, 0.0, 0.75])
        flat = side + np.array([0.0, 0.0, 0.12])
        every[:2] = [View("Whole", focus, reach, tuple(beside)), View("Side", focus, reach, tuple(flat))]
    return (meeting, close, *every) if space else (every[0], close, *every[1:])


def _frames(trajectory: Trajectory) -> Array:
    """Indices of the samples that are shown: even, and denser while there is contact."""
    count = len(trajectory.time)
    even = np.linspace(0, count - 1, min(count, FRAMES * 2 // 3))
    pressed = np.flatnonzero(trajectory.channels["contact.force"] != 0.0)
    dense = (
        pressed[np.linspace(0, len(pressed) - 1, min(len(pressed), FRAMES // 3)).astype(int)] if len(pressed) else []
    )
    edges = [i + d for i in (pressed[0], pressed[-1]) for d in (-1, 1)] if len(pressed) else []
    every = np.concatenate([even, dense, edges]).astype(int)
    return np.unique(np.clip(every, 0, count - 1))


def _configurations(scene: Scene, channel: dict[str, Array], count: int) -> Array:
    """(T, nq) of the scene's robot."""
    robot = scene.prepared
    joints = [
        channel.get(f"joint.{name}.position", np.full(count, p))
        for name, p in zip(robot.chain, scene.pose or (), strict=True)
    ]
    pushed = channel["wrist.deflection"]
    rows = []
    for t in range(count):
        q = robot.configuration(np.array([values[t] for values in joints]), slider=float(pushed[t]))
        if "base.quaternion.w" in channel:
            q[:3] = [channel[f"base.position.{a}"][t] for a in "xyz"]
            q[3:7] = [channel[f"base.quaternion.{a}"][t] for a in "xyzw"]
        rows.append(q)
    return np.array(rows)


def _shift(scene: Scene, channel: dict[str, Array]) -> Array:
    """(T, 1), how far the whole arm is drawn along the approach because only its hand's motion is known [m]."""
    known = any(f"joint.{name}.position" in channel for name in scene.prepared.chain) or "base.position.x" in channel
    moved = np.zeros_like(channel["hand.x"]) if known else channel["hand.x"] - channel["hand.x"][0]
    return moved[:, None]


def _target_motion(scene: Scene, channel: dict[str, Array], tip: Array, count: int) -> tuple[Array, Array]:
    """Centres of mass (T, 3) and rotations (T, 3, 3) of the target."""
    if "target.quaternion.w" in channel:
        places = np.column_stack([channel[f"target.position.{a}"] for a in "xyz"])
        quaternions = np.column_stack([channel[f"target.quaternion.{a}"] for a in "xyzw"])
        return places, np.array([pin.Quaternion(np.ascontiguousarray(q)).toRotationMatrix() for q in quaternions])
    ahead, side, up = scene.axes.T
    zero = np.zeros(count)
    places = tip - scene.lever + np.outer(channel["target.x"], ahead) + np.outer(channel.get("target.y", zero), side)
    return places, turned_about(up, channel.get("target.yaw", zero), scene.attitude)


def _centre_of_mass(robot: Robot, configurations: Array) -> Array:
    data = robot.model.createData()
    return np.array([pin.centerOfMass(robot.model, data, np.ascontiguousarray(q)) for q in configurations])


def _readouts(scene: Scene, channel: dict[str, Array]) -> list[Readout]:
    found = [
        Readout("contact force", "N", channel["contact.force"]),
        Readout("wrist pushed in", "mm", 1e3 * channel["wrist.deflection"], 1),
        Readout("target's speed", "mm/s", 1e3 * channel["target.x.velocity"], 1),
    ]
    if "target.yaw" in channel and np.ptp(channel["target.yaw"]) > 1e-6:
        found.append(Readout("target has turned", "°", np.degrees(channel["target.yaw"] - channel["target.yaw"][0]), 1))
    if "base.quaternion.w" in channel:
        angle = 2.0 * np.degrees(np.arccos(np.clip(np.abs(channel["base.quaternion.w"]), 0.0, 1.0)))
        along = np.column_stack([channel[f"base.velocity.{a}"] for a in "xyz"]) @ np.array(scene.approach)
        found += [Readout("base's speed", "mm/s", 1e3 * along, 1), Readout("base has turned", "°", angle)]
    return found


def _marks(trajectory: Trajectory) -> tuple[Mark, ...]:
    """First touch, last parting, and the first few sticks and slips."""
    end = float(trajectory.time[-1])
    contacts = contact_intervals(trajectory.events, False, float(trajectory.time[0]), end)
    marks = []
    if contacts:
        marks.append(Mark(contacts[0][0], "touch"))
        marks += [Mark(touch, "touch again", True) for touch, _ in contacts[1:60]]
        if contacts[-1][1] < end:
            marks.append(Mark(contacts[-1][1], "apart"))
    others: list[Event] = [e for e in trajectory.events if e.element != "contact" and e.kind in ("stick", "slip")]
    marks += [Mark(e.time, f"{e.element.rpartition(' at ')[2]} {_VERBS[e.kind]}", True) for e in others[:60]]
    return tuple(sorted((m for m in marks if m.time <= end), key=lambda m: m.time))


def _subtitle(scene: Scene, trajectory: Trajectory) -> str:
    base = "free base" if scene.base == "free" else "fixed base"
    named = [f"{e.effect.replace('_', ' ')} at {e.where}" for e in scene.effects]
    effects = f"; with {', '.join(named)}" if named else ""
    return f"{base}, {scene.joints} joints, {scene.target.mass:.4g} kg at {1e3 * scene.target.speed:.4g} mm/s{effects}"


def _description(scene: Scene, trajectory: Trajectory) -> str:
    found: Any = trajectory.restitution
    said = f"A {scene.target.mass:g} kg body meets the compliant wrist of {scene.prepared.name}"
    if found.touches:
        times = f"{found.touches} time{'s' if found.touches != 1 else ''}"
        said += f"; they touch {times} with up to {trajectory.peak_force.value:.3g} N"
        if np.isfinite(found.target):
            said += f", and the body leaves with {found.target:.3f} of its speed"
    return said + "."


def _notes(scene: Scene, trajectory: Trajectory) -> tuple[str, ...]:
    notes = ["The body's size is for show: a scene states mass, inertia and contact point."]
    if trajectory.backend == "reduced" and np.isfinite(scene.hand.mass):
        notes.append("The reduced model knows the hand alone: the whole arm is drawn shifted with it.")
    return tuple(notes)
