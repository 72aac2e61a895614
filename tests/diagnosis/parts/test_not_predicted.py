"""Every recorded channel is predicted by some part, taken as given, or listed as predicted by nothing."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from helpers_balls import balls
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.answer.not_predicted import not_predicted
from spacerobot.diagnosis.answer.schema import validate
from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.effects.registry import all_effects
from spacerobot.recordings.study import Study, load_study
from spacerobot.support.errors import InputError
from spacerobot.support.jsonio import plain
from spacerobot.view.report.evidence import read_evidence
from spacerobot.view.report.page import page

EXTRA = ("aux.temperature", "body.angular_velocity.z")


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    """A ball that falls, beside readings that no model knows."""
    return balls(tmp_path_factory.mktemp("balls"), {"light": (0.05, 0.003)}, beside=EXTRA)


def listed(study: Study, known: set[str]) -> list[str]:
    return [entry.channel for entry in not_predicted(study, known)]


@given(st.sets(st.sampled_from(["body.position.z", *EXTRA])))
def test_known_and_listed_are_all_that_was_recorded(study: Study, known: set[str]) -> None:
    found = listed(study, known)
    assert known.isdisjoint(found)
    assert known | set(found) == set(study.channels())
    assert found == [c for c in study.channels() if c not in known]


def test_the_verdict_and_the_report_say_so_and_nothing_else_changes(study: Study, tmp_path: Path) -> None:
    without = [n for n in all_effects() if n != "quadratic_drag"]
    found = diagnose(study, jobs=1, without=without)
    verdict, evidence = plain(found.verdict), plain(found.evidence)
    assert isinstance(verdict, dict)
    assert isinstance(evidence, dict)
    validate(verdict)
    assert [c["channel"] for c in verdict["not_predicted"]] == list(EXTRA)
    assert (verdict["exact"], verdict["moved"]) == (["body.mass"], {})  # stated for each trial, without a sigma
    text = page(verdict, read_evidence(evidence))
    assert re.search(r"2 recorded channels that no model predicts.*aux\.temperature", text, re.DOTALL)
    bare = diagnose(balls(tmp_path, {"light": (0.05, 0.003)}), jobs=1, without=without).verdict
    assert bare["not_predicted"] == []
    differ = ("not_predicted", "input_hash", "seconds")
    assert {k: v for k, v in bare.items() if k not in differ} == {
        k: v for k, v in found.verdict.items() if k not in differ
    }


@pytest.mark.real
@pytest.mark.parametrize(
    ("name", "silent"),
    [
        ("silverbox", set()),
        ("emps", {"joint.axis.reference"}),
        ("planar_impact", {f"body.{c}.{w}" for c in ("position.x", "position.y", "yaw") for w in ("before", "after")}),
    ],
)
def test_of_real_recordings_drives_and_followed_motion_are_known(name: str, silent: set[str]) -> None:
    try:
        study = load_study(f"real/{name}")
        models = models_for(study)
    except InputError as error:
        pytest.skip(f"the recordings of {name} are not here: {error}")
    known = {c for m in models for c in (*m.given, *(c for t in m.trials for c in t.channels))}
    assert set(listed(study, known)) == silent
