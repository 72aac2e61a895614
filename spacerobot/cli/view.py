"""`spacerobot view`: a robot, a capture or a recording as a scene to look at."""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from spacerobot.view.scene3d.serve import PageServer

_EPILOG = """\
examples:
  spacerobot view pa10_wrist --html arm.html
  spacerobot view panda --q 0 -0.5 0 -2 0 1.5 0.8 --html panda.html
  spacerobot view pa10_wrist --deg --q 0 45 0 90 0 -45 0 --to 0 10 0 60 0 20 0 --html path.html
  spacerobot view chaser_pa10_wrist --map --joints locked --html map.html
  spacerobot view scene.toml --html capture.html
  spacerobot view capture-out/trajectory.npz --html capture.html
  spacerobot view guide-friction --trial 05 --html trial.html
  spacerobot view report/verdict.json --html found.html
  spacerobot view pa10_wrist --live
  spacerobot view scene.toml --live

A robot moves its joints in turn; a scene is simulated; a study's trial is simulated beside its recording. The file
opens offline in any browser, loads nothing and is made without starting any server. --live serves the page on this
machine's loopback address only, at a random port: of a robot (without --to or --map) with a slider for each joint,
the effective mass at its tip as they move; of all else the same page, made anew at every reload. In the page: space
plays, arrow keys step, 1 to 5 choose a view; FILE#t=0.5&view=contact opens it still at a time and a view."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.epilog = _EPILOG
    parser.add_argument("what", metavar="WHAT", help="a robot or URDF, scene, trajectory, study or verdict")
    parser.add_argument("--html", metavar="FILE", help="write the page there; default: NAME.html in this folder")
    parser.add_argument("--live", action="store_true", help="serve it on loopback until Ctrl-C; a robot with sliders")
    parser.add_argument("--trial", metavar="ID", help="of a study; default: the first")
    parser.add_argument("--data", metavar="DIR", help="folder that a study's files are relative to")
    parser.add_argument("--q", nargs="+", metavar="X", help="of a robot: joint positions, base to tip")
    parser.add_argument(
        "--to", nargs="+", metavar="X", help="of a robot: move there from --q, the effective mass shown"
    )
    parser.add_argument("--deg", action="store_true", help="angles of --q and --to are degrees, not radians")
    parser.add_argument("--map", action="store_true", help="of a robot: effective mass over its workspace")
    parser.add_argument("--direction", nargs="+", metavar="X", help="with --to or --map: along which; default: 1 0 0")
    parser.add_argument("--joints", help="with --map, or a robot's --live: free (default) or locked")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--overwrite", action="store_true", help="replace FILE if it is there")


def run(args: argparse.Namespace) -> int:
    """Run the command."""
    from spacerobot.support.errors import InputError
    from spacerobot.support.files import may_write, write_text
    from spacerobot.support.jsonio import dumps
    from spacerobot.support.numbers import parse_numbers
    from spacerobot.view.scene3d.choose import film_of, kind_of
    from spacerobot.view.scene3d.page import page
    from spacerobot.view.scene3d.serve import PageServer

    pose, end = (
        None if given is None else parse_numbers(given, name) for given, name in ((args.q, "--q"), (args.to, "--to"))
    )
    if args.deg:
        if pose is None and end is None:
            raise InputError("says how to read --q, which is not given", where="--deg")
        pose, end = (None if given is None else [math.radians(p) for p in given] for given in (pose, end))
    if args.map and end is not None:
        raise InputError("a map has no path", valid="--map or --to", where="--to")
    mass = args.map or end is not None
    sliders = args.live and not mass
    for option, value, along, wanted in (
        ("--direction", args.direction, mass, "--to or --map"),
        ("--joints", args.joints, args.map or sliders, "--map or a robot's --live"),
    ):
        if value is not None and not along:
            raise InputError(f"goes with {wanted}", where=option)

    def make() -> str:
        if not mass:
            return page(film_of(args.what, trial=args.trial, data=args.data, pose=pose))
        from spacerobot.view.mass.choose import mass_film

        along = parse_numbers(args.direction or ["1", "0", "0"], "--direction", count=3, names=("x", "y", "z"))
        return page(mass_film(args.what, pose, end, along, joints=args.joints or "free"))

    if args.live:
        if args.html is not None:
            raise InputError("--live writes no file", given=args.html, valid="either of them", where="--html")
        if sliders:
            kind, path = kind_of(args.what, trial=args.trial, data=args.data, q=pose, joints=args.joints)
            if kind == "robot":
                from spacerobot.view.live.live_view import live_view

                view = live_view(path if path.is_file() else args.what, pose=pose, joints=args.joints or "free")
                return _serve(view.server(), args.json)
        make()  # what cannot be shown is said here, not in the browser
        return _serve(PageServer(make), args.json)
    target = Path(args.html) if args.html is not None else Path(f"{_stem(args.what)}.html")
    may_write(target, "a file", args.overwrite)
    text = make()
    write_text(target, text)
    answer = {"page": str(target.resolve()), "bytes": len(text.encode())}
    print(dumps(answer) if args.json else f"{target} ({len(text.encode()) / 1e6:.1f} MB): open it in a browser")
    return 0


def _serve(server: PageServer, as_json: bool) -> int:
    from spacerobot.support.jsonio import dumps

    print(dumps({"url": server.url}) if as_json else f"{server.url}\nCtrl-C ends it.", flush=True)
    try:
        server.serve()
    except KeyboardInterrupt:
        print("ended", file=sys.stderr)
    finally:
        server.close()
    return 0


def _stem(what: str) -> str:
    path = Path(what.rstrip("/"))
    return (
        path.parent.name
        if path.name in ("study.toml", "trajectory.npz", "scene.toml", "verdict.json") and path.parent.name
        else path.stem
    )
