"""The words that names of files and columns are made of, in lower case."""

from __future__ import annotations


def words(text: str) -> frozenset[str]:
    """The words of a text."""
    return frozenset(text.split())


THINGS = {
    "target": words("target satellite floater floating puck payload mockup client debris"),
    "wrist": words("wrist slider carriage plunger spring probe"),
    "hand": words("hand gripper ee effector flange tool tcp efpose"),
    "base": words("base platform chaser servicer"),
}
"""Thing of a wrist rig or platform -> what labs call it."""

ARM = words("elbow shoulder forearm upperarm")
"""Parts of an arm: a wrist beside them is one too, and no slider on a spring."""

QUANTITY = {
    "position": words(
        "pos position positions angle angles theta yaw heading psi q encoder encoders enc x y z xyz px py pz "
        "rz height pose efpose att attitude disp displ displacement defl deflection stroke"
    ),
    "velocity": words(
        "vel velocity velocities speed rate omega vx vy vz dx dy dz xdot ydot zdot dq qd qdot dtheta wx wy wz w gyro "
        "thetadot yawrate twist"
    ),
    "torque": words("tau torque torques effort efforts moment"),
    "force": words("force forces f fx fy fz load loadcell wrench ft"),
    "current": words("curr current currents amps"),
    "voltage": words("volt voltage volts"),
}
"""Quantity -> what columns of it are called."""

DIMENSION = {
    "length": "position", "angle": "position", "velocity": "velocity", "angular_velocity": "velocity",
    "force": "force", "torque": "torque", "voltage": "voltage", "current": "current",
}  # fmt: skip
"""Dimension of a stated unit -> quantity."""

_JETS = words("thruster thrusters jet jets nozzle nozzles")

COMMAND = _JETS | words(
    "ref reference references cmd command commands commanded des desired setpoint set goal sp dem demand "
    "demanded planned plan thrust"
)
"""Words of what was asked for, not measured; a thruster's push is commanded."""

REAL = words("current actual act measured meas real fb feedback true")
"""Words of what was measured, beside what was asked for."""

NOT_READINGS = words(
    "frame frames index sample samples counter count step steps row error err status mean marker "
    "residual quality id seq sequence"
)
"""Words of counters, statuses and errors."""

THRUSTERS = _JETS | words("thr valve valves solenoid solenoids")
"""Words of what pushes a body by its own place and direction, which no log says."""

CONVERTER = words("counts count raw adc digits ticks tick lsb bits inc increments")
"""Words of what a converter or an encoder counts, in no unit until its scale is stated."""

STAMPS = words("stamp stamps timestamp timestamps sec secs nsec nsecs nanosec nanosecs seq header")
"""Last words of the columns that a logger adds to each message: when it was sent, and its number."""

TURN = words("rotation rot quat quaternion orientation qx qy qz qw")
"""Words of the parts of a quaternion."""

TRIALS = words(
    "trial trials run runs shot shots test tests hit hits impact impacts take takes rep repetition repeat experiment "
    "exp episode case number no nr id index num"
)
"""Words of a column that numbers trials."""

QUANTITIES = words(
    "pos position positions vel velocity velocities acc accel torque torques effort efforts tau force forces "
    "wrench ft ati loadcell curr current currents volt voltage mocap motive optitrack vicon camera video cam "
    "imu gyro joint joints encoder encoders pose efpose state states time times stamps"
)
"""Words that say what a file measures, and so never tell one trial from another."""

TRACKERS = ("motive", "nexus")
"""Readers of exports that name a column by its body: what that is called is a name, and may be any word."""
