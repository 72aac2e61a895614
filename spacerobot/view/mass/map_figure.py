"""The effective mass over a slice of the workspace, as a figure."""

from __future__ import annotations

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from spacerobot.dynamics.direction import unit_directions
from spacerobot.dynamics.hand_pose import hand_aim
from spacerobot.dynamics.workspace import WorkspaceMap, workspace_map
from spacerobot.model.robot import Robot
from spacerobot.view.mass.side import draw_robot, plain_log, reach_of, right_axis
from spacerobot.view.plotting import BLACK, canvas, style

FINE = 60
"""Points across the reach of the arm."""


def slice_map(
    robot: Robot,
    pose: ArrayLike,
    direction: ArrayLike,
    *,
    base: str | None = None,
    joints: str = "free",
    fine: int = FINE,
) -> WorkspaceMap:
    """The map over the upright plane through the hand in which `direction` is seen best.

    Args:
        robot: the robot.
        pose: shape (len(chain),), the reference pose [rad or m].
        direction: shape (3,), unit vector in world axes.
        base: "fixed" or "free".
        joints: "free" or "locked".
        fine: points across.
    """
    pose = np.asarray(pose, dtype=float)
    direction = unit_directions(direction)
    middle, reach = reach_of(robot)
    place = hand_aim(robot, pose, direction).place
    right = right_axis(direction)
    step = 2.0 * reach / fine

    def line(k: int) -> np.ndarray:  # the grid meets the reference place
        low = np.ceil((middle[k] - reach - place[k]) / step)
        return place[k] + step * np.arange(low, low + fine + 1)

    axes = [np.array([p]) for p in place]
    axes[right], axes[2] = line(right), line(2)
    return workspace_map(robot, pose, direction, axes=(axes[0], axes[1], axes[2]), base=base, joints=joints)


def map_figure(robot: Robot, pose: ArrayLike, maps: dict[str, WorkspaceMap]) -> Figure:
    """Maps of one plane beside one another, in one colour scale, the arm drawn over them.

    Args:
        robot: the robot.
        pose: shape (len(chain),), the reference pose [rad or m].
        maps: by their titles.
    """
    pose = np.asarray(pose, dtype=float)
    first = next(iter(maps.values()))
    right = right_axis(first.direction)
    finite = np.concatenate([m.effective_mass_kg[np.isfinite(m.effective_mass_kg)] for m in maps.values()])
    low, high = (float(np.quantile(finite, q)) for q in (0.0, 0.97))
    norm = LogNorm(low, max(high, 1.05 * low))
    with style():
        figure = canvas(5.6 * len(maps) + 0.8, 5.0)
        panels = np.atleast_1d(figure.subplots(1, len(maps), sharey=True))
        for axes, (title, found) in zip(panels, maps.items(), strict=True):
            masses = found.effective_mass_kg.reshape(len(found.axes[right]), len(found.axes[2])).T
            shown = np.ma.masked_invalid(np.where(np.isinf(masses), 10.0 * high, masses))
            shift = first.place - found.place  # a spacecraft lifts its arm; the arms are laid over one another
            across, up = found.axes[right] + shift[right], found.axes[2] + shift[2]
            image = axes.pcolormesh(across, up, shown, norm=norm, cmap="viridis", shading="gouraud", zorder=1)
            image.set_rasterized(True)
            lines = axes.contour(across, up, shown, levels=_levels(low, high), colors="white", linewidths=0.8)
            axes.clabel(lines, fmt="%g", fontsize=8)
            draw_robot(axes, robot, pose, right, 0.55)
            lightest = found.points().reshape(-1, 3)[found.extreme(heaviest=False)] + shift
            spot = {"color": "white", "markeredgecolor": BLACK, "zorder": 7, "linestyle": ""}
            axes.plot(*first.place[[right, 2]], marker="o", label="this pose", **spot)
            axes.plot(*lightest[[right, 2]], marker="*", markersize=14, label="softest", **spot)
            axes.set_aspect("equal")
            there = first.points()[first.reached][:, [right, 2]]
            low_corner, high_corner = np.minimum(there.min(axis=0), 0.0) - 0.2, there.max(axis=0) + 0.1
            axes.set(xlim=(low_corner[0], high_corner[0]), ylim=(low_corner[1], high_corner[1]))
            axes.grid(visible=False)
            axes.set(xlabel=f"{'xy'[right]} [m]")
            axes.set_title(title, loc="left")
        panels[0].set(ylabel="z [m]")
        panels[0].legend(loc="upper left", frameon=True)
        bar = figure.colorbar(image, ax=panels, extend="max", label="effective mass [kg]", shrink=0.9)
        plain_log(bar.ax.yaxis)
        return figure


def _levels(low: float, high: float) -> list[float]:
    powers = 10.0 ** np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1)
    found = [float(f"{m * p:.3g}") for p in powers for m in (1.0, 2.0, 5.0)]
    return [level for level in found if low < level < high] or [float(np.sqrt(low * high))]
