"""A link behind a spring moves as its motor's measured motion shakes it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spacerobot.diagnosis.machines.hidden_motion import hidden
from spacerobot.effects.divided import divided
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate
from spacerobot.support.errors import SimulationError

JOINT = "joint.j"


def machine(share: float, stiffness: float, damping: float) -> Mechanism:
    whole = Mechanism(coordinates={JOINT: Coordinate(JOINT, 3.0, angular=True)}, ports={JOINT: {JOINT: 1.0}}, forces=())
    return divided(whole, JOINT, "link", share, stiffness=stiffness, damping=damping)[0]


@pytest.mark.parametrize("step", [0.01, 0.045])
def test_it_is_what_an_integrator_makes_of_the_same_motion(step: float) -> None:
    """Seven samples to a cycle of the resonance are enough."""
    time = np.arange(0.0, 4.0, step)

    def acceleration(t: np.ndarray) -> np.ndarray:
        return np.sin(3.0 * t) + 0.3 * np.cos(20.0 * t)

    ((_, (x, rate)),) = hidden(machine(1.5, 600.0, 1.8), {JOINT: acceleration(time)}, step).items()
    told = solve_ivp(
        lambda t, y: [y[1], -400.0 * y[0] - 1.2 * y[1] - acceleration(t)],
        (0.0, time[-1]), [-acceleration(0.0) / 400.0, 0.0], t_eval=time, rtol=1e-9, atol=1e-12, max_step=step,
    ).y  # fmt: skip
    np.testing.assert_allclose(x, told[0], atol=0.02 * np.abs(told[0]).max())
    np.testing.assert_allclose(rate, told[1], atol=0.02 * np.abs(told[1]).max())


def test_a_stiff_spring_is_none() -> None:
    """The link follows its motor, bent by what its inertia asks for."""
    time = np.arange(0.0, 2.0, 0.005)
    acceleration = np.cos(4.0 * time)
    ((_, (x, _rate)),) = hidden(machine(1.5, 1.5e6, 300.0), {JOINT: acceleration}, 0.005).items()
    np.testing.assert_allclose(x, -acceleration / 1e6, atol=2e-8)


def test_what_no_measured_motion_carries_is_refused() -> None:
    with pytest.raises(SimulationError, match="no measured motion"):
        hidden(machine(1.5, 600.0, 1.8), {"joint.other": np.zeros(5)}, 0.01)
