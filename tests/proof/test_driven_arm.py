"""Joint logs of the proof bench: MuJoCo against Pinocchio, hidden torques, strengths, what noise accounts for."""

from __future__ import annotations

import shutil
import subprocess
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from spacerobot.diagnosis.fitting.noise import rms_of
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.model.library import load
from spacerobot.proof.code_hash import ELSEWHERE, code_hashes, group
from spacerobot.proof.driven.arm import ROBOT, Log, believed, joints, links, run, torque_of
from spacerobot.proof.driven.arm import Path as Track
from spacerobot.proof.driven.bench import ArmBench
from spacerobot.proof.driven.campaign import DURATION, RATE, Campaign, drawn, write_study
from spacerobot.proof.driven.conceal import MAKERS, conceal
from spacerobot.proof.driven.hidden import DRAWS, draw, torque
from spacerobot.proof.driven.orders import FAMILY, FULL
from spacerobot.proof.driven.strength import Yardstick
from spacerobot.proof.engine.rig import STANDARD_GRAVITY
from spacerobot.proof.orders import of_family
from spacerobot.recordings.study import load_study
from spacerobot.support.sources import ROOT

pytest.importorskip("mujoco", reason="the extra `proof` is not installed")


@cache
def plain() -> tuple[Campaign, dict[str, Log]]:
    """A campaign with nothing missing, short: two trials."""
    whole = drawn(np.random.default_rng(4))
    some = replace(whole, tracks=dict(list(whole.tracks.items())[-2:]))
    return some, some.logs()


def test_inverse_dynamics_are_pinocchios() -> None:
    robot = load(ROBOT)
    model = pin.Model(robot.model)
    model.gravity.linear = np.array([0.0, 0.0, -STANDARD_GRAVITY])
    built = believed()
    rng = np.random.default_rng(1)
    q, v, a = rng.uniform(-1.0, 1.0, (3, 20, 7))
    step = 1e-4
    for k in range(20):
        line = np.array([-step, 0.0, step])[:, None]
        log = Log(line[:, 0], q[k] + v[k] * line, v[k] + a[k] * line, np.zeros((3, 7)))
        theirs = torque_of(built.masses, built.rotors, [log])[0][1]
        own = pin.rnea(model, model.createData(), robot.configuration(q[k]), v[k], a[k])
        np.testing.assert_allclose(theirs, own[[robot.velocity_index(j) for j in joints()]], rtol=1e-8, atol=1e-9)


def test_a_track_is_its_own_derivative_and_as_fast_as_asked() -> None:
    track = Track.drawn(np.random.default_rng(2), 0.5, DURATION)
    for t in (0.3, 2.0, 5.1):
        ahead, behind = track.at(t + 1e-5), track.at(t - 1e-5)
        for lower, upper in ((0, 1), (1, 2)):
            rate = (ahead[lower] - behind[lower]) / 2e-5
            np.testing.assert_allclose(rate, track.at(t)[upper], atol=1e-6)
    top = np.abs([track.at(t)[1] for t in np.linspace(0.0, DURATION, 300)]).max(axis=0)
    np.testing.assert_allclose(top, 0.5 * np.array([0.6, 0.6, 0.9, 0.9, 1.5, 1.5, 1.5]))


@pytest.mark.parametrize("effect", DRAWS)
def test_the_drive_overcomes_what_is_hidden(effect: str) -> None:
    """The torque that a rigid arm would need, taken from the log, leaves the hidden one, wherever the joint moves."""
    campaign, _ = plain()
    item = draw(effect, "E1", np.random.default_rng(3))(2.0)
    log = run(replace(campaign, hidden=(item,)).built(), next(iter(campaign.tracks.values())), DURATION, 500.0)
    left = log.torque - torque_of(campaign.masses, campaign.rotors, [log])[0]
    k = joints().index("E1")
    moves = np.convolve(np.abs(log.velocity[:, k]) < 0.08, np.ones(41), "same") == 0.0
    shown = torque(item, log.position, log.velocity)
    assert moves.sum() > 500
    size = float(np.abs(shown[moves]).max())
    np.testing.assert_allclose(left[moves, k], shown[moves], atol=0.06 * size)
    others = [i for i in range(7) if i != k]
    assert np.abs(left[moves][:, others]).max() < 0.05 * size


def test_strength_grows_with_the_size_and_what_a_value_covers_has_little() -> None:
    campaign, logs = plain()
    kind = draw("coulomb_friction", "S2", np.random.default_rng(5))
    yardstick = Yardstick(campaign, logs)
    one = yardstick.limits_at_one(kind)
    assert yardstick.limits_at_one(lambda s: kind(3.0 * s)) == pytest.approx(3.0 * one)
    some = dict(list(logs.items())[:1])
    assert Yardstick(campaign, some).limits_at_one(kind) < one


def left_over(folder: Path) -> dict[str, float]:
    """Joint -> what its refitted baseline leaves over the stated noise."""
    out = {}
    for model in models_for(load_study(folder)):
        bench, noise = Bench(model), _noise(model)
        fit = bench.baseline()
        rms = rms_of({k: t.residual for k, t in fit.trials.items()}, bench.trials)
        weight = max(float(t.blocks[0].weight.max()) for t in bench.trials)
        out[model.name] = next(iter(rms.values())) / weight / noise
    return out


def _noise(model: Machine) -> float:
    (noise,) = model.expected({}).values()
    return noise


@pytest.mark.slow
def test_stated_noise_accounts_for_what_the_right_model_leaves(tmp_path: Path) -> None:
    """And not for what a wrong one does: a ripple, or sensors that are noisier than stated."""
    campaign, logs = plain()
    write_study(tmp_path / "right", campaign, logs)
    assert left_over(tmp_path / "right") == pytest.approx(dict.fromkeys(joints(), 1.0), abs=0.15)
    ripple = replace(campaign, hidden=(draw("torque_ripple", "W1", np.random.default_rng(6))(1.0),))
    write_study(tmp_path / "ripple", ripple, ripple.logs())
    found = left_over(tmp_path / "ripple")
    assert found.pop("W1") > 3.0
    assert max(found.values()) < 1.2
    text = (tmp_path / "right" / "study.toml").read_text(encoding="utf-8")
    (tmp_path / "right" / "study.toml").write_text(text.replace("sigma = 0.15", "sigma = 0.05"), encoding="utf-8")
    assert left_over(tmp_path / "right")["S2"] > 1.4


def test_a_joint_that_stands_still_is_not_compared(tmp_path: Path) -> None:
    """Dry friction holds it: without the mask the true law leaves several times the noise."""
    campaign, _ = plain()
    item = draw("coulomb_friction", "W2", np.random.default_rng(7))(0.5)
    hidden = replace(campaign, hidden=(item,))
    write_study(tmp_path, hidden, hidden.logs())
    bench = ArmBench(tmp_path)
    fitted = bench.fitted((item.label,), {"coulomb_friction@joint.W2.force_Nm": item.values["force_Nm"]})
    assert fitted.held_out < 1.1
    assert bench.fitted((), {}).held_out > 1.2


@pytest.mark.slow
def test_every_kind_can_be_made() -> None:
    made = {o.kind: conceal(o) for o in of_family(FAMILY, dict.fromkeys(MAKERS, 1), 3)}
    assert set(made) == set(FULL) == set(MAKERS)
    for kind, found in made.items():
        truth = found.truth()
        assert bool(truth["effects"]) == (kind in ("unlabelled", "two", "outsider"))
        assert bool(truth["parameters"]) == (kind == "wrong_value")
        assert (truth["strength"] or 3.0) >= 3.0
        for log in found.logs.values():
            assert log.time.size == round(DURATION * RATE)
    assert links()["link2"] == pytest.approx(8.41)


@pytest.mark.slow
def test_a_wrists_diagnosis_depends_on_its_own_code_alone(tmp_path: Path) -> None:
    """What its hash leaves out is not loaded by it; what it loads is in the hash. Three trials go all the way."""
    whole = Path(__file__).parents[2] / "examples" / "studies" / "guide-friction"
    study = tmp_path / "guide-friction"
    shutil.copytree(whole, study)
    head, *trials = (whole / "study.toml").read_text(encoding="utf-8").split("[[trials]]")
    (study / "study.toml").write_text("[[trials]]".join([head, *trials[::5]]), encoding="utf-8")
    script = (
        "import sys\nfrom spacerobot.cli.main import main\n"
        f"main(['diagnose', {str(study)!r}, '--json', '--jobs', '1'])\n"
        "print('\\n'.join(m.__file__ for n, m in sys.modules.items() if n.startswith('spacerobot') and m.__file__))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    loaded = [Path(line) for line in done.stdout.splitlines() if line.endswith(".py")]
    assert len(loaded) > 100
    for name in ELSEWHERE:
        inside = [p for p in loaded if p.is_relative_to(ROOT / name) and p.name != "__init__.py"]
        assert not inside, name
    assert set(code_hashes()) == {group("rig"), group("driven arm")}
    assert group("chaser") == group("rig") != group("driven arm")
