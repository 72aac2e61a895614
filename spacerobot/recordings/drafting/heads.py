"""The head of a draft: the kind of rig, and the beliefs that only its author can state."""

from __future__ import annotations

from collections.abc import Sequence

from spacerobot.recordings.drafting.lines import toml
from spacerobot.recordings.drafting.rigs import RIGS

AXIS = "axis"
"""What a draft calls the joint of a lone axis, where no URDF does."""

_TOP = """format = 1
draft = true               # diagnose waits until you have read this through and deleted this line
title = {title}

# What you believe about the rig, in SI units. A value left out is unknown and will be fitted.
"""

_WRIST = """[baseline]                 # a wrist on a spring that meets a floating target
robot = "pa10_wrist"       # a bundled robot, one of example-robot-data, or a URDF beside this file
base = "fixed"             # or "free"
joints = "locked"          # the hand stands still, whatever arm holds it; or "free", "servo"
approach = [1, 0, 0]       # unit vector in the robot's world: the target's direction of motion
gravity = [0, 0, 0]        # along the axes that move

[baseline.wrist]
# mass =                   # kg: the slider and what rides on it
# stiffness =              # N/m
# damping =                # N s/m
# equivalent_damping =     # N s/m: your constant for the guide's friction, if you use one

[baseline.contact]
# stiffness =              # N/m
# damping =                # N s/m

[baseline.target]
{mass}

# How well you know them: one standard deviation, relative.
[baseline.sigma]
# wrist.mass =
# wrist.stiffness =
# target.mass =
"""

_ARM = """[baseline]                 # {words}
robot = {robot}{asked}
base = {base}
joints = "free"            # driven by what is logged
gravity = [0, 0, -9.80665] # in the robot's world
"""

_BODY = """[baseline]                 # a free body
base = "free"
gravity = [0, 0, -9.80665] # across a level table; turn it where another axis points up

[baseline.body]
# mass =                   # kg
# yaw_inertia =            # kg m2, or inertia = [x, y, z]
# restitution =            # where it hits something: speed after over speed before

# How well you know them: one standard deviation, relative.
[baseline.sigma]
# body.mass =
# body.yaw_inertia =
"""

_AXIS = """[baseline]                 # one driven axis
robot = {robot}
base = "fixed"
joints = "free"
{gravity}

[baseline.joint.{joint}]
{mass}
damping = 0.0              # N s/m, or N m s/rad
# stiffness =              # N/m, or N m/rad: of a spring that holds it where it reads 0
# gain =                   # N m, or N, for one unit of what drives it, where that is a current or a voltage

# How well you know them: one standard deviation, relative; a size with its unit where the value is 0.
[baseline.sigma]
# joint.{joint}.mass =
# joint.{joint}.damping =     # as "0.1 N s/m" or "0.1 N m s/rad"
# joint.{joint}.gain =
"""

_LEVEL = "gravity = [0, 0, 0]"
_FALLS = "gravity = [0, 0, -9.80665] # in the robot's world"
_UNKNOWN = 'mass = "unknown"           # kg, or kg m2 where it turns; state what you know'
_OF_URDF = "# mass =                   # kg, or kg m2 where it turns, if it is not as the URDF has it"

_PENDULUM = """[baseline]                 # a pendulum that swings freely
robot = {robot}{asked}
base = "fixed"
joints = "free"
gravity = [0, 0, -9.80665]

[baseline.joint.{joint}]
damping = 0.0              # N m s/rad
torque = 0                 # nothing drives it

# How well you know them: one standard deviation, relative. The mass of what turns is its inertia; without a line
# here it counts as exact, and a wrong one as a payload.
[baseline.sigma]
# joint.{joint}.mass =
# joint.{joint}.damping =
"""

_OF_ITS_PERIOD = "    # ? 1 kg, as far out as its period asks for: state your mass, its place and inertia there"

_UNTOLD = """# No column was recognised. Below, each says what it does and what it could be. Say which rig it is, and
# the draft has its beliefs: spacerobot study new FOLDER --overwrite --rig {rigs}.
[baseline]                 # ? which rig is this, and which of its channels are the columns
robot = "pa10_wrist"
"""


def head(title: str, kind: str, robot: str | None, joints: Sequence[str], masses: Sequence[float | None]) -> str:
    """Everything above the streams.

    Args:
        title: of the study.
        kind: of the rig.
        robot: what is known of the robot, None where nothing is.
        joints: its joints.
        masses: what the trials' names say of the target's mass, kg.
    """
    top = _TOP.format(title=toml(title))
    if kind == "wrist":
        stated = masses and all(m is not None for m in masses)
        mass = "# the mass is stated trial by trial" if stated else "# mass =                   # kg, or for each trial"
        return top + _WRIST.format(mass=mass)
    if kind in ("arm", "platform"):
        words = "a platform that floats, with an arm" if kind == "platform" else "an arm with joint logs"
        asked = "" if robot and joints else "   # ? which robot: no URDF lies beside the files (study new --robot NAME)"
        named = toml(robot if robot and joints else "pa10")
        base = '"free"' if kind == "platform" else '"fixed"'
        return top + _ARM.format(words=words, robot=named, asked=asked, base=base)
    joint = joints[0] if robot else AXIS
    if kind == "axis":
        gravity, mass = (_FALLS, _OF_URDF) if robot else (_LEVEL, _UNKNOWN)
        return top + _AXIS.format(robot=toml(robot or "axis.urdf"), joint=joint, gravity=gravity, mass=mass)
    if kind == "pendulum":
        asked = "" if robot else _OF_ITS_PERIOD
        return top + _PENDULUM.format(robot=toml(robot or "pendulum.urdf"), joint=joint, asked=asked)
    untold = _UNTOLD.format(rigs=f"{', '.join(list(RIGS)[:-1])} or {list(RIGS)[-1]}")
    return top + (_BODY if kind == "body" else untold)
