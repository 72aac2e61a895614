"""The floating platform: a record made in the plane by Newton's own bookkeeping, and the makers' own run."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.forward.choose import forward_model
from spacerobot.diagnosis.forward.floating_platform import FloatingPlatform
from spacerobot.diagnosis.machines.platform import platform_models
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError
from tests.overlay.studies import needs_real, write_csv

PLATFORM = (10.0, 0.5)
ARM = (1.5, 0.04)
MOUNT, REACH = 0.2, 0.3


def record(platform: tuple[float, float], drift: tuple[float, float, float]) -> dict[str, np.ndarray]:
    """A platform with one link at its rim, in the plane: positions from momentum, no Pinocchio in it."""
    (m0, i0), (m1, i1) = platform, ARM
    time = np.linspace(0.0, 12.0, 1201)
    swing = np.clip((time - 2.0) / 8.0, 0.0, 1.0)
    q = 1.4 * swing**3 * (10 - 15 * swing + 6 * swing**2)
    rate = np.gradient(q, time, edge_order=2)
    fine = slice(None)

    def lever(yaw: float, angle: float) -> np.ndarray:
        """From the platform's centre to the link's."""
        return np.array(
            [
                MOUNT * math.cos(yaw) + REACH * math.cos(yaw + angle),
                MOUNT * math.sin(yaw) + REACH * math.sin(yaw + angle),
            ]
        )

    reduced = m0 * m1 / (m0 + m1)
    yaw = np.empty_like(time)
    yaw[0] = 0.3
    r = lever(0.3, 0.0)
    spin = (i0 + i1 + reduced * (r @ r)) * drift[2]  # angular momentum about the common centre of mass

    def yaw_rate(psi: float, angle: float, qd: float) -> float:
        both = lever(psi, angle)
        arm = REACH * np.array([math.cos(psi + angle), math.sin(psi + angle)])
        inertia = i0 + i1 + reduced * (both @ both)
        return float((spin - (i1 + reduced * (both @ arm)) * qd) / inertia)

    for k in range(time.size - 1):  # Heun's third-order relatives are not needed: RK4 with interpolated drive
        h = time[k + 1] - time[k]
        qm, rm = (
            0.5 * (q[k] + q[k + 1]) + h / 8 * (rate[k] - rate[k + 1]),
            1.5 * (q[k + 1] - q[k]) / h - 0.25 * (rate[k] + rate[k + 1]),
        )
        a = yaw_rate(yaw[k], q[k], rate[k])
        b = yaw_rate(yaw[k] + 0.5 * h * a, qm, rm)
        c = yaw_rate(yaw[k] + 0.5 * h * b, qm, rm)
        d = yaw_rate(yaw[k] + h * c, q[k + 1], rate[k + 1])
        yaw[k + 1] = yaw[k] + h / 6 * (a + 2 * b + 2 * c + d)
    offset = np.array([lever(p, s) for p, s in zip(yaw, q, strict=True)]) * m1 / (m0 + m1)
    # the common centre moves evenly; the platform's own speed at the start is `drift`
    whirl = drift[2] * np.array([-offset[0, 1], offset[0, 0]])
    centre = offset[0] + np.outer(time, np.array(drift[:2]) + whirl)
    place = centre - offset
    return {"t": time[fine], "x": place[:, 0], "y": place[:, 1], "yaw": yaw, "q": q}


def study(folder: Path, *, believed: tuple[float, float] = PLATFORM, extra: str = "") -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    columns = record(PLATFORM, (0.01, -0.02, 0.03))
    write_csv(folder / "log.csv", {**columns, "fx": np.full(columns["t"].size, 0.5)})
    robot = (
        '<robot name="p"><link name="platform"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0"'
        ' ixz="0" iyz="0"/></inertial></link><link name="arm"><inertial><origin xyz="0.3 0 0"/><mass value="1.5"/>'
        '<inertia ixx="0.04" iyy="0.04" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="shoulder" type="revolute"><parent link="platform"/><child link="arm"/><origin xyz="0.2 0 0"/>'
        '<axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>'
    )
    (folder / "p.urdf").write_text(robot)
    (folder / "study.toml").write_text(
        f"""format = 1
[baseline]
robot = "p.urdf"
base = "free"
joints = "servo"
[baseline.platform]
mass = {believed[0]}
yaw_inertia = {believed[1]}
[streams.log]
time = "t"
[streams.log.channels]
x = {{ is = "base.position.x", sigma = 1e-5 }}
y = {{ is = "base.position.y", sigma = 1e-5 }}
yaw = {{ is = "base.yaw", sigma = 1e-5 }}
q = {{ is = "joint.shoulder.reference" }}
{extra}
[[trials]]
id = "a"
log = "log.csv"
"""
    )
    return folder


def worst(folder: Path) -> dict[str, float]:
    found = load_study(folder)
    model = forward_model(found)
    assert isinstance(model, FloatingPlatform)
    return {c.channel: float(np.abs(c.residual).max()) for c in model.simulate(found.trials[0]).channels}


def test_momentum_alone_reproduces_a_record_made_without_pinocchio(tmp_path: Path) -> None:
    found = worst(study(tmp_path))
    assert set(found) == {"base.position.x", "base.position.y", "base.yaw"}
    assert max(found.values()) < 5e-5


def test_a_joint_without_limits_is_a_joint_like_another(tmp_path: Path) -> None:
    folder = study(tmp_path)
    path = folder / "p.urdf"
    text = path.read_text().replace('type="revolute"', 'type="continuous"')
    path.write_text(text.replace('<limit lower="-3" upper="3" effort="1" velocity="1"/>', ""))
    assert max(worst(folder).values()) < 5e-5


def test_a_wrong_platform_is_seen(tmp_path: Path) -> None:
    assert worst(study(tmp_path / "inertia", believed=(10.0, 0.55)))["base.yaw"] > 2e-3
    assert worst(study(tmp_path / "mass", believed=(11.0, 0.5)))["base.position.x"] > 1e-4


def test_of_three_moments_of_inertia_the_one_counts_that_it_yaws_with(tmp_path: Path) -> None:
    folder = study(tmp_path)
    path = folder / "study.toml"
    path.write_text(path.read_text().replace(f"yaw_inertia = {PLATFORM[1]}", f"inertia = [0.9, 0.8, {PLATFORM[1]}]"))
    assert max(worst(folder).values()) < 5e-5
    (model,) = platform_models(load_study(folder))
    assert model.base["platform.yaw_inertia"] == PLATFORM[1]


def test_thrust_is_refused(tmp_path: Path) -> None:
    folder = study(tmp_path, extra='fx = { is = "base.force.x", use = "input" }')
    with pytest.raises(InputError, match="thrusters are on"):
        worst(folder)


@pytest.mark.real
@needs_real("spot_free_floating_arm")
def test_spot_turns_as_predicted_and_drifts_as_not() -> None:
    found = load_study("real/spot_free_floating_arm")
    model = forward_model(found)
    for trial in found.trials:
        channels = {c.channel: c for c in model.simulate(trial).channels}
        yaw = channels["base.yaw"]
        assert np.corrcoef(yaw.measured, yaw.simulated)[0, 1] > 0.97
        assert np.ptp(yaw.measured) > 0.8
        # markers are where the arm is believed to be: seen from the base, within a few centimetres
        drift = {a: channels[f"base.position.{a}"].residual for a in "xy"}
        assert np.abs(drift["y"]).max() > 0.2, "the platform drifts, which no momentum explains"
        for link in ("wrist", "elbow"):
            marker = channels[f"link.{link}.position.x"]
            assert np.sqrt(np.mean(marker.residual**2)) < 0.06
