"""What effects do to masses: the sum is what was there and what was added, or the effect is refused; in every door."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.diagnosis.terms.hypothesis import Believed, Site, hypothesis
from spacerobot.effects.primitives import Coordinate
from spacerobot.effects.registry import effect
from spacerobot.simulation.parts import EffectAt, Target, Wrist
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.scene_file import scene_from_text
from spacerobot.simulation.simulate import simulate
from spacerobot.support.errors import InputError, SimulationError

PLAIN = Scene("chaser_pa10_wrist", joints="free", wrist=Wrist(mass=0.7), target=Target(mass=9.0))
BEFORE = {name: c.mass for name, c in PLAIN.mechanism("multibody").coordinates.items()}
PLACES = ("target", "wrist", "base", "joint.S2")
EDGES = st.sampled_from([-1e-9, 0.0, 1e-9])
"""On either side of all that is there, and at it."""


def slosh(mass: float) -> EffectAt:
    return EffectAt("hidden_oscillator", "target", {"mass_kg": mass, "frequency_Hz": 1.0, "damping_ratio": 0.05})


def applied(item: EffectAt) -> tuple[Mapping[str, Coordinate], InputError | None]:
    """The coordinates that it leaves, or why it was refused."""
    try:
        return item.apply(PLAIN.mechanism("multibody")).coordinates, None
    except InputError as error:
        return {}, error


@settings(max_examples=60, derandomize=True, deadline=None)
@given(st.sampled_from(PLACES), st.one_of(st.floats(-40.0, 40.0), EDGES))
def test_a_payload_adds_up_or_is_refused(where: str, added: float) -> None:
    if abs(added) < 1e-6:
        added -= BEFORE[where]
    found, refused = applied(EffectAt("payload", where, {"mass_kg": added}))
    assert (refused is not None) == (BEFORE[where] + added <= 0.0)
    if refused is not None:
        assert float(str(refused.given)) == pytest.approx(added, rel=1e-5)
        assert f"above {-BEFORE[where]:g}" in str(refused.valid)
        assert refused.where == f"payload at {where}"
        return
    for name in (where, *([f"{where}.y"] if where == "target" else ())):
        assert found[name].mass == pytest.approx(BEFORE[where] + added, rel=1e-12, abs=1e-300)


@settings(max_examples=60, derandomize=True, deadline=None)
@given(st.one_of(st.floats(0.0, 30.0), st.sampled_from([9.0 - 1e-9, 9.0, 9.0 + 1e-9])))
def test_a_hidden_mass_is_part_of_the_target_or_refused(mass: float) -> None:
    found, refused = applied(slosh(mass))
    assert (refused is not None) == (mass >= 9.0)
    if refused is not None:
        assert float(str(refused.given)) == pytest.approx(mass, rel=1e-5)
        assert (refused.where, refused.valid) == ("hidden_oscillator at target", "below 9 kg")
        return
    along = [c.mass for c in found.values() if c.name == "target" or c.carrier == "target"]
    assert math.fsum(along) == pytest.approx(9.0, rel=1e-15)


IMPOSSIBLE = {
    "payload": (EffectAt("payload", "target", {"mass_kg": -20.0}), "-20", "above -9 kg"),
    "slosh": (slosh(20.0), "20", "below 9 kg"),
}


@pytest.mark.parametrize("name", list(IMPOSSIBLE))
def test_every_door_refuses_it(name: str, tmp_path: Path) -> None:
    item, given_, valid = IMPOSSIBLE[name]
    with pytest.raises(InputError, match=rf"effects\[0\].*given: {given_}.*valid: {valid}"):
        PLAIN.with_effects(item)
    written = Scene(target=Target(mass=9.0)).with_effects(slosh(1.0)).to_toml()
    values = ", ".join(f"{k} = {v}" for k, v in item.parameters.items())
    text = written[: written.index("[[effects]]")] + (
        f'[[effects]]\neffect = "{item.effect}"\nwhere = "target"\nparameters = {{ {values} }}\n'
    )
    with pytest.raises(InputError, match=rf"scene: effects\[0\].*given: {given_}.*valid: {valid}"):
        scene_from_text(text)
    site = Site(effect(item.effect), item.where)
    made = hypothesis(Believed({}, {}, {}, ()), [site])
    with pytest.raises(SimulationError, match=valid):  # a fit takes a shorter step
        made.edit(PLAIN.mechanism("reduced"), {site.key(k): v for k, v in item.parameters.items()}, "01")


def test_a_sweep_that_reaches_it_is_refused() -> None:
    pytest.importorskip("pyarrow", reason="extra 'scale' is not installed")
    from spacerobot.sweep.sweep_file import plan_from_text

    head, effects = Scene(target=Target(mass=9.0)).with_effects(slosh(4.0)).to_toml().split("[[effects]]")
    scene = head.replace("backend =", "# backend =").replace("\n[", "\n[scene.")
    text = f"format = 1\n[scene]\n{scene.replace('format = 1', '')}\n[[scene.effects]]{effects}\n"
    assert plan_from_text(text + '[grid]\n"target.mass" = [5.0, 9.0]\n', Path()).total == 2
    with pytest.raises(
        InputError, match=r"grid\.target\.mass: the sweep reaches target\.mass = 3.*given: 4.*below 3 kg"
    ):
        plan_from_text(text + '[grid]\n"target.mass" = [3.0, 9.0]\n', Path())


@settings(max_examples=12, derandomize=True, deadline=None)
@given(st.floats(-1.0, 1.2))
def test_a_joint_gives_away_no_more_than_it_has_of_its_own(share: float) -> None:
    """Its diagonal inertia is partly coupling: between the two no motion exists, and it is said before any step."""
    added = share * BEFORE["joint.S2"]
    try:
        scene = PLAIN.with_effects(EffectAt("payload", "joint.S2", {"mass_kg": added}))
        simulate(scene, duration=0.01, must_touch=False, rate=1000.0)
    except InputError:
        assert added < 0.0
