"""What a favourite does beyond a part of it: named, or perhaps the part's own too simple law."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.adequacy import Left
from spacerobot.diagnosis.fitted import Fit
from spacerobot.diagnosis.found import Found
from spacerobot.diagnosis.judge import AMBIGUOUS, NAMED, Judgement, judge
from spacerobot.diagnosis.workshop import Task, Workshop
from tests.diagnosis.rigs import write_study

ARM, RUB, TILT = ("arm_compliance", "arm"), ("coulomb_friction", "wrist"), ("table_tilt", "target")


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    folder: Path = tmp_path_factory.mktemp("judge")
    return Workshop(write_study(folder))


def judged(shop: Workshop, one: tuple[str, str], share: float) -> tuple[Judgement, Fit, Fit]:
    """Of a single effect that explains ten thousand, and a pair that does this share more; the single leaves a bend."""
    base, part = shop.run(Task((), {})), shop.run(Task((one,), {}, max_iterations=2))
    pair = shop.run(Task(tuple(sorted((one, TILT))), {}, max_iterations=2))
    assert base is not None
    assert part is not None
    assert pair is not None
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
