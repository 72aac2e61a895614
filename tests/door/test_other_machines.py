"""Studies of other machines than a wrist, broken: what `study check` accepts is answered, what not refused."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spacerobot.cli.main import main
from spacerobot.diagnosis.machines.choose import some_models_for
from spacerobot.diagnosis.selection.admission import admit
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError
from tests.door.machines import MACHINES, Mutation, mutations, one_trial, rows


def checked(folder: Path, capsys: pytest.CaptureFixture[str]) -> list[str]:
    """What `study check` refuses."""
    capsys.readouterr()  # what an example before this one said
    code = main(["study", "check", str(folder), "--json"])
    said = capsys.readouterr()
    assert code in (0, 2), said.err
    if not said.out:
        return [said.err.strip()]
    errors: list[str] = json.loads(said.out)["errors"]
    assert bool(errors) == (code == 2)
    return errors


@pytest.mark.parametrize("kind", MACHINES)
@given(changes=st.lists(mutations(), min_size=1, max_size=2))
@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_what_check_accepts_can_be_fitted_and_tried(
    kind: str, changes: list[Mutation], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """And what it refuses a diagnosis refuses in the same words."""
    monkeypatch.setenv("SPACEROBOT_DEBUG", "1")
    with tempfile.TemporaryDirectory() as top:
        folder = MACHINES[kind](Path(top) / "study")
        for change in changes:
            change(folder)
        errors = checked(folder, capsys)
        if errors:
            with pytest.raises(InputError) as refused:
                admit(load_study(folder))
            assert any(str(refused.value) in e for e in errors)
            return
        study = load_study(folder)
        admit(study)
        for model in some_models_for(study):
            bench = Bench(model)
            fit = bench.baseline()
            assert np.isfinite(fit.cost)
            assert bench.held_out(fit) is not None


@pytest.mark.slow
@pytest.mark.parametrize("kind", MACHINES)
@given(changes=st.lists(mutations(), min_size=1, max_size=2))
@settings(max_examples=4, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_whole_diagnosis_answers_too(
    kind: str, changes: list[Mutation], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("SPACEROBOT_DEBUG", "1")
    with tempfile.TemporaryDirectory() as top:
        folder = MACHINES[kind](Path(top) / "study")
        for change in changes:
            change(folder)
        errors = checked(folder, capsys)
        assert main(["diagnose", str(folder), "--jobs", "1"]) == (2 if errors else 0)


@pytest.mark.parametrize("kind", MACHINES)
def test_whole_studies_pass(kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = MACHINES[kind](tmp_path / "study")
    assert checked(folder, capsys) == []
    assert some_models_for(load_study(folder))


def test_a_motion_recorded_once_is_refused_by_both(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Nothing would be left to try a fit on; said at the door, with the line of the trial."""
    folder = MACHINES["platform"](tmp_path / "study")
    one_trial(folder)
    (said,) = checked(folder, capsys)
    assert f"{folder}/study.toml:" in said
    assert "trial a" in said
    assert "a second trial" in said
    assert main(["diagnose", str(folder)]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("kept", [5, 12])
def test_a_trial_that_is_cut_short_does_not_end_a_diagnosis(
    kept: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nothing can be located in a few readings of a fall; the other fall is judged as it is."""
    monkeypatch.setenv("SPACEROBOT_DEBUG", "1")
    folder = MACHINES["body"](tmp_path / "study")
    rows(0, kept)(folder)
    assert checked(folder, capsys) == []
    assert main(["diagnose", str(folder), "--jobs", "1"]) == 0


def test_nothing_but_a_stub_is_refused_at_the_door(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = MACHINES["body"](tmp_path / "study")
    one_trial(folder)
    rows(0, 5)(folder)
    (said,) = checked(folder, capsys)
    assert "too few readings" in said
