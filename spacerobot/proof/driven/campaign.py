"""A campaign of joint logs: what the lab believes of its arm, how it is built, and its logs with their noise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spacerobot.proof.driven.arm import ROBOT, Built, Log, believed, joints, links, run
from spacerobot.proof.driven.arm import Path as Track
from spacerobot.proof.driven.hidden import hide
from spacerobot.proof.engine.missing import Missing
from spacerobot.proof.engine.rig import STANDARD_GRAVITY
from spacerobot.support.files import write_text

DURATION, RATE = 6.0, 125.0
"""Length of a trial [s] and rate of its log [Hz]."""

SPEEDS = {"slow": 0.35, "middle": 0.65, "fast": 1.0}
"""Condition -> share of the fastest path."""

PER_SPEED = 2

TORQUE_NOISE = np.array([0.15, 0.15, 0.07, 0.07, 0.02, 0.02, 0.02])
"""Of the torque sensors [N m], by joint."""

POSITION_NOISE, VELOCITY_NOISE = 2e-5, 1e-3
"""Of the encoders [rad] and of the speeds that the drives log [rad/s]."""

MASS_SIGMA, LAST_SIGMA, ROTOR_SIGMA = 0.02, 0.1, 0.05
"""How well masses of links, that of the last one, and inertia about a joint are known, as shares."""

SPREAD = 0.5
"""How far off they are, in these deviations: who states them is cautious."""


@dataclass(frozen=True)
class Campaign:
    """Joint logs before they are taken.

    Attributes:
        masses: link -> mass as built [kg].
        rotors: joint -> reflected inertia as built [kg m^2].
        tracks: trial -> where it goes; its name begins with its condition.
        hidden: what the study does not say.
        seed: of the noise.
    """

    masses: Mapping[str, float]
    rotors: Mapping[str, float]
    tracks: Mapping[str, Track]
    hidden: tuple[Missing, ...] = ()
    seed: int = 0

    def built(self) -> Built:
        """The arm with what is hidden in it."""
        found = Built(dict(self.masses), dict(self.rotors))
        for item in self.hidden:
            hide(found, item)
        return found

    def logs(self) -> dict[str, Log]:
        """Trial -> what MuJoCo makes of it, without noise."""
        return {name: run(self.built(), track, DURATION, RATE) for name, track in self.tracks.items()}


def drawn(rng: np.random.Generator) -> Campaign:
    """A campaign with nothing missing: masses and inertia a little off, paths anew."""
    masses = {n: m * (1.0 + SPREAD * mass_sigma(n) * float(rng.standard_normal())) for n, m in links().items()}
    rotors = {n: i * (1.0 + SPREAD * ROTOR_SIGMA * float(rng.standard_normal())) for n, i in believed().rotors.items()}
    tracks = {
        f"{name}-{k + 1}": Track.drawn(rng, speed, DURATION) for name, speed in SPEEDS.items() for k in range(PER_SPEED)
    }
    return Campaign(masses, rotors, tracks, seed=int(rng.integers(2**31)))


def mass_sigma(link: str) -> float:
    """Relative deviation of a link's believed mass."""
    return LAST_SIGMA if link == f"link{len(joints())}" else MASS_SIGMA


def write_study(folder: Path, campaign: Campaign, logs: Mapping[str, Log]) -> Path:
    """Write study.toml and a log for each trial, with noise and rounding; returns the study file."""
    rng = np.random.default_rng([campaign.seed, 77])
    names = joints()
    lines = ["format = 1", 'title = "An arm on its own"', "", "[baseline]", f'robot = "{ROBOT}"', 'base = "fixed"']
    lines += ['joints = "free"', f"gravity = [0, 0, {-STANDARD_GRAVITY!r}]", "", "[baseline.sigma]"]
    lines += [f'"link.{n}.mass" = {mass_sigma(n)!r}' for n in links()]
    lines += [f'"joint.{n}.mass" = {ROTOR_SIGMA!r}' for n in names]
    lines += ["", "[streams.joints]", 'time = "time_s"', "[streams.joints.channels]"]
    for n in names:
        lines.append(f'q_{n}_rad = {{ is = "joint.{n}.position", sigma = {POSITION_NOISE!r} }}')
        lines.append(f'v_{n}_rad_s = {{ is = "joint.{n}.velocity", sigma = {VELOCITY_NOISE!r} }}')
    lines += ["", "[streams.torques]", 'time = "time_s"', "[streams.torques.channels]"]
    for n, sigma in zip(names, TORQUE_NOISE.tolist(), strict=True):
        lines.append(f't_{n}_Nm = {{ is = "joint.{n}.torque", sigma = {sigma!r}, use = "input" }}')
    for trial, log in logs.items():
        noise = (rng.standard_normal(log.torque.shape) for _ in range(3))
        position, velocity = log.position + POSITION_NOISE * next(noise), log.velocity + VELOCITY_NOISE * next(noise)
        torque = log.torque + TORQUE_NOISE * next(noise)
        both = np.stack([position, velocity], axis=2).reshape(log.time.size, -1)
        head = [f"{kind}_{n}_{unit}" for n in names for kind, unit in (("q", "rad"), ("v", "rad_s"))]
        write_text(folder / f"{trial}_joints.csv", _table(log.time, head, both, 6))
        write_text(folder / f"{trial}_torques.csv", _table(log.time, [f"t_{n}_Nm" for n in names], torque, 3))
        lines += ["", "[[trials]]", f'id = "{trial}"', f'condition = "{trial.split("-")[0]}"']
        lines += [f'{stream} = "{trial}_{stream}.csv"' for stream in ("joints", "torques")]
    path = folder / "study.toml"
    write_text(path, "\n".join(lines) + "\n")
    return path


def _table(time: np.ndarray, head: Sequence[str], values: np.ndarray, digits: int) -> str:
    rows = [",".join(["time_s", *head])]
    rows += [
        ",".join([f"{t:.4f}", *(f"{v:.{digits}f}" for v in row)]) for t, row in zip(time, values.tolist(), strict=True)
    ]
    return "\n".join(rows) + "\n"
