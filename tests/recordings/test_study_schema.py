"""study.toml's JSON Schema: whatever the reader takes is valid, a misspelled key is not, every key and unit is told."""

from __future__ import annotations

import copy
import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from spacerobot.recordings import baseline, gears, schema_rules, stream, study, trial
from spacerobot.recordings.channel import EXAMPLES
from spacerobot.recordings.new_study import new_study
from spacerobot.recordings.study_schema import study_schema
from spacerobot.recordings.values import GROUPS, known_names
from spacerobot.support.json_schema import checker
from spacerobot.support.jsonio import dumps
from tests.diagnosis.rigs import write_study
from tests.door.machines import MACHINES
from tests.overlay.studies import DATA

EXAMPLES_TOP = Path(__file__).resolve().parents[2] / "examples"
WRITTEN = sorted(EXAMPLES_TOP.rglob("study.toml"))
CHECK = checker(study_schema())

WHOLE = tomllib.loads(
    """
format = 1
draft = true
title = "every place in which a key may stand"
exact = ["wrist.mass"]
horizon = 2.5
[baseline]
robot = "pa10_wrist"
base = "fixed"
joints = "servo"
pose_deg = [0, 45, 0, 90, 0, -45, 0]
approach = [1, 0, 0]
gravity = [0, 0, -9.8]
"wrist.stiffness" = 1200
link.hand.inertia = [0.1, 0.1, 0.1]
[baseline.contact]
law = "hertz"
stiffness = "unknown"
[baseline.target]
contact_point = [0.3, 0.01]
"inertia.x" = 0.3
[baseline.joint]
"elbow.gain" = 2.0
wrist_1.bias = 0.1
[baseline.sigma]
wrist.mass = 0.01
"joint.elbow.zero" = "0.2 deg"
joint.elbow."gain" = 0.05
target.contact_point.lateral = "1 mm"
[baseline.scatter]
contact.stiffness = 0.1
[gears]
streams = ["log"]
joints = ["a", "b"]
ratio = [[45, 0], [32, 32]]
torque_per_ampere = 0.07
[streams.log]
time = 0
time_unit = "ms"
separator = "semicolon"
missing = [-999, 0]
rows = [2]
clock = "own"
[streams.log.channels]
x = { is = "target.x", unit = "mm", plus = { y = 0.1, z = [0, 0.02] }, offset_sigma = 0.1 }
body.x = { is = "hand.x" }
3 = [{ is = "joint.elbow.position" }, { is = "aux.elbow", missing = 0 }]
[streams.hits]
kind = "events"
channels.v = { is = "body.velocity.x", moment = "before", use = "input" }
[[trials]]
id = 3
condition = 12
target.mass = 9
"wrist.damping" = 2.0
pose = [0.1, 0.2]
window = [0, 3]
offset."target.x" = 0.3
offset.hand.x = 0.3
log = { file = "a.csv", rows = [0, 20], time_file = "t.txt" }
[[trials]]
id = "run {n:03d}"
each = [0, 20]
step = 2.0
window = [0, 2]
log = "all.csv"
hits = "hits.csv"
[[trials]]
index = "runs.csv"
id = "{run}"
target.mass = "{mass} g"
window = ["{from}", "{to}"]
offset."target.x" = "{zero}"
log = "{file}"
"""
)
"""A study of every kind of key."""


def breaches(told: dict[str, Any]) -> list[str]:
    return [error.message for error in CHECK.iter_errors(told)]


def test_the_schema_is_itself_valid() -> None:
    checker(study_schema())


@pytest.mark.parametrize("path", WRITTEN, ids=lambda p: p.parent.name)
def test_every_example_is_valid(path: Path) -> None:
    assert breaches(tomllib.loads(path.read_text(encoding="utf-8"))) == []


@pytest.mark.parametrize("name", sorted(MACHINES))
def test_studies_of_every_machine_are_valid(tmp_path: Path, name: str) -> None:
    assert breaches(tomllib.loads((MACHINES[name](tmp_path / "s") / "study.toml").read_text())) == []


@pytest.mark.parametrize("folder", ["motive_and_ati", "semicolons"])
def test_what_study_new_writes_is_valid(tmp_path: Path, folder: str) -> None:
    found = DATA / "newcomer" / folder
    found = found if found.is_dir() else EXAMPLES_TOP / "newcomer" / folder
    if not found.is_dir():
        pytest.skip("the newcomer's folders are not here")
    new_study(found, out=tmp_path / "study.toml")
    assert breaches(tomllib.loads((tmp_path / "study.toml").read_text(encoding="utf-8"))) == []


def test_a_study_of_every_kind_of_key_is_valid(tmp_path: Path) -> None:
    assert breaches(WHOLE) == []
    assert breaches(tomllib.loads(write_study(tmp_path).path.read_text())) == []


def tables(told: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[tuple[str | int, ...], dict[str, Any]]]:
    """Every table of a study with where it stands."""
    if isinstance(told, dict):
        yield path, told
    for key, inner in told.items() if isinstance(told, dict) else enumerate(told) if isinstance(told, list) else ():
        yield from tables(inner, (*path, key))


OWN_NAMES = [("streams",), ("streams", "log", "channels"), ("streams", "hits", "channels"), ("baseline", "joint")]
OWN_NAMES += [("baseline", "link"), ("baseline", "sigma", "joint"), ("streams", "log", "channels", "x", "plus")]
"""Tables whose keys are the user's own: nothing in them is misspelled."""

PLACES = [path for path, _ in tables(WHOLE) if path not in OWN_NAMES and "offset" not in path]


@pytest.mark.parametrize("path", PLACES, ids=lambda p: ".".join(map(str, p)) or "top")
def test_a_misspelled_key_is_not_valid(path: tuple[str | int, ...]) -> None:
    """Whatever it holds: a number, a list or a table; in a trial a text would be the file of a stream."""
    for value in (1.0, [1.0, 2.0, 3.0, 4.0], {"nonsense": {"more": 1}}):
        told = copy.deepcopy(WHOLE)
        at: Any = told
        for key in path:
            at = at[key]
        at["stifness"] = value
        assert breaches(told), value


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("format", 2),
        ("draft", "yes"),
        ("horizon", 0),
        ("baseline", {"base": "floating"}),
        ("baseline", {"wrist": {"mass": 0.0}}),
        ("baseline", {"wrist": {"stiffness": "1200 N/m"}}),
        ("baseline", {"target": {"contact_point": [1.0]}}),
        ("baseline", {"sigma": {"wrist.mass": -0.1}}),
        ("streams", {"log": {"time": "t"}}),
        ("streams", {"log": {"channels": {"x": {"is": "target.x"}}}}),
        ("streams", {"window": {"time": "t", "channels": {"x": {"is": "target.x"}}}}),
        ("streams", {"log": {"time": "t", "channels": {"x": {"is": "targt.x"}}}}),
        ("streams", {"log": {"time": "t", "channels": {"x": {"is": "target.x", "unit": "furlong"}}}}),
        ("trials", []),
        ("trials", [{"log": "a.csv"}]),
    ],
)
def test_values_that_the_reader_refuses_are_not_valid(key: str, value: object) -> None:
    assert breaches({**WHOLE, key: value})


def test_every_key_of_the_readers_has_a_rule_and_no_other() -> None:
    rules = (
        (study._TOP, schema_rules.TOP, {"format", "baseline", "gears", "streams", "trials"}),
        (baseline._PLAIN, schema_rules.BASELINE, set()),
        (gears._KEYS, schema_rules.GEARS, set()),
        (stream._KEYS, schema_rules.STREAM, {"channels"}),
        (stream._CHANNEL_KEYS, schema_rules.CHANNEL, set()),
        (trial._KEYS, schema_rules.TRIAL, set()),
        (trial._SOURCE_KEYS, schema_rules.SOURCE, set()),
    )
    for keys, known, elsewhere in rules:
        assert set(keys) == set(known) | elsewhere


@pytest.mark.parametrize("name", known_names())
def test_every_value_of_a_baseline_is_valid_nested_and_quoted(name: str) -> None:
    group, _, key = name.replace("NAME", "elbow").rpartition(".")
    kind = GROUPS[name.rpartition(".")[0]][key]
    value = [1.0] * len(kind.parts) if kind.parts else 1.0
    nested: dict[str, Any] = {key: value}
    for word in reversed(group.split(".")):
        nested = {word: nested}
    for stated in (nested, {f"{group}.{key}": value}, {**nested, "sigma": {f"{group}.{key}": 0.1}}):
        assert breaches({**WHOLE, "baseline": stated}) == []


def test_every_kind_of_channel_is_valid() -> None:
    for name in EXAMPLES:
        log = {"time": "t", "channels": {"x": {"is": name}}}
        assert breaches({**WHOLE, "streams": {"log": log}}) == [], name


def numbers(rule: Any, words: str = "") -> Iterator[str]:
    """What is said of every number of a schema."""
    if isinstance(rule, list):
        for one in rule:
            yield from numbers(one, words)
    elif isinstance(rule, dict):
        said = f"{words} {rule['description']}" if isinstance(rule.get("description"), str) else words
        if rule.get("type") in ("number", "integer"):
            yield said
        for key, inner in rule.items():
            yield from numbers(inner, "" if key in ("properties", "patternProperties", "$defs") else said)


def test_every_number_has_a_unit() -> None:
    told = list(numbers({k: v for k, v in study_schema().items() if k != "description"}))
    indices = "its index from 0|from 0;|a trial for each number|the trial's name|what it shares"
    assert len(told) > 200
    assert [said for said in told if not re.search(rf"\[[^\]]+\]|{indices}", said)] == []


def test_it_is_printed_and_shipped() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "spacerobot", "study", "schema"], capture_output=True, text=True, check=True
    )
    assert json.loads(done.stdout) == study_schema()
    shipped = Path(study.__file__).with_name("study.schema.json")
    assert shipped.read_text(encoding="utf-8") == dumps(study_schema()) + "\n"
