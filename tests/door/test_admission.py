"""Whatever `study check` accepts, `overlay` and `diagnose` answer; what they refuse, it refuses, in the same words."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spacerobot.cli.main import main
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection.admission import admit, has_wrist
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError
from tests.door.mutations import (
    Mutation,
    constant,
    drop_rows,
    drop_stream,
    drop_trials,
    mutations,
    renamed,
    sigma,
    small,
)


def answered(arguments: list[str], monkeypatch: pytest.MonkeyPatch) -> int:
    """The exit code; an error that nobody foresaw is raised."""
    monkeypatch.setenv("SPACEROBOT_DEBUG", "1")
    return main(arguments)


def begun(folder: Path) -> None:
    """What every diagnosis begins with, without its search; raises what that would raise."""
    study = load_study(folder)
    admit(study)
    if not has_wrist(study):
        return
    workshop = Workshop(study)
    fit = workshop.run(Task((), {}, max_iterations=2))
    assert fit is not None
    assert np.isfinite(fit.cost)
    assert np.isfinite(fit.z).all()


@given(changes=st.lists(mutations(), min_size=1, max_size=2))
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_what_check_accepts_is_answered(
    changes: list[Mutation], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with tempfile.TemporaryDirectory() as top:
        folder = small(Path(top) / "study")
        for change in changes:
            change(folder)
        code = answered(["study", "check", str(folder), "--json"], monkeypatch)
        capsys.readouterr()
        if code == 0:
            begun(folder)
            if answered(["overlay", str(folder), "--json"], monkeypatch) == 0:
                json.loads(capsys.readouterr().out)
        else:
            assert code == 2
            with pytest.raises(InputError):
                begun(folder)


@pytest.mark.slow
@given(changes=st.lists(mutations(), min_size=1, max_size=3))
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_whole_diagnosis_answers_too(changes: list[Mutation], monkeypatch: pytest.MonkeyPatch) -> None:
    with tempfile.TemporaryDirectory() as top:
        folder = small(Path(top) / "study")
        for change in changes:
            change(folder)
        code = answered(["study", "check", str(folder)], monkeypatch)
        assert answered(["diagnose", str(folder), "--jobs", "1"], monkeypatch) == code


CASES = {
    "no readings of the target": (drop_rows("01_mocap.csv", 1), "target.x has too few readings; given: 1 in trial 01"),
    "one trial": (drop_trials(1), "at least two trials"),
    "no track": (drop_stream("mocap", "02"), "without target.x has no start; given: 02"),
    "sigma of nothing": (sigma("target.x", "1e-300"), "sigma of target.x is out of range"),
    "no target": (renamed("target.x", "target.yaw"), "without target.x"),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("command", [["study", "check"], ["diagnose"]])
def test_it_is_said_where_and_what(
    case: str, command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    change, says = CASES[case]
    folder = small(tmp_path / "study")
    change(folder)
    assert main([*command, str(folder)]) == 2
    said = capsys.readouterr()
    line = next(text for text in (said.out + said.err).splitlines() if says in text)
    assert f"{folder}/study.toml" in line


@pytest.mark.parametrize("name", ["aux.temperature", "joint.S1.position", "target.yaw"])
def test_a_channel_without_a_readout_is_left_aside(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """And changes nothing: the fit is that of the study without it."""
    with_it, without = small(tmp_path / "with"), small(tmp_path / "without")
    renamed("wrist.x", name)(with_it)
    for path in (without / "study.toml",):
        path.write_text(
            "\n".join(line for line in path.read_text().splitlines() if '"wrist.x"' not in line), encoding="utf-8"
        )
    assert main(["study", "check", str(with_it), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["not_predicted"] == [name]
    fits = [Workshop(load_study(folder)).run(Task((), {}, max_iterations=2)) for folder in (with_it, without)]
    assert fits[0] is not None
    assert fits[1] is not None
    assert fits[0].cost == fits[1].cost


def test_a_dead_sensor_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = small(tmp_path / "study")
    constant("01_force.csv", 1, "0")(folder)
    assert main(["study", "check", str(folder)]) == 0, "with a stated sigma, no force is a reading like another"
    capsys.readouterr()
    sigma("contact.force", None)(folder)
    assert main(["study", "check", str(folder)]) == 2
    assert "contact.force is 0 throughout" in capsys.readouterr().out
