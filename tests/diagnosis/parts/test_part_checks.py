"""The checks of a part that is not the wrist rig can fail, each of them, and take its name back."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from helpers_models import ARM, arm_log

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.selection.checks import checks_of_part
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.kinds import NAMED, NOT_TRUSTED
from spacerobot.effects.registry import effect
from spacerobot.model.library import load
from spacerobot.support.errors import SimulationError


@pytest.fixture(scope="module")
def part() -> Part:
    """A shoulder with dry friction."""
    robot = load(ARM)
    planted = {"shoulder": (1.2, 0.0, 0.0), "elbow": (0.0, 0.0, 0.0)}
    grids = {f"run{n}": (arm_log(robot, n, planted), f"motion {n}", {}) for n in range(2)}
    model = InverseDynamics(robot, (0.0, 0.0, -9.81), grids, ("shoulder", "elbow"), compared=["shoulder"])
    return Part(grow(model, effects=[effect("coulomb_friction"), effect("viscous_friction")]))


def outcome(part: Part) -> tuple[dict[str, bool], str]:
    checks = checks_of_part(part.model, part.trials, part.growth.before.fit, part.fit)
    return {c.name.split(",")[0]: c.passed for c in checks}, replace(part, checks=checks).verdict


def test_a_sound_fit_passes_all(part: Part) -> None:
    assert outcome(part) == ({"nested cost": True, "cost at truth": True, "calibration": True}, NAMED)


def test_a_smaller_model_that_costs_less_is_noticed(part: Part) -> None:
    before = part.growth.before
    cheap = replace(before, fit=replace(before.fit, chi2=part.fit.chi2 - 50.0, prior=0.0))
    passed, verdict = outcome(replace(part, growth=replace(part.growth, before=cheap)))
    assert not passed["nested cost"]
    assert verdict == NOT_TRUSTED


@pytest.mark.parametrize(("check", "worse", "surer"), [("cost at truth", 100.0, 1.0), ("calibration", 0.0, 1e-5)])
def test_a_fit_that_stops_short_or_claims_too_much_is_noticed(
    part: Part, monkeypatch: pytest.MonkeyPatch, check: str, worse: float, surer: float
) -> None:
    whole = Fitter.fit

    def bad(self: Fitter, *args: Any, **options: Any) -> Fit:
        fit = whole(self, *args, **options)
        assert fit.covariance is not None
        return replace(fit, chi2=fit.chi2 + worse, covariance=surer * fit.covariance)

    monkeypatch.setattr(Fitter, "fit", bad)
    passed, verdict = outcome(part)
    assert [name for name, good in passed.items() if not good] == [check]
    assert verdict == NOT_TRUSTED


def test_a_copy_that_cannot_be_simulated_is_noticed(part: Part, monkeypatch: pytest.MonkeyPatch) -> None:
    def none(self: Fitter, *args: Any, **options: Any) -> Fit:
        raise SimulationError("made to fail")

    monkeypatch.setattr(Fitter, "fit", none)
    passed, verdict = outcome(part)
    assert not passed["cost at truth"]
    assert verdict == NOT_TRUSTED
