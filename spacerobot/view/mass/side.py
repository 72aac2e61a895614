"""A robot drawn from the side in a figure, and the plane in which it is looked at."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from spacerobot.dynamics.ellipsoid import BeltedEllipsoid
from spacerobot.model.robot import Robot
from spacerobot.view.demo import silhouette
from spacerobot.view.plotting import BLACK, GREY


def right_axis(direction: np.ndarray) -> int:
    """Which world axis lies to the right so that `direction` is seen best with z up: 0 for x, 1 for y."""
    return 1 if abs(direction[1]) > abs(direction[0]) else 0


def reach_of(robot: Robot) -> tuple[np.ndarray, float]:
    """Middle (3,) and radius [m] of a ball that the hand cannot leave: the first joint, and its way to the tip."""
    points = chain_points(robot, np.zeros(len(robot.chain)))
    return points[0], float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def chain_points(robot: Robot, pose: np.ndarray) -> np.ndarray:
    """Where the chain's joints and the tip are, shape (len(chain) + 1, 3) [m]."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.configuration(pose))
    joints = [np.array(data.oMi[robot.joint_id(name)].translation) for name in robot.chain]
    return np.array([*joints, np.array(data.oMf[robot.frame_id(robot.tip)].translation)])


def draw_robot(axes: Axes, robot: Robot, pose: np.ndarray, right: int = 0, alpha: float = 1.0) -> None:
    """Outlines of a robot's primitive shapes; its bones where it is made of meshes."""
    if "<mesh" not in robot.urdf:
        silhouette.draw(axes, robot, robot.configuration(pose), right=right, alpha=alpha)
        axes.autoscale_view()
        return
    points = chain_points(robot, pose)[:, (right, 2)]
    axes.plot(*points.T, color=GREY, linewidth=5, solid_capstyle="round", alpha=alpha, zorder=3)
    axes.plot(*points.T, "o", color=BLACK, markersize=4, alpha=alpha, zorder=3.5)


def plain_log(axis: Axis) -> None:
    """Numbers on a logarithmic axis as people write them, at 1, 2 and 5 of each decade."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_locator(NullLocator())


def draw_ellipsoid(
    axes: Axes, mobility: np.ndarray, centre: np.ndarray, scale: float, limit: float, colour: str, right: int = 0
) -> None:
    """The section of the belted ellipsoid in the plane of the figure.

    Args:
        axes: where to.
        mobility: shape (3, 3) [1/kg].
        centre: shape (3,) [m].
        scale: metres a kilogram.
        limit: greatest radius drawn [m].
        colour: of the outline.
        right: see `right_axis`.
    """
    angle = np.linspace(0.0, 2.0 * np.pi, 361)
    n = np.zeros((len(angle), 3))
    n[:, right], n[:, 2] = np.cos(angle), np.sin(angle)
    radius = np.minimum(scale * BeltedEllipsoid(mobility).radius(n), limit)
    outline = centre[[right, 2]] + radius[:, None] * n[:, (right, 2)]
    axes.fill(*outline.T, facecolor=colour, alpha=0.22, zorder=5)
    axes.plot(*outline.T, color=colour, linewidth=1.3, zorder=5.5)
