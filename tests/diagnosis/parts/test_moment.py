"""When a command acted: held until the next one it is half a sample late, which is no physics and no sensor fault."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.recordings.study import Study
from tests.diagnosis.parts.helpers_axis import STEP, followed


def found(study: Study) -> tuple[dict[tuple[str, str], list[float]], float]:
    """What is named, with its values, and by how much the log is late [s]."""
    verdict = diagnose(study, jobs=1).verdict
    assert verdict["verdict"] in ("named", "nothing_missing")
    effects = {(e["effect"], e["where"]): [p["value"] for p in e["parameters"].values()] for e in verdict["effects"]}
    (part,) = verdict["parts"]
    return effects, part["values"].get("joint.j.delay", 0.0)


@pytest.mark.slow
def test_a_held_command_is_early_by_half_a_sample_and_nothing_else_is_missing(tmp_path: Path) -> None:
    effects, delay = found(followed(tmp_path, viscous=9.0))
    assert list(effects) == [("viscous_friction", "joint.j")]
    assert effects["viscous_friction", "joint.j"] == pytest.approx([9.0], rel=0.01)
    assert delay == pytest.approx(-0.5 * STEP, rel=0.1)


@pytest.mark.slow
def test_what_sticks_is_no_sluggish_log(tmp_path: Path) -> None:
    effects, delay = found(followed(tmp_path, dry=1.5))
    assert list(effects) == [("coulomb_friction", "joint.j")]
    assert effects["coulomb_friction", "joint.j"] == pytest.approx([1.5], rel=0.02)
    assert delay == pytest.approx(-0.5 * STEP, abs=0.2 * STEP)


@pytest.mark.slow
def test_a_log_that_is_late_by_many_samples_is_a_sensor_s_fault(tmp_path: Path) -> None:
    effects, _ = found(followed(tmp_path, viscous=9.0, late=6))
    assert set(effects) == {("viscous_friction", "joint.j"), ("time_offset", "log")}
    assert effects["viscous_friction", "joint.j"] == pytest.approx([9.0], rel=0.02)
    assert effects["time_offset", "log"] == pytest.approx([5.5 * STEP], rel=0.05)


@pytest.mark.slow
def test_a_filter_in_the_log_is_found_where_there_is_one(tmp_path: Path) -> None:
    effects, _ = found(followed(tmp_path, viscous=9.0, sluggish=0.04))
    assert set(effects) == {("viscous_friction", "joint.j"), ("low_pass", "log")}
    assert effects["viscous_friction", "joint.j"] == pytest.approx([9.0], rel=0.02)
    assert effects["low_pass", "log"] == pytest.approx([1.0 / (2.0 * np.pi * 0.04)], rel=0.15)
