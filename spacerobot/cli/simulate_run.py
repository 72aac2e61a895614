"""What `spacerobot simulate` does once its arguments are read."""

from __future__ import annotations

import argparse
import csv
import io
import json
import sys
import warnings
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from spacerobot.cli.effect_files import read_text, run_effect_files
from spacerobot.cli.simulate_report import as_text
from spacerobot.dynamics.joint_kinds import angular
from spacerobot.dynamics.pose_limits import PoseLimitWarning
from spacerobot.model.spacecraft import SpacecraftSpec
from spacerobot.simulation.extrapolated import ExtrapolationWarning
from spacerobot.simulation.parts import EffectAt, Servo
from spacerobot.simulation.prediction import predict, predict_exact
from spacerobot.simulation.room import StartWarning, met_at_start
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.scene_file import read_scene
from spacerobot.simulation.simulate import default_duration, simulate
from spacerobot.simulation.trajectory import Trajectory
from spacerobot.support.errors import InputError
from spacerobot.support.jsonio import dumps
from spacerobot.support.numbers import parse_assignments, parse_numbers, to_radians
from spacerobot.support.progress import Progress
from spacerobot.support.runs import RunFolder, combined_hash

_PARTS: dict[str, dict[str, str]] = {
    "wrist": {
        "wrist_mass": "mass",
        "wrist_stiffness": "stiffness",
        "wrist_damping": "damping",
        "equivalent_damping": "equivalent_damping",
        "guide_friction": "guide_friction",
    },
    "contact": {
        "contact_stiffness": "stiffness",
        "contact_damping": "damping",
        "exponent": "exponent",
        "chi_over_k": "chi_over_k",
        "mu": "mu",
        "adhesion": "adhesion",
    },
    "target": {"target_mass": "mass", "speed": "speed", "gap": "gap"},
}
"""Part of a scene -> option -> field, of those that are one number."""

_SETTING = ("robot", "base", "spacecraft", "tip")
"""What decides which joints there are."""

_TABLE = ("target.x", "target.yaw", "wrist.x", "hand.x", "contact.force", "contact.penetration")
"""Channels that the CSV begins with."""


def run(args: argparse.Namespace) -> int:
    """Run the command."""
    codes = [read_text(f, "--effects") for f in args.effects]
    run_effect_files(args.effects)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", PoseLimitWarning)
        scene = _scene(args)
    said = list(dict.fromkeys(str(w.message) for w in caught if issubclass(w.category, PoseLimitWarning)))
    if met := met_at_start(scene):
        said.append(met)
    for text in said:
        print(f"spacerobot simulate: warning: {text}", file=sys.stderr)
    settings = {
        "tolerance": _number(args.tolerance, "--tolerance"),
        "rate": None if args.rate is None else _number(args.rate, "--rate"),
    }
    if args.out is None:
        answer, _ = _answer(scene, settings, said)
    else:
        robot = scene.prepared.urdf  # a URDF file may have changed under the same name
        digest = combined_hash(scene.to_toml(), robot, settings, codes)
        with RunFolder(args.out, "simulate", digest, overwrite=args.overwrite) as folder:
            if not folder.finished:
                answer, trajectory = _answer(scene, settings, said)
                folder.write("scene.toml", scene.to_toml())
                folder.write("trajectory.csv", _csv(trajectory))
                trajectory.save(folder.path("trajectory.npz"))
                folder.write("simulate.json", dumps(answer) + "\n")
                folder.finish()
            answer = json.loads((folder.folder / "simulate.json").read_text(encoding="utf-8"))
    print(dumps(answer) if args.json else as_text(answer))
    return 0


def _scene(args: argparse.Namespace) -> Scene:
    """The scene of the file or of the options, the options last."""
    file = args.what.lower().endswith(".toml")
    changes: dict[str, Any] = {}
    scene = read_scene(args.what) if file else None
    if scene is None:
        changes["robot"] = Path(args.what) if Path(args.what).suffix.lower() in (".urdf", ".xml") else args.what
    plain = Scene() if scene is None else scene
    for name in ("base", "joints", "backend"):
        if getattr(args, name) is not None:
            changes[name] = getattr(args, name)
    for name in ("approach", "gravity"):
        if getattr(args, name) is not None:
            changes[name] = tuple(parse_numbers(getattr(args, name), f"--{name}", count=3, names=("x", "y", "z")))
    for option, name in (("hand_speed", "hand_speed"), ("duration", "duration")):
        if getattr(args, option) is not None:
            changes[name] = _number(getattr(args, option), _flag(option))
    for part, fields in _PARTS.items():
        found: dict[str, Any] = {
            f: _number(getattr(args, o), _flag(o)) for o, f in fields.items() if getattr(args, o) is not None
        }
        found.update(_further(part, args))
        if found:
            changes[part] = replace(getattr(plain, part), **found)
    if args.servo_stiffness is not None:
        damping = parse_numbers(args.servo_damping or "0", "--servo-damping")
        stiffness = parse_numbers(args.servo_stiffness, "--servo-stiffness")
        changes["servo"] = Servo(*(v[0] if len(v) == 1 else v for v in (stiffness, damping)))
    elif args.servo_damping is not None:
        raise InputError("needs --servo-stiffness too", where="--servo-damping")
    if scene is not None and args.joints not in (None, "servo") and scene.servo is not None:
        changes["servo"] = None
    if args.spacecraft_mass is not None:
        changes["spacecraft"] = SpacecraftSpec(mass=_number(args.spacecraft_mass, "--spacecraft-mass"))
        changes.setdefault("base", "free")
    if args.effect:
        changes["effects"] = (*(plain.effects if scene is not None else ()), *(_effect(t) for t in args.effect))
    if args.frame is not None:
        changes["tip"] = args.frame
    if args.set:
        changes["others"] = parse_assignments(args.set, "--set")
        if args.deg:
            rough = replace(plain, **{k: v for k, v in changes.items() if k in _SETTING})
            kinds = angular(rough.prepared, changes["others"])
            values = to_radians(list(changes["others"].values()), kinds)
            changes["others"] = dict(zip(changes["others"], values, strict=True))
    if args.q is not None:
        changes["pose"] = tuple(parse_numbers(args.q, "--q"))
        if args.deg:
            rough = replace(plain, **{k: v for k, v in changes.items() if k in _SETTING})
            kinds = angular(rough.prepared, rough.prepared.chain)
            if len(kinds) == len(changes["pose"]):
                changes["pose"] = tuple(to_radians(changes["pose"], kinds))
    elif args.deg and not args.set:
        raise InputError("says how to read --q and --set, which are not given", where="--deg")
    return replace(scene, **changes) if scene is not None else Scene(**changes)


def _further(part: str, args: argparse.Namespace) -> dict[str, Any]:
    """Fields of a part that are no single number."""
    found: dict[str, Any] = {}
    if part == "contact":
        if args.law is not None:
            found["law"] = args.law
        if args.bilateral:
            found["bilateral"] = True
    if part == "target":
        for option in ("contact_point", "attitude", "spin"):
            if getattr(args, option) is not None:
                found[option] = tuple(parse_numbers(getattr(args, option), _flag(option)))
        if args.target_inertia is not None:
            numbers = parse_numbers(args.target_inertia, "--target-inertia")
            if len(numbers) not in (1, 3, 9):
                raise InputError(
                    "wrong length", given=f"{len(numbers)} numbers", valid="1, 3 or 9 numbers", where="--target-inertia"
                )
            if len(numbers) == 1:
                found.update(yaw_inertia=numbers[0], inertia=None)
            else:
                rows = numbers if len(numbers) == 3 else [numbers[0:3], numbers[3:6], numbers[6:9]]
                found.update(inertia=rows, yaw_inertia=None)
    return found


def _effect(text: str) -> EffectAt:
    name, at, rest = text.partition("@")
    where, _, values = rest.partition(":")
    if not (name and at and where):
        raise InputError("cannot be read", given=text, valid="NAME@WHERE:PARAMETER=VALUE,...", where="--effect")
    return EffectAt(name, where, parse_assignments([values], f"--effect {name}") if values else {})


def _answer(scene: Scene, settings: dict[str, Any], said: list[str]) -> tuple[dict[str, Any], Trajectory]:
    with Progress("simulating", 1, unit="scene"):  # which says so where it compiles for minutes, the first time
        return _simulated(scene, settings, said)


def _simulated(scene: Scene, settings: dict[str, Any], said: list[str]) -> tuple[dict[str, Any], Trajectory]:
    end = scene.duration if scene.duration is not None else default_duration(scene)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("ignore", StartWarning)  # said above, in the command's own words
        warnings.simplefilter("always", ExtrapolationWarning)
        trajectory = simulate(scene, duration=end, tolerance=settings["tolerance"], rate=settings["rate"])
    for warned in caught:
        print(f"warning: {warned.message}", file=sys.stderr)
    said = [*said, *(str(w.message) for w in caught)]
    predicted = predict(scene)
    exact = predict_exact(scene, end)
    ledger = trajectory.ledger
    return {
        "robot": scene.prepared.name,
        "base": scene.base,
        "joints": scene.joints,
        "backend": trajectory.backend,
        "duration_s": end,
        "hand": {"effective_mass_kg": scene.hand.mass, "stiffness_N_m": scene.hand.stiffness, "note": scene.hand.note},
        "predicted": None if predicted is None else asdict(predicted),
        "predicted_three_masses": None if exact is None else asdict(exact),
        "simulated": asdict(trajectory.restitution),
        "energy": {
            "initial_J": ledger.initial,
            "imbalance": ledger.closure,
            "dissipated_J": {k: float(v[-1]) for k, v in ledger.dissipated.items()},
        },
        "peak_contact_force_N": trajectory.peak_force.value,
        "peak_contact_force_s": trajectory.peak_force.time,
        "events": [asdict(e) for e in trajectory.events],
        "effects": [{"effect": e.effect, "where": e.where, "parameters": dict(e.parameters)} for e in scene.effects],
        "notes": list(scene.notes),
        "warnings": said,
    }, trajectory


def _csv(trajectory: Trajectory) -> str:
    names = [n for n in _TABLE if n in trajectory.channels]
    names += [n for n in trajectory.channels if n not in names]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["time [s]", *(f"{n} [{trajectory.units[n]}]" for n in names)])
    columns = [trajectory.time, *(trajectory.channels[n] for n in names)]
    writer.writerows([[f"{v:.10g}" for v in row] for row in zip(*columns, strict=True)])
    return text.getvalue()


def _flag(option: str) -> str:
    return "--" + option.replace("_", "-")


def _number(token: str, what: str) -> float:
    return parse_numbers([token], what, count=1)[0]
