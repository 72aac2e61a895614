"""Units to typical sizes, and effects scaled to them."""

from __future__ import annotations

import pickle

import pytest

from spacerobot.diagnosis.machines.sizes import USUAL, beside_usual, scaled
from spacerobot.effects.registry import all_effects, effect
from spacerobot.effects.sizes import Sizes
from spacerobot.support.errors import InputError


def test_sizes_of_units() -> None:
    s = Sizes(force=2.0, length=0.5, time=0.1)
    assert s.of("N s^2/m^2") == pytest.approx(2.0 * 0.01 / 0.25)
    assert s.of("N/m^3") == pytest.approx(2.0 / 0.125)
    assert s.of("kg") == pytest.approx(2.0 * 0.01 / 0.5)
    assert s.of("Hz") == pytest.approx(10.0)
    assert s.of("1") == 1.0
    with pytest.raises(InputError, match="unknown unit"):
        s.of("furlong")


@pytest.mark.parametrize("name", sorted(all_effects()))
def test_every_effect_can_be_scaled_and_stays_itself(name: str) -> None:
    plain, big = effect(name), scaled(effect(name), Sizes(force=5e3, length=30.0, time=2.0))
    assert big.name == name
    assert [p.null for p in big.parameters] == [p.null for p in plain.parameters]
    for p in big.parameters:
        assert all(p.lower <= s <= p.upper for s in p.starts)
    assert effect(name).parameters is plain.parameters


def test_a_thousandfold_rig_gets_thousandfold_steps() -> None:
    small, large = (scaled(effect("coulomb_friction"), Sizes(f, 1.0, 1.0)).parameters[0] for f in (1.0, 1000.0))
    assert large.scale == pytest.approx(1000.0 * small.scale)
    assert large.starts == pytest.approx([1000.0 * s for s in small.starts])


def test_sizes_must_be_positive() -> None:
    with pytest.raises(InputError, match="typical size"):
        Sizes(0.0, 1.0, 1.0)


@pytest.mark.parametrize("name", sorted(all_effects()))
def test_a_rig_of_another_size_is_searched_in_its_own_sizes(name: str) -> None:
    """Two machines alike but for their units of force, length and time begin their fits alike; the usual as it is."""
    sizes = Sizes(force=40.0 * USUAL.force, length=5.0 * USUAL.length, time=4.0 * USUAL.time)
    plain, big = effect(name), beside_usual(effect(name), sizes)
    assert beside_usual(effect(name), USUAL) is plain
    unit = Sizes(force=40.0, length=5.0, time=4.0)
    for was, now in zip(plain.parameters, big.parameters, strict=True):
        angle = was.unit in ("rad", "rad/m")  # against a gravity that is the same for both
        factor = 5.0 ** (was.unit == "rad") / 16.0 if angle else unit.of(was.unit)
        assert now.scale == pytest.approx(factor * was.scale)
        assert all(was.lower <= s <= was.upper for s in now.starts)
        assert now.starts[0] == pytest.approx(min(max(factor * was.starts[0], was.lower), was.upper))
    assert pickle.loads(pickle.dumps(big)).parameters == big.parameters  # as sent to workers
