"""What `spacerobot mass` does once its arguments are read."""

from __future__ import annotations

import argparse
import math
import sys
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from spacerobot.cli.mass_report import as_json, as_text, response_table
from spacerobot.dynamics.apparent_mass import apparent_mass
from spacerobot.dynamics.direction import unit_directions
from spacerobot.dynamics.effective_mass import EffectiveMass, effective_mass
from spacerobot.dynamics.impact import Impact, impact
from spacerobot.dynamics.joint_kinds import angular
from spacerobot.dynamics.pose_limits import PoseLimitWarning
from spacerobot.model.library import load
from spacerobot.model.robot import Robot
from spacerobot.model.wrist import aim
from spacerobot.simulation.parts import Servo
from spacerobot.support.errors import InputError
from spacerobot.support.jsonio import dumps
from spacerobot.support.numbers import parse_assignments, parse_numbers, to_radians
from spacerobot.support.runs import RunFolder, combined_hash

_PA10 = ("S1", "S2", "S3", "E1", "E2", "W1", "W2")
_PA10_POSE = tuple(math.radians(x) for x in (0, 45, 0, 90, 0, -45, 0))


def run(args: argparse.Namespace) -> int:
    """Run the command."""
    robot, notes = _robot(args)
    pose, others, said = _pose(robot, args)
    direction = parse_numbers(args.direction, "--direction", count=3, names=("x", "y", "z"))
    options: dict[str, Any] = {
        "frame": args.frame,
        "base": args.base,
        "slider": args.slider,
    }
    servo = _servo(args)
    frequency = _number(args.frequency, "--frequency")
    target = _number(args.target_mass, "--target-mass")
    stiffness = _number(args.wrist_stiffness, "--wrist-stiffness")

    def felt(by: Robot) -> EffectiveMass:
        return effective_mass(
            by,
            pose,
            direction,
            joints=args.joints,
            others=others,
            omega=None if frequency is None else 2.0 * math.pi * frequency,
            wrist_stiffness=stiffness,
            target_mass=target,
            servo=servo,
            **options,
        )

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PoseLimitWarning)  # said below, in the command's own words
        if args.aim and robot.slider is None:
            raise InputError("there is no wrist to aim", given=robot.name, valid="a robot with a wrist", where="--aim")
        against = unit_directions(direction, where="--direction")
        aimed = robot if robot.slider is None else aim(robot, pose, against)
        robot = aimed if args.aim else robot
        result = felt(robot)
        # servos of a scene have no frequency of their own to be compared at
        known = aimed.slider is not None and args.frame is None and args.joints != "servo"
        as_scene = felt(aimed).effective_mass_kg if known else None
    q = robot.configuration(pose, others=others)
    answer = as_json(result, robot.chain, [*notes, *said], _impact(robot, q, args, target, options))
    answer["notes"] += _otherwise(result, as_scene)
    answer.update(aimed=bool(args.aim), aimed_effective_mass_kg=as_scene)
    for text in result.warnings:
        print(f"spacerobot mass: warning: {text}", file=sys.stderr)
    files = _pictures(args, robot, pose, direction)
    if args.out is not None:
        _write(args, robot, q, direction, result, answer, options, servo, files)
    print(dumps(answer) if args.json else as_text(answer, angular(robot, robot.chain)))
    return 0


def _otherwise(result: EffectiveMass, as_scene: float | None) -> list[str]:
    """What to say where a scene, which turns the wrist against the target's way, has another hand."""
    if as_scene is None or math.isclose(result.effective_mass_kg, as_scene, rel_tol=1e-9):
        return []
    return [
        "the wrist points as the robot has it; a scene of this direction turns it to point against that, and "
        f"`simulate` has {as_scene:.6g} kg there (--aim)"
    ]


def _robot(args: argparse.Namespace) -> tuple[Robot, list[str]]:
    robot = load(args.robot)
    if args.base != "free" or robot.floating:
        return robot, []
    robot = load(args.robot, floating=True)
    mass = robot.model.inertias[1].mass
    return robot, [
        f"{robot.name} floats on its own base link of {mass:g} kg; for a spacecraft use a chaser or float_base"
    ]


def _pose(robot: Robot, args: argparse.Namespace) -> tuple[np.ndarray, dict[str, float], list[str]]:
    """Positions of the chain, of other joints, and what to say about them."""
    turning = angular(robot, robot.chain)
    named = parse_assignments(args.set, "--set")
    if args.deg:
        named = dict(zip(named, to_radians(list(named.values()), angular(robot, named)), strict=True))
    said = []
    if args.q is not None:
        values = parse_numbers(args.q, "--q", count=len(robot.chain), names=robot.chain)
        pose = np.array(to_radians(values, turning) if args.deg else values)
        twice = [name for name in named if name in robot.chain]
        if twice:
            raise InputError("--set names a joint that --q has set", given=", ".join(twice))
    else:
        pose = np.array(_PA10_POSE if robot.chain == _PA10 else np.zeros(len(robot.chain)))
        where = "0, 45, 0, 90, 0, -45, 0 deg" if robot.chain == _PA10 else "all joints at zero"
        said.append(f"no --q given: {where}")
        for i, name in enumerate(robot.chain):
            pose[i] = named.pop(name, pose[i])
    return pose, named, said


def _impact(
    robot: Robot, q: np.ndarray, args: argparse.Namespace, target: float | None, options: dict[str, Any]
) -> Impact | None:
    """The impact that --target-mass asks for; of joints that are free where they are servo-held."""
    restitution, speed = _number(args.restitution, "--restitution"), _number(args.speed, "--speed")
    if target is None:
        if restitution is not None or speed is not None:
            raise InputError("an impact needs a target", valid="--target-mass KG")
        return None
    return impact(
        robot,
        q,
        parse_numbers(args.direction, "--direction", count=3),
        approach_speed=1.0 if speed is None else speed,
        restitution=1.0 if restitution is None else restitution,
        target_mass=target,
        joints="locked" if args.joints == "locked" else "free",
        **options,
    )


def _write(
    args: argparse.Namespace,
    robot: Robot,
    q: np.ndarray,
    direction: list[float],
    result: EffectiveMass,
    answer: dict[str, Any],
    options: dict[str, Any],
    servo: Servo | None,
    pictures: Callable[[], dict[str, str | bytes]],
) -> None:
    shown = [args.to, args.deg, args.speed] if args.pictures else None
    with RunFolder(args.out, "mass", combined_hash(robot.urdf, answer, shown), overwrite=args.overwrite) as folder:
        if folder.finished:
            return
        folder.write("mass.json", dumps(answer) + "\n")
        if result.omega_rad_s is not None:
            omega = result.omega_rad_s * np.logspace(-2.0, 2.0, 401)
            response = apparent_mass(robot, q, direction, omega, servo=servo, **options)
            folder.write("apparent_mass.csv", response_table(response))
        for name, content in pictures().items():
            folder.write(name, content)
        folder.finish()


def _pictures(
    args: argparse.Namespace, robot: Robot, pose: np.ndarray, direction: list[float]
) -> Callable[[], dict[str, str | bytes]]:
    """What makes the files that --pictures asks for, checked before anything is written."""
    if not args.pictures:
        if args.to is not None:
            raise InputError("goes with --pictures", where="--to")
        return dict
    if args.out is None:
        raise InputError("needs a folder", valid="--out DIR", where="--pictures")
    if args.frame is not None:
        raise InputError("pictures are of the hand", given=args.frame, valid="no --frame", where="--pictures")
    given: dict[str, Any] = {
        "servo_stiffness": _list(args.servo_stiffness, "--servo-stiffness"),
        "servo_damping": _list(args.servo_damping, "--servo-damping"),
        "tip_mass": _with_slider(robot, _number(args.target_mass, "--target-mass")),
        "wrist_stiffness": _number(args.wrist_stiffness, "--wrist-stiffness"),
        "speed": _number(args.speed, "--speed"),
    }
    if args.to is not None:
        values = parse_numbers(args.to, "--to", count=len(robot.chain), names=robot.chain)
        given["end"] = np.array(to_radians(values, angular(robot, robot.chain)) if args.deg else values)
    from spacerobot.view.mass.page import MassQuestion, mass_files  # loads what draws, which a plain answer can spare

    known = {key: value for key, value in given.items() if value is not None}
    asked = MassQuestion(robot, pose, np.array(direction), **known)
    return lambda: mass_files(asked)


def _with_slider(robot: Robot, target_mass: float | None) -> float | None:
    """Mass that the wrist's spring carries in a contact: the target's, with the slider's where there is one [kg]."""
    if target_mass is None or robot.slider is None:
        return target_mass
    return target_mass + float(robot.model.inertias[robot.joint_id(robot.slider)].mass)


def _servo(args: argparse.Namespace) -> Servo | None:
    stiffness = _list(args.servo_stiffness, "--servo-stiffness")
    damping = _list(args.servo_damping, "--servo-damping")
    if stiffness is None and damping is not None:
        raise InputError("needs --servo-stiffness too", where="--servo-damping")
    return None if stiffness is None else Servo(stiffness, [0.0] if damping is None else damping)


def _list(tokens: list[str] | None, what: str) -> list[float] | None:
    return None if tokens is None else parse_numbers(tokens, what)


def _number(token: str | None, what: str) -> float | None:
    return None if token is None else parse_numbers(token, what, count=1)[0]
