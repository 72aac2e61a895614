"""Friction that fades over the trials is found again, with its trend."""

from __future__ import annotations

from pathlib import Path

import pytest

from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection.search import search
from spacerobot.diagnosis.selection.search_state import silent
from spacerobot.diagnosis.terms.decision import EARN
from spacerobot.effects import registry
from spacerobot.effects.effect import Effect
from spacerobot.effects.trend import NUMBER, SUFFIX, TREND, Trend

from .rigs import write_study

FIRST, FADES = 0.45, -0.1


class _Fading(Trend):
    """Each study's trial is made by itself: counts them, as the lab's days do."""

    made = 0

    def edit(self, mechanism, where, values):  # type: ignore[no-untyped-def]
        """One trial more."""
        number, _Fading.made = _Fading.made, _Fading.made + 1
        return super().edit(mechanism, where, {**values, NUMBER: float(number)})


def test_friction_that_fades_comes_back_with_its_trend(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    steady: Effect = registry.effect("coulomb_friction")
    fading = _Fading(steady)
    setattr(fading, "name", "fading")  # noqa: B010 - a name for this test alone
    monkeypatch.setitem(registry._effects, "fading", fading)
    _Fading.made = 0
    planted = [("fading", "wrist", {"force_N": FIRST, TREND: FADES})]
    workshop = Workshop(write_study(tmp_path, planted=planted, speeds=(0.06, 0.085, 0.11)))
    assert _Fading.made == 6
    single = workshop.run(Task((("coulomb_friction", "wrist"),), {"coulomb_friction@wrist.force_N": 0.2}))
    assert single is not None
    assert single.chi2 > 1.1 * single.samples
    key = f"coulomb_friction{SUFFIX}@wrist."
    label = (("coulomb_friction" + SUFFIX, "wrist"),)
    start = {key + "force_N": 0.2, key + TREND: 0.0}
    found = workshop.run(Task(label, start, near=single, max_iterations=30))
    assert found is not None
    assert found.chi2 < 1.03 * found.samples
    low, high = found.errors()[key + TREND]
    assert abs(found.values()[key + TREND] - FADES) < 4.0 * max(high - low, 1e-3)
    assert found.values()[key + "force_N"] == pytest.approx(FIRST, rel=0.03)


def test_it_is_looked_for_where_the_steady_one_explains_nearly_all(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """What steady friction leaves of a slow fading is within what ends a search, and is far beyond chance."""
    fading = _Fading(registry.effect("coulomb_friction"))
    setattr(fading, "name", "fading")  # noqa: B010 - a name for this test alone
    monkeypatch.setitem(registry._effects, "fading", fading)
    _Fading.made = 0
    planted = [("fading", "wrist", {"force_N": FIRST, TREND: 0.25 * FADES})]
    workshop = Workshop(write_study(tmp_path, planted=planted, speeds=(0.06, 0.085, 0.11)))
    steady, slowly = (("coulomb_friction", "wrist"),), (("coulomb_friction" + SUFFIX, "wrist"),)
    sites = [workshop.model.site(registry.effect("coulomb_friction"), "wrist")]
    with Pool(workshop, 1) as pool:
        found = search(pool, sites, silent)
    assert found.explains(found.fits[steady])
    assert found.fits[slowly].cost < found.fits[steady].cost - EARN
