"""From a finished run of either backend to a trajectory."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from spacerobot.dynamics.joint_kinds import joint_axis
from spacerobot.effects.mechanism import Mechanism
from spacerobot.simulation.energy import Ledger, stored_by_elements
from spacerobot.simulation.events import Event, contact_intervals
from spacerobot.simulation.multibody.ports import RISE, SLIDE
from spacerobot.simulation.multibody.run import MultibodyRun, MultibodySample
from spacerobot.simulation.peaks import peak_deflection, peak_force
from spacerobot.simulation.reduced.forces import PRESSED
from spacerobot.simulation.reduced.run import ReducedRun, Sample
from spacerobot.simulation.restitution import Restitution, Speeds, restitution_of
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.scene_mechanism import ARM_MOMENTUM, SERVO
from spacerobot.simulation.sensors import read_channels
from spacerobot.simulation.trajectory import Trajectory

_UNITS = (
    ("contact.force", "N"),
    ("contact.friction", "N"),
    ("contact.slip", "m/s"),
    ("angular_momentum.", "kg m^2/s"),
    ("momentum.", "kg m/s"),
    ("angular_velocity", "rad/s"),
    ("quaternion", "1"),
    ("target.yaw.velocity", "rad/s"),
    ("target.yaw", "rad"),
)


def unit_of(channel: str, angular: bool = False) -> str:
    """The SI unit of a channel; `angular` says that its joint turns."""
    for part, unit in _UNITS:
        if part in channel:
            return unit
    if channel.endswith(".torque"):
        return "N m" if angular else "N"
    length = "rad" if angular else "m"
    return f"{length}/s" if channel.endswith(".velocity") or ".velocity." in channel else length


def _notes(scene: Scene) -> tuple[str, ...]:
    hand = (f"hand: {scene.hand.note}",) if scene.hand.note else ()
    return (*hand, *scene.notes)


def _start_touch(events: tuple[Event, ...], pressed: bool, start: float) -> tuple[Event, ...]:
    return (Event(start, "contact", "touch"), *events) if pressed else events


def _restitution(events: tuple[Event, ...], end: float, speeds: Callable[[float], Speeds]) -> Restitution:
    intervals = contact_intervals(events, False, 0.0, end)
    before = speeds(intervals[0][0]) if intervals else None
    after = speeds(intervals[-1][1]) if intervals and intervals[-1][1] < end else None
    return restitution_of(intervals, end, before, after)


def of_multibody(scene: Scene, run: MultibodyRun, times: np.ndarray) -> Trajectory:
    """The trajectory of a multibody run, channels at `times`, shape (T,) [s]."""
    taken = run.sample(times)
    channels = _multibody_channels(scene, run, taken)
    mechanism = run.mechanism

    def speeds(t: float) -> Speeds:
        at = run.sample(np.array([t]))
        hand, target = (float(run.port(p, at.velocity)[0]) for p in ("hand", "target"))
        return Speeds(hand, target, float(at.contact[0, 1]))

    events = _start_touch(run.events, run.starts_pressed, run.start)
    angular = {f"joint.{n}.{kind}" for n in scene.prepared.chain for kind in ("position", "velocity", "torque")}
    turning = {c for c in angular if c in channels and mechanism.angular(c.rsplit(".", 1)[0])}
    return Trajectory(
        time=times,
        channels=channels,
        units={c: unit_of(c, c in turning) for c in channels},
        measured=read_channels(run, mechanism, mechanism.readouts, times),
        ledger=multibody_ledger(run),
        events=events,
        restitution=_restitution(events, run.end, speeds),
        backend="multibody",
        scene=scene.to_toml(),
        notes=_notes(scene),
        peak_force=peak_force(run),
        peak_deflection=peak_deflection(run),
    )


def _multibody_channels(scene: Scene, run: MultibodyRun, taken: MultibodySample) -> dict[str, np.ndarray]:
    mechanism, assembly = run.mechanism, run.assembly
    names = list(mechanism.coordinates)
    out: dict[str, np.ndarray] = {}
    shown = {"wrist.x": "wrist", "target.x": "target", "target.y": "target.y", "target.yaw": "target.yaw"}
    if "hand" in names:
        shown["hand.x"] = "hand"
    shown.update({n: n for n in names if mechanism.coordinates[n].carrier is not None})
    for channel, coordinate in shown.items():
        i = names.index(coordinate)
        value = taken.position[:, i]
        out[channel] = np.unwrap(value) if channel == "target.yaw" else value
        out[f"{channel}.velocity"] = taken.velocity[:, i]
    if "hand" not in names:
        out["hand.x"], out["hand.x.velocity"] = np.zeros((2, taken.time.size))
    out["wrist.deflection"], out["wrist.deflection.velocity"] = taken.slider.T
    out["contact.force"] = run.contact_force(taken)
    out["contact.penetration"], out["contact.penetration.velocity"] = taken.contact[:, :2].T
    out["contact.slide"], out["contact.slide.velocity"] = taken.contact[:, 2:4].T
    _tangential(out, mechanism, taken.modes[:, 0], taken.contact[:, [3, 5]].T, taken.friction)
    for body, k in (("hand", 0), ("tip", 1)):
        out.update({f"{body}.position.{a}": taken.place[:, k, i] for i, a in enumerate("xyz")})
    bodies = {"target": assembly.target, **({"base": 1} if scene.base == "free" else {})}
    for body, joint in bodies.items():
        q, v = assembly.model.joints[joint].idx_q, assembly.model.joints[joint].idx_v
        world = _rotated(taken.configuration[:, q + 3 : q + 7], taken.rates[:, v : v + 6])
        for i, axis in enumerate("xyz"):
            out[f"{body}.position.{axis}"] = taken.configuration[:, q + i]
            out[f"{body}.velocity.{axis}"] = world[:, i]
            out[f"{body}.angular_velocity.{axis}"] = world[:, 3 + i]
        for i, part in enumerate("xyzw"):
            out[f"{body}.quaternion.{part}"] = taken.configuration[:, q + 3 + i]
    for name in names:
        if name.startswith("joint."):
            joint = assembly.model.joints[assembly.joints[name]]
            q, v = joint.idx_q, joint.idx_v
            turned = taken.configuration[:, q : q + joint.nq]
            value = turned[:, 0] if joint.nq == 1 else np.unwrap(np.arctan2(turned[:, 1], turned[:, 0]))
            out[f"{name}.position"] = value
            out[f"{name}.velocity"] = taken.rates[:, v]
            out[f"{name}.torque"] = _actuation(run, taken, name)
    for i, axis in enumerate("xyz"):
        out[f"momentum.{axis}"] = taken.momentum[:, i]
        out[f"angular_momentum.{axis}"] = taken.momentum[:, 3 + i]
    return out


def _tangential(
    out: dict[str, np.ndarray], mechanism: Mechanism, contact_mode: np.ndarray, rates: np.ndarray, friction: np.ndarray
) -> None:
    """Slip [m/s] and friction force on the target [N], along the face's lateral (y) and upward (z) axis, in contact.

    Args:
        out: channels, to which these are added.
        mechanism: its frictions name their ports.
        contact_mode: shape (T,).
        rates: of the target's contact point over the face, shape (2, T).
        friction: shape (T, R).
    """
    pressed = contact_mode == PRESSED
    for axis, port, rate in zip("yz", (SLIDE, RISE), rates, strict=True):
        out[f"contact.slip.{axis}"] = np.where(pressed, rate, 0.0)
        acting = [i for i, f in enumerate(mechanism.frictions) if f.port == port]
        out[f"contact.friction.{axis}"] = friction[:, acting].sum(axis=1)


def _rotated(quaternions: np.ndarray, twists: np.ndarray) -> np.ndarray:
    """Body twists of a free-flyer, shape (T, 6), in world axes; quaternions (x, y, z, w), shape (T, 4)."""
    u, w = quaternions[:, None, :3], quaternions[:, None, 3:]
    parts = twists.reshape(-1, 2, 3)
    across = 2.0 * np.cross(u, parts)
    return np.asarray((parts + w * across + np.cross(u, across)).reshape(-1, 6))


def _actuation(run: MultibodyRun, taken: MultibodySample, port: str) -> np.ndarray:
    """What the elements at a joint's port exert on it, shape (T,)."""
    total = np.zeros(taken.time.size)
    for i, force in enumerate(run.mechanism.forces):
        if force.port == port:
            total += taken.force[:, 1 + i]  # the contact comes first
    for r, friction in enumerate(run.mechanism.frictions):
        if friction.port == port:
            total += taken.friction[:, r]
    for s, state in enumerate(run.mechanism.states):
        if state.port == port:
            total += taken.remembered[:, s]
    return total


def _read_by_elements(mechanism: Mechanism) -> list[str]:
    """Ports whose motion says what an element stores, the contact apart."""
    read = dict.fromkeys([(f.sense or f.port) for f in mechanism.forces] + [s.port for s in mechanism.states])
    return [p for p in read if p != "contact"]


def multibody_ledger(run: MultibodyRun) -> Ledger:
    """Energies at the ends of the integrator's steps."""
    times = run.boundaries()
    taken = run.sample(times)
    mechanism = run.mechanism
    ports = _read_by_elements(mechanism)
    displacement = {p: run.port_values(p, taken, 0) for p in ports}
    rate = {p: run.port_values(p, taken, 1) for p in ports}
    displacement["contact"], rate["contact"] = taken.contact[:, 0], taken.contact[:, 1]
    stored = stored_by_elements(mechanism, displacement, rate, taken.modes[:, 0], taken.memory)
    own = run.dynamics.names
    names = [*own.forces, *own.frictions, *own.states, *own.inputs]
    work: dict[str, np.ndarray] = {}
    for i, name in enumerate(names):
        work[name] = work.get(name, 0.0) + taken.work[:, i]
    if np.any(run.assembly.model.gravity.linear):
        stored["gravity"] = taken.potential
        work["gravity"] = taken.potential[0] - taken.potential
    for kick in run.kicks:
        work[kick.name] = work.get(kick.name, 0.0) + np.where(times >= kick.time, kick.work, 0.0)
    return Ledger(times, taken.kinetic, stored, work)


def of_reduced(scene: Scene, run: ReducedRun, times: np.ndarray) -> Trajectory:
    """The trajectory of a reduced run, channels at `times`, shape (T,) [s]."""
    taken = run.sample(times)
    mechanism, names = run.mechanism, list(run.layout.coordinates)
    out: dict[str, np.ndarray] = {}
    shown = {"wrist.x": "wrist", "target.x": "target", "hand.x": "hand"}
    others = {n: n for n in names if n not in shown.values() and not n.startswith("arm.")}
    for channel, coordinate in {**shown, **others}.items():
        if coordinate in names:
            i = names.index(coordinate)
            out[channel], out[f"{channel}.velocity"] = taken.position[:, i], taken.velocity[:, i]
        else:
            out[channel], out[f"{channel}.velocity"] = np.zeros((2, times.size))
    out["wrist.deflection"], out["wrist.deflection.velocity"] = (
        run.port("wrist", s) for s in (taken.position, taken.velocity)
    )
    out["contact.force"] = run.contact_force(taken)
    out["contact.penetration"], out["contact.penetration.velocity"] = reduced_contact(run, taken)
    _tangential(out, mechanism, run.contact_modes(times), reduced_slip(run, taken), taken.friction)
    mass = {n: mechanism.coordinates[n].mass for n in names}
    arm = scene.hand.arm
    apart = ("target.y", "target.yaw", *(() if arm is None else arm.names))
    along = sum(
        (taken.velocity[:, i] * mass[n] for i, n in enumerate(names) if n not in apart), start=np.zeros(times.size)
    )
    if arm is not None:
        along = along + run.port(ARM_MOMENTUM, taken.velocity)
        for joint, at in zip(scene.prepared.chain, scene.pose or (), strict=True):
            out[f"joint.{joint}.position"] = at + run.port(f"{SERVO}{joint}", taken.position)
            out[f"joint.{joint}.velocity"] = run.port(f"{SERVO}{joint}", taken.velocity)
    across = taken.velocity[:, names.index("target.y")] * mass["target.y"] if "target.y" in names else 0.0 * along
    for i, axis in enumerate("xyz"):
        out[f"momentum.{axis}"] = along * scene.axes[i, 0] + across * scene.axes[i, 1]

    def speeds(t: float) -> Speeds:
        at = run.sample(np.array([t]))
        hand, target = (float(run.port(p, at.velocity)[0]) for p in ("hand", "target"))
        return Speeds(hand, target, float(reduced_contact(run, at)[1][0]))

    events = _start_touch(run.events, bool(run.steps.modes[0, 0] == PRESSED), run.start)
    return Trajectory(
        time=times,
        channels=out,
        units={c: unit_of(c, _turns(scene, mechanism, c)) for c in out},
        measured=read_channels(run, mechanism, mechanism.readouts, times),
        ledger=reduced_ledger(run),
        events=events,
        restitution=_restitution(events, run.end, speeds),
        backend="reduced",
        scene=replace(scene, backend="reduced").to_toml(),
        notes=_notes(scene),
        peak_force=peak_force(run),
        peak_deflection=peak_deflection(run),
    )


def _turns(scene: Scene, mechanism: Mechanism, channel: str) -> bool:
    """Whether a channel of the reduced model is of something that turns."""
    if channel in mechanism.coordinates:
        return mechanism.coordinates[channel].angular
    robot = scene.prepared
    joint = channel.removeprefix("joint.").rsplit(".", 1)[0]
    return channel.startswith("joint.") and joint_axis(robot.model, robot.joint_id(joint))[0]


def reduced_contact(run: ReducedRun, taken: Sample) -> tuple[np.ndarray, np.ndarray]:
    """Penetration and its rate, shape (T,) each; see `Contact` for the formula."""
    contact, names = run.mechanism.contact, list(run.layout.coordinates)
    assert contact is not None
    target, wrist = names.index("target"), names.index("wrist")
    depth = taken.position[:, target] - taken.position[:, wrist]
    rate = taken.velocity[:, target] - taken.velocity[:, wrist]
    if "target.yaw" in names:
        yaw, spin = (s[:, names.index("target.yaw")] for s in (taken.position, taken.velocity))
        depth = depth + contact.turned(yaw)[0]
        rate = rate - (contact.ahead * np.sin(yaw) + contact.lateral * np.cos(yaw)) * spin
    return depth, rate


def reduced_slip(run: ReducedRun, taken: Sample) -> np.ndarray:
    """Rates at which the contact point slides sideways and upwards, shape (2, T); see `Contact` for the formula."""
    contact, names = run.mechanism.contact, list(run.layout.coordinates)
    assert contact is not None
    rate = np.zeros(taken.time.size)
    if "target.y" in names:
        rate = rate + taken.velocity[:, names.index("target.y")]
    if "target.yaw" in names:
        yaw, spin = (s[:, names.index("target.yaw")] for s in (taken.position, taken.velocity))
        rate = rate + (contact.ahead * np.cos(yaw) - contact.lateral * np.sin(yaw)) * spin
    return np.array([rate, np.zeros_like(rate)])


def reduced_ledger(run: ReducedRun) -> Ledger:
    """Energies at the ends of the integrator's steps."""
    times = run.boundaries()
    taken = run.sample(times)
    mechanism = run.mechanism
    ports = _read_by_elements(mechanism)
    displacement = {p: run.port(p, taken.position) for p in ports}
    rate = {p: run.port(p, taken.velocity) for p in ports}
    displacement["contact"], rate["contact"] = reduced_contact(run, taken)
    modes = np.append(run.steps.modes[:, 0], run.steps.modes[-1, 0])
    stored = stored_by_elements(mechanism, displacement, rate, modes, taken.memory)
    work: Mapping[str, np.ndarray] = dict(run.work())
    kinetic = run.kinetic(taken.velocity)
    for kick in mechanism.impulses:  # a kick happens between two steps; sampled is the side after it
        at = np.flatnonzero(np.isclose(times, kick.time, rtol=0.0, atol=1e-12))
        if at.size and math.isfinite(kick.impulse):
            i = int(at[0])
            after = float(run.port(kick.port, taken.velocity[i : i + 1])[0])
            row = run.system.rows[run.layout.port(kick.port)]
            gain = kick.impulse * (after - 0.5 * kick.impulse * float(row**2 @ run.system.inverse_mass))
            before = work.get(kick.name, np.zeros_like(kinetic))
            work = {**work, kick.name: before + np.where(times >= kick.time, gain, 0.0)}
    return Ledger(times, kinetic, stored, work)
