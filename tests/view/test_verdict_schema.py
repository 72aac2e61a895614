"""The schema of verdict.json: every kind passes, and each breach of the promise is found."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers_report import FRICTION, KINDS, verdict

from spacerobot.diagnosis.answer.schema import FORMAT, PROMISED, VERDICTS, schema, validate
from spacerobot.support.errors import InputError
from spacerobot.support.json_schema import checker


def test_schema_is_itself_valid() -> None:
    checker(schema())
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


def _numbers(found: dict[str, Any], rule: Any, seen: tuple[str, ...] = ()) -> bool:
    """Whether a rule of the schema holds a number that is not in a record of its own."""
    if not isinstance(rule, dict):
        return False
    if rule.get("type") in ("number", "integer"):
        return True
    inner = [*rule.get("anyOf", ()), *rule.get("prefixItems", ()), rule.get("items"), rule.get("additionalProperties")]
    return any(_numbers(found, each) for each in inner)


def test_every_number_of_the_schema_has_a_unit() -> None:
    """In its own words, or in a key beside it that says whose unit it is."""
    found = schema()
    lacking = []
    for name, record in {"Verdict": found, **found["$defs"]}.items():
        units = " ".join(r.get("description", "") for k, r in record.get("properties", {}).items() if "unit" in k)
        for key, rule in record.get("properties", {}).items():
            said = rule.get("description", "")
            told = re.search(r"\[[^\]]+\]|\bSI\b|\bunit\b", said) or re.search(rf"\b{key}\b", units)
            if key != "format" and _numbers(found, rule) and not told:
                lacking.append(f"{name}.{key}")
    assert lacking == []
    assert "SI" in found["description"]
    assert _numbers(found, {"type": "array", "items": {"anyOf": [{"type": "number"}, {"type": "null"}]}})


def _promised(record: str, rules: dict[str, Any]) -> set[str]:
    return {f"{record}.{key}" for key in rules.get("properties", {})}


def test_no_key_of_a_record_is_new_without_a_new_number() -> None:
    """`promised_1.txt` is what readers of format 1 were told of; a further key belongs into the next format's file."""
    file = Path(__file__).with_name(f"promised_{FORMAT}.txt")
    told = set(file.read_text(encoding="utf-8").split())
    found = schema()
    now = set().union(*(_promised(name, rules) for name, rules in {"Verdict": found, **found["$defs"]}.items()))
    assert now <= told, f"raise FORMAT, and list what is new in promised_{FORMAT + 1}.txt"
