"""Which pose makes a soft capture: the poses that hold the hand in place, by the force that they let arise."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from spacerobot.dynamics.soft_capture import SoftCapture
from spacerobot.model.robot import Robot
from spacerobot.view.mass.side import draw_robot, right_axis
from spacerobot.view.plotting import BLACK, BLUE, VERMILION, canvas, style


def soft_figure(robot: Robot, found: SoftCapture) -> Figure:
    """Softest and hardest pose from the side; effective mass and peak force of all.

    Args:
        robot: the robot.
        found: its poses.
    """
    right = right_axis(found.direction)
    with style():
        figure = canvas(11.0, 4.4)
        soft, hard, curve = figure.subplots(1, 3, width_ratios=(1.0, 1.0, 1.25))
        for axes, index, name in ((soft, 0, "softest"), (hard, -1, "hardest")):
            draw_robot(axes, robot, found.poses[index], right)
            axes.set_aspect("equal")
            axes.set(xlabel=f"{'xy'[right]} [m]")
            axes.set_title(f"{name}: {found.effective_mass_kg[index]:.4g} kg", loc="left")
        both = [edge for axes in (soft, hard) for edge in axes.get_ylim()]
        for axes in (soft, hard):
            axes.set_ylim(min(both), max(both))
        soft.set(ylabel="z [m]")
        share = np.linspace(0.0, 100.0, len(found.poses))
        for values, colour, dash, name in (
            (found.effective_mass_kg, BLUE, "-", "effective mass"),
            (found.peak_force_N, VERMILION, (0, (5, 2)), "peak force"),
        ):
            curve.plot(share, 100.0 * values / values[found.given], color=colour, linestyle=dash, label=name)
        curve.plot(share[found.given], 100.0, "o", color=BLACK, label="the pose that was asked about")
        ratio = found.effective_mass_kg / found.effective_mass_kg[found.given]
        finite = ratio[np.isfinite(ratio)]
        top = 100.0 * float(np.quantile(finite, 0.97)) if len(finite) else 100.0
        curve.set(xlabel="poses, softest first [%]", ylabel="of the pose that was asked about [%]")
        curve.set_ylim(0.0, 1.15 * max(top, 100.0))
        curve.set_title(f"{len(found.poses)} poses that hold the hand in place", loc="left")
        curve.legend(loc="lower right")
        return figure
