"""One picture of what the project does: a collision, predicted and simulated, and a simulation over a recording."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Rectangle

from spacerobot.diagnosis.forward.base import TrialOverlay
from spacerobot.model.library import load
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.trajectory import Trajectory
from spacerobot.view.demo import silhouette
from spacerobot.view.plotting import BLACK, BLUE, GREY, ORANGE, VERMILION, canvas, style


def picture(scene: Scene, trajectory: Trajectory, numbers: dict[str, Any], trial: TrialOverlay, title: str) -> Figure:
    """The picture.

    Args:
        scene: what was simulated.
        trajectory: what came of it.
        numbers: the answer of `spacerobot simulate --json`.
        trial: of a study, measured and simulated.
        title: of the trial.
    """
    with style():
        figure = canvas(12.0, 6.8)
        grid = figure.add_gridspec(2, 3)
        _arm(figure.add_subplot(grid[0, :2]), scene)
        _collision(figure.add_subplot(grid[1, 0]), figure.add_subplot(grid[1, 1]), trajectory, numbers)
        _recording(figure.add_subplot(grid[0, 2]), figure.add_subplot(grid[1, 2]), trial, title)
        return figure


def _arm(axes: Axes, scene: Scene) -> None:
    """The robot before the touch; the scene's target comes from the right, as approach -x says."""
    robot, target = scene.prepared, load("target")
    q = robot.configuration(np.array(scene.pose))
    silhouette.draw(axes, robot, q)
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, q)
    tip = pin.updateFramePlacement(robot.model, data, robot.frame_id(str(robot.contact))).translation
    half, gap = 0.25, 0.06
    x, z = tip[0] + gap + half, tip[2]
    silhouette.draw(axes, target, target.configuration(), shift=(x, z))
    arrow = FancyArrowPatch((x + 0.16, z + 0.34), (x - 0.16, z + 0.34), arrowstyle="-|>", mutation_scale=18)
    arrow.set(color=VERMILION, linewidth=2.0)
    axes.add_patch(arrow)
    axes.text(x, z + 0.38, f"{scene.target.speed * 100:g} cm/s", ha="center", color=VERMILION)
    axes.text(x, z - 0.36, f"floating target\n{scene.target.mass:g} kg", ha="center", va="top")
    axes.annotate(
        f"compliant wrist\n{scene.wrist.stiffness:g} N/m",
        (tip[0] - 0.1, tip[2] - 0.06),
        xytext=(tip[0] - 0.28, tip[2] - 0.36),
        ha="center",
        va="top",
        arrowprops={"arrowstyle": "-", "color": GREY},
    )
    axes.add_patch(Rectangle((-0.3, -0.05), 0.6, 0.05, color="#C8C8C8", zorder=1))
    axes.set_aspect("equal")
    axes.set(xlim=(-0.32, x + 0.4), ylim=(-0.2, 0.8))
    axes.axis("off")


def _collision(left: Axes, right: Axes, trajectory: Trajectory, numbers: dict[str, Any]) -> None:
    time = trajectory.time
    left.plot(time, 1e3 * trajectory["target.x"], color=BLUE, label="target")
    left.plot(time, 1e3 * trajectory["wrist.x"], color=ORANGE, label="wrist")
    left.set(xlabel="time [s]", ylabel="position [mm]")
    left.set_title("a hit, predicted and simulated", loc="left")
    left.legend(loc="lower center", bbox_to_anchor=(0.56, 0.0))
    right.set_title("its contact force", loc="left")
    right.plot(time, trajectory["contact.force"], color=BLACK, linewidth=1.2)
    right.set(xlabel="time [s]", ylabel="contact force [N]")
    predicted, exact, simulated = numbers["predicted"], numbers["predicted_three_masses"], numbers["simulated"]
    first = simulated["first_touch"]
    for end, colour, name in (
        (first + predicted["contact_time"], VERMILION, f"Eq. 16: {predicted['contact_time']:.3f} s"),
        (simulated["last_separation"], BLUE, f"simulated: {simulated['contact_time']:.3f} s"),
    ):
        right.axvline(end, color=colour, linestyle=(0, (4, 2)), linewidth=1.3, label=name)
    right.legend(loc="upper right", title="contact time", alignment="left")
    text = (
        f"restitution\nEq. 18  {predicted['restitution']:.3f}\nEqs. 2–4  {exact['restitution_hand']:.3f}\n"
        f"simulated  {simulated['hand']:.3f}"
    )
    left.text(0.03, 0.06, text, transform=left.transAxes, va="bottom", fontsize=9)


def _recording(above: Axes, below: Axes, trial: TrialOverlay, title: str) -> None:
    channel = next(c for c in trial.channels if c.channel == "target.x")
    above.plot(channel.time, 1e3 * channel.measured, color=BLACK, linewidth=3.0, alpha=0.35, label="recorded")
    above.plot(channel.time, 1e3 * channel.simulated, color=VERMILION, linewidth=1.4, label="simulated")
    above.set(ylabel="target.x [mm]")
    above.set_title(title, loc="left")
    above.legend(loc="lower center")
    below.axhspan(-2e3 * channel.sigma, 2e3 * channel.sigma, color=ORANGE, alpha=0.35, linewidth=0, label="noise, ±2σ")
    below.axhline(0.0, color=GREY, linewidth=0.8)
    below.plot(channel.time, 1e3 * channel.residual, color=BLUE, linewidth=1.2, label="residual")
    below.set(xlabel="time [s]", ylabel="predicted − measured [mm]")
    below.legend(loc="upper left")
    below.set_title("what the simulation lacks", loc="left")
