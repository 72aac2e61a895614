"""Words, numbers, formulas of reports."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.effects.registry import all_effects
from spacerobot.recordings.value_units import unit_of_value
from spacerobot.view.report.formula import mathml
from spacerobot.view.report.story import few_trials, improvement
from spacerobot.view.report.unseen import unseen
from spacerobot.view.report.words import (
    beyond,
    effect_object,
    number,
    parameter_label,
    parameters_text,
    per_unit,
    place,
    probability,
    quantity,
    rivals_with_own_units,
    unit_of_name,
    with_own_units,
)


@pytest.mark.parametrize(
    ("given_", "said"),
    [
        ((0.308, "N", (0.291, 0.325)), "0.308 N (95 %: 0.291 to 0.325)"),
        ((0.0042, "s", (0.00416, 0.00424)), "4.200 ms (95 %: 4.160 to 4.240)"),
        ((2.1e-5, "m", (1e-5, 3.2e-5)), "21 µm (95 %: 10 to 32)"),
        ((-0.5, "N", (-0.6, -0.4)), "−0.50 N (95 %: −0.60 to −0.40)"),
        ((1.5, "1", (1.48, 1.52)), "1.500 (95 %: 1.480 to 1.520)"),
        (("inf", "N/m", [1e5, "inf"]), "∞ N/m (95 %: 1 × 10⁵ to ∞)"),
        ((None, "N", None), "–"),
        ((12.0, "N/m^3", None), "12 N/m³"),
    ],
)
def test_quantities(given_: tuple, said: str) -> None:
    assert quantity(*given_).replace("\u00a0", " ") == said


@settings(max_examples=200, derandomize=True)
@given(st.floats(1e-12, 1e12), st.floats(1e-6, 0.5))
def test_a_printed_interval_never_loses_its_ends(value: float, relative: float) -> None:
    said = quantity(value, "kg", (value * (1 - relative), value * (1 + relative)))
    low, high = said.split(":")[1].rstrip(")").split(" to ")
    assert low.strip() != high.strip() or relative < 1e-3


@settings(max_examples=200, derandomize=True)
@given(st.floats(allow_nan=False, allow_infinity=False, min_value=-1e30, max_value=1e30))
def test_numbers_keep_three_digits(value: float) -> None:
    said = number(value).replace("−", "-").replace("\u202f", "")
    superscripts = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
    mantissa, _, exponent = said.partition(" × 10")
    read = float(mantissa) * 10.0 ** int(exponent.translate(superscripts) or 0)
    assert math.isclose(read, value, rel_tol=5.1e-3, abs_tol=1e-300)


def test_articles_and_plain_hundreds() -> None:
    assert effect_object({"effect": "time_offset", "where": "force_sensor"}) == "a time offset in the force sensor"
    assert effect_object({"effect": "end_stop", "where": "wrist"}) == "an end stop in the wrist's guide"
    above = {"effect": "end_stop", "where": "joint.a", "kind": "above"}
    assert effect_object(above) == "an end stop on one side (above) in joint a"
    assert effect_object({"effect": "coulomb_friction", "where": "wrist"}) == "Coulomb friction in the wrist's guide"
    assert number(190.4, 2) == "190"
    assert number(1.9e7, 2) == "1.9 × 10⁷"


def test_probabilities_do_not_pretend() -> None:
    assert probability(0.0) == "< 10⁻⁹"
    assert probability(2e-7) == "10⁻⁷"
    assert probability(0.031) == "0.031"


def test_every_parameter_of_the_catalogue_has_a_label_without_its_unit() -> None:
    for effect in all_effects().values():
        for parameter in effect.parameters:
            label = parameter_label(parameter.name)
            assert label
            assert "_" not in label
            if parameter.unit not in ("1", "channel unit"):
                assert unit_of_name(parameter.name) == parameter.unit


def test_places_read_as_part_of_a_sentence() -> None:
    assert place("joint.S2") == "in joint S2"
    assert place("target.yaw") == "on the target (yaw)"
    assert place("imu") == "in imu"


@pytest.mark.parametrize("name", sorted(all_effects()))
def test_every_formula_of_the_catalogue_renders(name: str) -> None:
    said = mathml(all_effects()[name].formula)
    assert said.startswith("<math ")
    assert "\\" not in said.split(">", 1)[1]


@pytest.mark.parametrize(
    "latex", [r"\text{<script>x</script>}", r"\href{javascript:x}{y}", r"\frac{", "<img src=x>", ""]
)
def test_a_hostile_formula_is_shown_as_text(latex: str) -> None:
    said = mathml(latex)
    assert "<script" not in said
    assert "href=" not in said
    assert "<img" not in said


def test_one_channel_that_gains_is_told_of_where_all_together_hide_it() -> None:
    overall = {"rms_before": 1.14, "rms_after": 1.11}
    turning = {"rms_before": 0.18, "rms_after": 0.03}
    others = {"rms_before": 2.0, "rms_after": 2.0}
    channels = {"target.velocity.yaw": turning, "joint.1.torque": others}
    verdict = {"held_out": {"unit": "spread", "overall": overall, "channels": channels}}
    assert improvement(verdict) == "data of target.velocity.yaw held back from the fit are predicted 6 times nearer"
    turning["rms_after"] = 0.179  # no channel gains
    assert "110 % of each channel's own spread" in (improvement(verdict) or "")
    overall["rms_after"] = 0.5
    assert "50 % instead of 110 %" in (improvement(verdict) or "")


def test_parameters_of_one_effect_and_of_two() -> None:
    levels = {"asymmetric_friction@joint.E1.force_plus_N": 0.0163, "asymmetric_friction@joint.E1.force_minus_N": 0.015}
    assert parameters_text(levels) == "force plus 0.0163, force minus 0.015"  # a joint that turns has no forces in N
    late = {"time_offset@mocap.delay_s": 0.003}
    assert parameters_text(late) == "3\u00a0ms"
    pushed = {"external_impulse@target.impulse_Ns": 0.02, "external_impulse@target.time_s": 0.65}
    two = parameters_text({**late, **pushed})
    first, second = two.split("; ")
    assert first.endswith(": delay 3\u00a0ms")
    assert second == "external impulse on the target: impulse 0.02\u00a0N s, time 0.65\u00a0s"
    assert parameters_text({}) == ""


def test_what_was_done_with_the_trials_kept_aside_is_said() -> None:
    fold = {"left_out": ["1", "2"], "selected": [], "leads_to": "a part of it", "rms_selected": 3.0}
    named = {"left_out": ["3"], "selected": [{"effect": "adhesion", "where": "contact"}], "leads_to": "another set"}
    held_out = {
        "same_set": 1,
        "folds": [{**fold}, {**named, "rms_selected": math.inf}, {**fold, "leads_to": "the same set"}],
        "taken_from_unseen": ["each trial's own start"],
        "failed": [{"trial": "3", "model": "after", "why": "<b>it would not</b>"}],
    }
    said = unseen({"held_out": held_out})
    assert "the same set 1 of 3 times" in said[0]
    assert "trials 1, 2" in said[1]
    assert "the baseline" in said[1]
    assert "trial 3" in said[2]
    assert "adhesion at contact" in said[2]
    assert "each trial's own start" in said[3]
    assert "it would not" in said[4]
    assert unseen({"held_out": {"overall": {}}}) == unseen({}) == []


def test_few_trials_are_told_what_they_can_show() -> None:
    said = [few_trials(n) for n in (1, 2, 3)]
    assert len(set(said)) == 3
    assert all(said)
    assert few_trials(0) is None
    assert few_trials(4) is None


def test_a_channel_s_own_unit_is_looked_up() -> None:
    bias = {"effect": "bias", "where": "drive", "parameter": "value", "smallest": 0.2, "unit": "channel unit"}
    verdict = {"effects": [], "alternatives": [], "detectable": [bias, {**bias, "where": "force_sensor"}]}
    channels = {"joint.axis.torque": {"unit": "N m", "stream": "drive"}}
    drive, force = with_own_units(verdict, channels)["detectable"]
    assert (drive["unit"], force["unit"]) == ("N m", "N")
    pushed = {"effect": "bias", "where": "command", "parameters": {"value": {"value": 0.1, "unit": "channel unit"}}}
    (part,) = with_own_units({**verdict, "parts": [{"part": "body", "effects": [pushed]}]}, {})["parts"]
    assert part["effects"][0]["parameters"]["value"]["unit"] == "N"
    assert "channel" not in quantity(0.2, with_own_units(verdict, {})["detectable"][0]["unit"])


def test_what_else_was_tried_has_its_units_too() -> None:
    tried = {"parameters": {"bias@drive.value": 0.2, "bias@mocap.value": 1e-5, "scale@mocap.factor": 0.7}}
    channels = {"joint.axis.torque": {"unit": "N m", "stream": "drive"}}
    (found,) = rivals_with_own_units([tried], channels)
    assert found["parameters"]["bias@drive.value"] == {"value": 0.2, "unit": "N m"}
    assert parameters_text({"bias@mocap.value": found["parameters"]["bias@mocap.value"]}) == "10\xa0µm"
    assert found["parameters"]["scale@mocap.factor"] == 0.7


def test_no_size_beyond_what_the_catalogue_allows_is_a_limit() -> None:
    late = {"effect": "time_offset", "where": "mocap", "parameter": "delay_s", "unit": "s"}
    assert beyond({**late, "smallest": 6e12})
    assert beyond({**late, "smallest": "inf"})
    assert beyond({**late, "smallest": None})
    assert not beyond({**late, "smallest": 1e-4})


def test_forces_on_a_body_of_unknown_mass_are_per_kilogram() -> None:
    """Its own alone, and what has no mass in it (a delay, an angle) stays what it was."""

    def drag(where: str, part: str, unit: str = "N s/m") -> dict[str, object]:
        value = {"value": 1.0, "ci95": [0.9, 1.1], "unit": unit}
        return {"effect": "viscous_drag", "where": where, "part": part, "parameters": {"x": value}}

    effects = [drag("target", "a"), drag("target", "b"), drag("target.yaw", "a", "N m s/rad"), drag("target", "a", "s")]
    parts = [{"part": "a", "relative_to": ["body.mass", "body.yaw_inertia"]}, {"part": "b", "relative_to": []}]
    limits = [{"effect": "payload", "where": "a", "parameter": "mass_kg", "smallest": 0.1, "unit": "kg"}]
    found = per_unit({"effects": effects, "parts": parts, "detectable": limits})
    units = [e["parameters"]["x"]["unit"] for e in found["effects"]]
    assert units == ["N s/m per kg", "N s/m", "N m s/rad per kg m^2", "s"]
    assert found["detectable"][0]["unit"] == "kg per kg"
    rivals = [{"effects": effects[:1], "score": 0.0}, {"effects": [], "score": -1.0}]
    among = per_unit({"effects": [], "parts": parts, "detectable": [], "alternatives": rivals})["alternatives"]
    assert [[e["parameters"]["x"]["unit"] for e in a["effects"]] for a in among] == [["N s/m per kg"], []]
    plain = {"viscous_drag@target.coefficient_Ns_m": 0.2, "viscous_drag@target.yaw.coefficient_Ns_m": 0.1}
    own = {"effects": [], "parameters": {**plain, "table_tilt@target.angle_rad": 0.1}, "part": "a", "score": 0.0}
    told = per_unit({"effects": [], "parts": parts, "detectable": [], "alternatives": [own]})["alternatives"]
    text = parameters_text(told[0]["parameters"]).replace("\xa0", " ")
    assert "0.2 N s/m per kg" in text
    assert "0.1 N m s/rad per kg m²" in text
    assert "0.1 rad" in text
    assert per_unit({"effects": effects, "detectable": []})["effects"] == effects


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("wrist.mass", "kg"),
        ("target.x.zero", "m"),
        ("contact.force.zero", "N"),
        ("joint.a.zero", "rad"),
        ("contact.force|Fx.factor", ""),
        ("nothing", ""),
    ],
)
def test_a_believed_value_has_its_unit(name: str, unit: str) -> None:
    assert unit_of_value(name) == unit
