"""Bodies in the plane: what resists them is one law for all directions, and knocks are found in their own trials."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.diagnose import diagnose
from tests.diagnosis.parts.helpers_plane import MASS, in_plane


def against(velocity: np.ndarray, power: float) -> np.ndarray:
    """Unit force against the velocity, times a power of the speed."""
    speed = max(float(np.hypot(*velocity)), 1e-6)
    return -velocity / speed * speed**power


@pytest.mark.parametrize(
    ("effect", "power", "size"),
    [
        ("coulomb_friction", 0.0, 0.08),
        ("viscous_drag", 1.0, 0.6),
        ("quadratic_drag", 2.0, 1.5),
    ],
)
@pytest.mark.slow
def test_an_oblique_slide_has_one_law_for_all_directions(
    effect: str, power: float, size: float, tmp_path: Path
) -> None:
    """Not one along and another across, nor drag in the place of dry friction."""
    study = in_plane(tmp_path, lambda v: size * against(v, power))
    verdict = diagnose(study, jobs=1).verdict
    assert verdict["verdict"] == "named"
    (found,) = verdict["effects"]
    assert (found["effect"], found["where"]) == (effect, "target")
    (value,) = found["parameters"].values()
    assert value["value"] == pytest.approx(size, rel=0.05)


@pytest.mark.slow
def test_knocks_are_found_in_their_trials_with_moment_and_size(tmp_path: Path) -> None:
    """Two of four trials, along, across and about; what acts in all of them is found beside."""
    knocks = {1: (2.2, (0.10, -0.06, 0.004)), 3: (3.9, (-0.08, 0.0, -0.005))}
    study = in_plane(tmp_path, lambda v: 0.6 * against(v, 1.0), knocks)
    verdict = diagnose(study, jobs=1).verdict
    struck = [e for e in verdict["effects"] if e["effect"] == "external_impulse"]
    steady = [(e["effect"], e["where"]) for e in verdict["effects"] if e not in struck]
    assert steady == [("viscous_drag", "target")]
    assert verdict["effects"][0]["parameters"]["coefficient_Ns_m"]["value"] == pytest.approx(0.6, rel=0.1)
    places = ("target", "target.y", "target.yaw")
    planted = {(f"s{n}", w): (j, t) for n, (t, js) in knocks.items() for w, j in zip(places, js, strict=True) if j}
    found = {(e["trials"][0], e["where"]): [p["value"] for p in e["parameters"].values()] for e in struck}
    assert set(found) == set(planted)
    for key, (impulse, moment) in planted.items():
        assert found[key] == pytest.approx([impulse, moment], rel=0.15), key


@pytest.mark.slow
def test_a_push_that_lasts_takes_nothing_from_what_acts_always(tmp_path: Path) -> None:
    """It is found whole, with how long it lasted; the drag beside it is as without it."""
    study = in_plane(tmp_path, lambda v: 0.6 * against(v, 1.0), {1: (2.0, (0.10, -0.06, 0.004))}, lasting=0.9)
    drag, *struck = diagnose(study, jobs=1).verdict["effects"]
    assert drag["parameters"]["coefficient_Ns_m"]["value"] == pytest.approx(0.6, rel=0.02)
    found = {(e["trials"][0], e["where"]): [p["value"] for p in e["parameters"].values()] for e in struck}
    assert set(found) == {("s1", w) for w in ("target", "target.y", "target.yaw")}
    for where, impulse in (("target", 0.10), ("target.y", -0.06), ("target.yaw", 0.004)):
        assert found["s1", where] == pytest.approx([impulse, 2.45, 0.9], rel=0.15), where


@pytest.mark.slow
def test_a_bowl_is_no_drag_although_bodies_that_leave_its_middle_slow_down(tmp_path: Path) -> None:
    """Each of its curvatures explains one channel alone; beside them the bearing's friction is found as well."""

    def pull(state: np.ndarray) -> np.ndarray:
        bowl = -9.80665 * MASS * 0.0013 * state[:2]
        return np.array([*bowl, -0.004 * state[5]])

    verdict = diagnose(in_plane(tmp_path, pull=pull), jobs=1).verdict
    found = {(e["effect"], e["where"]): next(iter(e["parameters"].values()))["value"] for e in verdict["effects"]}
    assert found == {
        ("table_curvature", "target"): pytest.approx(0.0013, rel=0.1),
        ("table_curvature", "target.y"): pytest.approx(0.0013, rel=0.1),
        ("viscous_drag", "target.yaw"): pytest.approx(0.004, rel=0.1),
    }


@pytest.mark.slow
def test_nothing_struck_a_body_that_glides(tmp_path: Path) -> None:
    """Noise is no knock."""
    verdict = diagnose(in_plane(tmp_path), jobs=1).verdict
    assert verdict["verdict"] == "nothing_missing"


@pytest.mark.slow
def test_what_comes_again_in_another_trial_is_no_knock(tmp_path: Path) -> None:
    """At the same moment and the same way: the machine does it, and its model leaves it out. It has no name here."""
    kick = (2.2, (0.10, -0.06, 0.004))
    verdict = diagnose(in_plane(tmp_path, lambda v: 0.6 * against(v, 1.0), {1: kick, 3: kick}), jobs=1).verdict
    assert not [e for e in verdict["effects"] if e["effect"] == "external_impulse"]
    assert verdict["verdict"] != "nothing_missing"
