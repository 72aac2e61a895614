"""From touch to tumble: momentum handed over, and how the base turns afterwards."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spacerobot.simulation.scene import Scene
from spacerobot.simulation.scene_file import scene_from_text
from spacerobot.simulation.trajectory import Trajectory
from spacerobot.support.errors import InputError
from spacerobot.view.plotting import BLACK, BLUE, GREEN, GREY, SERIES, VERMILION, canvas, style


def base_turn(trajectory: Trajectory) -> np.ndarray:
    """Angle of the base from its first attitude, shape (T,) [rad].

    Raises:
        InputError: the base is fixed.
    """
    if "base.quaternion.w" not in trajectory.channels:
        raise InputError("the base does not float", given=trajectory.backend, valid="a multibody run with a free base")
    q = np.column_stack([trajectory[f"base.quaternion.{a}"] for a in "xyzw"])
    angle: np.ndarray = 2.0 * np.arccos(np.clip(np.abs(q @ q[0]), 0.0, 1.0))
    return angle


def target_momentum(trajectory: Trajectory) -> np.ndarray:
    """Linear momentum of the target, world axes, shape (T, 3) [kg m/s]."""
    mass = scene_from_text(trajectory.scene, where="the trajectory's scene").target.mass
    return mass * np.column_stack([trajectory[f"target.velocity.{a}"] for a in "xyz"])


def tumble_figure(trajectory: Trajectory) -> Figure:
    """Momentum along the approach, total and shared; the base's turn and speed of turning."""
    scene = scene_from_text(trajectory.scene, where="the trajectory's scene")
    n = np.array(scene.approach)
    total, target = trajectory.linear_momentum @ n, target_momentum(trajectory) @ n
    with style():
        figure = canvas(10.0, 3.8)
        left, right = figure.subplots(1, 2)
        left.plot(trajectory.time, target, color=BLUE, label="target")
        left.plot(trajectory.time, total - target, color=VERMILION, linestyle=(0, (5, 2)), label="chaser")
        left.plot(trajectory.time, total, color=BLACK, linestyle=":", label="both")
        left.set(xlabel="time [s]", ylabel="momentum along the approach [kg m/s]")
        left.legend()
        left.set_title(f"conserved to {float(np.ptp(total)):.1e} kg m/s", loc="left")
        right.plot(trajectory.time, np.degrees(base_turn(trajectory)), color=GREEN)
        right.set(xlabel="time [s]", ylabel="base has turned [°]")
        rate = np.column_stack([trajectory[f"base.angular_velocity.{a}"] for a in "xyz"])[-1]
        right.set_title(f"tumbles at {np.degrees(np.linalg.norm(rate)):.2f} °/s in the end", loc="left")
        _touch(trajectory, left, right)
        return figure


def compare_tumbles(runs: Mapping[str, tuple[Scene, Trajectory]]) -> Figure:
    """How far the wrist is pushed in and the base turns, for several captures, by name."""
    with style():
        figure = canvas(10.0, 3.8)
        left, right = figure.subplots(1, 2)
        for (name, (_, run)), colour in zip(runs.items(), SERIES, strict=False):
            left.plot(run.time, 1e3 * run["wrist.deflection"], color=colour, label=name)
            right.plot(run.time, np.degrees(base_turn(run)), color=colour, label=name)
        left.set(xlabel="time [s]", ylabel="wrist pushed in [mm]")
        right.set(xlabel="time [s]", ylabel="base has turned [°]")
        right.legend()
        return figure


def _touch(trajectory: Trajectory, *panels: Axes) -> None:
    for axes in panels:
        axes.axvline(trajectory.restitution.first_touch, color=GREY, linewidth=1.0, linestyle=":")
