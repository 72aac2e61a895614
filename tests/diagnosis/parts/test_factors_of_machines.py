"""A camera that is tilted, a drive with cross-talk, a zero that was found: any machine's fit finds what is doubted."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from spacerobot.diagnosis.answer.part_verdict import furthest_moved
from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.machines.choose import some_models_for
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.doubted import Doubted
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.selection.admission import admit, of_study
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.study_check import check_study
from spacerobot.model.library import load
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError
from tests.diagnosis.parts.helpers_models import ARM, arm_log
from tests.diagnosis.parts.helpers_plane import in_plane
from tests.door.machines import MACHINES
from tests.overlay.studies import write_csv

TRUE, SIGMA = 0.04, 0.03

SPOILT = [
    ("body", "z", "body.position.z", 8.0),
    ("axis", "x", "joint.slide.position", 0.05),
    ("axis", "u", "joint.slide.torque", 4.0),
    ("torques", "u", "joint.slide.torque", 4.0),
    ("torques", "x", "joint.slide.position", 0.2),
    ("platform", "x", "base.position.x", 0.5),
    ("platform", "yaw", "base.yaw", 0.5),
    ("platform", "q", "joint.pivot.reference", 2.0),
    ("impacts", "a_x", "body.velocity.x.after", 1.0),
    ("impacts", "b_y", "body.velocity.y.before", 1.0),
]
"""Machine, a column of its files, the channel that this is, and the size of a column beside it."""


def table(path: Path) -> dict[str, np.ndarray]:
    head, *rows = path.read_text().splitlines()
    values = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    return dict(zip(head.split(","), values.T, strict=True))


def floating(folder: Path) -> Path:
    """The platform, its track as momentum has it: what was made up would hide a factor."""
    study = MACHINES["platform"](folder)
    (model,) = some_models_for(load_study(study))
    for n, trial in enumerate(model.trials):
        start = np.array([n.guess for n in model.nuisances(trial)])
        shown = model.predict(model.mechanism(model.base, trial), trial, start).blocks
        columns, random = table(study / f"{trial.id}.csv"), np.random.default_rng(n)
        for name, block in zip(("x", "y", "yaw"), shown, strict=True):
            columns[name] = block[0] + 1e-3 * random.standard_normal(block.shape[1])
        write_csv(study / f"{trial.id}.csv", columns)
    return study


def spoilt(folder: Path, machine: str, column: str, size: float, factor: float = TRUE) -> Path:
    """Every file with a further column, of which one channel lacks so many times."""
    study, random = {**MACHINES, "platform": floating}[machine](folder), np.random.default_rng(11)
    for path in sorted(study.glob("*.csv")):
        columns = table(path)
        rows = np.arange(len(columns[column])) / len(columns[column])
        columns["beside"] = size * (np.sin(random.uniform(9.0, 14.0) * rows + random.uniform(0.0, 6.0)) + 0.3)
        columns[column] = columns[column] - factor * columns["beside"]
        write_csv(path, columns)
    return study


def doubting(study: Path, column: str, said: str) -> Path:
    """The study with more said of a column."""
    file = study / "study.toml"
    text, count = re.subn(rf'^({re.escape(column)} = {{ is = "[^"]*")', rf"\1, {said}", file.read_text(), flags=re.M)
    assert count == 1
    file.write_text(text)
    return study


def fitted(study: Path) -> tuple[Machine, Fit]:
    """The machine and its baseline, under the weights that this leaves."""
    (model,) = some_models_for(load_study(study))
    bench = Bench(model)
    fit = bench.baseline()
    for _ in range(2):
        bench.weigh(fit)
        fit = bench.again(fit)
    return model, fit


@pytest.mark.parametrize(("machine", "column", "channel", "size"), SPOILT)
def test_a_doubted_factor_is_found(tmp_path: Path, machine: str, column: str, channel: str, size: float) -> None:
    study = spoilt(tmp_path / "s", machine, column, size)
    held, _ = fitted(study)
    assert not held.believed.zeros
    _, fit = fitted(doubting(study, column, f"plus = {{ beside = [0, {SIGMA}] }}"))
    key = f"{channel}|beside.factor"
    low, high = fit.errors()[key]
    error = 0.5 * (high - low)
    assert error < 0.5 * SIGMA  # or the data tell nothing of it
    assert fit.values()[key] == pytest.approx(TRUE, abs=4.0 * error)
    assert abs(fit.values()[key] - TRUE) < 0.25 * TRUE


@pytest.mark.parametrize("channel", ["joint.elbow.position", "joint.shoulder.torque"])
def test_what_leaks_into_one_joint_shows_in_the_torque_of_another(channel: str) -> None:
    """The shoulder carries the elbow: a factor in the elbow's encoder is found from the shoulder's torque alone."""
    robot, key, grids, columns = load(ARM), f"{channel}|beside", {}, {}
    for n in range(2):
        grid = arm_log(robot, n, {})
        column = 0.5 * np.sin(1.7 * grid.time + n) * (20.0 if channel.endswith("torque") else 1.0)
        grids[f"run{n}"] = (
            replace(grid, value={**grid.value, channel: grid.value[channel] - TRUE * column}),
            f"motion {n}",
            {},
        )
        columns[f"run{n}"] = {key: (grid.time, column)}
    model = InverseDynamics(
        robot,
        (0.0, 0.0, -9.81),
        grids,
        ("shoulder", "elbow"),
        compared=["shoulder"],
        doubted=Doubted({key: SIGMA, "joint.elbow.torque|beside": SIGMA}, columns),
    )
    assert list(model.believed.zeros) == [key]  # the elbow's torque tells the shoulder nothing
    bench = Bench(model)
    fit = bench.baseline()
    bench.weigh(fit)
    assert bench.again(fit).values()[f"{key}.factor"] == pytest.approx(TRUE, abs=0.05 * TRUE)


@pytest.mark.parametrize(("machine", "column", "channel", "size"), [SPOILT[2], SPOILT[5]])
def test_where_no_factor_is_planted_none_is_found(
    tmp_path: Path, machine: str, column: str, channel: str, size: float
) -> None:
    study = doubting(spoilt(tmp_path / "s", machine, column, size, 0.0), column, f"plus = {{ beside = [0, {SIGMA}] }}")
    _, fit = fitted(study)
    low, high = fit.errors()[f"{channel}|beside.factor"]
    assert abs(fit.values()[f"{channel}|beside.factor"]) < 4.0 * 0.5 * (high - low)


def test_a_doubted_zero_is_found_by_any_machine(tmp_path: Path) -> None:
    """A force whose log stands 3 N too high, beside a spring: with a zero that is exact the cart rests elsewhere."""
    study = MACHINES["axis"](tmp_path / "s")
    for path in study.glob("*.csv"):
        columns = table(path)
        columns["u"] = columns["u"] + 3.0
        write_csv(path, columns)
    _, fit = fitted(doubting(study, "u", "offset_sigma = 4.0"))
    assert fit.values()["joint.slide.torque.zero"] == pytest.approx(3.0, abs=0.2)


def test_what_a_factor_was_found_to_be_stands_in_the_verdict(tmp_path: Path) -> None:
    study = doubting(spoilt(tmp_path / "s", "axis", "u", 4.0), "u", f"plus = {{ beside = [0, {SIGMA}] }}")
    model, fit = fitted(study)
    told = furthest_moved([cast(Part, SimpleNamespace(fit=fit, model=model))], [])
    found = told["joint.slide.torque|beside.factor"]
    assert found.value == pytest.approx(TRUE, rel=0.1)
    assert found.in_sigmas == pytest.approx(TRUE / SIGMA, rel=0.1)


@pytest.mark.slow
def test_past_a_camera_that_is_askew_the_drag_is_named_and_the_camera_too(tmp_path: Path) -> None:
    """Taken as exact, the camera bends the track so that a viscous drag was named."""
    puck = in_plane(tmp_path / "s", lambda v: -2.0 * np.hypot(*v) * v).path
    for path in puck.parent.glob("*.csv"):
        columns = table(path)
        columns["x"] = columns["x"] - 0.3 * columns["y"]
        write_csv(path, columns)
    text = re.sub(r'(is = "body[^"]*")', r"\1, sigma = 0.001", puck.read_text())
    puck.write_text(text.replace("x = { ", "x = { plus = { y = [0, 0.2] }, "))
    told = diagnose(load_study(puck)).answer
    (found,) = told.effects
    assert (told.verdict, found.effect, found.where) == ("named", "quadratic_drag", "target")
    low, high = found.parameters["coefficient_Ns2_m2"].ci95
    assert low <= 2.0 <= high
    assert told.moved["body.position.x|y.factor"].value == pytest.approx(0.3, abs=0.005)


def test_check_asks_for_what_no_fit_finds(tmp_path: Path) -> None:
    """A study with a doubt that nothing weighs is refused with the line, and what would do instead."""
    study = spoilt(tmp_path / "s", "platform", "x", 0.5)
    file = study / "study.toml"
    more = 'q = { is = "joint.pivot.reference" }\nbeside = { is = "base.velocity.x", plus = { x = [0, 0.1] } }'
    file.write_text(file.read_text().replace('q = { is = "joint.pivot.reference" }', more))
    loaded = load_study(study)
    (told,) = of_study(loaded)
    assert "the factor of x in base.velocity.x is doubted, and no fit" in str(told)
    assert "plus = { x = 0.0 }" in str(told)
    assert "study.toml:" in str(told)
    assert str(told) in check_study(loaded)["errors"]
    with pytest.raises(InputError, match="no fit of this study's machines"):
        admit(loaded)


def test_a_force_along_a_bodys_axes_cannot_be_doubted(tmp_path: Path) -> None:
    study = MACHINES["body"](tmp_path / "s")
    file = study / "study.toml"
    said = '[streams.video.channels]\nt = { is = "body.force.x", frame = "body", offset_sigma = 0.1 }'
    file.write_text(file.read_text().replace("[streams.video.channels]", said))
    with pytest.raises(InputError, match="turned as it was read"):
        load_study(study)
