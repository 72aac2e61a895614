"""A wrist on a robot that moves: joints, base, wrist and target fitted at once, against the whole robot."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.locate.locate import locate
from spacerobot.diagnosis.machines.whole_rig import WholeRig
from spacerobot.diagnosis.selection.admission import admit
from spacerobot.diagnosis.selection.beyond import NEAR, apart, of_whole_robot
from spacerobot.diagnosis.terms.decision import LOCATED
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.simulation.parts import EffectAt
from tests.diagnosis.moving_robots import moving_robot

ELBOW, GUIDE = ("coulomb_friction", "joint.E1"), ("coulomb_friction", "wrist")


def _fitted(workshop: Workshop, *label: tuple[str, str]) -> Fit:
    plain = workshop.fitter().fit(hypothesis(workshop.model.believed, []))
    if not label:
        return plain
    found = workshop.run(Task(label, {}, near=plain))
    assert found is not None
    return found


def _left(fit: Fit) -> float:
    return fit.chi2 / fit.samples


@pytest.mark.parametrize(
    ("joints", "floating"),
    [
        pytest.param("servo", False, marks=pytest.mark.slow),
        ("locked", True),
        pytest.param("free", True, marks=pytest.mark.slow),
    ],
)
def test_what_is_believed_rightly_leaves_noise(tmp_path: Path, joints: str, floating: bool) -> None:
    study = moving_robot(tmp_path, joints, floating=floating)
    admit(study)
    workshop = of_whole_robot(Workshop(study))
    assert isinstance(workshop.model, WholeRig)
    fit = _fitted(workshop)
    assert apart(workshop, fit) < 2.0 * NEAR
    assert _left(fit) == pytest.approx(1.0, abs=6.0 * np.sqrt(2.0 / fit.samples))


@pytest.mark.slow
def test_friction_in_a_joint_is_told_from_friction_in_the_wrist(tmp_path: Path) -> None:
    """Each is put in, and explains what the other one does not."""
    for planted, other, force in ((ELBOW, GUIDE, 0.2), (GUIDE, ELBOW, 0.4)):
        folder = tmp_path / planted[1]
        folder.mkdir()
        workshop = Workshop(moving_robot(folder, "servo", EffectAt(*planted, {"force_N": force})))
        right, wrong = _fitted(workshop, planted), _fitted(workshop, other)
        assert _left(right) < 1.1
        assert right.chi2 < wrong.chi2 - 50.0
        value = right.values()[f"{planted[0]}@{planted[1]}.force_N"]
        assert value == pytest.approx(force, rel=0.1)


def test_a_base_that_drifts_is_seen_to(tmp_path: Path) -> None:
    """Each trial's own drift comes from the base's track: none was put in, and none is found beyond its noise."""
    workshop = Workshop(moving_robot(tmp_path, "locked", floating=True))
    fit = _fitted(workshop)
    for trial in workshop.trials:
        own = zip(workshop.model.nuisances(trial), fit.trials[trial.id].initial, strict=True)
        drift = {n.coordinate: v for n, v in own if n.rate and n.coordinate.startswith("base.")}
        assert set(drift) == {"base.position.x", "base.position.z", "base.pitch"}
        assert max(map(abs, drift.values())) < 1e-4


def test_a_hand_that_is_stated_takes_no_part(tmp_path: Path) -> None:
    """The robot's own masses are what the wrist feels."""
    study = moving_robot(tmp_path, "locked", floating=True)
    text = study.path.read_text()
    study.path.write_text(text.replace("[baseline.wrist]", "[baseline.hand]\nmass = 1.0\n[baseline.wrist]"))
    from spacerobot.recordings.study import load_study

    workshop = Workshop(load_study(tmp_path))
    assert "hand.mass" not in workshop.model.base
    assert _left(_fitted(workshop)) < 1.1


@pytest.mark.slow
def test_a_joint_that_rubs_opens_the_robots_balances_alone(tmp_path: Path) -> None:
    """Those of wrist and target close; of a robot that is believed rightly every balance does."""
    for name, planted in (("clean", ()), ("rubs", (EffectAt(*ELBOW, {"force_N": 0.4}),))):
        folder = tmp_path / name
        folder.mkdir()
        workshop = Workshop(moving_robot(folder, "servo", *planted))
        rows = locate(workshop.model, workshop.model.from_rest(workshop.trials)).rows
        opened = {r.balance for r in rows if r.p < LOCATED}
        assert bool(opened) == bool(planted)
        assert all(b == "hand" or b.startswith("arm.") for b in opened)


@pytest.mark.slow
def test_a_chaser_whose_elbow_rubs_is_named_so(tmp_path: Path) -> None:
    """The search is made again about what it found; a joint's friction is a torque."""
    study = moving_robot(tmp_path, "free", EffectAt(*ELBOW, {"force_N": 0.1}), floating=True)
    verdict = diagnose(study).verdict
    assert verdict["verdict"] == "named", verdict["why"]
    (found,) = verdict["effects"]
    assert (found["effect"], found["where"]) == ELBOW
    low, high = found["parameters"]["force_Nm"]["ci95"]
    assert low < 0.1 < high
    assert found["parameters"]["force_Nm"]["unit"] == "N m"


def test_what_a_zero_changes_is_what_two_predictions_differ_by(tmp_path: Path) -> None:
    """It is added to its channel and to nothing else: no simulation is needed to tell."""
    workshop = Workshop(moving_robot(tmp_path, "free", floating=True))
    fitter, trial = workshop.fitter(), workshop.trials[0]
    made, start = hypothesis(workshop.model.believed, []), fitter.guess()[trial.id]
    base, _ = fitter.residual(made, made.start(), trial, start)
    told = 0
    for n, nuisance in enumerate(workshop.model.nuisances(trial)):
        added = fitter.added(trial, n)
        assert (added is None) == (not nuisance.adds_to)
        if added is not None:
            moved = start.copy()
            moved[n] += 1.0
            np.testing.assert_allclose(fitter.residual(made, made.start(), trial, moved)[0] - base, added, rtol=1e-9)
            told += 1
    assert told > 5
