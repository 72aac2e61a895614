"""Where the time of a trial, a pose and a hypothesis goes, and what none of them can do without."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks.diagnosis import PLAIN, START, STUDY
from benchmarks.timing import costs
from benchmarks.trials import SCENES, TARGET, WRIST
from benchmarks.where_page import page as page
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.dynamics.batch import effective_mass_batch
from spacerobot.model.library import load
from spacerobot.recordings.study import load_study, resolve_study
from spacerobot.simulation.exact.batch import collide
from spacerobot.simulation.exact.structure import piecewise_linear
from spacerobot.simulation.multibody.assembly import assemble_bodies
from spacerobot.simulation.multibody.dynamics import Dynamics
from spacerobot.simulation.multibody.machine import GUARDS, RATES
from spacerobot.simulation.multibody.run import integrate_scene
from spacerobot.simulation.reduced.run import prepare, simulate
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import default_duration, reduced_start

NAME, TITLE = "where", "Where the time goes, and the limit"
TOLERANCE = 1e-6


def measure(quick: bool) -> dict[str, Any]:
    """Each by itself."""
    repeats = 2 if quick else 7
    return {
        "tolerance": TOLERANCE,
        "multibody": [_multibody(label, repeats) for label in list(SCENES)[: 1 if quick else None]],
        "reduced": _reduced(repeats),
        "pose": _pose(repeats, 500 if quick else 20_000),
        "hypothesis": _hypothesis(repeats),
    }


def _scene(label: str) -> Scene:
    robot, joints = SCENES[label]
    return Scene(load(robot), joints=joints, wrist=WRIST, target=TARGET, backend="reduced")


def _multibody(label: str, repeats: int) -> dict[str, Any]:
    """Calls times what one costs: right-hand sides, guards, the assembly; the rest is the loop around them."""
    scene = _scene(label)
    end, mechanism = default_duration(scene), scene.mechanism("multibody")
    run = integrate_scene(scene, end, tolerance=TOLERANCE)
    rates, guards = run.dynamics.settings[[RATES, GUARDS]].astype(int).tolist()
    assembly = assemble_bodies(scene, mechanism)
    dynamics = Dynamics(assembly, mechanism)
    y, out, slope = np.zeros(dynamics.size), np.empty(dynamics.size), np.empty(dynamics.size)
    y[: dynamics.nq] = assembly.configuration
    y[dynamics.nq : dynamics.nq + dynamics.nv] = assembly.velocity
    signs, model, data = np.empty(dynamics.modes.size), assembly.model, assembly.model.createData()
    q, v, tau = np.array(assembly.configuration), np.array(assembly.velocity), np.zeros(model.nv)
    found = costs(
        {
            "trial": lambda: integrate_scene(scene, end, tolerance=TOLERANCE),
            "assembly": lambda: Dynamics(assemble_bodies(scene, mechanism), mechanism),
            "rate": lambda: dynamics.rate(0.0, y, out),
            "guard": lambda: dynamics.guard(0.0, y, signs, slope),
            "pin.aba": lambda: pin.aba(model, data, q, v, tau),
        },
        repeats=repeats,
    )
    return {
        "scene": label,
        "rates": rates,
        "guards": guards,
        "steps": int(run.steps.time.size),
        "events": len(run.events),
        "seconds": {k: c.median for k, c in found.items()},
    }


def _reduced(repeats: int) -> dict[str, Any]:
    """The compiled loop, beside making the mechanism's arrays and the way into the loop and out of it."""
    scene = _scene("held arm")
    mechanism, end = scene.mechanism("reduced"), default_duration(scene)
    prepared, (position, velocity) = prepare(mechanism), reduced_start(scene)
    structure, numbers = piecewise_linear(scene)
    many = np.tile(numbers, (500, 1))

    def run(until: float) -> Any:
        return simulate(prepared, position=position, velocity=velocity, end=until, tolerance=TOLERANCE)

    found = costs(
        {
            "prepare": lambda: prepare(mechanism),
            "in and out": lambda: run(1e-9),
            "trial": lambda: run(end),
            "exact, 500": lambda: collide(structure, many),
        },
        repeats=repeats,
    )
    seconds = {k: c.median for k, c in found.items()}
    seconds["exact"] = seconds.pop("exact, 500") / len(many)
    done = run(end)
    return {"steps": int(done.steps.time.size), "events": len(done.events), "seconds": seconds}


def _pose(repeats: int, count: int) -> dict[str, Any]:
    """One pose of many, and what it computes and moves."""
    robot = load("pa10_wrist")
    poses = np.random.default_rng(1).uniform(-1.0, 1.0, (count, len(robot.chain)))
    found = costs({"poses": lambda: effective_mass_batch(robot, poses)}, repeats=repeats)
    n = robot.model.nv
    return {
        "joints": n,
        "operations": operations(n),
        "bytes": 8 * (len(robot.chain) + 9 + 1),
        "seconds": found["poses"].median / count,
    }


def operations(n: int) -> int:
    """Additions and multiplications of G = J H^-1 J^T in a chain of n joints, counted in the kernel's source."""
    place, gather = 81 + 18, 170
    compose = 60 + 11 * (n + 1) // 2 + 13
    return n * (place + gather + compose) + n**3 // 3 + 3 * n**2 + 6 * 2 * n


def _hypothesis(repeats: int) -> dict[str, Any]:
    """A fit from a cold start: its simulations, timed one by one, and what is left."""
    workshop = Workshop(load_study(resolve_study(STUDY)))

    def fit() -> Any:
        return workshop.run(Task(PLAIN, START))

    done = fit()
    calls: list[float] = []
    with _timed(workshop.model, "predict", calls):
        begun = time.process_time()
        fit()
        inside = sum(calls) / (time.process_time() - begun)
    found = costs({"fit": fit}, repeats=repeats)
    return {
        "trials": len(workshop.trials),
        "samples": sum(t.samples for t in workshop.trials),
        "free": len(done.hypothesis.free),
        "iterations": done.iterations,
        "simulations": len(calls),
        "share": inside,
        "seconds": found["fit"].median,
    }


@contextlib.contextmanager
def _timed(owner: Any, name: str, calls: list[float]) -> Iterator[None]:
    original: Callable[..., Any] = getattr(owner, name)

    def timing(*args: Any, **options: Any) -> Any:
        begun = time.process_time()
        found = original(*args, **options)
        calls.append(time.process_time() - begun)
        return found

    setattr(owner, name, timing)
    try:
        yield
    finally:
        delattr(owner, name)
