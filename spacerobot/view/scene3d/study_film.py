"""A recorded trial beside its simulation: the recording as a ghost, coloured by how far apart the two are."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from spacerobot.diagnosis.forward.base import ChannelOverlay
from spacerobot.diagnosis.forward.choose import forward_model
from spacerobot.diagnosis.forward.floating_platform import FloatingPlatform
from spacerobot.model.robot import Robot
from spacerobot.recordings.rig_robot import study_robot
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial
from spacerobot.support.errors import InputError
from spacerobot.view.scene3d.extent import gains_for, view_of, views_of
from spacerobot.view.scene3d.film import Array, Body, Film, Trail
from spacerobot.view.scene3d.robot_body import frame_poses, robot_bodies
from spacerobot.view.scene3d.study_capture import capture_film
from spacerobot.view.scene3d.target_body import as_ghost
from spacerobot.view.scene3d.tracks import Tracks


def study_film(study: Study, trial: str | None = None) -> Film:
    """A film of one trial.

    Args:
        study: one that `spacerobot overlay` can simulate and that has a body to show.
        trial: its id; the first if None.

    Raises:
        NotFoundError: no such trial.
        InputError: nothing in the study can be simulated, or nothing of it can be drawn.
    """
    model = forward_model(study)
    chosen = study.trials[0] if trial is None else study.trial(trial)
    overlay = model.simulate(chosen)
    channels = {c.channel: c for c in overlay.channels if c.time.size > 1}
    if "target.x" in channels:
        return capture_film(study, chosen, overlay, channels)
    if isinstance(model, FloatingPlatform):
        return _platform(study, chosen, model, channels)
    joints = [c.split(".")[1] for c in channels if c.startswith("joint.") and c.endswith(".position")]
    if joints and study.robot_source is not None:
        return _joints(study, chosen, joints, channels)
    raise InputError(
        "nothing of this study can be drawn",
        given=", ".join(study.channels()[:8]),
        valid="a target's track, a floating platform, or a joint of a robot that the study names",
        where=str(study.path),
    )


def _platform(study: Study, trial: Trial, model: FloatingPlatform, channels: dict[str, ChannelOverlay]) -> Film:
    robot = model.robot
    tracks = Tracks(channels, "base.yaw")
    recording = study.recording(trial)
    joints = {j: np.interp(tracks.time, *recording[c].good()) for j, c in model.drives.items() if c in recording}

    def configurations(track: Callable[[str], Array]) -> Array:
        x, y, yaw = (track(f"base.{n}") for n in ("position.x", "position.y", "yaw"))
        rows = []
        for t in range(len(tracks.time)):
            q = robot.configuration(others={j: float(values[t]) for j, values in joints.items()})
            q[:7] = [x[t], y[t], 0.0, 0.0, 0.0, math.sin(0.5 * yaw[t]), math.cos(0.5 * yaw[t])]
            rows.append(q)
        return np.array(rows)

    simulated = robot_bodies(robot, configurations(tracks.simulated))
    mismatch = tracks.mismatch("base.position.x", "base.position.y", "base.yaw")
    ghosts = _ghosts(robot, configurations(tracks.measured), simulated, mismatch)
    tip = frame_poses(robot, configurations(tracks.simulated), robot.tip)[:, :3]
    return _plain(study, trial, tracks, simulated + ghosts, tip, "base.position.x", "base.position.y", "base.yaw")


def _joints(study: Study, trial: Trial, joints: list[str], channels: dict[str, ChannelOverlay]) -> Film:
    robot = study_robot(study)
    names = {j: f"joint.{j}.position" for j in joints}
    tracks = Tracks(channels, names[joints[0]])

    def configurations(track: Callable[[str], Array]) -> Array:
        values = {j: track(name) for j, name in names.items()}
        return np.array(
            [robot.configuration(others={j: float(v[t]) for j, v in values.items()}) for t in range(len(tracks.time))]
        )

    simulated = robot_bodies(robot, configurations(tracks.simulated))
    ghosts = _ghosts(robot, configurations(tracks.measured), simulated, tracks.mismatch(*names.values()))
    tip = frame_poses(robot, configurations(tracks.simulated), robot.tip)[:, :3]
    return _plain(study, trial, tracks, simulated + ghosts, tip, *names.values())


def _ghosts(robot: Robot, configurations: Array, simulated: tuple[Body, ...], mismatch: Array) -> tuple[Body, ...]:
    """Ghosts of those bodies that move at all."""
    bodies = robot_bodies(robot, configurations, prefix="recorded")
    pairs = [(b, s) for b, s in zip(bodies, simulated, strict=True) if np.ptp(b.poses, axis=0).max() > 1e-9]
    return tuple(as_ghost(b.pieces, b.name, b.poses, s.poses, mismatch) for b, s in pairs)


def _plain(study: Study, trial: Trial, tracks: Tracks, bodies: tuple[Body, ...], tip: Array, *shown: str) -> Film:
    focus, reach, floor = view_of(bodies)
    return Film(
        title=study.title or study.path.stem,
        subtitle=f"trial {trial.id}, {study.condition(trial)}",
        description=f"Trial {trial.id}, simulated, with the recording as a translucent ghost.",
        time=tracks.time,
        bodies=bodies,
        focus=focus,
        reach=reach,
        floor=floor,
        views=views_of(focus, reach),
        trails=(Trail("tip", tip, (0.9, 0.35, 0.1)),),
        readouts=tracks.readouts(*shown),
        gains=gains_for(bodies),
    )
