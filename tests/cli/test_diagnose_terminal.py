"""What `diagnose` prints: every kind of verdict, and what has no interval."""

from __future__ import annotations

import argparse

import msgspec
import pytest

from spacerobot.cli.diagnose_run import show
from spacerobot.diagnosis.answer.record import Verdict
from spacerobot.diagnosis.answer.result import Diagnosis
from spacerobot.diagnosis.answer.schema import VERDICTS
from tests.view.helpers_report import verdict


@pytest.mark.parametrize("kind", VERDICTS)
def test_every_kind_of_verdict_is_printed(kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert show(argparse.Namespace(json=False), verdict(kind), None) == 0
    said = capsys.readouterr().out.splitlines()
    assert kind in said[0]
    assert all("None" not in line and line == line.rstrip() for line in said)


def test_a_whole_number_has_no_interval(capsys: pytest.CaptureFixture[str]) -> None:
    found = verdict("named")
    found["effects"][0]["parameters"]["order"] = {"value": 2.0, "ci95": None, "unit": ""}
    show(argparse.Namespace(json=False), found, None)
    (line,) = [x for x in capsys.readouterr().out.splitlines() if "order" in x]
    assert line.split() == ["order", "2"]
    assert "order" in Diagnosis(msgspec.convert(found, Verdict), {})._repr_html_()


def test_a_learned_law_shows_its_values_in_a_notebook() -> None:
    found = verdict("learned")
    (law,) = found["learned"]
    shown = Diagnosis(msgspec.convert(found, Verdict), {})._repr_html_()
    assert all(name in shown for name in law["parameters"])
