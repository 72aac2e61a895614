"""Where the noise is stated, a choice must gain more under it than chance brings."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

pytest.importorskip("mujoco", reason="the extra `proof` is not installed")

from helpers_driven import driven_study

from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.selection import forward_selection as module
from spacerobot.diagnosis.selection.candidate import Candidate
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.judge import moved
from spacerobot.diagnosis.terms.hypothesis import Label
from spacerobot.effects.registry import effect
from spacerobot.proof.engine.missing import Missing

JOINT = "S1"


def rash(tested: Sequence[Candidate], baseline: Candidate, trials: object) -> Candidate:
    """Always an effect."""
    return min((c for c in tested if c.sites), key=lambda c: c.error, default=baseline)


def chosen_rashly(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    hidden: tuple[Missing, ...] = (),
    known: tuple[str, ...] = ("coulomb_friction", "viscous_friction"),
    seed: int = 4,
) -> Label:
    """What stands of a search that always wants an effect, whatever unseen trials say of it."""

    monkeypatch.setattr(module, "choice", rash)
    (model,) = [m for m in models_for(driven_study(folder, *hidden, seed=seed)) if m.name == JOINT]
    found = grow(model, effects=[effect(name) for name in known])
    assert (found.after is found.before) == (not found.after.sites)
    assert found.after.sites or not found.rivals
    return found.after.label


@pytest.mark.slow
def test_what_gains_nothing_under_the_stated_noise_is_not_chosen(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert chosen_rashly(tmp_path, monkeypatch) == ()


def test_the_best_of_many_places_must_gain_more_than_one_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of nine effects one gained 5.7 with nothing there; alone one in fifty would, of nine the best one in six."""
    frictions = ("coulomb_friction", "viscous_friction", "asymmetric_friction", "quadratic_damping")
    tried = (*frictions, "preload", "cubic_stiffness", "time_offset", "scale", "low_pass")
    assert chosen_rashly(tmp_path, monkeypatch, known=tried, seed=1) == ()


def test_what_is_there_stands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    item = Missing("coulomb_friction", f"joint.{JOINT}", {"force_Nm": 0.3})
    assert ("coulomb_friction", f"joint.{JOINT}") in chosen_rashly(tmp_path, monkeypatch, (item,))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_link_far_heavier_than_stated_bends_no_other_and_needs_no_push(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    """Held by what was stated of it, it pulled the links before it along, and a preload made up for the rest."""
    monkeypatch.setattr(module, "choice", rash)
    study = driven_study(tmp_path, seed=seed, heavier={"link7": 1.8})
    (model,) = [m for m in models_for(study) if m.name == "E1"]
    found = grow(model, effects=[effect(name) for name in ("preload", "coulomb_friction", "end_stop")])
    assert found.after is found.before
    assert moved(found.after.fit) == ("link.link7.mass",)
    value = found.after.fit.values()["link.link7.mass"] / model.believed.values["link.link7.mass"]
    assert value == pytest.approx(1.8, rel=0.1)


@pytest.mark.slow
def test_an_effect_whose_interval_holds_nothing_is_not_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Even where chance and unseen trials were to speak for it."""
    monkeypatch.setattr(module, "by_chance", lambda *asked: False)
    monkeypatch.setattr(module, "pays", lambda new, old, trials: True)
    assert chosen_rashly(tmp_path, monkeypatch, known=("viscous_friction",)) == ()
    monkeypatch.setattr(module, "unshown", lambda fit: "")
    assert chosen_rashly(tmp_path, monkeypatch, known=("viscous_friction",)) != ()
