"""The schema of verdict.json: every kind passes, and each breach of the promise is found."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from helpers_report import FRICTION, KINDS, verdict
from jsonschema import Draft202012Validator

from spacerobot.diagnosis.answer.schema import FORMAT, PROMISED, VERDICTS, schema, validate
from spacerobot.support.errors import InputError


def test_schema_is_itself_valid() -> None:
    Draft202012Validator.check_schema(schema())
    assert set(schema()["properties"]["verdict"]["enum"]) == set(VERDICTS) == set(KINDS)


@pytest.mark.parametrize("kind", KINDS)
def test_complete_verdicts_pass(kind: str) -> None:
    validate(verdict(kind))
    validate({**verdict(kind), "confidence": np.float64(0.5), "an_extension": [1, 2]})


def _without(key: str) -> Any:
    def change(told: dict[str, Any]) -> None:
        del told[key]

    return change


@pytest.mark.parametrize(
    ("kind", "change", "path"),
    [
        *[("named", _without(key), "verdict") for key in schema()["required"]],
        ("named", lambda v: v.update(verdict="perhaps"), "verdict.verdict"),
        ("named", lambda v: v.update(confidence=1.2), "verdict.confidence"),
        ("named", lambda v: v.update(format=2), "verdict.format"),
        ("named", lambda v: v.update(effects=[]), "verdict.effects"),
        ("unknown", lambda v: v.update(effects=[FRICTION]), "verdict.effects"),
        ("ambiguous", lambda v: v["alternatives"].pop(), "verdict.alternatives"),
        ("wrong_parameter", lambda v: v.update(parameters={}), "verdict.parameters"),
        ("wrong_parameter", lambda v: v["parameters"]["wrist.stiffness"].pop("believed"), "verdict.parameters.wrist"),
        ("named", lambda v: v["effects"][0]["parameters"]["force_N"].update(ci95=[1.0]), "force_N.ci95"),
        ("named", lambda v: v["effects"][0]["parameters"]["force_N"].update(value="much"), "force_N.value"),
        ("named", lambda v: v["located"][0].update(p=1.5), "verdict.located[0].p"),
        ("named", lambda v: v["held_out"].pop("overall"), "verdict.held_out"),
        ("named", lambda v: v["detectable"][0].pop("unit"), "verdict.detectable[0]"),
        ("ambiguous", lambda v: v["next_experiment"].pop("why"), "verdict.next_experiment"),
    ],
)
def test_breaches_are_named_with_their_place(kind: str, change: Any, path: str) -> None:
    told = verdict(kind)
    change(told)
    with pytest.raises(InputError) as caught:
        validate(told)
    assert path in str(caught.value)


def test_no_seconds_for_a_checker_of_what_the_schema_does_not_have() -> None:
    words = (
        "import sys; from spacerobot.diagnosis.answer.schema import _validator; _validator(); "
        "print([name for name in sys.modules if name.startswith('rfc3987_syntax')])"
    )
    done = subprocess.run([sys.executable, "-c", words], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
    assert "iri" not in str(schema())


def test_what_no_format_promised_raises_its_number() -> None:
    """A new key or kind must be promised under a new number: old readers were never told of it."""
    kinds, keys = PROMISED[FORMAT]
    assert set(VERDICTS) <= kinds
    assert set(schema()["properties"]) <= keys
    assert schema()["properties"]["format"]["enum"] == [FORMAT]
    assert max(PROMISED) == FORMAT


@pytest.mark.parametrize(("number", "word"), [(FORMAT + 1, "newer"), (FORMAT - 1, "older")])
def test_readers_of_another_format_are_told_in_one_line(number: int, word: str) -> None:
    with pytest.raises(InputError, match=word) as told:
        validate({**verdict("named"), "format": number})
    assert "\n" not in str(told.value)


def test_every_number_of_the_schema_has_a_unit() -> None:
    """Stated beside it, or in the words of what holds it."""
    found = schema()
    for name in ("seconds", "confidence", "located", "held_out", "detectable", "parameters", "moved"):
        said = found["properties"][name]["description"]
        assert any(word in said for word in ("[s]", "[1]", "SI", "unit", "sigma")), name
    assert "SI" in found["description"]
