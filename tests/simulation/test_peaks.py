"""The peak of a contact is that of the motion, not of whatever samples somebody asked for."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.simulation.parts import ContactLaw, EffectAt, Target, Wrist
from spacerobot.simulation.peaks import peak
from spacerobot.simulation.scene import BACKENDS, Scene
from spacerobot.simulation.simulate import simulate
from spacerobot.simulation.trajectory import Trajectory
from spacerobot.sweep.engine import _integrated
from spacerobot.theory import kelvin_voigt, power_law

ANVIL = Wrist(mass=1e9, stiffness=1.0)
"""A wrist that does not give way: the contact alone has a closed form."""


def hit(contact: ContactLaw, mass: float, speed: float) -> Scene:
    return Scene(wrist=ANVIL, contact=contact, target=Target(mass=mass, speed=speed), duration=0.05)


@settings(max_examples=25, derandomize=True, deadline=None)
@given(
    mass=st.floats(-3.0, 2.0).map(lambda e: 10.0**e),
    stiffness=st.floats(2.0, 9.0).map(lambda e: 10.0**e),
    zeta=st.floats(0.0, 0.9),
    speed=st.floats(-3.0, 0.0).map(lambda e: 10.0**e),
    backend=st.sampled_from(BACKENDS),
)
def test_a_spring_and_a_dashpot_peak_as_the_closed_form_says(
    mass: float, stiffness: float, zeta: float, speed: float, backend: str
) -> None:
    """However short: from microseconds, which no sample at 1 kHz sees, to longer than the run."""
    damping = 2.0 * zeta * math.sqrt(stiffness * mass)
    found = simulate(hit(ContactLaw(stiffness, damping), mass, speed), backend=backend, rate=100.0)
    strongest = kelvin_voigt.peak_force(mass, stiffness, damping, speed)
    if found.restitution.contact_time == found.restitution.contact_time:  # it ended within the run
        assert found.peak_force.value == pytest.approx(strongest, rel=1e-6)
        assert 0.0 <= found.peak_force.time <= found.restitution.contact_time
    assert found.peak_force.value * (1.0 + 1e-12) >= found["contact.force"].max()


@pytest.mark.parametrize("backend", BACKENDS)
def test_hertz_peaks_as_its_closed_form_says(backend: str) -> None:
    found = simulate(hit(ContactLaw(2e6, law="hertz"), 0.02, 0.3), backend=backend)
    assert found.peak_force.value == pytest.approx(power_law.peak_force(0.02, 2e6 * 1e-3**-0.5, 0.3), rel=1e-6)
    assert found["contact.force"].max() < 0.9 * found.peak_force.value, "the samples do miss it"


CHATTER = Scene(
    wrist=Wrist(stiffness=5100.0, damping=2.7),
    contact=ContactLaw(damping=60.0),
    target=Target(speed=0.07, contact_point=(0.15, 0.02), yaw_inertia=0.4),
    duration=0.4,
)
SCENES = {
    "many touches": CHATTER,
    "turning": replace(CHATTER, target=replace(CHATTER.target, spin=(0.0, 0.0, 0.2), gap=0.01)),
    "adhesive": replace(CHATTER, contact=ContactLaw(damping=10.0, adhesion=2.0)),
    "stopped": CHATTER.with_effects(EffectAt("end_stop", "wrist", {"travel_m": 0.002, "stiffness_N_m": 1e6})),
}


@pytest.mark.parametrize("name", list(SCENES))
def test_dense_sampling_finds_no_higher_and_comes_near_on_both_backends(name: str) -> None:
    runs = {b: simulate(SCENES[name], backend=b, rate=2e4) for b in BACKENDS}
    for run in runs.values():
        for channel, top in (("contact.force", run.peak_force), ("wrist.deflection", run.peak_deflection)):
            most = run[channel].max()
            assert most <= top.value * (1.0 + 1e-9)
            assert most == pytest.approx(top.value, rel=0.03)
            near = np.abs(run.time - top.time) < 1.1 / 2e4
            assert run[channel][near].max() == pytest.approx(top.value, rel=0.2)
    few, many = runs["reduced"], runs["multibody"]
    assert few.peak_force.value == pytest.approx(many.peak_force.value, rel=1e-6)
    assert few.peak_deflection.value == pytest.approx(many.peak_deflection.value, rel=1e-6)
    assert few.peak_force.time == pytest.approx(many.peak_force.time, abs=1e-6)


def test_the_rate_of_the_samples_changes_no_peak_and_a_sweep_has_the_same() -> None:
    coarse, fine = (simulate(SCENES["turning"], rate=r) for r in (10.0, 5e3))
    assert coarse.peak_force == fine.peak_force
    assert coarse.peak_deflection == fine.peak_deflection
    found = _integrated(SCENES["turning"])
    assert float(found.peak_force[0]) == fine.peak_force.value
    assert float(found.peak_deflection[0]) == fine.peak_deflection.value


def test_what_never_touches_has_no_peak_and_a_saved_run_keeps_its_own(tmp_path: Path) -> None:
    gone = replace(CHATTER, target=replace(CHATTER.target, gap=0.05), duration=None)
    missed = simulate(gone, duration=0.1, must_touch=False)
    assert missed.peak_force.value == 0.0
    assert math.isnan(missed.peak_force.time)
    found = simulate(CHATTER)
    kept = Trajectory.load(found.save(tmp_path / "run.npz"))
    assert kept.peak_force == found.peak_force
    assert kept.peak_deflection == found.peak_deflection


def test_a_top_within_one_step_and_one_at_a_jump_are_found() -> None:
    ends, steps = np.array([0.0, 1.0, 2.0]), np.array([True, True])
    bump = peak(lambda t: np.exp(-(((t - 0.6180339) / 0.3) ** 2)), ends, steps, 4)
    assert bump.value == pytest.approx(1.0, abs=1e-11)
    assert bump.time == pytest.approx(0.6180339, abs=1e-5)
    jump = peak(lambda t: np.where(t < 1.0, t, 0.0), ends, steps, 4)
    assert jump.value == pytest.approx(1.0, abs=1e-12)
    assert peak(lambda t: np.where(t < 1.0, 5.0, t), ends, np.array([False, True]), 4).value == 2.0
