"""Moments found in recordings: the shock of a touch, the jump of what was touched, and figures others state."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.locate.velocity_jump import jump
from spacerobot.diagnosis.machines.touch import first_shock
from spacerobot.support.errors import InputError
from spacerobot.view.report.when import happened
from spacerobot.view.table.literature import FILE, quoted

TIME = np.arange(0.0, 8.0, 0.001)


def balance(at: float | None, every: float | None = None) -> np.ndarray:
    """Two joints' residuals: noise, a slow drift, a vibration; and a blow at a moment, or at every so many seconds."""
    random = np.random.default_rng(0)
    rest = 0.05 * random.standard_normal((TIME.size, 2))
    rest[:, 0] += 0.5 * np.sin(0.7 * TIME) + 0.3 * np.sin(2 * np.pi * 15.0 * TIME)
    for moment in np.arange(0.5, 8.0, every) if every else [at] if at else []:
        after = np.maximum(TIME - moment, 0.0)
        rest[:, 1] += np.where(after > 0.0, 4.0 * np.exp(-after / 0.1) * np.sin(2 * np.pi * 40.0 * after), 0.0)
    return rest


@pytest.mark.parametrize("at", [3.2, 5.437])
def test_the_moment_of_a_blow_lies_in_its_interval(at: float) -> None:
    found = first_shock(TIME, balance(at))
    assert found is not None
    assert found.low <= at <= found.high
    assert found.high - found.low < 0.02


def test_a_machine_that_is_never_touched_or_shakes_itself_again_and_again_has_no_moment() -> None:
    assert first_shock(TIME, balance(None)) is None
    assert first_shock(TIME, balance(None, every=1.7)) is None


def reversing(moment: float) -> tuple[np.ndarray, np.ndarray]:
    """Velocities of a joint that turns back once, and of one that rests; and the steps that friction makes of that."""
    random = np.random.default_rng(2)
    velocity = np.column_stack([0.8 * (TIME - moment), 0.0 * TIME]) + 1e-3 * random.standard_normal((TIME.size, 2))
    residual = 0.01 * random.standard_normal((TIME.size, 2))
    residual[:, 0] += 0.2 * np.sign(TIME - moment)
    return velocity, residual


def test_a_joint_that_turns_back_was_not_touched_whatever_its_friction() -> None:
    velocity, residual = reversing(4.0)
    assert first_shock(TIME, residual) is not None  # so it seems to who does not look at the motion
    assert first_shock(TIME, residual, 0.005, velocity) is None


def test_a_blow_is_found_beside_a_reversal_and_at_rest() -> None:
    velocity, residual = reversing(4.0)
    for joint in (0, 1):
        struck = residual.copy()
        struck[:, joint] += balance(6.1)[:, 1] - balance(None)[:, 1]
        found = first_shock(TIME, struck, 0.005, velocity)
        assert found is not None
        assert found.low <= 6.1 <= found.high


def test_a_joint_that_shakes_alone_and_an_arm_that_starts_and_stops_were_not_touched() -> None:
    random = np.random.default_rng(3)
    quiet = 0.01 * random.standard_normal((TIME.size, 6))
    blow = (balance(4.0) - balance(None))[:, 1:]
    assert first_shock(TIME, quiet + blow * np.array([0.0, 0.0, 1.0, 0.0, 0.1, 0.0])) is None
    found = first_shock(TIME, quiet + blow * np.array([0.3, 0.2, 1.0, 0.0, 0.1, 0.0]))
    assert found is not None
    assert found.low <= 4.0 <= found.high
    for going in (np.clip((TIME - 3.0) / 0.4, 0.0, 1.0), np.clip((5.0 - TIME) / 0.4, 0.0, 1.0)):
        velocity = going[:, None] * np.array([0.5, -0.4, 0.3, 0.6, -0.2, 0.4])
        rest = quiet + 0.4 * np.sign(velocity)
        velocity += 1e-3 * random.standard_normal(velocity.shape)
        assert first_shock(TIME, rest) is not None  # so it seems to who does not look at the motion
        assert first_shock(TIME, rest, 0.005, velocity) is None
        found = first_shock(TIME, rest + (balance(6.1) - balance(None))[:, 1:], 0.005, velocity)
        assert found is not None
        assert found.low <= 6.1 <= found.high


def test_an_arm_that_begins_to_move_was_not_touched_though_few_of_its_joints_do() -> None:
    """A trajectory that begins with some joints: what breaks loose there shakes the others' balances too."""
    random = np.random.default_rng(4)
    going, blow = np.clip((TIME - 4.0) / 0.1, 0.0, 1.0), (balance(4.0) - balance(None))[:, 1:]
    rest = 0.01 * random.standard_normal((TIME.size, 7)) + blow * np.array([0.0, 1.0, 0.8, 0.0, 0.3, 1.0, 0.2])
    starts, thrown = (0.1 * x[:, None] * np.array([0, -1, 1, 0, 0, -1, 0]) for x in (going, going * (TIME < 4.2)))
    noise = 1e-3 * random.standard_normal(starts.shape)
    assert first_shock(TIME, rest, 0.005, starts + noise) is None
    found = first_shock(TIME, rest, 0.005, thrown + noise)  # what is hit at rest does not go on
    assert found is not None
    assert found.low <= 4.0 <= found.high


@pytest.mark.parametrize("step", [0.01, 0.004])
def test_what_noise_alone_shakes_of_a_slow_log_is_no_touch(step: float) -> None:
    """One joint's friction steps; of the others a stretch is a reading or two, and some are always large."""
    time, random, found = np.arange(0.0, 20.0, step), np.random.default_rng(5), 0
    for _ in range(40):
        rest = 0.01 * random.standard_normal((time.size, 6))
        found += first_shock(time, rest + np.where(time > 9.0, 0.3, 0.0)[:, None] * np.eye(6)[5]) is not None
        touched = first_shock(time, rest + np.where(time > 9.0, 0.3, 0.0)[:, None] * np.array([0, 0, 0, 1, 1, 1]))
        assert touched is not None
        assert touched.low - step <= 9.0 <= touched.high + step
    assert found == 0


def spinning(kind: str) -> np.ndarray:
    random = np.random.default_rng(1)
    noise = 0.02 * random.standard_normal(TIME.size)
    if kind == "caught":
        return np.interp(TIME, [0.0, 4.0, 4.15, 8.0], [1.0, 1.0, 0.0, 0.0]) + noise
    return np.interp(TIME, [0.0, 3.0, 6.0, 8.0], [1.0, 1.0, 0.0, 0.0]) + noise


def test_a_body_that_is_caught_jumps_and_one_that_spins_down_does_not() -> None:
    found = jump(TIME, spinning("caught"))
    assert found is not None
    assert found.low <= 4.0 <= found.high
    assert abs(found.time - 4.0) < 0.02
    assert jump(TIME, spinning("down")) is None


@pytest.mark.real
@pytest.mark.slow
def test_the_satellite_is_touched_and_its_clock_is_behind() -> None:
    """Others read 8.70 and 9.17 s off the torques, and 1.0 s for the clock."""
    from helpers_models import real_study

    from spacerobot.diagnosis.answer.events import clocks, touches
    from spacerobot.diagnosis.answer.record import written
    from spacerobot.diagnosis.machines.choose import models_for

    study = real_study("franka_captures_satellite")
    seen = touches(models_for(study))
    moments = {t.trial: t.moment.time for t in seen}
    assert moments == {"free": pytest.approx(9.17, abs=0.02), "compensated": pytest.approx(8.70, abs=0.02)}
    (late,) = clocks(study, seen)
    assert (late.trial, late.where) == ("compensated", "satellite")
    low, high = late.parameters["delay_s"].ci95
    assert low <= -1.0 <= high
    assert late.parameters["delay_s"].value == pytest.approx(-1.0, abs=0.05)
    said = happened({"events": [written(t.entry()) for t in seen], "clocks": [written(late)]})
    assert any("behind" in s for s in said)
    assert len(said) == 3


def test_a_clock_that_is_set_in_many_trials_has_one_sentence() -> None:
    def clock(trial: str, late: float) -> dict[str, object]:
        value = {"value": late, "ci95": [late - 0.001, late + 0.001], "unit": "s"}
        told = {"effect": "time_offset", "where": "camB", "against": "camA", "why": "the touch shows on both"}
        return {**told, "trial": trial, "parameters": {"delay_s": value}}

    few = [clock("01", -0.15), clock("02", 0.3)]
    assert len(happened({"clocks": few})) == 2
    (said,) = happened({"clocks": [*few, clock("03", 0.1)]})
    assert "in each of 3 trials" in said
    assert "from 0.1500 s behind it in trial 01 to 0.3000 s ahead of it in trial 02, each within 0.0010 s" in said


def test_figures_that_others_state_are_read_or_refused(tmp_path: Path) -> None:
    assert quoted(tmp_path) is None
    file = tmp_path / FILE
    file.write_text(
        'origin = "a paper"\n[[figures]]\nwhat = "y"\nchannels = ["y"]\nunit = "m"\nbefore = [1, 2]\nafter = 0.5\n'
    )
    found = quoted(tmp_path)
    assert found is not None
    assert (found.figures[0].before, found.figures[0].after) == ((1.0, 2.0), (0.5,))
    assert found.figures[0].channels == {"y": 1.0}
    file.write_text(
        'origin = "a paper"\n[[figures]]\nwhat = "y"\nchannel = ["y"]\nunit = "m"\nbefore = 1\nafter = 0.5\n'
    )
    with pytest.raises(InputError, match="figures"):
        quoted(tmp_path)
