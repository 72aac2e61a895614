"""Files that name nothing: what columns are to each other, what is asked of the rest, and how their author answers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers_labs import columns_of

from spacerobot.recordings.draft import draft, draft_study
from spacerobot.recordings.drafting.hints import hint
from spacerobot.recordings.drafting.rigs import RIGS
from spacerobot.recordings.study import Study, load_study
from spacerobot.support.errors import InputError, NotFoundError

T = np.arange(0, 12, 0.01)
RNG = np.random.default_rng(4)


def studied(folder: Path, **said: str) -> Study:
    (folder / "study.toml").write_text(draft_study(folder, **said), encoding="utf-8")
    return load_study(folder)


def swings(length: float, phase: float) -> tuple[np.ndarray, np.ndarray]:
    rate = np.sqrt(9.80665 / length)
    return 0.1 * np.cos(rate * T + phase), -0.1 * rate * np.sin(rate * T + phase)


def test_a_rate_beside_its_angle_is_a_pendulum(tmp_path: Path) -> None:
    for n in range(3):
        np.savetxt(tmp_path / f"swing_{n}.csv", np.column_stack([T, *swings(0.3, n)]), delimiter=",")
    made = draft(tmp_path)
    assert made.kind == "pendulum"
    assert float(made.files["pendulum.urdf"].split('xyz="0 0 -')[1].split('"')[0]) == pytest.approx(0.3, rel=0.02)
    study = studied(tmp_path)
    assert columns_of(study) == {"joint.axis.position": "1", "joint.axis.velocity": "2"}
    text = (tmp_path / "study.toml").read_text()
    assert text.count("by what it does, not by its name: is it?") == 2


def test_a_rate_in_another_unit_is_none(tmp_path: Path) -> None:
    """It might be a torque in step with the speed."""
    angle, rate = swings(0.3, 0.0)
    np.savetxt(tmp_path / "swing_1.csv", np.column_stack([T, angle, 57.3 * rate]), delimiter=",")
    assert "joint.axis.velocity" not in studied(tmp_path).channels()


def test_several_pairs_are_joints_in_order(tmp_path: Path) -> None:
    (a, va), (b, vb) = swings(0.3, 0.0), swings(0.1, 1.0)
    np.savetxt(tmp_path / "double_1.csv", np.column_stack([T, a, b, va, vb]), delimiter=",")
    told = columns_of(studied(tmp_path))
    assert [told[f"joint.joint{j}.{q}"] for j in (1, 2) for q in ("position", "velocity")] == ["1", "3", "2", "4"]


@pytest.mark.parametrize("first", ["drive", "answer"])
def test_of_two_the_smoother_one_moves(tmp_path: Path, first: str) -> None:
    drive = RNG.normal(size=len(T))
    answer = np.zeros(len(T))
    for k in range(2, len(T)):  # a mass on a spring, well damped
        answer[k] = 1.8 * answer[k - 1] - 0.9 * answer[k - 2] + 0.1 * drive[k - 1]
    columns = [T, drive, answer] if first == "drive" else [T, answer, drive]
    np.savetxt(tmp_path / "run.csv", np.column_stack(columns), delimiter=",")
    told = columns_of(studied(tmp_path))
    assert told == {"joint.axis.torque": "1" if first == "drive" else "2",
                    "joint.axis.position": "2" if first == "drive" else "1"}  # fmt: skip
    noise = np.column_stack([T, drive, RNG.normal(size=len(T))])
    (tmp_path / "other").mkdir()
    np.savetxt(tmp_path / "other" / "run.csv", noise, delimiter=",")
    assert not any(c.startswith("joint.") for c in studied(tmp_path / "other").channels())


def test_states_before_and_after_are_events(tmp_path: Path) -> None:
    n = 50
    place = RNG.normal(size=(n, 3))
    before = np.column_stack([place, RNG.normal(size=(n, 3))])
    after = np.column_stack([place, RNG.normal(size=(n, 3))])
    np.savez(tmp_path / "drops.npz", states_pre=before, states_post=after, normal=RNG.normal(size=(n, 3)))
    study = studied(tmp_path)
    assert next(iter(study.streams.values())).kind == "events"
    recording = study.recording(study.trials[0])
    assert np.allclose(recording["body.velocity.x.after"].value, after[:, 3])
    assert np.allclose(recording["body.yaw.before"].value, before[:, 2])
    assert np.allclose(recording["aux.normal_yaw"].value, np.load(tmp_path / "drops.npz")["normal"][:, 2])


def test_events_by_name(tmp_path: Path) -> None:
    rows = RNG.normal(size=(30, 4))
    np.savetxt(tmp_path / "drops.csv", rows, delimiter=",", header="vx_before,vy_before,vx_after,vy_after", comments="")
    told = columns_of(studied(tmp_path))
    assert told == {"body.velocity.x.before": "vx_before", "body.velocity.y.before": "vy_before",
                    "body.velocity.x.after": "vx_after", "body.velocity.y.after": "vy_after"}  # fmt: skip


def wide(folder: Path) -> Path:
    """A wide file without a header: a body that drifts and turns, its copies, a status and what never changes."""
    x, turn = 0.05 * T + RNG.normal(0, 1e-4, len(T)), np.mod(40.0 * T, 360.0)
    rows = [T, np.full(len(T), 7.0), x, 2 * x, turn, np.roll(x, 3), (T > 5).astype(float), RNG.normal(size=len(T))]
    rows[5][:3] = x[0]
    np.savetxt(folder / "run_1.csv", np.column_stack(rows), delimiter=",")
    return folder


def test_each_silent_column_says_what_it_could_be(tmp_path: Path) -> None:
    text = draft_study(wide(tmp_path))
    lines = {line.split('"')[1]: line for line in text.splitlines() if '" = { is = "aux.' in line}
    assert "1" not in lines  # it never changes
    assert "smooth: target.x, body.position.x or joint.axis.position, in m or rad?" in lines["2"]
    assert 'jumps by a turn: body.yaw, unit = "deg", unwrap = true?' in lines["4"]
    assert "in steps" in lines["6"]
    assert "rough: contact.force" in lines["7"]
    assert "which rig is this" in text
    assert hint(np.array([0.0, 1.0, 0.0]), "axis").endswith('.torque or .voltage with use = "input"?')


def test_a_copy_is_said_to_be_one(tmp_path: Path) -> None:
    x = np.cumsum(RNG.normal(size=300))
    rows = np.column_stack([np.arange(300) * 0.01, x, np.r_[x[:2], x[:-2]], x, -x])
    np.savetxt(tmp_path / "run.csv", rows, delimiter=",")
    text = draft_study(tmp_path)
    assert '"3" = { is = "aux.3" }   # as 1' in text
    assert '"2" = { is = "aux.2" }   # as 1, 2 rows later' in text


def test_the_rig_and_a_list_of_some_columns(tmp_path: Path) -> None:
    (wide(tmp_path) / "columns.csv").write_text("index,name\n2,x [m]\n3,y [m]\n4,rotation [deg]\n6,force x cmd [N]\n")
    np.savetxt(tmp_path / "other_1.csv", RNG.normal(size=(40, 9)), delimiter=",")
    study = studied(tmp_path, rig="body", files="run_*")
    told = columns_of(study)
    assert told == {"body.position.x": "2", "body.position.y": "3", "body.yaw": "4", "body.force.x": "6"}
    assert "[baseline.body]" in (tmp_path / "study.toml").read_text()
    assert len(study.streams) == 1


def test_a_track_lost_at_zero_and_a_turn_that_one_file_shows(tmp_path: Path) -> None:
    """A force that rests at 0 is no such track, and is read as it stands."""
    x = 1.0 + 0.02 * T + RNG.normal(0, 1e-4, len(T))
    for n, spin in enumerate((0.1, 1.0)):
        lost = np.where((T < 0.5) | ((T > 4) & (T < 4.2)), 0.0, x)
        turn = np.mod(spin * T + np.pi, 2 * np.pi) - np.pi
        force = np.where(T < 6, 0.0, 0.4 * np.sin(T))
        head = "t,x [m],y [m],yaw [rad],fx cmd [N]"
        rows = np.column_stack([T, lost, x, turn, force])
        np.savetxt(tmp_path / f"run_{n}.csv", rows, delimiter=",", header=head, comments="")
    text = draft_study(tmp_path)
    assert '"x [m]" = { is = "body.position.x", missing = 0.0 }' in text
    assert text.count("missing") == 1
    assert '"yaw [rad]" = { is = "body.yaw", unwrap = true }' in text


def test_each_kind_of_rig_makes_a_draft_that_loads(tmp_path: Path) -> None:
    for rig in RIGS:
        folder = tmp_path / rig
        folder.mkdir()
        study = studied(wide(folder), rig=rig)
        assert study.recording(study.trials[0])
    with pytest.raises(NotFoundError, match="kind of rig"):
        draft(tmp_path, rig="boat")
    with pytest.raises(InputError, match="no file of the folder has such a name"):
        draft(tmp_path, pattern="nothing*")
