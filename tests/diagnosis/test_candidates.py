"""Candidates: what is covered by a believed value is not proposed; special cases are known as such."""

from __future__ import annotations

from spacerobot.diagnosis.terms.candidates import acting_as, candidate_sites, contains, means, mirrored
from spacerobot.diagnosis.terms.hypothesis import Believed
from spacerobot.effects.registry import all_effects
from spacerobot.simulation.rig import rig


def labels(sigma: dict[str, float], without: tuple[str, ...] = ()) -> set[tuple[str, str]]:
    believed = Believed({}, sigma, {}, ("all",))
    effects = [e for e in all_effects().values() if e.name not in without]
    return {s.label for s in candidate_sites(rig({}), believed, effects)}


def test_a_believed_mass_covers_a_payload() -> None:
    assert ("payload", "target") in labels({})
    assert ("payload", "target") not in labels({"target.mass": 0.01})


def test_a_value_says_what_acts_exactly_as_it_does() -> None:
    def told(name: str, larger: bool) -> list[tuple[str, str]]:
        return [(effect.name, where) for effect, where in acting_as(rig({}), name, larger)]

    assert told("wrist.damping", True) == [("viscous_friction", "wrist")]
    assert told("wrist.damping", False) == []  # no friction drives
    assert told("target.mass", False) == [("payload", "target")]
    assert told("wrist.stiffness", True) == []


def test_effects_can_be_withheld() -> None:
    assert ("coulomb_friction", "wrist") in labels({})
    assert not any(name == "coulomb_friction" for name, _ in labels({}, ("coulomb_friction",)))


def test_special_cases() -> None:
    coulomb, both_ways = ("coulomb_friction", "wrist"), ("asymmetric_friction", "wrist")
    tilt = ("table_tilt", "target")
    assert contains([both_ways], [coulomb])
    assert contains([both_ways, tilt], [coulomb])
    assert contains([coulomb, tilt], [tilt])
    assert not contains([coulomb], [both_ways])
    assert not contains([coulomb], [coulomb])
    assert not contains([("asymmetric_friction", "joint.a")], [coulomb])


def test_a_stream_cannot_be_early() -> None:
    late = {"time_offset@mocap.delay_s": 0.01}
    early = {"time_offset@mocap.delay_s": -0.01}
    assert means([("time_offset", "mocap")], late)
    assert not means([("time_offset", "mocap")], early)


MOCAP, FORCE = ("time_offset", "mocap"), ("time_offset", "force_sensor")
STOP = ("end_stop", "wrist")


def test_a_stream_that_is_early_is_the_other_one_late() -> None:
    values = {"time_offset@mocap.delay_s": -0.01, "end_stop@wrist.travel_m": 0.02, "wrist.mass": 0.7}
    found = mirrored((STOP, MOCAP), values, [MOCAP, FORCE, STOP])
    assert found is not None
    label, moved = found
    assert set(label) == {STOP, FORCE}
    assert moved == {"time_offset@force_sensor.delay_s": 0.01, "end_stop@wrist.travel_m": 0.02, "wrist.mass": 0.7}
    assert means(label, moved)


def test_what_is_late_already_or_late_beside_two_others_is_left_alone() -> None:
    late = {"time_offset@mocap.delay_s": 0.01}
    early = {"time_offset@mocap.delay_s": -0.01}
    assert mirrored((STOP, MOCAP), late, [MOCAP, FORCE]) is None
    assert mirrored((STOP,), {}, [MOCAP, FORCE]) is None
    assert mirrored((MOCAP,), early, [MOCAP]) is None
    assert mirrored((MOCAP,), early, [MOCAP, FORCE, ("time_offset", "imu")]) is None
    assert mirrored((FORCE, MOCAP), {**early, "time_offset@force_sensor.delay_s": 0.0}, [MOCAP, FORCE]) is None
