"""`spacerobot simulate`: a wrist meets a free-flying body; predicted beside simulated."""

from __future__ import annotations

import argparse

_EPILOG = """\
examples:
  spacerobot simulate pa10_wrist --wrist-stiffness 530 --wrist-damping 2 --target-mass 9 --speed 0.07
  spacerobot simulate chaser_pa10_wrist --joints free --speed 0.05 --gap 0.01 --json
  spacerobot simulate pa10_wrist --effect coulomb_friction@wrist:force_N=0.4 --out friction
  spacerobot simulate scene.toml --backend reduced --out reduced

A scene file has the tables wrist, contact, target, servo, chaser, spacecraft and [[effects]]; `--out` writes the scene
of any run as scene.toml, a file to start from. Options given beside a file replace what the file says. x grows along
the approach; times in s, SI units. Restitution is that of the target alone, of target against hand, and at the contact
point; contact time is first touch to last separation."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.epilog = _EPILOG
    parser.add_argument("what", metavar="SCENE.toml|ROBOT", help="a scene file, a robot's name, or a URDF file")
    robot = parser.add_argument_group("robot")
    robot.add_argument("--base", help="fixed or free; default: free if the robot floats")
    robot.add_argument("--joints", help="locked (default), free or servo")
    robot.add_argument("--q", nargs="+", metavar="X", help="joint positions, base to tip")
    robot.add_argument("--deg", action="store_true", help="angles of --q and --set are degrees, not radians")
    robot.add_argument("--set", nargs="+", action="extend", metavar="JOINT=VALUE", default=[], help="other joints")
    robot.add_argument("--frame", help="that carries the wrist, of a robot that has none; default: the arm's tip")
    robot.add_argument("--servo-stiffness", nargs="+", metavar="K", help="N m/rad, one value or one per joint")
    robot.add_argument("--servo-damping", nargs="+", metavar="D", help="N m s/rad; default: 0")
    robot.add_argument("--spacecraft-mass", metavar="KG", help="put the arm on a box of this mass that floats")
    robot.add_argument("--hand-speed", metavar="V", help="of a free chaser as a whole, toward the target, m/s")
    wrist = parser.add_argument_group("wrist")
    wrist.add_argument("--wrist-mass", metavar="KG", help="of the slider; default: 0.7")
    wrist.add_argument("--wrist-stiffness", metavar="K", help="N/m; default: 1020")
    wrist.add_argument("--wrist-damping", metavar="C", help="N s/m; default: 0")
    wrist.add_argument("--equivalent-damping", metavar="C", help="that stands for guide friction, N s/m; default: 0")
    wrist.add_argument("--guide-friction", metavar="F", help="Coulomb friction of the guide, N; default: 0")
    contact = parser.add_argument_group("contact")
    contact.add_argument("--contact-stiffness", metavar="K", help="N/m (at 1 mm); default: 68000")
    contact.add_argument("--contact-damping", metavar="C", help="N s/m; default: 0")
    contact.add_argument("--law", help="kelvin_voigt (default), hertz or hunt_crossley")
    contact.add_argument("--exponent", metavar="N", help="of the contact law, if another than its own")
    contact.add_argument("--chi-over-k", metavar="X", help="damping of Hunt and Crossley over stiffness, s/m")
    contact.add_argument(
        "--bilateral", action="store_true", default=None, help="the contact pulls (the paper's reading)"
    )
    contact.add_argument("--mu", help="Coulomb friction at the contact point; default: 0")
    contact.add_argument("--adhesion", metavar="F", help="tension before the surfaces part, N; default: 0")
    target = parser.add_argument_group("target")
    target.add_argument("--target-mass", metavar="KG", help="default: 9")
    target.add_argument("--target-inertia", nargs="+", metavar="I", help="1, 3 or 9 numbers, kg m^2")
    target.add_argument("--contact-point", nargs="+", metavar="X", help="ahead, lateral (and up) of its centre, m")
    target.add_argument("--attitude", nargs="+", metavar="X", help="roll, pitch, yaw in the approach axes, rad")
    target.add_argument("--spin", nargs="+", metavar="X", help="angular velocity, world axes, rad/s")
    target.add_argument("--speed", metavar="V", help="along the approach, m/s; default: 0.1")
    target.add_argument("--gap", metavar="X", help="to the wrist's tip at the start, m; default: 0")
    scene = parser.add_argument_group("scene")
    scene.add_argument("--approach", nargs="+", metavar="X", help="unit vector, world axes; default: along the hand")
    scene.add_argument("--gravity", nargs="+", metavar="X", help="m/s^2, world axes; default: 0 0 0")
    scene.add_argument(
        "--effect", action="append", default=[], metavar="NAME@WHERE:PARAMETER=VALUE,...", help="may be repeated"
    )
    scene.add_argument(
        "--effects", action="append", default=[], metavar="FILE.py", help="run FILE.py, which adds effects"
    )
    run = parser.add_argument_group("run")
    run.add_argument("--backend", help="multibody (default) or reduced")
    run.add_argument("--duration", metavar="S", help="default: arrival and four predicted contact times")
    run.add_argument("--tolerance", metavar="X", default="1e-9", help="of the integration; default: 1e-9")
    run.add_argument("--rate", metavar="HZ", help="samples a second; default: 1000, fewer in a run of many minutes")
    output = parser.add_argument_group("output")
    output.add_argument("--json", action="store_true", help="print one JSON object")
    output.add_argument("--out", metavar="DIR", help="write simulate.json, scene.toml, trajectory.npz and .csv there")
    output.add_argument("--overwrite", action="store_true", help="replace a run that is in DIR")


def run(args: argparse.Namespace) -> int:
    """Run the command."""
    from spacerobot.cli.simulate_run import run as work

    return work(args)
