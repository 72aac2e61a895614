"""When a command acted: held until the next one it is half a sample late, which is no physics and no sensor fault."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.recordings.study import Study, load_study
from tests.diagnosis.parts.helpers_axis import HEAD, axis_urdf

MASS, STEP, FINE = 2.0, 0.01, 20


def followed(folder: Path, *, dry: float = 0.0, viscous: float = 0.0, late: int = 0, sluggish: float = 0.0) -> Study:
    """An axis under a controller that holds its command over a sample; its log of the command `late` samples late, or
    through a filter of a time constant [s]. Friction is set-valued: it sticks."""
    random, text = np.random.default_rng(2), HEAD
    for n in range(4):
        wish = 2.0 + 0.4 * n
        place, rate, rows = 0.0, 0.0, []
        for k in range(900):
            t = k * STEP
            aim = 0.2 * np.sin(wish * t) + 0.08 * np.sin(2.7 * wish * t)
            speed = 0.2 * wish * np.cos(wish * t) + 0.08 * 2.7 * wish * np.cos(2.7 * wish * t)
            command = MASS * (400.0 * (aim - place) + 32.0 * (speed - rate))
            rows.append([t, round(place + 1e-5 * random.standard_normal(), 6), command])
            for _ in range(FINE):
                rate += STEP / FINE * (command - viscous * rate) / MASS
                rubs = STEP / FINE * dry / MASS
                rate = float(np.sign(rate)) * max(abs(rate) - rubs, 0.0)
                place += STEP / FINE * rate
        log = np.array(rows)
        shown = log[:, 2].copy()
        if sluggish:
            for k in range(1, shown.size):
                shown[k] = shown[k - 1] + (1.0 - np.exp(-STEP / sluggish)) * (log[k, 2] - shown[k - 1])
        log[late:, 2] = shown[: shown.size - late] if late else shown
        log = log[late:]
        log[:, 2] += 0.02 * random.standard_normal(len(log))
        np.savetxt(folder / f"{n}.csv", log, delimiter=",", header="t,q,u", comments="")
        text += f'[[trials]]\nid = "{n}"\ncondition = "{n}"\nlog = "{n}.csv"\n'
    (folder / "axis.urdf").write_text(axis_urdf(MASS))
    (folder / "study.toml").write_text(text)
    return load_study(folder)


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
