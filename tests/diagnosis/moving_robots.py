"""Small synthetic studies of a wrist on a robot that moves, made with the whole robot and planted physics."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from spacerobot.recordings.study import Study, load_study
from spacerobot.simulation.multibody.run import integrate_scene
from spacerobot.simulation.parts import ContactLaw, EffectAt, Servo, Target, Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.sensors import read_channels

SPEEDS = (0.03, 0.06, 0.05)
SIGMA = {"target.x": 1.5e-4, "wrist.x": 1.5e-4, "contact.force": 0.25, "joint": 5e-5, "base": 1e-4}
RATE = 400.0
BASE = ("base.position.x", "base.position.z", "base.pitch")


def moving_robot(
    folder: Path, joints: str, *planted: EffectAt, floating: bool = False, noise: float = 1.0, seed: int = 3
) -> Study:
    """Three hits on a robot whose joints are free, on servos, or locked on a base that floats."""
    random = np.random.default_rng(seed)
    robot = "chaser_pa10_wrist" if floating else "pa10_wrist"
    servo = Servo(4e3, 8.0) if joints == "servo" else None
    text = f"""format = 1
title = "a robot that moves"
[baseline]
robot = "{robot}"
base = "{"free" if floating else "fixed"}"
joints = "{joints}"
approach = [1, 0, 0]
[baseline.wrist]
mass = 0.7
stiffness = 1020
damping = 6.0
[baseline.contact]
stiffness = 68000
damping = 60
[baseline.sigma]
"wrist.stiffness" = 0.01
"wrist.damping" = 0.1
"target.mass" = 0.002
"""
    channels: list[str] = []
    for number, speed in enumerate(SPEEDS):
        mass = 9.0 + 4.0 * number
        scene = Scene(
            robot=robot,
            joints=joints,
            servo=servo,
            approach=(1.0, 0.0, 0.0),
            wrist=Wrist(mass=0.7, stiffness=1020.0, damping=6.0),
            contact=ContactLaw(stiffness=68000.0, damping=60.0),
            target=Target(mass=mass, speed=speed, gap=0.01),
            effects=planted,
        )
        end = 0.01 / speed + 0.6
        run = integrate_scene(scene, end, tolerance=1e-8)
        time = np.arange(0.0, end, 1.0 / RATE)
        chain = scene.prepared.chain
        channels = ["target.x", "wrist.x", "contact.force"]
        channels += [f"joint.{j}.position" for j in chain] if joints != "locked" else []
        channels += BASE if floating else ()
        seen = read_channels(run, run.mechanism, channels, time)
        columns = [time]
        for channel in channels:
            place = scene.pose[chain.index(channel.split(".")[1])] if channel.startswith("joint") else 0.0
            columns.append(seen[channel] + place + noise * _sigma(channel) * random.standard_normal(time.size))
        head = ",".join(["time", *channels])
        np.savetxt(folder / f"{number}.csv", np.transpose(columns), "%.9g", ",", header=head, comments="")
        text += f'[[trials]]\nid = "t{number}"\ntarget.mass = {mass}\nlog = "{number}.csv"\n'
    if servo is not None:
        for joint in chain:
            text = text.replace(
                "[baseline.sigma]", f"[baseline.joint.{joint}]\nstiffness = 4e3\ndamping = 8.0\n[baseline.sigma]"
            )
    rows = "\n".join(f'"{c}" = {{ is = "{c}", sigma = {_sigma(c)} }}' for c in channels)
    text = text.replace("[[trials]]", f'[streams.log]\ntime = "time"\n[streams.log.channels]\n{rows}\n[[trials]]', 1)
    (folder / "study.toml").write_text(text)
    return load_study(folder)


def _sigma(channel: str) -> float:
    return SIGMA.get(channel) or SIGMA[channel.split(".")[0]]


def misfit(residuals: Sequence[np.ndarray]) -> float:
    """rms of all of them."""
    return float(np.sqrt(np.mean(np.square(np.concatenate(residuals)))))
