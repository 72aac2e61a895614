"""Filters of higher order: what scipy's own state-space simulation makes of them, and what a data sheet says."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.signal import bessel, butter, filtfilt, lsim

from spacerobot.effects.filters import ANALOGUE, ORDERS, first_orders
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import ChannelMap, Coordinate, Readout
from spacerobot.effects.registry import effect
from spacerobot.simulation.parts.effect_at import EffectAt
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.sensors import read_channels
from spacerobot.simulation.simulate import simulate
from spacerobot.support.errors import InputError, NotFoundError

FORMS = [(order, kind) for order in ORDERS for kind in ANALOGUE]


def gain(form: tuple[int, str], frequency: np.ndarray) -> np.ndarray:
    """By partial fractions; frequency in cutoffs."""
    return np.asarray(sum(g / (1.0 + 1j * frequency / r) for r, g in first_orders(*form)))


@pytest.mark.parametrize("form", FORMS)
def test_a_constant_passes_and_the_cutoff_is_three_decibels_down(form: tuple[int, str]) -> None:
    low, cutoff, far = np.abs(gain(form, np.array([0.0, 1.0, 100.0])))
    assert low == pytest.approx(1.0, abs=1e-9)
    assert cutoff == pytest.approx(np.sqrt(0.5), abs=1e-6)
    assert far < 8.0 * 100.0 ** -form[0]  # 20 dB a decade for each order


@pytest.mark.parametrize("order", [2, 4])
def test_bessel_delays_all_alike_and_butterworth_keeps_the_gain(order: int) -> None:
    at = np.linspace(0.01, 0.7, 50)
    delay = {k: -np.gradient(np.unwrap(np.angle(gain((order, k), at))), at) for k in ANALOGUE}
    assert np.ptp(delay["bessel"]) < 0.3 * np.ptp(delay["butterworth"])
    assert np.abs(gain((order, "butterworth"), at)).min() > np.abs(gain((order, "bessel"), at)).min()


class Pulse:
    """A run that begins at rest and moves as a smooth bump."""

    start = 0.0

    def positions(self, times: np.ndarray) -> np.ndarray:
        return np.exp(-0.5 * ((times - 0.3) / 0.02) ** 2)[:, None]

    def states(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return self.positions(times), np.zeros((times.size, 1))

    def port(self, name: str, states: np.ndarray) -> np.ndarray:
        return states[:, 0]

    def switches(self) -> np.ndarray:
        return np.empty(0)


def rig() -> Mechanism:
    return Mechanism(
        coordinates={"x": Coordinate("x", 1.0)},
        ports={"x": {"x": 1.0}},
        readouts={"x": Readout("x", "position", "x")},
        sensors={"gauge": ("x",)},
    )


@pytest.mark.parametrize("cutoff", [8.0, 40.0])
@pytest.mark.parametrize("form", FORMS)
def test_a_pulse_comes_out_as_from_the_state_space(form: tuple[int, str], cutoff: float) -> None:
    made = rig().with_map(ChannelMap("x", "low_pass", cutoff, form=form))
    run: Any = Pulse()
    times = np.linspace(0.0, 0.8, 401)
    shown = read_channels(run, made, ["x"], times)["x"]
    wide = 2.0 * np.pi * cutoff
    system = (
        bessel(form[0], wide, analog=True, norm="mag") if form[1] == "bessel" else butter(form[0], wide, analog=True)
    )
    fine = np.linspace(0.0, 0.8, 16001)
    _, expected, _ = lsim(system, run.positions(fine)[:, 0], fine)
    assert np.abs(shown - expected[::40]).max() < 2e-3
    other = bessel(form[0], 1.1 * wide, analog=True, norm="mag")
    _, wrong, _ = lsim(other, run.positions(fine)[:, 0], fine)
    assert np.abs(shown - wrong[::40]).max() > 5e-3


@pytest.mark.parametrize("order", [2, 4])
def test_both_ways_is_what_tracking_software_does(order: int) -> None:
    """scipy's filtfilt over a finished recording: nothing is late, and a hump that the filter widens stays even."""
    made = rig().with_map(ChannelMap("x", "low_pass", 12.0, form=(order, "zero_phase")))
    run: Any = Pulse()
    times = np.linspace(0.0, 0.8, 401)
    shown = read_channels(run, made, ["x"], times)["x"]
    fine = np.linspace(0.0, 0.8, 8001)
    b, a = butter(order, 12.0, fs=1e4)
    expected = filtfilt(b, a, run.positions(fine)[:, 0])[::20]
    assert np.abs(shown - expected).max() < 3e-3
    assert times[np.argmax(shown)] == pytest.approx(0.3, abs=2e-3)
    once = read_channels(
        run, rig().with_map(ChannelMap("x", "low_pass", 12.0, form=(order, "butterworth"))), ["x"], times
    )
    assert np.abs(once["x"] - expected).max() > 0.1


def test_a_scene_states_order_and_kind() -> None:
    stated = EffectAt("low_pass", "gauge", {"cutoff_Hz": 20.0, "order": 4, "kind": "bessel"}).apply(rig())
    assert stated.maps == EffectAt("low_pass~4_bessel", "gauge", {"cutoff_Hz": 20.0}).apply(rig()).maps
    plain = EffectAt("low_pass", "gauge", {"cutoff_Hz": 20.0}).apply(rig())
    assert EffectAt("low_pass", "gauge", {"cutoff_Hz": 20.0, "order": 1}).apply(rig()).maps == plain.maps != stated.maps


@pytest.mark.parametrize("wrong", [{"order": 3}, {"order": 2, "kind": "chebyshev"}, {"kind": "elliptic"}])
def test_an_unknown_form_is_refused_with_those_there_are(wrong: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="4 bessel"):
        EffectAt("low_pass", "gauge", {"cutoff_Hz": 20.0, **wrong}).apply(rig())
    with pytest.raises(NotFoundError):
        effect("low_pass~3_bessel")
    with pytest.raises(NotFoundError):
        effect("bias~2_bessel")


def test_a_word_that_names_no_form_is_refused_where_the_effect_is_read(tmp_path: Path) -> None:
    words = 'effect = "coulomb_friction"\nwhere = "wrist"\nparameters = { force_N = "strong" }'
    (tmp_path / "scene.toml").write_text(f"[wrist]\nstiffness = 530\n[[effects]]\n{words}\n")
    with pytest.raises(InputError, match=r"force_N.*not a number.*strong"):
        simulate(Scene.from_toml(tmp_path / "scene.toml"))
