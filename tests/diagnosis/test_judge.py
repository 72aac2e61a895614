"""What a set earns over a part of it: named, or perhaps the part's own too simple law, and never left out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spacerobot.diagnosis.fitting.adequacy import Left
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection.judge import Judgement, judge
from spacerobot.diagnosis.selection.search_state import Found
from spacerobot.diagnosis.terms.decision import MARGIN, MOVED, PENALTY, SLIGHT, SMALL
from spacerobot.diagnosis.terms.kinds import AMBIGUOUS, NAMED, UNKNOWN
from tests.diagnosis.rigs import write_study

ARM, RUB, TILT = ("arm_compliance", "arm"), ("coulomb_friction", "wrist"), ("table_tilt", "target")


KEPT: dict[tuple[int, tuple[str, str]], list[Fit]] = {}


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    folder: Path = tmp_path_factory.mktemp("judge")
    return Workshop(write_study(folder))


def judged(shop: Workshop, one: tuple[str, str], share: float) -> tuple[Judgement, Fit, Fit]:
    """Of a single effect that explains ten thousand, and a pair that does this share more; the single leaves a bend."""
    base, part, pair = fits(shop, one)
    base = replace(base, chi2=base.chi2 + 1e4, prior=0.0, z=0.0 * base.z)
    part = replace(part, chi2=base.chi2 - 1e4, prior=0.0, z=_unmoved(part))
    pair = replace(pair, chi2=base.chi2 - (1.0 + share) * 1e4, prior=0.0, z=_unmoved(pair))
    found = Found(base)
    found.keep(part)
    found.keep(pair)
    left = {id(f): Left((), 1.0) for f in (base, pair)}  # the part is not among those that leave noise
    return judge(found, left, None, ()), part, pair


def _unmoved(fit: Fit) -> np.ndarray:
    z = fit.z.copy()
    z[[k for k, f in enumerate(fit.hypothesis.free) if f.kind == "believed"]] = 0.0
    return z


def test_what_an_arm_of_one_mode_leaves_may_be_its_other_modes(shop: Workshop) -> None:
    judgement, part, pair = judged(shop, ARM, 0.02)
    assert judgement.verdict == AMBIGUOUS
    assert judgement.alternatives == (pair, part)
    assert judged(shop, ARM, 0.2)[0].verdict == NAMED


def test_what_another_law_leaves_is_something_else(shop: Workshop) -> None:
    judgement, _, pair = judged(shop, RUB, 0.02)
    assert judgement.verdict == NAMED
    assert judgement.chosen is pair


def fits(shop: Workshop, one: tuple[str, str]) -> tuple[Fit, Fit, Fit]:
    """Baseline, single and pair of a shop, each made once."""
    kept = KEPT.setdefault((id(shop), one), [])
    if not kept:
        kept += _fits(shop, one)
    return kept[0], kept[1], kept[2]


def _fits(shop: Workshop, one: tuple[str, str]) -> tuple[Fit, Fit, Fit]:
    base, part = shop.run(Task((), {})), shop.run(Task((one,), {}, max_iterations=2))
    pair = shop.run(Task(tuple(sorted((one, TILT))), {}, max_iterations=2))
    assert base is not None
    assert part is not None
    assert pair is not None
    return base, part, pair


def weighed(shop: Workshop, explained: float, earned: float, one: tuple[str, str] = RUB) -> tuple[Judgement, Fit, Fit]:
    """Of a single effect that leaves nothing but noise, and a pair that earns so much more after its price."""
    base, part, pair = fits(shop, one)
    price = PENALTY * sum(f.kind == "effect" for f in pair.hypothesis.free)
    own = PENALTY * sum(f.kind == "effect" for f in part.hypothesis.free)
    base = replace(base, chi2=base.chi2 + explained, prior=0.0, z=0.0 * base.z)
    part = replace(part, chi2=base.chi2 - explained - own, prior=0.0, z=_unmoved(part))
    pair = replace(pair, chi2=base.chi2 - explained - earned - price, prior=0.0, z=_unmoved(pair))
    found = Found(base)
    found.keep(part)
    found.keep(pair)
    return judge(found, {id(f): Left((), 1.0) for f in (base, part, pair)}, None, ()), part, pair


@pytest.mark.parametrize("one", [RUB, ARM])
@given(explained=st.floats(100.0, 1e6), earned=st.floats(-16.0, 1e5))
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_what_earns_decisively_is_always_given(
    shop: Workshop, one: tuple[str, str], explained: float, earned: float
) -> None:
    """The one law: no single is named with certainty where a set that holds it is decisively better.

    What a law that leaves noise may owe to its own small defects is no decision.
    """
    judgement, part, pair = weighed(shop, explained, earned, one)
    given_sets = judgement.alternatives or (judgement.chosen,)
    owed = max(MARGIN, SMALL * explained)
    if earned > 1.01 * owed:
        assert pair in given_sets
        assert judgement.verdict in (NAMED, AMBIGUOUS)
        assert judgement.confidence < 0.99 or earned > 0.5 * SLIGHT * explained or one is ARM
    elif earned < 0.99 * owed:
        assert (judgement.verdict, judgement.chosen) == (NAMED, part)


def test_a_set_that_nearly_earns_its_place_costs_certainty(shop: Workshop) -> None:
    sure = [weighed(shop, 1e4, earned)[0].confidence for earned in (-16.0, 0.0, 5.0, 9.9)]
    assert sure == sorted(sure, reverse=True)
    assert sure[0] > 0.98
    assert sure[-1] < 0.6


def test_a_set_that_a_bound_holds_is_not_named(shop: Workshop) -> None:
    """Whatever it earns: where only it explains the data, they are unknown, and what holds all but it is named."""
    _, part, pair = weighed(shop, 1e4, 5e3)
    (tilt,) = (k for k, f in enumerate(pair.hypothesis.free) if f.key.startswith("table_tilt"))
    z = pair.z.copy()
    z[tilt] = pair.hypothesis.free[tilt].bounds[1]
    held = replace(pair, z=z)
    base = replace(part, hypothesis=replace(part.hypothesis, sites=()), chi2=part.chi2 + 1e4)
    found = Found(base)
    found.keep(held)
    assert judge(found, {id(f): Left((), 1.0) for f in (base, held)}, None, ()).verdict == UNKNOWN
    found.keep(part)
    said = judge(found, {id(f): Left((), 1.0) for f in (base, held, part)}, None, ())
    assert (said.verdict, said.chosen) == (NAMED, part)
    withdrawn = judge(found, {id(base): Left((), 1.0)}, None, (), [part.hypothesis.label])
    assert withdrawn.verdict == UNKNOWN


@pytest.mark.parametrize(("bent", "said"), [(0, NAMED), (1, NAMED), (2, UNKNOWN)])
def test_an_effect_beside_many_wrong_values_is_not_named(shop: Workshop, bent: int, said: str) -> None:
    """One value may be stated wrongly beside one effect; where two are bent as well, something else bends all."""
    base, part, _ = fits(shop, RUB)
    z = _unmoved(part)
    z[[k for k, f in enumerate(part.hypothesis.free) if f.kind == "believed"][:bent]] = 2.0 * MOVED
    part = replace(part, chi2=base.chi2 - 5000.0, prior=0.0, z=z)
    base = replace(base, chi2=base.chi2 + 5000.0, prior=0.0, z=0.0 * base.z)
    found = Found(base)
    found.keep(part)
    judgement = judge(found, {id(f): Left((), 1.0) for f in (base, part)}, None, ())
    assert judgement.verdict == said
    assert len(judgement.moved) == bent


def test_the_same_of_two_effects(shop: Workshop) -> None:
    judgement, _, pair = judged(shop, RUB, 0.5)
    assert (judgement.verdict, judgement.chosen) == (NAMED, pair)
    z = pair.z.copy()
    z[next(k for k, f in enumerate(pair.hypothesis.free) if f.kind == "believed")] = 2.0 * MOVED
    base = replace(pair, hypothesis=replace(pair.hypothesis, sites=()), chi2=pair.chi2 + 1e4)
    found = Found(replace(base, z=0.0 * base.z))
    found.keep(replace(pair, z=z))
    left = {id(f): Left((), 1.0) for f in (found.baseline, *found.fits.values())}
    assert judge(found, left, None, ()).verdict == UNKNOWN
