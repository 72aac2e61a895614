"""Fits recover what was planted, from a wrong start, and never cost more than the truth."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.linearised import _slope
from spacerobot.diagnosis.fitting.screen import Screener, together
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.effects.registry import effect
from spacerobot.support.errors import SimulationError
from tests.diagnosis.rigs import write_study

FRICTION = (("coulomb_friction", "wrist"),)


@pytest.fixture(scope="module")
def rubbing(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    folder = tmp_path_factory.mktemp("rubbing")
    truth = {"wrist.stiffness": 1012.0, "wrist.equivalent_damping": 0.0}
    planted = [("coulomb_friction", "wrist", {"force_N": 0.4})]
    return Workshop(write_study(folder, planted=planted, truth=truth))


def truth_cost(workshop: Workshop, made, values: dict[str, float]) -> float:
    fitter = workshop.fitter()
    speeds = {"00": 0.06, "01": 0.11, "10": 0.06, "11": 0.11}
    state = fitter.state(made, made.start(values), {k: np.array([-0.02, v]) for k, v in speeds.items()})
    assert state is not None
    prior = np.array([f.prior for f in made.free], dtype=float)
    return state.chi2() + float(prior @ state.z**2)


@pytest.mark.parametrize("start", [0.05, 1.5])
def test_planted_friction_is_recovered_from_a_wrong_start(rubbing: Workshop, start: float) -> None:
    fit = rubbing.run(Task(FRICTION, {"coulomb_friction@wrist.force_N": start}))
    assert fit is not None
    assert fit.values()["coulomb_friction@wrist.force_N"] == pytest.approx(0.4, abs=0.01)
    assert fit.values()["contact.damping"] == pytest.approx(60.0, rel=0.05)
    assert fit.chi2 / fit.samples == pytest.approx(1.0, abs=0.04)
    truth = {
        "coulomb_friction@wrist.force_N": 0.4,
        "wrist.equivalent_damping": 0.0,
        "wrist.stiffness": 1012.0,
        "contact.damping": 60.0,
    }
    assert fit.cost <= truth_cost(rubbing, fit.hypothesis, truth) + 1.0


def test_without_the_effect_the_fit_is_visibly_worse(rubbing: Workshop) -> None:
    base = rubbing.run(Task((), {}))
    better = rubbing.run(Task(FRICTION, {"coulomb_friction@wrist.force_N": 0.2}))
    assert base is not None
    assert better is not None
    assert base.cost > better.cost + 300.0


def test_interval_covers_the_truth(rubbing: Workshop) -> None:
    fit = rubbing.run(Task(FRICTION, {"coulomb_friction@wrist.force_N": 0.2}))
    assert fit is not None
    assert fit.covariance is not None
    index = fit.hypothesis.keys.index("wrist.stiffness")
    free = fit.hypothesis.free[index]
    spread = 4.0 * np.sqrt(fit.covariance[index, index])
    assert free.value(fit.z[index] - spread) < 1012.0 < free.value(fit.z[index] + spread)


def test_screening_puts_the_planted_effect_first(rubbing: Workshop) -> None:
    base = rubbing.run(Task((), {}))
    assert base is not None
    sites = [Site(effect(n), "wrist") for n in ("coulomb_friction", "cubic_stiffness", "backlash")]
    sites.append(Site(effect("table_tilt"), "target"))
    screen = Screener(rubbing.fitter(), rubbing.model.believed).screen(base, sites)
    assert screen.scored[0].site.label == ("coulomb_friction", "wrist")
    assert screen.pairs()[0][0] >= screen.scored[0].gain - 1e-6  # a pair never explains less than its best half


def test_screening_counts_what_pulled_values_pay(tmp_path: Path) -> None:
    """A scale error that believed values have taken up leaves little in the readings, and much in their priors."""
    planted = [("scale", "force_sensor", {"factor": 1.06}), ("time_offset", "mocap", {"delay_s": 0.004})]
    workshop = Workshop(write_study(tmp_path, planted=planted))
    late = workshop.run(Task((("time_offset", "mocap"),), {"time_offset@mocap.delay_s": 0.004}))
    assert late is not None
    paid = late.cost - late.chi2
    assert paid > 100.0
    scale = Site(effect("scale"), "force_sensor")
    (first, *_) = Screener(workshop.fitter(), workshop.model.believed).screen(late, [scale]).scored
    both = workshop.run(Task(tuple(sorted([scale.label, *late.hypothesis.label])), dict(first.start), near=late))
    assert both is not None
    assert late.cost - both.cost > 0.7 * paid
    assert first.gain == pytest.approx(late.cost - both.cost, rel=0.5)


def test_scores_do_not_depend_on_how_the_sites_are_parted(rubbing: Workshop) -> None:
    base = rubbing.run(Task((), {}))
    assert base is not None
    sites = [Site(effect(n), "wrist") for n in ("coulomb_friction", "cubic_stiffness", "backlash")]
    screener = Screener(rubbing.fitter(), rubbing.model.believed)
    whole = together([screener.screen(base, sites)], sites)
    parts = together([screener.screen(base, sites[k::2]) for k in (1, 0)], sites)
    assert [(s.site.label, s.start, s.gain) for s in whole.scored] == [
        (s.site.label, s.start, s.gain) for s in parts.scored
    ]
    assert [p[0] for p in whole.pairs()] == [p[0] for p in parts.pairs()]


def test_trials_order_changes_nothing(tmp_path: Path) -> None:
    workshop = Workshop(write_study(tmp_path, masses=(9.0,), speeds=(0.06, 0.1, 0.12)))
    one = workshop.run(Task((), {}))
    turned = Fitter(workshop.model, workshop.trials[::-1])
    two = turned.fit(one.hypothesis, warm=None) if one else None
    assert one is not None
    assert two is not None
    assert two.cost == pytest.approx(one.cost, abs=0.2)


def test_rescue_brings_back_a_start_that_wandered(rubbing: Workshop) -> None:
    fit = rubbing.run(Task(FRICTION, {"coulomb_friction@wrist.force_N": 0.2}))
    assert fit is not None
    fitter = rubbing.fitter()
    lost = {k: v + np.array([3e-3, -2e-3]) for k, v in fit.initials().items()}
    state = fitter.state(fit.hypothesis, fit.z, lost)
    assert state is not None
    back, moved = fitter.rescue(fit.hypothesis, state)
    assert moved
    assert back.chi2() < 3.0 * fit.chi2 < 0.1 * state.chi2()


@pytest.mark.parametrize(
    ("either", "both", "broken", "expected"),
    [
        (True, False, (), 2.1),  # forward
        (True, True, (), 2.0),  # central
        (False, True, (), 2.1),  # at a bound
        (True, False, (0.1,), 1.9),  # what cannot be simulated ahead is asked behind
        (True, True, (-0.1,), 2.1),
        (True, True, (0.1, -0.1), 0.0),
        (False, False, (0.1,), 0.0),
    ],
)
def test_a_difference_that_cannot_be_simulated_is_taken_elsewhere(
    either: bool, both: bool, broken: tuple[float, ...], expected: float
) -> None:
    def shown(by: float) -> np.ndarray:
        if by in broken:
            raise SimulationError("no")
        return np.array([2.0 * by + by**2])

    assert _slope(shown, np.zeros(1), 0.1, either, both) == pytest.approx(expected)
