from __future__ import annotations

import functools
from pathlib import Path

import pytest

from spacerobot.diagnosis.locate.locate import locate
from spacerobot.diagnosis.locate.located import Located
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.data import trial_data
from spacerobot.recordings.dataroot import recordings_folder
from spacerobot.recordings.study import load_study

ROOT = recordings_folder() or Path("nowhere")

pytestmark = pytest.mark.campaigns


@functools.cache
def located(name: str) -> Located:
    if not (ROOT / name / "study.toml").is_file():
        pytest.skip(f"no campaign {name} under SPACEROBOT_DATA")
    study = load_study(ROOT / name)
    trials = trial_data(study)
    return locate(RigModel(study, trials), trials)


@pytest.mark.parametrize(
    ("name", "balance", "depends_on"),
    [
        ("guide-friction", "wrist", ("sign of velocity",)),
        pytest.param("hardening-spring", "wrist", ("displacement^3",), marks=pytest.mark.slow),
        pytest.param("bed-tilt", "target", ("constant",), marks=pytest.mark.slow),
        ("force-delay", "force_sensor", ("time",)),
        pytest.param("eccentric-hit", "target.yaw", ("force",), marks=pytest.mark.slow),
        pytest.param(
            "hertz-contact", "contact", ("constant", "displacement", "displacement^2"), marks=pytest.mark.slow
        ),
        ("compliant-arm", "hand", ("force", "frequency")),
        pytest.param("end-stop", "wrist", ("large displacement",), marks=pytest.mark.slow),
        pytest.param("sloshing-target", "target", ("frequency",), marks=pytest.mark.slow),
    ],
)
def test_the_first_row_points_at_the_left_out_physics(name: str, balance: str, depends_on: tuple[str, ...]) -> None:
    top = located(name).rows[0]
    assert top.balance == balance
    assert top.depends_on in depends_on
    assert top.p < 0.01


def test_two_effects_in_two_balances() -> None:
    best = located("friction-and-drag").best()
    assert best["wrist"].depends_on == "sign of velocity"
    assert best["target"].depends_on == "velocity^2"
    assert best["target"].coefficient == pytest.approx(4.0, abs=3.0 * best["target"].error)


def test_nothing_where_nothing_is_missing() -> None:
    found = located("clean")
    assert found.found(0.05) == ()
    assert all(t.chi2 < 1.15 * t.freedom for t in found.totals)


def test_what_the_tilt_and_the_slosh_weigh() -> None:
    tilt = located("bed-tilt")
    phases = {r.phase for r in tilt.found() if (r.balance, r.depends_on) == ("target", "constant")}
    assert {"approach", "coast"} <= phases
    assert tilt.rows[0].coefficient / -9.80665 == pytest.approx(0.00015, rel=0.2)
    slosh = located("sloshing-target").rows[0]
    assert -slosh.coefficient == pytest.approx(1.6, rel=0.3)


def test_where_the_end_stop_stands_and_how_late_the_force_is() -> None:
    assert located("end-stop").rows[0].at == pytest.approx(0.0265, rel=0.02)
    (clock,) = located("force-delay").clocks
    assert clock.delay_s == pytest.approx(0.004, abs=3.0 * clock.error_s)
