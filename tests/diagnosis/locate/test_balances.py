from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from helpers_locate import VALUES, Rig, believed, record

from spacerobot.diagnosis.locate.prepared import Prepared
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.effects.effect import Placed
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.registry import all_effects
from spacerobot.simulation.rig import rig
from spacerobot.support.errors import InputError


def prepared(made: tuple[Rig, tuple[TrialData, ...]], change: dict[str, float] | None = None) -> list[Prepared]:
    model, trials = made
    return [Prepared(model, t, {**VALUES, **t.overrides, **(change or {})}, trials) for t in trials]


def misfit(parts: list[Prepared], name: str) -> tuple[float, int]:
    """chi-squared against sensor noise alone, and the number of rows."""
    total, count = 0.0, 0
    for part in parts:
        tested = part.tested(name)
        white = tested.exact(tested.residual.value)
        total, count = total + float(white @ white), count + white.size
    return total, count


@pytest.fixture(scope="module")
def exact() -> tuple[Rig, tuple[TrialData, ...]]:
    return record(noise=0.0, speeds=(0.05, 0.15))


@pytest.mark.parametrize("name", ["wrist", "target", "contact"])
def test_exact_data_close_every_balance(exact: tuple[Rig, tuple[TrialData, ...]], name: str) -> None:
    total, count = misfit(prepared(exact), name)
    assert total < 0.01 * count


@pytest.mark.parametrize(
    ("name", "value", "factor"),
    [
        ("wrist", "wrist.stiffness", 1.05),
        ("wrist", "wrist.mass", 1.3),
        ("wrist", "wrist.damping", 2.5),
        ("target", "target.mass", 1.03),
        ("contact", "contact.stiffness", 0.5),
    ],
)
def test_a_wrong_value_opens_its_balance_and_no_other_body(
    exact: tuple[Rig, tuple[TrialData, ...]], name: str, value: str, factor: float
) -> None:
    model, trials = exact
    parts = [
        Prepared(model, t, {**VALUES, **t.overrides, value: {**VALUES, **t.overrides}[value] * factor}, trials)
        for t in trials
    ]
    total, _ = misfit(parts, name)
    assert total > 30.0
    for other in {"wrist", "target"} - {name}:
        assert misfit(parts, other)[0] < 3.0


def test_noise_closes_at_one_per_degree_of_freedom() -> None:
    parts = prepared(record(seed=4))
    for name in ("wrist", "target", "contact"):
        total, count = misfit(parts, name)
        assert total / count == pytest.approx(1.0, abs=5.0 * np.sqrt(2.0 / count))


def test_bodies_are_summed_where_the_contact_is_not_measured() -> None:
    made = record(noise=0.0, channels=(("target.x", "wrist.x"),), speeds=(0.1,))
    parts = prepared(made)
    assert set(parts[0].found) == {"wrist + target"}
    total, count = misfit(parts, "wrist + target")
    assert total < 0.1 * count
    wrong = prepared(made, {"wrist.stiffness": 1100.0})
    assert misfit(wrong, "wrist + target")[0] > 10.0 * total + 30.0


def test_a_body_that_no_channel_shows_has_no_balance() -> None:
    parts = prepared(record(channels=(("target.x",), ("contact.force",)), masses=(9.0,)))
    assert set(parts[0].found) == {"target"}


def test_yaw_balance_of_an_eccentric_contact() -> None:
    turning = {**VALUES, "target.yaw_inertia": 0.3, "target.contact_point.ahead": 0.1}
    hit = {**turning, "target.contact_point.lateral": 0.01}
    _, trials = record(
        values=hit,
        channels=(("target.x", "wrist.x", "target.yaw"), ("contact.force",)),
        noise=0.0,
        speeds=(0.1,),
        masses=(9.0,),
    )
    model = Rig(believed(("target.mass=9",)), hit)
    right = Prepared(model, trials[0], hit, trials)
    wrong = Prepared(model, trials[0], turning, trials)
    assert misfit([right], "target.yaw")[0] < 1.0
    assert misfit([wrong], "target.yaw")[0] > 100.0


def test_nonlinear_laws_are_balanced_too() -> None:
    stiff = Placed(all_effects()["cubic_stiffness"], "wrist", {"k3_N_m3": 4e5})
    _, trials = record(stiff.apply, noise=0.0, speeds=(0.15,), masses=(23.2,))

    class Hardening(Rig):
        def mechanism(self, values: Mapping[str, float], trial: TrialData) -> Mechanism:
            return stiff.apply(rig(values))

    values = {**VALUES, **trials[0].overrides}
    right = Prepared(Hardening(believed(("all",))), trials[0], values, trials)
    wrong = Prepared(Rig(believed(("all",))), trials[0], values, trials)
    assert misfit([right], "wrist")[0] < 2.0
    assert misfit([wrong], "wrist")[0] > 1000.0


def test_what_should_stand_still() -> None:
    soft = Placed(
        all_effects()["arm_compliance"], "arm", {"mass_kg": 20.0, "stiffness_N_m": 3e4, "damping_Ns_m": 100.0}
    )
    made = record(
        soft.apply,
        channels=(("target.x", "wrist.x", "hand.x"), ("contact.force",)),
        noise=0.0,
        speeds=(0.1,),
        masses=(23.2,),
    )
    parts = prepared(made)
    assert misfit(parts, "hand")[0] > 100.0
    assert parts[0].found["hand"].unit == "m"


def test_a_trial_without_positions_is_refused() -> None:
    model, trials = record(channels=(("contact.force",),), speeds=(0.1,), masses=(9.0,))
    with pytest.raises(InputError, match="no channel measures"):
        Prepared(model, trials[0], {**VALUES, **trials[0].overrides}, trials)


def test_missing_samples_do_no_harm() -> None:
    model, trials = record(seed=2, speeds=(0.1,), masses=(23.2,))
    rng = np.random.default_rng(7)
    blocks = tuple(replace(b, weight=b.weight * (rng.uniform(size=b.weight.shape) > 0.1)) for b in trials[0].blocks)
    gappy = replace(trials[0], blocks=blocks)
    part = Prepared(model, gappy, {**VALUES, **gappy.overrides}, (gappy,))
    total, count = misfit([part], "target")
    assert total / count < 1.5


def test_force_read_backwards_is_understood() -> None:
    model, trials = record(noise=0.0, speeds=(0.1,), masses=(9.0,))
    block = trials[0].blocks[1]
    turned = replace(trials[0], blocks=(trials[0].blocks[0], replace(block, value=-block.value)))

    class Reversed(Rig):
        def mechanism(self, values: Mapping[str, float], trial: TrialData) -> Mechanism:
            plain = rig(values)
            flipped = replace(plain.readouts["contact.force"], sign=-1.0)
            return replace(plain, readouts={**plain.readouts, "contact.force": flipped})

    values = {**VALUES, **turned.overrides}
    part = Prepared(Reversed(model.believed), turned, values, (turned,))
    total, count = misfit([part], "target")
    assert total < 0.05 * count


def test_a_sensor_noisier_than_stated_shows() -> None:
    made = record(seed=9, speeds=(0.1,), masses=(9.0,))
    loud = replace(made[1][0], blocks=tuple(replace(b, weight=3.0 * b.weight) for b in made[1][0].blocks))
    part = Prepared(made[0], loud, {**VALUES, **loud.overrides}, (loud,))
    total, count = misfit([part], "target")
    assert total / count > 4.0
