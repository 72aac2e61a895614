"""`spacerobot mass`: effective mass of a robot at one pose, frame and direction."""

from __future__ import annotations

import argparse

_EPILOG = """\
examples:
  spacerobot mass pa10_wrist --q 0 45 0 90 0 -45 0 --deg --direction 1 0 0 --base fixed --joints free
  spacerobot mass chaser_pa10_wrist --q 0,45,0,90,0,-45,0 --deg --direction 0 0 -1 --joints locked --json
  spacerobot mass pa10_wrist --q 0 45 0 90 0 -45 0 --deg --direction 1 0 0 --aim      (the hand that `simulate` has)
  spacerobot mass panda --q 0 -0.5 0 -2 0 1.5 0.8 --frame panda_hand_tcp --set panda_finger_joint1=0.02
  spacerobot mass pa10_wrist --deg --q 0 45 0 90 0 -45 0 --joints servo --servo-stiffness 1e5 --servo-damping 50 \\
      --wrist-stiffness 530 --target-mass 9 --out mass-out
  spacerobot mass pa10_wrist --deg --q 0 45 0 90 0 -45 0 --to 0 10 0 60 0 20 0 --out mass-out --pictures

Directions are in world axes and have length 1. A free wrist slider is carried along sideways but slides along its
axis. Infinity is written "inf" in JSON."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.epilog = _EPILOG
    parser.add_argument("robot", metavar="ROBOT", help="name of a robot (see `spacerobot robots`) or a URDF file")
    pose = parser.add_argument_group("pose")
    pose.add_argument("--q", nargs="+", metavar="X", help="joint positions, base to tip, one per joint of the arm")
    pose.add_argument("--deg", action="store_true", help="angles of --q and --set are degrees, not radians")
    pose.add_argument("--set", nargs="+", action="extend", metavar="JOINT=VALUE", default=[], help="other joints")
    what = parser.add_argument_group("what is asked")
    what.add_argument("--direction", nargs="+", metavar="X", default=["1", "0", "0"], help="default: 1 0 0")
    what.add_argument("--aim", action="store_true", help="turn the wrist against the direction first, as a scene does")
    what.add_argument("--frame", help="where it is felt; default: the wrist mount, or the arm's tip")
    what.add_argument("--base", help="fixed or free; default: free if the robot floats")
    what.add_argument("--joints", default="free", help="free (default), locked or servo")
    what.add_argument("--slider", default="free", help="of the wrist: free (default) or locked")
    servo = parser.add_argument_group("servo joints: one value, or one per joint")
    servo.add_argument("--servo-stiffness", nargs="+", metavar="K", help="N m/rad")
    servo.add_argument("--servo-damping", nargs="+", metavar="D", help="N m s/rad; default: 0")
    servo.add_argument("--frequency", metavar="HZ", help="default: of the contact, from the next two options")
    servo.add_argument("--wrist-stiffness", metavar="K", help="spring of the wrist, N/m")
    hit = parser.add_argument_group("impact")
    hit.add_argument("--target-mass", metavar="KG", help="mass of a point target that hits along the direction")
    hit.add_argument("--restitution", metavar="E", help="0 to 1; default: 1")
    hit.add_argument("--speed", metavar="V", help="approach speed, m/s; default: 1")
    output = parser.add_argument_group("output")
    output.add_argument("--json", action="store_true", help="print one JSON object")
    output.add_argument("--out", metavar="DIR", help="also write mass.json (servo: and apparent_mass.csv) there")
    output.add_argument("--pictures", action="store_true", help="with --out: also mass.html and its pictures")
    output.add_argument("--to", nargs="+", metavar="X", help="with --pictures: pose where a path ends, as --q")
    output.add_argument("--overwrite", action="store_true", help="replace a run that is in DIR")


def run(args: argparse.Namespace) -> int:
    """Run the command."""
    from spacerobot.cli.mass_run import run as work

    return work(args)
