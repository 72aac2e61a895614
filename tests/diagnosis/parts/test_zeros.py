"""What is believed to be zero, with a sigma of its own unit: encoders' zeros, a torque log's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from helpers_models import ARM, arm_log, in_own_unit

from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.noise import floor_of, reweighted
from spacerobot.diagnosis.machines.joint_log import shifted
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.terms.hypothesis import Believed, hypothesis
from spacerobot.model.library import load

GRAVITY = (0.0, 0.0, -9.81)


def misplaced(zero: dict[str, float], bias: float = 0.0, **believed: object) -> InverseDynamics:
    """The arm's logs, read by encoders whose zeros are off [rad], and a torque log that is [N m]."""
    robot = load(ARM)
    grids = {}
    for n in range(2):
        grid = shifted(arm_log(robot, n, {}), {j: -z for j, z in zero.items()})
        torque = "joint.shoulder.torque"
        grids[f"run{n}"] = (replace(grid, value={**grid.value, torque: grid.value[torque] + bias}), f"motion {n}", {})
    return InverseDynamics(robot, GRAVITY, grids, ("shoulder", "elbow"), compared=["shoulder"], **believed)  # type: ignore[arg-type]


def fitted(model: InverseDynamics) -> tuple[dict[str, float], dict[str, float], float]:
    """Values, their standard errors, and the rms of what is left [N m]."""
    made = hypothesis(model.believed, [])
    fit = Fitter(model, model.trials).fit(made)
    trials = reweighted(model.trials, floor_of({k: t.residual for k, t in fit.trials.items()}, model.trials))
    fit = Fitter(model, trials).fit(made, warm=fit.values())
    steps = np.array([f.slope(z) for f, z in zip(fit.hypothesis.free, fit.z, strict=True)])
    error = np.sqrt(np.diag(fit.covariance)) * steps
    state = Fitter(model, trials).state(made, fit.z, {t.id: np.zeros(0) for t in trials})
    rest = in_own_unit(state, trials)
    return fit.values(), dict(zip(made.keys, error.tolist(), strict=True)), float(np.sqrt(np.mean(rest**2)))


@pytest.mark.parametrize("zero", [0.02, -0.01])
def test_an_encoders_zero_comes_back(zero: float) -> None:
    sigma = {"joint.shoulder.zero": 0.05, "joint.elbow.zero": 0.05}
    values, error, rest = fitted(misplaced({"shoulder": zero, "elbow": -zero}, absolute=sigma))
    assert values["joint.shoulder.zero"] == pytest.approx(zero, abs=0.001)
    assert values["joint.elbow.zero"] == pytest.approx(-zero, abs=0.002)
    assert max(error.values()) < 0.01
    assert rest < 0.02
    *_, held = fitted(misplaced({"shoulder": zero, "elbow": -zero}))
    assert held > 2.0 * rest  # where it may not move, it is missed


def test_a_stated_zero_is_exact_and_a_later_one_an_earlier_place() -> None:
    stated = {"joint.shoulder.zero": 0.4, "joint.elbow.zero": -0.3}
    assert fitted(misplaced({"shoulder": 0.4, "elbow": -0.3}, values=stated))[2] < 0.02
    assert fitted(misplaced({"shoulder": 0.4, "elbow": -0.3}))[2] > 0.1


def test_the_zero_of_a_torque_log_comes_back() -> None:
    values, error, rest = fitted(misplaced({}, 0.3, absolute={"joint.shoulder.bias": 0.5}))
    assert values["joint.shoulder.bias"] == pytest.approx(0.3, abs=5 * error["joint.shoulder.bias"] + 1e-3)
    assert rest < 0.02


def test_a_value_around_zero_adds_and_has_its_stated_sigma() -> None:
    believed = Believed({}, {}, {}, ("all",), absolute={"wrist.preload": 0.5, "joint.a.damping": 0.1})
    made = hypothesis(believed, [])
    z = np.array([2.0, 3.0])
    assert made.trial_values(z, {}, "all", {}) == {"wrist.preload": 1.0, "joint.a.damping": pytest.approx(0.3)}
    assert made.trial_values(z, {}, "all", {"wrist.preload": 0.2})["wrist.preload"] == pytest.approx(1.2)
    assert made.sigmas(z) == {"wrist.preload": 2.0, "joint.a.damping": 3.0}
    assert made.bounds()[0].tolist() == [-np.inf, 0.0]  # nothing is damped by less than nothing
    loose = hypothesis(believed.free_of(["wrist.preload"]), [])
    assert loose.sigmas(np.array([0.1, 0.0]))["wrist.preload"] == pytest.approx(3.0)
