"""Every check of the product's own can fail, and a failed check takes the verdict's word back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from spacerobot.diagnosis import diagnose as whole
from spacerobot.diagnosis.fitting import profile
from spacerobot.diagnosis.fitting.adequacy import Left
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.learning import settle
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.selection import checks, confirm
from spacerobot.diagnosis.selection.check import Check
from spacerobot.diagnosis.selection.judge import judge
from spacerobot.diagnosis.selection.search_state import Found
from spacerobot.diagnosis.terms.candidates import contains, simpler
from spacerobot.diagnosis.terms.hypothesis import Site
from spacerobot.diagnosis.terms.kinds import NAMED, NOT_TRUSTED
from spacerobot.effects.registry import effect
from spacerobot.support.jsonio import plain
from tests.diagnosis.rigs import write_study

LABEL = (("coulomb_friction", "wrist"),)


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    folder: Path = tmp_path_factory.mktemp("checks")
    return Workshop(write_study(folder, planted=[("coulomb_friction", "wrist", {"force_N": 0.35})]))


@pytest.fixture(scope="module")
def base(shop: Workshop) -> Fit:
    fit = shop.run(Task((), {}))
    assert fit is not None
    return fit


@pytest.fixture(scope="module")
def chosen(shop: Workshop) -> Fit:
    fit = shop.run(Task(LABEL, {"coulomb_friction@wrist.force_N": 0.3}))
    assert fit is not None
    return fit


def found(base: Fit, chosen: Fit) -> Found:
    out = Found(base)
    out.keep(chosen)
    return out


def test_a_sound_fit_passes_all(shop: Workshop, base: Fit, chosen: Fit) -> None:
    assert checks.nested([base, chosen], chosen).passed
    assert [c.passed for c in checks.synthetic(shop, chosen)] == [True, True]
    assert confirm.confirm(shop, chosen).passed


def test_a_smaller_model_that_costs_less_is_noticed(base: Fit, chosen: Fit) -> None:
    cheap = replace(base, chi2=chosen.chi2 - 50.0, prior=0.0)
    assert not checks.nested([cheap, chosen], chosen).passed


@pytest.mark.slow
def test_an_optimiser_that_stops_short_of_the_truth_is_noticed(
    shop: Workshop, chosen: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = Workshop.run

    def lazy(self: Workshop, task: Task) -> Fit | None:
        fit = run(self, replace(task, max_iterations=1))
        return None if fit is None else replace(fit, chi2=fit.chi2 + 100.0)

    monkeypatch.setattr(Workshop, "run", lazy)
    assert not checks.synthetic(shop, chosen)[0].passed
    assert not checks.synthetic(shop, chosen, lead=100.0)[0].passed  # the rival may have won by it
    assert checks.synthetic(shop, chosen, lead=1e6)[0].passed  # no rival could have


def test_an_interval_that_claims_too_much_is_noticed(
    shop: Workshop, chosen: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As certain as if it had ten thousand times the data, in the curvature and in the profile."""
    run, interval = Workshop.run, checks.profile_interval

    def boastful(self: Workshop, task: Task) -> Fit | None:
        fit = run(self, task)
        return None if fit is None or fit.covariance is None else replace(fit, covariance=1e-4 * fit.covariance)

    def narrow(fitter: Fitter, fit: Fit, key: str, inflation: float) -> tuple[float, float]:
        value = fit.values()[key]
        low, high = interval(fitter, fit, key, inflation)
        return value + 1e-2 * (low - value), value + 1e-2 * (high - value)

    monkeypatch.setattr(Workshop, "run", boastful)
    cost, sizes = checks.synthetic(shop, chosen)
    assert cost.passed
    assert sizes.passed  # the curvature boasts, but the profile is what a verdict states
    monkeypatch.setattr(checks, "profile_interval", narrow)
    cost, sizes = checks.synthetic(shop, chosen)
    assert cost.passed
    assert not sizes.passed
    assert "coulomb_friction@wrist.force_N" in sizes.detail


@pytest.mark.slow
def test_a_size_that_jagged_costs_hide_widens_its_interval(
    shop: Workshop, chosen: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A fit of the copy that ends ten standard errors off is believed where a second copy agrees, and only there."""
    key = "coulomb_friction@wrist.force_N"
    run, missed = Workshop.run, iter([10.0, -12.0, *(3 * [10.0, -90.0]), 10.0, -90.0, *(2 * [10.0, -12.0])])

    def jagged(self: Workshop, task: Task) -> Fit | None:
        fit = run(self, task)
        assert fit is not None
        assert fit.covariance is not None
        k = fit.hypothesis.keys.index(key)
        z = fit.z.copy()
        z[k] = chosen.z[k] + next(missed) * fit.covariance[k, k] ** 0.5
        return replace(fit, z=z)

    def narrow(fitter: Fitter, fit: Fit, key: str, inflation: float) -> tuple[float, float]:
        return fit.values()[key], fit.values()[key]

    monkeypatch.setattr(Workshop, "run", jagged)
    monkeypatch.setattr(checks, "profile_interval", narrow)
    _, sizes = checks.synthetic(shop, chosen)
    assert sizes.passed
    assert sizes.worst == pytest.approx(10.0, rel=0.05)
    value = chosen.values()[key]
    low, high = checks.widened(chosen, key, (value, value), sizes.missed[key])
    assert low < value < high
    assert checks.widened(chosen, key, (low - 1.0, high + 1.0), sizes.missed[key]) == (low - 1.0, high + 1.0)
    _, sizes = checks.synthetic(shop, chosen)
    assert not sizes.passed
    assert not sizes.missed
    _, sizes = checks.synthetic(shop, chosen)  # one copy of three is a draw of noise
    assert sizes.passed
    assert "1 of 3 copies failed" in sizes.detail


def test_a_moment_is_sought_beyond_the_next_rise(shop: Workshop, chosen: Fit, monkeypatch: pytest.MonkeyPatch) -> None:
    """A second minimum within the level, four steps out, belongs to the interval; one beyond a long rise does not."""
    fitter = shop.fitter()
    index = chosen.hypothesis.keys.index("coulomb_friction@wrist.force_N")
    free, best = chosen.hypothesis.free[index], float(chosen.z[index])
    longest = max(t.end - t.start for t in fitter.trials)
    step = abs(free.z(free.value(best) + longest / profile.MOMENT) - best)

    def ends(second: int) -> float:
        low = {0, second}
        monkeypatch.setattr(
            profile._Profiler, "_rise", lambda self, at: 0.0 if round((at - best) / step) in low else 50.0
        )
        made = profile._Profiler(fitter, chosen, index, 1.0)
        assert made._moment_step == pytest.approx(step)
        places = [0.1 * step + k * step for k in range(1, profile.FURTHER + 1)]
        return round(made._further(1.0, 0.1 * step, places, profile.OUTSIDE) / step, 3)

    assert ends(4) == pytest.approx(4.1)
    assert ends(9) == pytest.approx(0.1)


def test_a_copy_that_cannot_be_simulated_is_noticed(
    shop: Workshop, chosen: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Workshop, "run", lambda self, task: None)
    (cost,) = checks.synthetic(shop, chosen)
    assert not cost.passed


class Notes(dict[str, Any]):
    """What one diagnosis has fitted, for the next."""

    def save(self, name: str, value: Any) -> None:
        self[name] = value

    def load(self, name: str) -> Any | None:
        return self.get(name)


def test_each_failed_check_reaches_the_verdict(tmp_path: Path) -> None:
    """A diagnosis that names friction, with one check after the other made to fail in the product's own run."""
    study = write_study(tmp_path, planted=[("coulomb_friction", "wrist", {"force_N": 0.35})], speeds=(0.08,))
    notes = Notes()
    located: list[Any] = []
    locate = whole._located

    def once(*args: Any, **options: Any) -> Any:
        if not located:
            located.append(locate(*args, **options))
        return located[0]

    fine = Check("fine", True, "")
    failed = Check("failed", False, "made to fail")
    for check in ("none", "nested", "synthetic", "confirm"):
        with pytest.MonkeyPatch.context() as patched:
            patched.setattr(RigModel, "sites", lambda *a: [Site(effect("coulomb_friction"), "wrist")])
            patched.setattr(whole, "_located", once)
            for name in ("nested", "synthetic", "confirm"):
                said = failed if name == check else fine
                patched.setattr(settle, name, _answer([said] if name == "synthetic" else said))
            found = whole.diagnose(study, jobs=1, store=notes)
        verdict = plain(found.verdict)
        assert verdict["verdict"] == ("named" if check == "none" else "not_trusted")
        assert len(verdict["effects"]) == (check == "none")
        assert (plain(failed) in plain(found.evidence)["checks"]) == (check != "none")
        assert verdict["why"] == ([] if check == "none" else ["failed: made to fail"])  # in JSON as in the report


def _answer(value: Any) -> Callable[..., Any]:
    return lambda *a: value


def test_a_failed_check_takes_the_name_back(base: Fit, chosen: Fit) -> None:
    fits = found(base, chosen)
    fine = Left((), 1.0)
    left = {id(base): fine, id(chosen): fine}
    assert judge(fits, left, None, ()).verdict == NAMED
    assert judge(fits, left, None, ["cost at truth"]).verdict == NOT_TRUSTED


def test_simpler_sets_are_contained_in_what_they_came_from() -> None:
    label = (("quadratic_drag", "target"), ("stribeck_friction", "wrist"))
    less = simpler(label)
    assert (("coulomb_friction", "wrist"), ("quadratic_drag", "target")) in less
    assert all(contains(label, one) for one in less)
    assert simpler((("coulomb_friction", "wrist"),)) == []


@pytest.mark.parametrize("refused", [True, False])
def test_a_copy_goes_on_where_its_fit_ends_as_what_no_search_would_name(
    refused: bool, shop: Workshop, chosen: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At as low a cost, but thrice as strong: in a minimum that a search passes by, as a Stribeck friction that rises
    with speed, the fit is not at its end; in one that a verdict would state, the numbers are not to be trusted."""
    run, index = Workshop.run, chosen.hypothesis.keys.index("coulomb_friction@wrist.force_N")
    elsewhere = 3.0 * chosen.values()["coulomb_friction@wrist.force_N"]

    def astray(self: Workshop, task: Task) -> Fit | None:
        fit = run(self, task)
        if fit is None or task.near is not None or not task.label:
            return fit
        z = fit.z.copy()
        z[index] = chosen.hypothesis.free[index].z(elsewhere)
        return replace(fit, z=z)

    def implausible(sites: object, values: Mapping[str, float], size_at: object) -> str:
        far = values["coulomb_friction@wrist.force_N"] > 0.9 * elsewhere
        return "too strong" if far and refused else ""

    monkeypatch.setattr(Workshop, "run", astray)
    monkeypatch.setattr(checks, "implausible", implausible)
    monkeypatch.setattr(checks, "profile_interval", lambda fitter, fit, key, inflation: (fit.values()[key],) * 2)
    assert all(c.passed for c in checks.synthetic(shop, chosen)) is refused


def test_a_copy_is_fitted_one_effect_after_the_other_too(shop: Workshop, chosen: Fit) -> None:
    """As a search finds them: of two effects, one near the truth alone, then the other beside it."""
    other = ("table_tilt", "target")
    both = shop.run(Task(tuple(sorted((*LABEL, other))), {}, near=chosen))
    assert both is not None
    tasks = list(checks._other_starts(shop, both, both, ()))
    stepwise = [t for t in tasks if t.near is not None and len(t.near.hypothesis.sites) == 1]
    assert {t.near.hypothesis.label for t in stepwise if t.near is not None} == {LABEL, (other,)}
    for task in stepwise:
        assert task.label == both.hypothesis.label
    beside = [t.near for t in checks._other_starts(shop, chosen, chosen, ()) if t.near is not None]
    assert [f.hypothesis.label for f in beside if f is not chosen] == [()]  # one alone: beside the fit without it


def test_a_part_of_a_fit_has_the_same_values(shop: Workshop, chosen: Fit) -> None:
    both = shop.run(Task(tuple(sorted((*LABEL, ("table_tilt", "target")))), {}, near=chosen))
    assert both is not None
    part, values = checks._part(both, LABEL[0]), both.values()
    assert part.hypothesis.label == LABEL
    assert part.values() == {k: v for k, v in values.items() if not k.startswith("table_tilt")}
    assert part.z.size == len(part.hypothesis.free)
