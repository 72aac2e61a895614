"""The scenes of the bench: the air-bed rig, and those in which more than slider and target moves."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from spacerobot.proof import air_bed
from spacerobot.proof.campaign import Belief, Campaign, Trial
from spacerobot.proof.engine.arm import POSE, arm_mass
from spacerobot.proof.engine.sensors import Channel
from spacerobot.proof.labs.another import another_lab
from spacerobot.proof.labs.orders import FAMILY as ANOTHER_LAB
from spacerobot.proof.sizes import JOINTS, places
from spacerobot.proof.whole.orders import FAMILY
from spacerobot.proof.whole.scene import whole_machine

CHASER_MASSES = (4.0, 9.0, 16.0)
"""Targets [kg] that a free chaser meets: light ones, so that it turns little while it is watched."""

NOT_IN_SPACE = ("table_tilt", "tether", "coulomb_friction at target", "quadratic_drag", "viscous_drag")
"""What a chaser and its target, both floating, have no table or air for."""


def scene(family: str, rng: np.random.Generator, *, effect: tuple[str, str] | None = None) -> Campaign:
    """A campaign of a family with nothing missing.

    Args:
        family: of the scene.
        rng: where everything comes from.
        effect: what will be hidden, so that the scene can show it.
    """
    if family in ("chaser", "servo arm"):
        return _arm(family, rng)
    if family == FAMILY:
        return whole_machine(_arm("chaser", rng), rng)
    if family == ANOTHER_LAB:
        lab, hand = another_lab(rng, air_bed.SIGMA), bool(rng.random() < 0.3)
        per_mass = int(rng.integers(2 if len(lab.masses) > 1 else 4, 6))
        return replace(air_bed.air_bed(rng, lab=lab, per_mass=per_mass, hand_marker=hand), family=family)
    name = effect[0] if effect else ""
    marker = name == "arm_compliance" or (not name and bool(rng.random() < 0.5))
    turning = name in ("eccentric_contact",)
    campaign = air_bed.air_bed(
        rng, spinning=family == "spinning" and not turning, turning=turning, hand_marker=marker and family == "rig"
    )
    return replace(campaign, family=family)


def hideable(campaign: Campaign, *, outside: bool = False) -> list[tuple[str, str]]:
    """(effect, place) that a scene can hide, of the catalogue or of those outside it."""
    channels = {c.name for s in campaign.streams for c in s.channels}
    found = places(turning="target.y" in channels, outside=outside)
    if campaign.family == FAMILY:
        return [] if outside else [("coulomb_friction", "wrist"), *JOINTS]
    absent = {"force_sensor", "mocap"} - {s.sensor for s in campaign.streams}
    found = [k for k in found if k[1] not in absent]
    if campaign.family == "servo arm" and not outside:
        return [("arm_compliance", "arm")]
    if "target.yaw" in channels:  # the oscillator moves along a line, not with a body that turns
        found = [k for k in found if k[0] not in ("hidden_oscillator", "magnetic_pull")]
    if campaign.family == "chaser":
        found = [k for k in found if k[0] not in NOT_IN_SPACE and f"{k[0]} at {k[1]}" not in NOT_IN_SPACE]
        found = [k for k in found if k[0] not in ("magnetic_pull", "periodic_cable")]
    if "hand.x" not in channels or campaign.family == "chaser":
        found = [k for k in found if k[0] != "arm_compliance"]
    return found


def _arm(family: str, rng: np.random.Generator) -> Campaign:
    """A meeting with the end of a whole arm: on a free spacecraft with its joints locked, or on servos."""
    floating = family == "chaser"
    plain = air_bed.air_bed(rng, per_mass=3, spring=float(rng.choice([1020.0, 3600.0, 5100.0])))
    believed = dict(plain.belief.values)
    sigma = dict(plain.belief.sigma)
    head = {**air_bed.HEAD, "pose": [round(a, 6) for a in POSE]}
    built = dict(plain.as_built)
    mocap = list(plain.streams[0].channels)
    mocap.append(Channel("hand.x", 1.5e-4, 1e-5))
    trials = plain.trials
    if floating:
        head.update({"robot": "chaser_pa10_wrist", "base": "free"})
        mass = arm_mass(floating=True)
        believed["hand.mass"] = round(mass, 1)
        sigma["hand.mass"] = 0.01
        built["hand.mass"] = mass
        masses = dict(zip(air_bed.MASSES, CHASER_MASSES, strict=True))
        trials = tuple(_lighter(t, masses[float(t.overrides["target.mass"])]) for t in trials)
    streams = (replace(plain.streams[0], channels=tuple(mocap)), plain.streams[1])
    title = "A free chaser meets a target" if floating else "A target meets an arm"
    belief = Belief(head, believed, sigma, plain.belief.scatter)
    return replace(plain, title=title, belief=belief, as_built=built, trials=trials, streams=streams, family=family)


def _lighter(trial: Trial, mass: float) -> Trial:
    old = float(trial.overrides["target.mass"])
    over = trial.values.target_mass / old
    contact = math.pi * math.sqrt((mass + 0.7) / trial.values.wrist_stiffness)
    arrival = -trial.position["target"] / trial.velocity["target"]
    return replace(
        trial,
        values=replace(trial.values, target_mass=mass * over),
        overrides={"target.mass": mass},
        duration=round(arrival + 1.4 * contact + 0.35, 2),
    )
