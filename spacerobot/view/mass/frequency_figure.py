"""Apparent mass over frequency: free, servo-held and locked joints on a fixed and on a floating base."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from spacerobot.dynamics.apparent_mass import ApparentMass, apparent_mass
from spacerobot.dynamics.contact_frequency import contact_frequency
from spacerobot.dynamics.direction import unit_directions
from spacerobot.dynamics.servo import HoldsJoints
from spacerobot.model.robot import Robot
from spacerobot.model.spacecraft import float_base
from spacerobot.support.errors import InputError
from spacerobot.view.mass.side import plain_log
from spacerobot.view.plotting import BLACK, BLUE, GREY, VERMILION, canvas, style

HERTZ = (0.1, 300.0)
"""Range of the figure."""


def responses(robot: Robot, pose: ArrayLike, direction: ArrayLike, *, servo: HoldsJoints) -> dict[str, ApparentMass]:
    """The response with the base fixed and floating, by these words.

    Args:
        robot: one with a fixed base is put on the default spacecraft for the second.
        pose: shape (len(chain),) [rad or m].
        direction: shape (3,), unit vector in world axes.
        servo: what holds the joints.
    """
    pose = np.asarray(pose, dtype=float)
    direction = unit_directions(direction)
    omega = 2.0 * np.pi * np.geomspace(*HERTZ, 481)
    floating = robot if robot.floating else float_base(robot)
    return {
        "fixed": apparent_mass(robot, pose, direction, omega, base="fixed", servo=servo),
        "floating": apparent_mass(floating, pose, direction, omega, base="free", servo=servo),
    }


def frequency_figure(
    found: dict[str, ApparentMass], *, wrist_stiffness: float | None = None, tip_mass: float | None = None
) -> Figure:
    """Magnitude and phase over frequency.

    Args:
        found: as `responses` gives them.
        wrist_stiffness: [N/m]; with the next one, where a contact rings is marked.
        tip_mass: of target and slider [kg].
    """
    with style():
        figure = canvas(8.4, 5.6)
        size, angle = figure.subplots(2, 1, sharex=True, height_ratios=(2.4, 1.0))
        for name, colour, dash in (("fixed", BLUE, "-"), ("floating", VERMILION, (0, (5, 2)))):
            response = found[name]
            hertz = response.omega / (2.0 * np.pi)
            size.plot(hertz, response.magnitude, color=colour, linestyle=dash, label=f"{name} base, joints on servos")
            angle.plot(hertz, np.degrees(response.phase), color=colour, linestyle=dash)
            size.axhline(
                1.0 / response.free_mobility, color=colour, linestyle=":", linewidth=1.2, label=f"{name}, joints free"
            )
            if response.locked_mobility > 0.0:
                locked = 1.0 / response.locked_mobility
                size.axhline(locked, color=colour, linestyle="-.", linewidth=1.2, label=f"{name}, joints locked")
        if wrist_stiffness is not None and tip_mass is not None:
            at = ringing(found["fixed"], wrist_stiffness, tip_mass)
            for axes in (size, angle):
                axes.axvline(at, color=BLACK, linewidth=1.0)
            text = f" contact of {tip_mass:g} kg\n on {wrist_stiffness:g} N/m"
            size.annotate(text, (at, 0.03), xycoords=("data", "axes fraction"), fontsize=9)
        free = [1.0 / r.free_mobility for r in found.values()]
        top = 30.0 * max([1.0 / r.locked_mobility for r in found.values() if r.locked_mobility > 0.0] or free)
        size.set(xscale="log", yscale="log", ylabel="|apparent mass| [kg]", ylim=(0.15 * min(free), top))
        for axis in (size.yaxis, angle.xaxis):
            plain_log(axis)
        size.set_title("force over acceleration of the hand", loc="left")
        size.legend(loc="upper right")
        angle.axhline(0.0, color=GREY, linewidth=0.8)
        angle.set(xlabel="frequency [Hz]", ylabel="phase [°]", ylim=(-195.0, 195.0), yticks=(-180, -90, 0, 90, 180))
        return figure


def ringing(response: ApparentMass, wrist_stiffness: float, tip_mass: float) -> float:
    """Frequency of a contact through the wrist's spring [Hz], as its own apparent mass has it."""

    def mobility(omega: float) -> complex:
        real, imaginary = (np.interp(omega, response.omega, part(response.mobility)) for part in (np.real, np.imag))
        return complex(real, imaginary)

    if not (wrist_stiffness > 0.0 and tip_mass > 0.0):
        raise InputError("a contact needs a stiffness and a mass", given=f"{wrist_stiffness:g} N/m, {tip_mass:g} kg")
    return contact_frequency(mobility, wrist_stiffness, tip_mass)[0] / (2.0 * math.pi)
