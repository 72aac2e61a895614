"""`spacerobot robots`: which robots can be loaded, and what one of them is."""

from __future__ import annotations

import argparse
from typing import Any

from spacerobot.support.jsonio import dumps, plain

_EPILOG = """examples:
  spacerobot robots                        every robot known by name
  spacerobot robots pa10_wrist             one of them: joints, limits, rotor inertias, frames
  spacerobot robots panda --wrist --json   with the compliant wrist attached to its tip
  spacerobot robots my_arm.urdf --package-dir ~/ros/share --out my_arm
                                           any URDF; --out writes the URDF that was understood
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.epilog = _EPILOG
    parser.add_argument("robot", nargs="?", help="a name, a URDF file or URDF text; all names if absent")
    parser.add_argument("--tip", metavar="FRAME", help="frame at the end of the arm")
    parser.add_argument("--wrist", action="store_true", help="attach the compliant wrist to the tip")
    parser.add_argument("--chaser", action="store_true", help="put the arm on the default free-flying spacecraft")
    parser.add_argument("--package-dir", action="append", default=[], metavar="DIR", help="folder of package:// meshes")
    parser.add_argument("--json", action="store_true", help="one JSON object on stdout")
    parser.add_argument("--out", metavar="DIR", help="write robots.json there, and the URDF of the one robot")
    parser.add_argument("--overwrite", action="store_true", help="replace another run in DIR")


def run(args: argparse.Namespace) -> int:
    """List the robots, or show one."""
    urdf = None
    if args.robot is None:
        report = _all()
        text = _table(report["robots"])
    else:
        report, urdf = _one(args)
        text = _card(report["robot"])
    if args.out:
        _write(args, report, urdf)
    print(dumps(report) if args.json else text)
    return 0


def _all() -> dict[str, Any]:
    from spacerobot.model import examples
    from spacerobot.model.describe import summary
    from spacerobot.model.library import bundled

    return {"robots": [summary(name) for name in (*bundled(), *examples.names())]}


def _one(args: argparse.Namespace) -> tuple[dict[str, Any], str | None]:
    from spacerobot.model.describe import figures, other_joints
    from spacerobot.model.library import load
    from spacerobot.model.spacecraft import float_base
    from spacerobot.model.wrist import attach_wrist

    robot = load(args.robot, tip=args.tip, package_dirs=args.package_dir)
    if args.wrist:
        robot = attach_wrist(robot)
    if args.chaser:
        robot = float_base(robot)
    urdf = None
    if args.out:
        from spacerobot.model.yourdf import urdf_text

        urdf = urdf_text(robot)
    report = {
        "name": robot.name,
        **figures(robot),
        "slider": robot.slider,
        "contact": robot.contact,
        "joints": robot.joint_rows(),
        "other_joints": other_joints(robot),
    }
    return {"robot": report}, urdf


def _write(args: argparse.Namespace, report: dict[str, Any], urdf: str | None) -> None:
    from spacerobot.support.runs import RunFolder, combined_hash

    with RunFolder(args.out, "robots", combined_hash(plain(report), urdf), overwrite=args.overwrite) as folder:
        if not folder.finished:
            folder.write("robots.json", dumps(report) + "\n")
            if urdf is not None:
                folder.write("robot.urdf", urdf)
            folder.finish()


def _table(rows: list[dict[str, Any]]) -> str:
    lines = [f"{'name':26} {'dof':>3} {'mass kg':>8} {'base':5} {'tip':26} notes"]
    for row in rows:
        if row["refused"]:
            continue
        notes = "; ".join(n for n in (row["notes"], "with rotor inertia" if row["rotor_inertia"] else "") if n)
        figures = f"{row['dof']:3d} {row['mass_kg']:8.2f} {row['base']:5}"
        lines.append(f"{row['name']:26} {figures} {row['tip']:26} {notes}".rstrip())
    refused = [row for row in rows if row["refused"]]
    if refused:
        lines += ["", "refused:", *(f"  {row['refused']}" for row in refused)]
    return "\n".join(lines)


def _card(robot: dict[str, Any]) -> str:
    size = f"{robot['dof']} joints to {robot['tip']}, {robot['mass_kg']:.2f} kg"
    lines = [
        f"{robot['name']}: {size}, base {robot['base']}",
        f"{'joint':28} {'lower':>9} {'upper':>9} {'velocity':>9} {'effort':>8} {'rotor':>9}  unit",
    ]
    lines += [
        f"{j['name']:28} {j['lower']:9.4g} {j['upper']:9.4g} {j['velocity_limit']:9.4g} "
        f"{j['effort_limit']:8.4g} {j['rotor_inertia']:9.4g}  {j['unit']}"
        for j in robot["joints"]
    ]
    if robot["wrist"]:
        lines.append(f"wrist: slider {robot['slider']} (positive pushed in), contact frame {robot['contact']}")
    if robot["other_joints"]:
        lines.append(f"joints outside of the chain: {', '.join(robot['other_joints'])}")
    return "\n".join(lines)
