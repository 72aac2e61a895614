"""A deck with an arm, moved by equations of its own: what acts on it in the lab is found, and by the right name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.machines.choose import some_models_for
from spacerobot.diagnosis.machines.platform import Platform
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.recordings.study import load_study
from tests.door.machines import floater

DECK, TURNS, HINGE = 10.0, 0.5, 0.2
ROD, HALF, ROD_TURNS = 1.5, 0.3, 0.04
"""Of `floater`: masses [kg], moments about their own centres [kg m^2], and where hinge and rod's centre are [m]."""

STEP, SECONDS, NOISE = 0.005, 12.0, 2e-4
Push = Callable[[np.ndarray, float], tuple[float, float, float]]
"""Of (x, y, yaw, and their rates) and the trial's number: force along x and y, torque, at the deck's centre."""


def nothing(state: np.ndarray, trial: float) -> tuple[float, float, float]:
    return 0.0, 0.0, 0.0


def hose(state: np.ndarray, trial: float) -> tuple[float, float, float]:
    return 1.2 - 1.5 * state[0], -0.6 - 1.5 * state[1], 0.0


def other_hose(state: np.ndarray, trial: float) -> tuple[float, float, float]:
    """Tied up elsewhere in every trial."""
    return 1.5 * (np.cos(trial) - state[0]), 1.5 * (np.sin(trial) - state[1]), 0.0


def film(state: np.ndarray, trial: float) -> tuple[float, float, float]:
    return 0.0, 0.0, -0.04 * state[5]


def fan(state: np.ndarray, trial: float) -> tuple[float, float, float]:
    return 0.0, 0.0, -0.3 * abs(state[5]) * state[5]


def bearing(state: np.ndarray, trial: float) -> tuple[float, float, float]:
    return 0.0, 0.0, -0.002 * float(np.tanh(state[5] / 1e-4))


def across(v: np.ndarray) -> np.ndarray:
    return np.array([-v[1], v[0]])


def track(push: Push, rod: float, trial: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times (T,), joint angles (T,) and the deck's (T, 3): two rigid bodies, each with Newton's and Euler's laws."""
    rng = np.random.default_rng(int(trial))
    size, pace = rng.uniform(0.5, 0.9, 2), rng.uniform(0.6, 1.2, 2)
    inertia = ROD_TURNS * rod / ROD

    def joint(t: float) -> np.ndarray:
        """Angle, rate and acceleration; at rest at first."""
        u = min(t / 3.0, 1.0)
        r = u**3 * (10 - 15 * u + 6 * u * u), 10 * u**2 * (1 - u) ** 2, 20 / 3 * u * (1 - u) * (1 - 2 * u)
        s, c = np.sin(pace * t), np.cos(pace * t)
        q = np.array([size @ s, size @ (pace * c), -size @ (pace**2 * s)])
        return np.array([r[0] * q[0], r[1] * q[0] + r[0] * q[1], r[2] * q[0] + 2 * r[1] * q[1] + r[0] * q[2]])

    def change(t: float, s: np.ndarray) -> np.ndarray:
        q, dq, ddq = joint(t)
        yaw, turn, spin = s[2], s[5], s[5] + dq
        hinge = HINGE * np.array([np.cos(yaw), np.sin(yaw)])
        arm = HALF * np.array([np.cos(yaw + q), np.sin(yaw + q)])
        place = hinge + arm
        bent = -(turn**2) * hinge - spin**2 * arm + ddq * across(arm)  # how the rod accelerates without x'', y'', yaw''
        force = np.array(push(s, trial))
        mass = np.diag([DECK + rod, DECK + rod, TURNS + inertia + rod * place @ place])
        mass[:2, 2] = mass[2, :2] = rod * across(place)
        load = force - np.array([*(rod * bent), inertia * ddq + rod * (place[0] * bent[1] - place[1] * bent[0])])
        return np.concatenate([s[3:], np.linalg.solve(mass, load)])

    time = np.arange(0.0, SECONDS, STEP)
    out = np.empty((time.size, 6))
    state = np.concatenate([rng.uniform(-0.5, 0.5, 3), rng.uniform(-0.05, 0.05, 2), [0.15]])
    for k, t in enumerate(time):
        out[k] = state
        a = change(t, state)
        b = change(t + STEP / 2, state + STEP / 2 * a)
        c = change(t + STEP / 2, state + STEP / 2 * b)
        d = change(t + STEP, state + STEP * c)
        state = state + STEP / 6 * (a + 2 * b + 2 * c + d)
    return time, np.array([joint(t)[0] for t in time]), out[:, :3]


def lab(folder: Path, push: Push, *, rod: float = ROD, doubted: str = "") -> Path:
    """Three recordings; the lab believes in a rod of 1.5 kg, and in nothing that pushes."""
    rng = np.random.default_rng(4)
    tracks = {}
    for trial in (1, 2, 3):
        time, angle, deck = (x[::4] for x in track(push, rod, trial))
        seen = deck + NOISE * rng.standard_normal(deck.shape)
        tracks[str(trial)] = {"t": time, **dict(zip(("x", "y", "yaw"), seen.T, strict=True)), "q": angle}
    beliefs = f"[baseline.sigma]\nplatform.mass = 0.01\nplatform.yaw_inertia = 0.02\n{doubted}\n"
    return floater(folder, tracks, NOISE, beliefs=beliefs, apart=True)


def bench(folder: Path) -> Bench:
    (model,) = some_models_for(load_study(folder))
    assert isinstance(model, Platform)
    return Bench(model)


def test_what_nothing_pushes_leaves_the_noise(tmp_path: Path) -> None:
    fit = bench(lab(tmp_path / "s", nothing)).baseline()
    left = np.concatenate(list(fit.residuals().values()))
    assert np.sqrt(np.mean(left**2)) == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize(
    ("push", "effect", "where", "truth"),
    [
        (hose, "umbilical", "base", {"stiffness_N_m": 1.5, "ahead_N": 1.2, "aside_N": -0.6}),
        (film, "viscous_drag", "base.yaw", {"coefficient_Ns_m": 0.04}),
        (fan, "quadratic_drag", "base.yaw", {"coefficient_Ns2_m2": 0.3}),
        (bearing, "coulomb_friction", "base.yaw", {"force_N": 0.002}),
    ],
)
def test_what_pushes_is_offered_and_found(
    push: Push, effect: str, where: str, truth: dict[str, float], tmp_path: Path
) -> None:
    at = bench(lab(tmp_path / "s", push))
    base = at.baseline()
    promises = {p.site.label: p for p in at.promises(base, at.model.sites())}
    fit = at.fitted(base, promises[(effect, where)])
    assert fit is not None
    fit = at.again(fit)  # a baseline without it went far astray, and the way back takes more steps than one fit has
    for name, value in truth.items():
        assert fit.values()[f"{effect}@{where}.{name}"] == pytest.approx(value, rel=0.02), name


def test_a_link_that_is_heavier_than_believed_is_weighed(tmp_path: Path) -> None:
    at = bench(lab(tmp_path / "s", nothing, rod=1.2 * ROD, doubted="link.rod.mass = 0.1"))
    values = at.baseline().values()
    ratio = (values["link.rod.mass"] / values["platform.mass"]) / (ROD / DECK)
    assert ratio == pytest.approx(1.2, rel=0.01)  # without outer forces motion tells ratios of masses alone


@pytest.mark.slow
@pytest.mark.parametrize(("push", "verdict"), [(hose, "named"), (other_hose, "unknown")])
def test_a_hose_is_named_and_one_that_no_law_fits_is_no_silence(push: Push, verdict: str, tmp_path: Path) -> None:
    """Half a metre of motion under noise of 0.2 mm is not nothing."""
    said = diagnose(load_study(lab(tmp_path / "s", push)), jobs=1).verdict
    assert said["verdict"] == verdict
    assert [(e["effect"], e["where"]) for e in said["effects"]] == (
        [("umbilical", "base")] if verdict == "named" else []
    )
