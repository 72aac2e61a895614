"""The sliders that the notebooks offer: a pose, and a collision."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from spacerobot.dynamics.direction import unit_directions
from spacerobot.dynamics.effective_mass import effective_mass
from spacerobot.dynamics.hand_pose import chain_limits
from spacerobot.model.robot import Robot
from spacerobot.simulation.prediction import predict
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate
from spacerobot.view.capture.hit_figure import hit_figure
from spacerobot.view.mass.side import chain_points, draw_ellipsoid, draw_robot, right_axis
from spacerobot.view.notebook.explorer import Explorer, Slide
from spacerobot.view.plotting import BLUE, canvas, style


def mass_explorer(robot: Robot, pose: ArrayLike, direction: ArrayLike, *, joints: str = "free") -> Explorer:
    """A slider for each joint; arm, belted ellipsoid and effective mass follow.

    Args:
        robot: the robot.
        pose: shape (len(chain),), at the start [rad or m].
        direction: shape (3,), unit vector in world axes.
        joints: "free" or "locked".
    """
    pose = np.asarray(pose, dtype=float)
    direction = unit_directions(direction)
    low, high = chain_limits(robot)
    low, high = np.maximum(low, -math.pi), np.minimum(high, math.pi)
    slides = {
        name: Slide(f"{name} [°]", math.degrees(p), math.degrees(a), math.degrees(b), 1.0)
        for name, p, a, b in zip(robot.chain, pose, low, high, strict=True)
    }
    size = float(np.linalg.norm(np.diff(chain_points(robot, pose), axis=0), axis=1).sum())

    def draw(**degrees: float) -> tuple[Figure, str]:
        q = np.radians([degrees[name] for name in robot.chain])
        found = effective_mass(robot, q, direction, joints=joints)
        right = right_axis(direction)
        with style():
            figure = canvas(7.0, 5.0)
            axes = figure.subplots()
            draw_robot(axes, robot, q, right)
            tip = chain_points(robot, q)[-1]
            draw_ellipsoid(axes, found.mobility[:3, :3], tip, 0.015 * size, 0.5 * size, BLUE, right)
            axes.set_aspect("equal")
            axes.set(xlim=(-1.1 * size, 1.1 * size), ylim=(-0.5 * size, 1.3 * size))
            axes.set(xlabel=f"{'xy'[right]} [m]", ylabel="z [m]")
            axes.set_title(f"{found.effective_mass_kg:.3g} kg; 10 cm of ellipsoid are {0.1 / (0.015 * size):.2g} kg")
        return figure, f"effective mass along the direction: {found.effective_mass_kg:.4g} kg"

    return Explorer(draw, slides)


def collision_explorer(scene: Scene) -> Explorer:
    """Speed, spring, damping and target of a hit; motion, force and Eqs. 16 and 18 follow.

    Args:
        scene: where the sliders begin; it is simulated with the reduced backend.
    """
    slides = {
        "speed": Slide("speed [mm/s]", 1e3 * scene.target.speed, 10.0, 300.0, 5.0),
        "stiffness": Slide("wrist spring [N/m]", scene.wrist.stiffness, 100.0, 5000.0, 10.0),
        "damping": Slide("wrist damping [N s/m]", scene.wrist.damping + scene.wrist.equivalent_damping, 0.0, 60.0, 0.5),
        "friction": Slide("guide friction [N]", scene.wrist.guide_friction, 0.0, 3.0, 0.05),
        "mass": Slide("target [kg]", scene.target.mass, 1.0, 100.0, 0.5),
    }

    def draw(speed: float, stiffness: float, damping: float, friction: float, mass: float) -> tuple[Figure, str]:
        wrist = replace(
            scene.wrist, stiffness=stiffness, damping=damping, equivalent_damping=0.0, guide_friction=friction
        )
        changed = replace(scene, wrist=wrist, target=replace(scene.target, mass=mass, speed=1e-3 * speed))
        trajectory = simulate(changed, backend="reduced")
        found, said = trajectory.restitution, predict(changed)
        text = f"restitution {found.hand:.3f} after {found.contact_time:.3f} s"
        if said is not None:
            text += f"; Eqs. 16 and 18: {said.restitution:.3f} after {said.contact_time:.3f} s"
        return hit_figure(trajectory), text

    return Explorer(draw, slides)
