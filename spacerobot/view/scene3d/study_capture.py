"""A recorded capture beside its simulation."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from spacerobot.diagnosis.forward.base import ChannelOverlay, TrialOverlay
from spacerobot.model.wrist import aim, attach_wrist
from spacerobot.recordings.rig_robot import study_robot
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial
from spacerobot.view.scene3d.extent import gains_for, view_of
from spacerobot.view.scene3d.facing import NOTE, comes_through, half_turned, placed
from spacerobot.view.scene3d.film import Array, Arrow, Body, Film, Look, Mark, Piece, Trail
from spacerobot.view.scene3d.poses import poses_of, turned_about
from spacerobot.view.scene3d.robot_body import frame_poses, robot_bodies
from spacerobot.view.scene3d.solids import sphere
from spacerobot.view.scene3d.target_body import EDGE, as_ghost, target_pieces
from spacerobot.view.scene3d.tracks import Tracks
from spacerobot.view.scene3d.trajectory_film import arrow_scale, capture_views
from spacerobot.view.scene3d.wrist_spring import DRAWN_BY, wrist_spring


def capture_film(study: Study, trial: Trial, overlay: TrialOverlay, channels: dict[str, ChannelOverlay]) -> Film:
    """The film of one trial in which a target's track is recorded."""
    tracks = Tracks(channels, "target.x")
    approach = np.array(study.baseline.approach)
    pose = np.array(study.pose(trial))
    robot = study_robot(study, default="pa10_wrist")
    robot = robot if robot.slider is not None else attach_wrist(robot)
    if len(pose) != len(robot.chain):
        pose = np.zeros(len(robot.chain))
    robot = aim(robot, pose, approach)
    notes: tuple[str, ...] = ("The body's size is for show.",)
    place = np.eye(4)
    drawn = robot
    if not robot.floating and comes_through(robot, pose, approach):
        drawn, place = half_turned(robot, pose, approach)
        notes = (*notes, NOTE)
    if "wrist.x" in channels:
        pushed, pushed_measured = tracks.simulated("wrist.x"), tracks.measured("wrist.x")
    else:
        pushed = pushed_measured = np.maximum(tracks.simulated("target.x"), 0.0)
        notes = (*notes, "The wrist's own motion is not recorded: it is drawn where the target pushes it.")
    configurations = np.array([robot.configuration(pose, slider=float(p)) for p in pushed])
    arm = robot_bodies(drawn, configurations, hide=DRAWN_BY) + wrist_spring(drawn, configurations)
    bodies = arm if drawn is robot else placed(arm, place)
    rest = frame_poses(robot, robot.configuration(pose)[None, :], str(robot.contact))[0, :3]
    axes = _axes(approach)
    lever = _lever(study, trial)
    target = target_pieces(lever, panels=False)
    simulated, recorded = (_target(track, rest, axes, lever) for track in (tracks.simulated, tracks.measured))
    of_target = tuple(name for name in channels if name.startswith("target."))
    bodies += (
        Body("target", target, simulated, kind="target"),
        as_ghost(target, "recorded/target", recorded, simulated, tracks.mismatch(*of_target)),
    )
    if "wrist.x" in channels:
        centre = rest + 0.015 * approach
        tip, tip_simulated = (_straight(centre, approach, x) for x in (pushed_measured, pushed))
        ball = (Piece(sphere(0.0175), Look()),)
        bodies += (as_ghost(ball, "recorded/tip", tip, tip_simulated, tracks.mismatch("wrist.x"), 0.6),)
    point = rest + np.outer(pushed, approach)
    force = tracks.simulated("contact.force")
    focus, reach, floor = view_of(bodies)
    return Film(
        title=study.title or study.path.stem,
        subtitle=f"trial {trial.id}, {study.condition(trial)}",
        description=f"Trial {trial.id}: a body meets the wrist, simulated, with the recording as a translucent ghost.",
        time=tracks.time,
        bodies=bodies,
        focus=focus,
        reach=reach,
        floor=floor,
        views=capture_views(rest, approach, focus, reach, space=False),
        trails=(Trail("target", simulated[:, :3], (0.15, 0.6, 0.85)),),
        readouts=tracks.readouts("target.x", "wrist.x", "target.yaw", "contact.force"),
        marks=tuple(Mark(t, "touch" if i == 0 else "touch again", i > 0) for i, t in enumerate(overlay.touches[:12])),
        arrow=Arrow(force, point, -approach, arrow_scale(force)) if np.any(force) else None,
        chart="contact.force" if "contact.force" in channels else "",
        gains=gains_for(bodies),
        notes=notes,
    )


def _axes(approach: Array) -> Array:
    """Columns approach, lateral, up, as scenes have them, (3, 3)."""
    side = np.cross((0.0, 0.0, 1.0), approach)
    side = side / np.linalg.norm(side) if np.linalg.norm(side) > 1e-6 else np.array([0.0, 1.0, 0.0])
    side = side - approach * (approach @ side)
    side = side / np.linalg.norm(side)
    return np.column_stack([approach, side, np.cross(approach, side)])


def _lever(study: Study, trial: Trial) -> Array:
    """The contact point in the target's axes, (3,); the middle of its front where the study does not say."""
    values = study.values(trial)
    ahead = values.get("target.contact_point.ahead", EDGE / 2.0) or EDGE / 2.0
    return np.array([ahead, values.get("target.contact_point.lateral", 0.0), 0.0])


def _target(track: Callable[[str], Array], rest: Array, axes: Array, lever: Array) -> Array:
    """Poses of the target's centre of mass, (T, 7), from a function that gives its channels."""
    ahead, side, up = axes.T
    centre = rest - axes @ lever
    places = centre + np.outer(track("target.x"), ahead) + np.outer(track("target.y"), side)
    yaw = track("target.yaw")
    return poses_of(places, turned_about(up, yaw, axes))


def _straight(start: Array, direction: Array, distance: Array) -> Array:
    poses = np.zeros((len(distance), 7))
    poses[:, :3] = start + np.outer(distance, direction)
    poses[:, 6] = 1.0
    return poses
