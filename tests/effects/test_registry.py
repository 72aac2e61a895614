"""Effects are found, named once, bounded, and a user's own file adds one."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from spacerobot.effects import registry
from spacerobot.effects.effect import name_on
from spacerobot.simulation.rig import rig
from spacerobot.support.errors import InputError, NotFoundError

OWN = '''
from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.primitives import Force


def force(d, v, aux, p):
    return -p[0] * v * d * d


class VanDerPol(Effect):
    """Damping that grows with displacement."""

    name = "van_der_pol"
    title = "van der Pol damping"
    formula = "f = -c d^2 v"
    source = "van der Pol (1926)"
    parameters = (Parameter("coefficient_Ns_m3", "N s/m^3", 0.0, 100.0, 0.0, 1e6, (500.0,)),)

    def places(self, mechanism):
        return ("wrist",) if "wrist" in mechanism.ports else ()

    def edit(self, mechanism, where, values):
        return mechanism.with_force(Force("van der Pol", where, Kernel(force), (values["coefficient_Ns_m3"],)))
'''


def test_every_promised_effect_is_there() -> None:
    promised = {
        "coulomb_friction",
        "stribeck_friction",
        "asymmetric_friction",
        "viscous_friction",
        "quadratic_damping",
        "cubic_stiffness",
        "backlash",
        "end_stop",
        "preload",
        "hertz_contact",
        "hunt_crossley",
        "adhesion",
        "contact_friction",
        "arm_compliance",
        "viscous_drag",
        "quadratic_drag",
        "table_tilt",
        "tether",
        "eccentric_contact",
        "hidden_oscillator",
        "external_impulse",
        "payload",
        "transmission_coupling",
        "magnus",
        "time_offset",
        "low_pass",
        "scale",
        "bias",
        "sensor_inertia",
    }
    assert promised <= set(registry.all_effects())


@pytest.mark.parametrize("name", sorted(registry.all_effects()))
def test_parameters_are_sound(name: str) -> None:
    effect = registry.effect(name)
    assert effect.parameters
    for p in effect.parameters:
        assert p.lower <= p.null <= p.upper
        assert all(p.lower <= s <= p.upper for s in p.starts)
        assert not p.log or min(p.starts) > 0.0
    assert effect.formula
    assert effect.source


def test_unknown_names_suggest_the_nearest() -> None:
    with pytest.raises(NotFoundError, match="coulomb_friction"):
        registry.effect("columb_friction")
    with pytest.raises(NotFoundError, match="wrist"):
        registry.effect("coulomb_friction").apply(rig({}), "wrst", {"force_N": 0.1})
    with pytest.raises(InputError, match="outside its bounds"):
        registry.effect("coulomb_friction").apply(rig({}), "wrist", {"force_N": -0.1})


def test_units_follow_the_joint() -> None:
    assert name_on("force_N", True) == "force_Nm"
    assert name_on("coefficient_Ns_m", True) == "coefficient_Nms_rad"
    assert name_on("k3_N_m3", True) == "k3_Nm_rad3"
    assert name_on("force_N", False) == "force_N"


def test_a_users_file_adds_an_effect(tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    path.write_text(OWN)
    try:
        assert registry.load_effects(path) == ["van_der_pol"]
        edited = registry.effect("van_der_pol").apply(rig({}), "wrist", {"coefficient_Ns_m3": 500.0})
        assert edited.forces[-1].kernel.force(0.1, 2.0, 0.0, (500.0,)) == pytest.approx(-10.0)
    finally:
        registry._effects.pop("van_der_pol", None)


@pytest.mark.parametrize(("text", "says"), [("1 / 0", "ZeroDivisionError"), ("x = 1", "defines no Effect")])
def test_a_bad_file_is_one_clear_error(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "bad.py"
    path.write_text(text)
    with pytest.raises(InputError, match=re.escape(says)):
        registry.load_effects(path)
