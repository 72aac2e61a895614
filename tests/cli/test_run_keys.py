"""Every option that changes a result changes the run's key, so that a finished run is never taken for another one."""

from __future__ import annotations

import argparse
import functools
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from spacerobot.cli.main import COMMANDS, build_parser, main
from spacerobot.effects import registry
from spacerobot.support.runs import RunFolder
from tests.effects.test_registry import OWN
from tests.sweep.helpers_sweep import SWEEP

POSE = ["--q", "0", "1", "0", "1", "0", "1", "0"]
SERVO = ["--joints", "servo", "--servo-stiffness", "3e3", "--servo-damping", "5"]

BASE: dict[str, list[str]] = {
    "mass": [
        "pa10_wrist",
        "--target-mass",
        "9",
        *SERVO,
        "--frequency",
        "2",
        "--q",
        *["0", "1", "0", "1", "0", "1", "0"],
    ],
    "simulate": ["pa10_wrist", *SERVO, *POSE],
    "paper": [],
    "sweep": ["sweep.toml"],
    "overlay": ["guide-friction"],
    "diagnose": ["guide-friction"],
    "prove": ["--seed", "3"],
    "robots": ["ur5"],
}
"""Ordinary arguments, to which one is added."""

CHASER = ["chaser_pa10_wrist"]
OTHER_BASE: dict[tuple[str, str], list[str]] = {
    ("mass", "--joints"): CHASER,
    ("mass", "--wrist-stiffness"): ["pa10_wrist", "--target-mass", "9", "--wrist-stiffness", "500", *SERVO],
    ("mass", "--slider"): ["pa10_wrist"],
    ("simulate", "--base"): CHASER,
    ("simulate", "--hand-speed"): [*CHASER, "--joints", "free"],
    ("simulate", "--joints"): CHASER,
    ("simulate", "--frame"): ["pa10"],
    ("simulate", "--backend"): ["pa10_wrist"],
}
"""What some options need to mean anything."""

OWN_FILE = "own.py"

CHANGES: dict[str, dict[str, str]] = {
    "mass": {
        "--q": "0 1 0 1 0 1 0.1", "--deg": "", "--direction": "0 1 0", "--frame": "link7", "--base": "free",
        "--joints": "locked", "--slider": "locked", "--servo-stiffness": "4e3", "--servo-damping": "6",
        "--frequency": "3", "--wrist-stiffness": "900", "--target-mass": "8", "--restitution": "0.5", "--speed": "0.3",
        "--aim": "", "--pictures": "", "--to": "0 1 0 1 0 1 0.2 --pictures",
    },
    "simulate": {
        "--base": "fixed", "--joints": "free", "--q": "0 1 0 1 0 1 0.1", "--deg": "", "--frame": "flange",
        "--servo-stiffness": "4e3", "--servo-damping": "6", "--spacecraft-mass": "300", "--hand-speed": "0.01",
        "--wrist-mass": "0.8", "--wrist-stiffness": "900", "--wrist-damping": "2", "--equivalent-damping": "5",
        "--guide-friction": "0.1", "--contact-stiffness": "5e4", "--contact-damping": "20", "--law": "hertz",
        "--exponent": "1.4 --law hertz", "--chi-over-k": "0.5 --law hunt_crossley", "--bilateral": "", "--mu": "0.1",
        "--adhesion": "1", "--target-mass": "8", "--target-inertia": "0.4", "--contact-point": "0.1 0 0",
        "--attitude": "0.1 0 0", "--spin": "0 0 0.1", "--speed": "0.07", "--gap": "0.02", "--approach": "0 1 0",
        "--gravity": "0 0 -9.8", "--effect": "coulomb_friction@wrist:force_N=0.1", "--effects": OWN_FILE,
        "--backend": "reduced", "--duration": "0.7", "--tolerance": "1e-7", "--rate": "500",
    },
    "paper": {"--seed": "4", "--equivalent-damping": "8.5"},
    "sweep": {"--seed": "9"},
    "overlay": {"--trials": "03", "--model": OWN_FILE},
    "diagnose": {"--seed": "4", "--effects": OWN_FILE, "--without": "tether"},
    "prove": {"--seed": "4", "--quick": "", "--kinds": "outsider", "--scenes": "rig", "--share": "0.5",
              "--no-rivals": ""},
    "robots": {"--tip": "ee_link", "--wrist": "", "--chaser": ""},
}  # fmt: skip
"""For each option that changes a result, a value unlike the one that the base has."""

EVERYWHERE = {"-h", "--out", "--json", "--overwrite", "-v"}
NEUTRAL = {
    "mass": {"--set"},  # the PA10 has no joint outside its chain; the answer says every joint, and is in the key
    "simulate": {"--set"},
    "sweep": {"--jobs", "--dask"},
    "overlay": {"--dask", "--data"},  # what the data hold counts, not where they lie
    "diagnose": {"--jobs", "--dask", "--data"},
    "prove": {"--list", "--minutes", "--resume", "--again", "--jobs", "--dask", "--docs", "--page"},
    "robots": {"--package-dir"},
}
"""Options that say where, how fast, or in which form."""

NO_RUN = {"compare", "effects", "demo", "view", "study"}
"""Commands that keep no run of their own arguments."""


class Key(BaseException):
    """The key of a run that is not begun."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Where the files lie that arguments name; effects that a file adds are taken off again."""
    found = tmp_path_factory.mktemp("keys")
    (found / "sweep.toml").write_text(SWEEP)
    (found / OWN_FILE).write_text(OWN)
    before = registry.all_effects()
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(found)
        patch.setattr(RunFolder, "__init__", told)
        yield found
    for name in set(registry.all_effects()) - set(before):
        registry._effects.pop(name)


def told(self: RunFolder, folder: Any, command: str, input_hash: str, **more: Any) -> None:
    raise Key(f"{command} {input_hash}")


@functools.cache
def key(command: str, *arguments: str) -> str:
    """The key of the run that these arguments ask for."""
    with pytest.raises(Key) as seen:
        code = main([command, *arguments, "--out", "out"])
        raise AssertionError(f"{command} {arguments} ended with {code} and no run")
    return str(seen.value)


def options(command: str) -> set[str]:
    actions = build_parser(command)._actions
    choices = next(a for a in actions if isinstance(a, argparse._SubParsersAction)).choices
    return {a.option_strings[0] for a in choices[command]._actions if a.option_strings}


def test_every_option_of_every_command_is_tried_or_neutral() -> None:
    assert set(CHANGES) | NO_RUN == set(COMMANDS)
    for command, changes in CHANGES.items():
        neutral = EVERYWHERE | NEUTRAL.get(command, set())
        assert not neutral & set(changes)
        assert options(command) <= neutral | set(changes), command
        assert set(changes) <= options(command)


@pytest.mark.parametrize(("command", "option"), [(c, o) for c, changes in CHANGES.items() for o in changes])
def test_an_option_that_changes_the_result_changes_the_key(folder: Path, command: str, option: str) -> None:
    if command == "prove":
        pytest.importorskip("mujoco")
    if command == "sweep":
        pytest.importorskip("pyarrow")
    base = OTHER_BASE.get((command, option), BASE[command])
    assert key(command, *base, option, *CHANGES[command][option].split()) != key(command, *base)


def test_the_same_question_has_the_same_key(folder: Path) -> None:
    for command in ("mass", "simulate", "paper", "diagnose", "overlay"):
        assert key(command, *BASE[command], "--json") == key(command, *BASE[command])
    assert key("diagnose", *BASE["diagnose"], "--jobs", "2") == key("diagnose", *BASE["diagnose"])


@pytest.mark.parametrize("name", ["study.toml", "03_force.csv"])
def test_a_byte_of_the_input_changes_the_key(folder: Path, name: str) -> None:
    from spacerobot.recordings.study import load_study, resolve_study

    source = resolve_study("guide-friction").parent
    copied = folder / f"copy-{name}"
    shutil.copytree(source, copied)
    before = load_study(copied).input_hash
    path = copied / name
    path.write_bytes(path.read_bytes() + b"\n")
    assert load_study(copied).input_hash != before
