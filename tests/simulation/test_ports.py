"""Ports of the multibody backend: rate, row and bias acceleration are derivatives of the displacement."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from spacerobot.simulation.multibody.assembly import assemble_bodies
from spacerobot.simulation.multibody.dynamics import Dynamics
from spacerobot.simulation.parts import ContactLaw, EffectAt, Target
from spacerobot.simulation.scene import Scene

SLOSH = EffectAt("hidden_oscillator", "target", {"mass_kg": 1.0, "frequency_Hz": 2.0, "damping_ratio": 0.1})
COUPLED = EffectAt("transmission_coupling", "joint.S3", {"ratio": 0.3})
COMPLIANT = EffectAt("arm_compliance", "arm", {"mass_kg": 20.0, "stiffness_N_m": 4e4, "damping_Ns_m": 100.0})
TARGET = Target(contact_point=(0.15, 0.03, -0.02), attitude=(0.2, 0.1, -0.3))
SCENES = {
    "chaser": Scene("chaser_pa10_wrist", joints="free", target=TARGET, contact=ContactLaw(mu=0.2), effects=(COUPLED,)),
    "locked": Scene("chaser_pa10_wrist", target=TARGET, contact=ContactLaw(mu=0.2), approach=(0.6, 0.0, 0.8)),
    "compliant": Scene(target=TARGET, contact=ContactLaw(mu=0.2), effects=(COMPLIANT, SLOSH)),
    "continuous joints": Scene("kinova", joints="free", target=TARGET),
}

HEADINGS = ("target.yaw", "base.roll", "base.pitch", "base.yaw", "base.turn.x", "base.turn.y", "base.turn.z")


@pytest.mark.parametrize("name", SCENES)
def test_rates_rows_and_biases(name: str) -> None:
    scene = SCENES[name]
    mechanism = scene.mechanism()
    assembly = assemble_bodies(scene, mechanism)
    dynamics = Dynamics(assembly, mechanism)
    rng = np.random.default_rng(0)
    model, step = assembly.model, 1e-5
    y, slope = np.zeros(dynamics.size), np.zeros(dynamics.size)
    for _ in range(3):
        q = pin.integrate(model, assembly.configuration, 0.1 * rng.normal(size=model.nv))
        v = 0.5 * rng.normal(size=model.nv)

        def seen(q: np.ndarray, v: np.ndarray = v) -> dict[str, tuple[float, float, float, np.ndarray]]:
            y[: dynamics.nq], y[dynamics.nq : dynamics.nq + dynamics.nv] = q, v
            with dynamics.whole():
                dynamics.rate(0.0, y, slope)
            return {
                p: (
                    dynamics.port_position(p),
                    dynamics.port_rate(p),
                    dynamics.port_bias(p),
                    dynamics.port_row(p).copy(),
                )
                for p in dynamics.names.ports
            }

        before, here, after = (seen(pin.integrate(model, q, s * step * v)) for s in (-1, 0, 1))
        for port, (_, rate, bias, row) in here.items():
            assert row @ v == pytest.approx(rate, abs=1e-12), port
            assert (after[port][1] - before[port][1]) / (2 * step) == pytest.approx(bias, abs=1e-7), port
            if port not in HEADINGS:  # a heading is an angle only while the body turns about its axis
                assert (after[port][0] - before[port][0]) / (2 * step) == pytest.approx(rate, abs=1e-8), port


def test_configuration_rate_is_that_of_the_manifold() -> None:
    scene = SCENES["chaser"]
    mechanism = scene.mechanism()
    assembly = assemble_bodies(scene, mechanism)
    dynamics = Dynamics(assembly, mechanism)
    model, step = assembly.model, 1e-6
    rng = np.random.default_rng(1)
    q, v = pin.integrate(model, assembly.configuration, rng.normal(size=model.nv)), rng.normal(size=model.nv)
    y, slope = np.zeros(dynamics.size), np.zeros(dynamics.size)
    y[: dynamics.nq], y[dynamics.nq : dynamics.nq + dynamics.nv] = q, v
    dynamics.rate(0.0, y, slope)
    found = (pin.integrate(model, q, step * v) - pin.integrate(model, q, -step * v)) / (2 * step)
    assert np.abs(found - slope[: dynamics.nq]).max() < 1e-8


def test_accelerations_are_those_of_forward_dynamics() -> None:
    """The kernel's own Cholesky factor against Pinocchio's articulated-body algorithm."""
    for name, scene in SCENES.items():
        mechanism = scene.mechanism()
        assembly = assemble_bodies(scene, mechanism)
        dynamics = Dynamics(assembly, mechanism)
        model = assembly.model
        rng = np.random.default_rng(2)
        q, v = pin.integrate(model, assembly.configuration, 0.1 * rng.normal(size=model.nv)), rng.normal(size=model.nv)
        y, slope = np.zeros(dynamics.size), np.zeros(dynamics.size)
        y[: dynamics.nq], y[dynamics.nq : dynamics.nq + dynamics.nv] = q, v
        dynamics.modes[:] = 1  # all friction slides
        dynamics.rate(0.0, y, slope)
        torque = np.zeros(model.nv)
        for i, force in enumerate(dynamics.mechanism.forces):
            torque += dynamics.port_row(force.port) * dynamics.w[dynamics.force_place(1 + i)]
        torque += dynamics.port_row("contact") * dynamics.w[dynamics.force_place(0)]
        for r, friction in enumerate(dynamics.mechanism.frictions):
            torque += dynamics.port_row(friction.port) * dynamics.friction_force(r)
        expected = pin.aba(model, model.createData(), q, v, torque)
        found = slope[dynamics.nq : dynamics.nq + dynamics.nv]
        assert np.abs(found - expected).max() < 1e-8 * max(1.0, np.abs(expected).max()), name
