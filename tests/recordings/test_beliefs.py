"""How well a value of a wrist rig is known where the lab does not say."""

from __future__ import annotations

from pathlib import Path

import pytest

from spacerobot.cli.main import main
from spacerobot.recordings.beliefs import UNSTATED, Beliefs, beliefs_of
from spacerobot.recordings.study import load_study
from spacerobot.simulation.rig import DEFAULTS
from spacerobot.support.errors import InputError
from tests.diagnosis.rigs import write_study


def edited(folder: Path, *edits: tuple[str, str]) -> Path:
    write_study(folder, masses=(9.0,), speeds=(0.06, 0.11))
    file = folder / "study.toml"
    text = file.read_text()
    for old, new in edits:
        assert old in text, old
        text = text.replace(old, new, 1)
    file.write_text(text)
    return file


def beliefs(folder: Path, *edits: tuple[str, str]) -> Beliefs:
    return beliefs_of(load_study(edited(folder, *edits)), DEFAULTS)


C_EQ = ('"wrist.equivalent_damping" = 0.15\n', "")
MASS = ('"wrist.mass" = 0.01\n', "")
TARGET = ('"target.mass" = 0.002\n', "")


def test_what_is_stated_stays_as_it_is_stated(tmp_path: Path) -> None:
    """And the wrist's damping, which adds to the absorbing constant, is as well known as that."""
    study = load_study(edited(tmp_path))
    found = beliefs_of(study, DEFAULTS)
    assert found == Beliefs(study.sigma, (), {})
    assert "wrist.damping" in study.values()
    assert found.words() == ()


def test_a_mass_without_a_sigma_is_known_to_two_per_cent(tmp_path: Path) -> None:
    found = beliefs(tmp_path, MASS, TARGET)
    assert found.assumed == ("wrist.mass", "target.mass")
    assert found.sigma["wrist.mass"] == found.sigma["target.mass"] == UNSTATED == 0.02
    assert any("wrist.mass, target.mass" in said for said in found.words())


def test_a_constant_that_absorbs_is_free_and_takes_the_damping_with_it(tmp_path: Path) -> None:
    found = beliefs(tmp_path, C_EQ)
    assert found.free == {"wrist.equivalent_damping": -2.1}
    assert "wrist.damping" not in found.sigma
    assert found.assumed == ()


def test_a_damping_of_its_own_sigma_does_not_go_with_it(tmp_path: Path) -> None:
    found = beliefs(tmp_path, ('"wrist.equivalent_damping" = 0.15', '"wrist.damping" = 0.1'))
    assert found.free == {"wrist.equivalent_damping": 0.0}
    assert found.sigma["wrist.damping"] == 0.1


@pytest.mark.parametrize("place", ["format = 1\n", 'robot = "pa10_wrist"\n'])
def test_exact_holds_values(tmp_path: Path, place: str) -> None:
    names = 'exact = ["wrist.mass", "wrist.equivalent_damping", "wrist.damping"]\n'
    found = beliefs(tmp_path, MASS, C_EQ, (place, place + names))
    assert found.assumed == ()
    assert found.free == {}
    assert not {"wrist.mass", "wrist.damping"} & set(found.sigma)


def test_geometry_is_exact(tmp_path: Path) -> None:
    new = "\n[baseline.target]\nyaw_inertia = 0.2\ncontact_point = [0.1, 0.01]\n\n[baseline.sigma]"
    assert beliefs(tmp_path, ("\n[baseline.sigma]", new)).assumed == ("target.yaw_inertia",)


@pytest.mark.parametrize(
    ("given", "why"),
    [('"wrist.mass"', "must be a list"), ('["wrist.mas"]', "wrist.mass"), ('["wrist.mass"]', "exact and have a sigma")],
)
def test_exact_is_refused_with_the_reason(tmp_path: Path, given: str, why: str) -> None:
    with pytest.raises(InputError, match=why):
        load_study(edited(tmp_path, ("format = 1\n", f"format = 1\nexact = {given}\n")))


def test_check_says_what_was_assumed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = edited(tmp_path, MASS, C_EQ)
    assert main(["study", "check", str(file)]) == 0
    said = capsys.readouterr().out
    assert "taken as known to 2%: wrist.mass" in said
    assert "wrist.equivalent_damping has no sigma and is there to absorb" in said
