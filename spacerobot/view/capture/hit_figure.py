"""A hit: where target and wrist go, the force between them, and where the energy went."""

from __future__ import annotations

import math

from matplotlib.figure import Figure

from spacerobot.simulation.trajectory import Trajectory
from spacerobot.view.plotting import BLACK, BLUE, GREY, ORANGE, canvas, style


def hit_figure(trajectory: Trajectory) -> Figure:
    """Positions on the left, contact force on the right, first touch and last separation marked."""
    found = trajectory.restitution
    with style():
        figure = canvas(10.0, 3.6)
        left, right = figure.subplots(1, 2)
        left.plot(trajectory.time, 1e3 * trajectory["target.x"], color=BLUE, label="target")
        left.plot(trajectory.time, 1e3 * trajectory["wrist.x"], color=ORANGE, linestyle=(0, (5, 2)), label="wrist")
        left.set(xlabel="time [s]", ylabel="position [mm]")
        left.legend()
        right.plot(trajectory.time, trajectory["contact.force"], color=BLACK, linewidth=1.2)
        right.set(xlabel="time [s]", ylabel="contact force [N]")
        for axes in (left, right):
            for at in (found.first_touch, found.last_separation):
                if math.isfinite(at):
                    axes.axvline(at, color=GREY, linewidth=1.0, linestyle=":")
        left.set_title(f"restitution {found.hand:.3f}", loc="left")
        right.set_title(f"contact time {found.contact_time:.3f} s, {found.touches} touches", loc="left")
        return figure
