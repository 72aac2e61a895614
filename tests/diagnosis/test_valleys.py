"""Where a contact rings its damping has several valleys: wherever a fit begins, it ends in the deepest."""

from __future__ import annotations

import pytest

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import RESCUE_GAIN
from spacerobot.diagnosis.fitting.starts import fit_from
from spacerobot.diagnosis.fitting.valleys import FACTOR, deepest, valleys
from spacerobot.diagnosis.fitting.workshop import Workshop
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from tests.diagnosis.rigs import write_study

KEY = "contact.damping"
TRUE = 88.0
BEGUN = (0.6, 6.0, 40.0, 180.0, 1000.0)
"""N s/m."""

STIFF = {"contact.stiffness": 1.7e5, "wrist.mass": 0.8, "wrist.stiffness": 3400.0, "wrist.equivalent_damping": 13.0}


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    """A tip that rings faster than a camera sees, and nobody feels its force."""
    folder = tmp_path_factory.mktemp("ringing")
    rig = {"truth": {**STIFF, KEY: TRUE}, "believed": STIFF, "masses": (5.58, 23.6), "speeds": (0.025, 0.057)}
    return Workshop(write_study(folder, **rig, tracking=5e-5, pressed=False))


@pytest.fixture(scope="module")
def plain(shop: Workshop) -> list[Fit]:
    """Fits of the baseline from everywhere, which stay in the valley in which they began."""
    made = hypothesis(shop.model.believed, ())
    return [shop.fitter().fit(made, warm={KEY: value}) for value in BEGUN]


def test_a_fit_alone_stays_in_a_wrong_valley(plain: list[Fit]) -> None:
    """Else the tests below could not fail."""
    costs = [f.cost for f in plain]
    assert max(costs) > min(costs) + 10.0 * RESCUE_GAIN


def test_wherever_it_begins_it_ends_in_the_deepest(shop: Workshop, plain: list[Fit]) -> None:
    for value in BEGUN:
        fit = fit_from(shop.fitter(), shop.model.believed, (), {KEY: value})
        assert fit.cost < min(f.cost for f in plain) + RESCUE_GAIN
        assert fit.values()[KEY] == pytest.approx(TRUE, rel=0.2)


def test_what_is_promised_there_is_found(shop: Workshop, plain: list[Fit]) -> None:
    """To first order, and to a step of the search: the fit from there costs no more, and lies next to it."""
    worst = max(plain, key=lambda f: f.cost)
    first = valleys(shop.fitter(), worst, KEY)[0]
    assert first.promised < worst.cost - RESCUE_GAIN
    found = deepest(shop.fitter(), worst, (KEY,), max_iterations=40)
    assert found.cost < worst.cost - RESCUE_GAIN
    again = valleys(shop.fitter(), found, KEY)
    assert not again or again[0].promised > found.cost - 10.0 * RESCUE_GAIN
    assert 1.0 / FACTOR**2 < found.values()[KEY] / TRUE < FACTOR**2


def test_the_deepest_is_left_alone(shop: Workshop, plain: list[Fit]) -> None:
    best = min(plain, key=lambda f: f.cost)
    assert deepest(shop.fitter(), best, (KEY, "no such value"), max_iterations=40) is best
