"""Laws of no catalogue, learned inside the simulation: the true one comes back, a wrong kind does not do as well."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from spacerobot.diagnosis.fitting import linearised
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.linearised import Linearised
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.learning.bands import band
from spacerobot.diagnosis.learning.curves import Curve, Sketch, first_shape, fit_curve, sketch
from spacerobot.diagnosis.learning.describe import describe
from spacerobot.diagnosis.learning.ended import ended, written
from spacerobot.diagnosis.learning.ground import visited
from spacerobot.diagnosis.learning.learn import WITHIN, _catalogue_there, _learn, _named_as_well
from spacerobot.diagnosis.selection.search_state import Found
from spacerobot.diagnosis.terms.hypothesis import Site, hypothesis
from spacerobot.effects import registry
from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.learned import LearnedLaw
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Force, Friction

from .rigs import write_study

SPEEDS = (0.05, 0.08, 0.11)


def worn(v: float, normal: float, d: float, p: Any) -> float:
    """Dry friction that is strong about one place."""
    return p[0] * math.exp(-(((d - p[1]) / p[2]) ** 2))


def back_only(d: float, v: float, aux: float, p: Any) -> float:
    """A damper of the return stroke."""
    return -p[0] * min(v, 0.0)


def pressed(v: float, normal: float, d: float, p: Any) -> float:
    """A guide under load: dry friction in proportion to what presses in the contact."""
    return p[0] * normal


def stiffening(d: float, v: float, aux: float, p: Any) -> float:
    """A tip that grows stiff with the third power of how far it is pressed in."""
    return -(p[0] * d + p[1] * v + p[4] * d * d * d)


def magnet(d: float, v: float, aux: float, p: Any) -> float:
    """A magnet under the table, which pulls the target to its place from either side."""
    u = (d - p[1]) / p[2]
    return -p[0] * u * math.exp(0.5 - 0.5 * u * u)


PLACES = {stiffening: "contact", magnet: "target"}
"""Where a law acts, if not in the guide."""


class Hidden(Effect):
    """Physics of no catalogue, from code of its own."""

    title, formula, source = "hidden", "f", "this test"

    def __init__(self, name: str, law: Any, numbers: tuple[float, ...]) -> None:
        self.law, self.numbers = law, numbers
        for key, value in {"name": name, "parameters": (Parameter("share", "", 0.0, 1.0, 0.0, 10.0, (1.0,)),)}.items():
            setattr(self, key, value)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """The guide, the tip or the target."""
        return (PLACES.get(self.law, "wrist"),)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The law at the port."""
        p = (self.numbers[0] * values["share"], *self.numbers[1:])
        if self.law is worn:
            return mechanism.with_friction(Friction("hidden", where, worn, p))
        if self.law is pressed:
            return mechanism.with_friction(Friction("hidden", where, pressed, p, normal="contact"))
        if self.law is stiffening:
            return mechanism.with_contact(lambda c: replace(c, kernel=Kernel(stiffening), p=(*c.p[:4], *p)))
        return mechanism.with_force(Force("hidden", where, Kernel(self.law), p))


Planted = tuple[str, str, dict[str, float]]


def _workshop(
    monkeypatch: pytest.MonkeyPatch, folder: Path, law: Any, numbers: tuple[float, ...], *more: Planted
) -> Workshop:
    registry.all_effects()
    monkeypatch.setitem(registry._effects, "hidden", Hidden("hidden", law, numbers))
    where = PLACES.get(law, "wrist")
    study = write_study(folder, planted=[("hidden", where, {"share": 1.0}), *more], speeds=SPEEDS)
    monkeypatch.undo()
    return Workshop(study)


def _sketched(workshop: Workshop, beside: Fit, where: str, kind: Any, of: Any) -> tuple[Sketch, Curve]:
    told = sketch(workshop, beside, where, kind, of)
    assert told is not None
    curve = fit_curve(workshop, beside, told)
    assert curve is not None
    return told, curve


def _curve(workshop: Workshop, beside: Fit, where: str, kind: Any, of: Any) -> Curve:
    return _sketched(workshop, beside, where, kind, of)[1]


def test_a_weak_field_under_a_floating_target_is_found_from_nothing(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A fiftieth of what the contact brings: nothing holds the target, and each push sends it another way."""
    workshop = _workshop(monkeypatch, tmp_path, magnet, (0.2, -0.004, 0.02))
    baseline = workshop.run(Task((), {}))
    assert baseline is not None
    curve = _curve(workshop, baseline, "target", "force", "d")
    assert curve.fit.cost < 1.05 * curve.fit.samples < baseline.cost
    seen = band(curve)
    truth = np.array([-magnet(x, 0.0, 0.0, (0.2, -0.004, 0.02)) for x in seen.x])
    assert np.mean((seen.low <= truth) & (truth <= seen.high)) >= 0.85


def test_how_a_curve_moves_a_floating_target_is_its_slope(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """What a fit takes for a derivative is one: a tenth of the step, to both sides, says the same."""
    workshop = _workshop(monkeypatch, tmp_path, magnet, (0.32, -0.0036, 0.025))
    baseline = workshop.run(Task((), {}))
    assert baseline is not None
    site = Site(LearnedLaw(first_shape(workshop, baseline, "target", "force", "d").divided(12)), "target")
    made = hypothesis(workshop.model.believed, [site], baseline.values())
    near = Linearised(workshop.model, workshop.trials)
    state = near.state(made, made.start(baseline.values()), baseline.initials())
    assert state is not None
    own = [k for k, free in enumerate(made.free) if free.kind == "effect"]
    slopes = near.jacobians(made, state, {})
    monkeypatch.setattr(linearised, "OF_CURVES", 0.1 * linearised.OF_CURVES)
    for trial, finer in near.jacobians(made, state, {}, both=True).items():
        assert np.linalg.norm((slopes[trial] - finer)[:, own]) < 0.1 * np.linalg.norm(finer[:, own])


@pytest.mark.slow
def test_a_worn_guide_is_learned_with_its_band_and_its_formula(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    workshop = _workshop(monkeypatch, tmp_path, worn, (1.6, 0.008, 0.003))
    baseline = workshop.run(Task((), {}))
    assert baseline is not None
    assert baseline.chi2 > 1.5 * baseline.samples
    right = _curve(workshop, baseline, "wrist", "friction", "d")
    wrong = _curve(workshop, baseline, "wrist", "force", "d")
    assert right.fit.chi2 < 1.03 * right.fit.samples
    assert workshop.left_by(right.fit).adequate
    assert right.evidence > wrong.evidence + 100.0
    seen = band(right)
    truth = np.array([worn(1.0, 0.0, x, (1.6, 0.008, 0.003)) for x in seen.x])
    assert np.mean((seen.low <= truth) & (truth <= seen.high)) >= 0.85
    closed = written(workshop, right, describe(right))
    assert closed is not None
    told, form = closed
    assert workshop.left_by(form).adequate
    assert told.like == "coulomb_friction"
    found = {key.rpartition(".")[2]: value for key, value in form.values().items() if "@" in key}
    assert found["a_1"] == pytest.approx(1.6, rel=0.05)
    assert found["a_1_place"] == pytest.approx(0.008, rel=0.05)
    assert found["a_1_width"] == pytest.approx(0.003, rel=0.1)


def test_a_damper_of_one_stroke_is_learned_and_only_its_sum_with_the_damping_is_claimed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    workshop = _workshop(monkeypatch, tmp_path, back_only, (11.0,))
    baseline = workshop.run(Task((), {}))
    assert baseline is not None
    told, right = _sketched(workshop, baseline, "wrist", "force", "v")
    assert told.least(right.fit.prior) < WITHIN * right.fit.cost, "what loud noise shows would have left it out"
    assert right.fit.chi2 < 1.03 * right.fit.samples
    seen = band(right)
    assert "wrist.equivalent_damping" in seen.with_
    damping = sum(workshop.model.base[n] for n in ("wrist.damping", "wrist.equivalent_damping") if n in seen.with_)
    truth = damping * seen.x + 11.0 * np.minimum(seen.x, 0.0)
    assert np.mean((seen.low <= truth) & (truth <= seen.high)) >= 0.85
    closed = written(workshop, right, describe(right))
    assert closed is not None
    like, form = closed
    assert workshop.left_by(form).adequate
    assert "one stroke" in like.words


@pytest.mark.parametrize(
    ("law", "numbers", "where", "kind", "of"),
    [
        pytest.param(pressed, (0.06,), "wrist", "friction", "N", marks=pytest.mark.slow),
        pytest.param(stiffening, (1e11,), "contact", "force", "d", marks=pytest.mark.slow),
    ],
)
def test_a_law_of_the_press_and_one_of_the_tip_are_learned_with_their_formulas(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    law: Any,
    numbers: tuple[float, ...],
    where: str,
    kind: Any,
    of: Any,
) -> None:
    workshop = _workshop(monkeypatch, tmp_path, law, numbers)
    baseline = workshop.run(Task((), {}))
    assert baseline is not None
    right = _curve(workshop, baseline, where, kind, of)
    other = _curve(workshop, baseline, "wrist", "force", "v")
    assert right.evidence > other.evidence + 20.0
    right, closed = ended(workshop, right, baseline)
    assert closed is not None
    told, form = closed
    assert workshop.left_by(form).adequate
    assert told.formula.words[0][0] == ("line" if law is pressed else "cube")
    assert right.fit.chi2 < form.chi2 + right.determined(), "a curve can be whatever its formula is"
    seen = band(right)
    least, most = visited(workshop, right.fit, where)[of]
    assert seen.x[-1] < most + 0.02 * (most - least), "nobody knows what no trial has shown"
    traded = sum(workshop.model.base[n] for n in seen.with_) * seen.x
    truth = traded + (numbers[0] * seen.x if law is pressed else numbers[0] * seen.x**3)
    assert np.mean((seen.low <= truth) & (truth <= seen.high)) >= 0.85
    (found,) = [value for key, value in form.values().items() if key.endswith(".a_1")]
    assert found == pytest.approx(numbers[0], rel=0.05 if law is pressed else 0.2)


def test_a_law_leads_to_the_name_that_the_search_had_missed(tmp_path: Path) -> None:
    """A taut line bends every track from the start; whoever has found the law knows where to look for it."""
    study = write_study(tmp_path, planted=[("tether", "target", {"stiffness_N_m": 7.0, "slack_m": 0.0})], speeds=SPEEDS)
    workshop = Workshop(study)
    baseline = workshop.run(Task((), {}))
    assert baseline is not None
    curve = _curve(workshop, baseline, "target", "force", "d")
    offered = [("tether", "target"), ("viscous_drag", "target"), ("coulomb_friction", "wrist")]
    found = Found(baseline, singles=tuple(workshop.model.site(registry.effect(e), w) for e, w in offered))
    with Pool(workshop, 1) as pool:
        _catalogue_there(pool, curve, found, lambda *_: None)
    assert found.best.hypothesis.label == (("tether", "target"),)
    assert found.best.values()["tether@target.stiffness_N_m"] == pytest.approx(7.0, rel=0.1)
    assert (("coulomb_friction", "wrist"),) not in found.fits  # elsewhere
    assert _named_as_well(curve, found)


@pytest.mark.slow
def test_a_law_is_learned_beside_an_effect_of_the_catalogue(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    drag = ("viscous_drag", "target", {"coefficient_Ns_m": 1.0})
    workshop = _workshop(monkeypatch, tmp_path, worn, (1.6, 0.008, 0.003), drag)
    baseline, beside = (workshop.run(Task(label, {})) for label in ((), (("viscous_drag", "target"),)))
    assert baseline is not None
    assert beside is not None
    with Pool(workshop, 1) as pool:
        learnt = _learn(pool, beside, Found(baseline, {beside.hypothesis.label: beside}), lambda *_: None)
    assert learnt is not None
    assert learnt.trusted
    assert (learnt.curve.shape.kind, learnt.curve.shape.of, learnt.curve.site.where) == ("friction", "d", "wrist")
    assert learnt.fit.values()["viscous_drag@target.coefficient_Ns_m"] == pytest.approx(1.0, rel=0.1)
