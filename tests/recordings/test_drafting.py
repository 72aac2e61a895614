"""`study new`: what it writes its own check reads, and what it proposes follows from the files alone."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path, PurePath

import numpy as np
import pytest
from helpers_recordings import real
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spacerobot.recordings.dataroot import recordings_folder
from spacerobot.recordings.draft import draft, draft_study
from spacerobot.recordings.drafting.names import named, same
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError

NAMES = st.sampled_from(
    ["t", "time_s", "Time [ms]", "Frame", "x_target_m", "Slider [mm]", "F", "Fz (N)", "q1", "dq1", "q1_cmd", "tau1",
     "x", "y", "theta", "Target_X", "Current_X", "rotation.x", "qw", "", "a b", 'q"uote', "V1", "status", "id", "pose"]
)  # fmt: skip
CELLS = st.sampled_from(["0", "1", "-2.5", "3e-4", "", "nan", "4.9e-324", "1e95", "ok", "0.1", "7"])


@st.composite
def tables(draw: st.DrawFn) -> str:
    """A CSV as loggers leave them: stalled and missing stamps, words, empty cells, numbers no sensor gives."""
    names = draw(st.lists(NAMES, min_size=1, max_size=5))
    rows = draw(st.integers(3, 12))
    clock = list(np.cumsum([draw(st.sampled_from([0.01, 0.01, 0.01, 0.0, -0.005])) for _ in range(rows)]))
    lines = [",".join(names)] if draw(st.booleans()) else []
    for k in range(rows):
        lines.append(",".join([f"{clock[k]:.4f}", *(draw(CELLS) for _ in names[1:])]))
    return "\n".join(lines) + "\n"


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    st.dictionaries(
        st.sampled_from(["a_1.csv", "a_2.csv", "b_1.csv", "run3 9kg.txt", "id.csv", "pos"]), tables(), min_size=1
    )
)
def test_whatever_new_writes_check_reads(files: dict[str, str]) -> None:
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        for name, text in files.items():
            (folder / name).write_text(text)
        try:
            text = draft_study(folder)
        except InputError:
            return  # nothing that can be read, said so
        (folder / "study.toml").write_text(text)
        study = load_study(folder)
        assert study.draft
        assert all(len(study.recording(t)) for t in study.trials)


@pytest.mark.parametrize(
    ("path", "words", "keys", "mass"),
    [
        ("run1_12.5kg.csv", (), ("run1",), 12.5),
        ("Take 2025-03-10 01.csv", ("take",), ("2025-03-10", "01"), None),
        ("satellite_velocity_0.08.gz", ("satellite", "velocity"), ("0.08",), None),
        ("test_10/joint_torques.txt.gz", ("joint", "torques"), ("test_10",), None),
        ("force/03.csv", ("force",), ("03",), None),
        ("trial7_500g.txt", (), ("trial7",), 500.0),
    ],
)
def test_names_of_files(path: str, words: tuple[str, ...], keys: tuple[str, ...], mass: float | None) -> None:
    found = named(PurePath(path))
    assert (found.words, found.keys) == (words, keys)
    assert [v for _, v, _ in found.values] == ([] if mass is None else [mass])


@given(st.integers(0, 999), st.integers(1, 4), st.sampled_from(["", "run", "Trial"]))
def test_a_number_is_itself_however_it_is_written(n: int, width: int, word: str) -> None:
    assert same(f"{word}{n:0{width}d}") == same(str(n))


def write_rig(
    folder: Path, *, sign: int, axis: str, zero: float, touch: float, force_sign: int, lag: float = 0.0
) -> None:
    """Trials of a wrist rig: a target in motion capture, mm, that pushes a resting slider; a force sensor, N."""
    rng = np.random.default_rng(5)
    for n, speed in enumerate((30.0, 60.0, 90.0), 1):
        t = np.arange(0, 2, 0.005)
        pushed = np.where(t > 1, speed / 8 * np.sin(np.clip(8 * (t - 1), 0, math.pi)), 0.0)
        target = np.where(t > 1, pushed - 2 * speed * np.clip(t - 1 - math.pi / 8, 0, None), speed * (t - 1))
        columns = {f"{b}_{a}": rng.normal(0, 0.1, len(t)) for b in ("target", "slider") for a in "xyz"}
        columns[f"target_{axis}"] += touch + sign * target
        columns[f"slider_{axis}"] += zero + sign * pushed
        head = ",".join(["t", *(f"{c} [mm]" for c in columns)])
        rows = np.column_stack([t, *columns.values()])
        np.savetxt(folder / f"mocap_{n:02d}.csv", rows, "%.5f", ",", header=head, comments="")
        f = rng.normal(0, 0.2, (len(t), 3))
        f[:, 1] += force_sign * 0.8 * pushed
        header = "time_s,Fx [N],Fy [N],Fz [N]"
        table = np.column_stack([t + n * lag, f])
        np.savetxt(folder / f"ft_{n:02d}.csv", table, "%.5f", ",", header=header, comments="")


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("axis", ["x", "z"])
def test_signs_zeroes_and_noise_come_from_the_free_approach(tmp_path: Path, sign: int, axis: str) -> None:
    write_rig(tmp_path, sign=sign, axis=axis, zero=300.0, touch=330.0, force_sign=-sign, lag=3.0)
    (tmp_path / "study.toml").write_text(draft_study(tmp_path))
    study = load_study(tmp_path)
    assert [t.id for t in study.trials] == ["01", "02", "03"]
    for trial in study.trials:
        recording = study.recording(trial)
        target, wrist, force = recording["target.x"], recording["wrist.x"], recording["contact.force"]
        before = target.time < 1
        assert np.polyfit(target.time[before], target.value[before], 1)[0] > 0  # x grows along the travel
        assert abs(np.mean(wrist.value[before])) < 5e-5
        assert np.mean(wrist.value[wrist.time > 1]) > 0  # positive pushed in
        assert abs(np.interp(1.0, target.time, target.value)) < 6e-4  # 0 where it touches
        assert force.value.max() > 5 * force.sigma
        assert target.sigma == pytest.approx(1e-4, rel=0.3)
        assert force.sigma == pytest.approx(0.2, rel=0.3)
    assert study.streams["ft"].own_clock
    assert not study.streams["mocap"].own_clock


def test_a_shared_clock_stays_shared(tmp_path: Path) -> None:
    write_rig(tmp_path, sign=1, axis="x", zero=0.0, touch=0.0, force_sign=1)
    (tmp_path / "study.toml").write_text(draft_study(tmp_path))
    assert not load_study(tmp_path).streams["ft"].own_clock


def test_what_was_asked_for_is_never_a_measured_channel(tmp_path: Path) -> None:
    names = ["t", "Target_X", "Current_X", "Current_Y", "Error_X", "rotation.x", "x_cmd", "Goal_Y", "Current_Yaw"]
    rows = "".join(
        ",".join([f"{k / 50:.2f}", *(f"{k + j * 0.1:.2f}" for j in range(len(names) - 1))]) + "\n" for k in range(60)
    )
    (tmp_path / "log.csv").write_text(",".join(names) + "\n" + rows)
    made = draft(tmp_path)
    measured = {
        line.reading.column: line.channel for lines in made.lines.values() for line in lines if line.use == "output"
    }
    assert measured == {"Current_X": "body.position.x", "Current_Y": "body.position.y", "Current_Yaw": "body.yaw"}


def test_one_stalled_stamp_costs_one_row(tmp_path: Path) -> None:
    rows = [f"{k / 100:.2f},{min(k, 10)}" for k in range(400)]
    rows[50] = "0.49,77"
    (tmp_path / "log_1.csv").write_text("t,x_target_m\n" + "\n".join(rows) + "\n")
    (tmp_path / "study.toml").write_text(draft_study(tmp_path))
    study = load_study(tmp_path)
    assert len(next(iter(study.recording(study.trials[0]).values()))) == 399


def test_numbers_of_unwritten_memory_in_an_unused_column_cost_that_column_alone(tmp_path: Path) -> None:
    rows = "".join(f"{k / 100:.2f},{k},{'4.9e-324' if k == 7 else k}\n" for k in range(40))
    (tmp_path / "log_1.csv").write_text("t,x_target_m,junk\n" + rows)
    (tmp_path / "study.toml").write_text(draft_study(tmp_path))
    assert len(load_study(tmp_path).trials) == 1


def test_a_list_in_quotes_leaves_the_names_alone(tmp_path: Path) -> None:
    rows = "".join(f'{k / 50:.2f},{k}.5,ok,,"[1, 0, 1, 0, 1, 0, 1, 0]",False,{k}.25\n' for k in range(60))
    (tmp_path / "log.csv").write_text("t,Current_X,status,spare,Command_Vector,late,Current_Y\n" + rows)
    columns = {line.reading.column for lines in draft(tmp_path).lines.values() for line in lines}
    assert columns == {"Current_X", "Current_Y"}


def _newcomer(name: str) -> Path:
    top = recordings_folder()
    if top is None or not (top / "newcomer" / name).is_dir():
        pytest.skip("the newcomer's folders are not here: set SPACEROBOT_DATA")
    return top / "newcomer" / name


@pytest.mark.parametrize("name", ["motive_and_ati", "semicolons"])
def test_a_newcomers_folder_becomes_a_wrist_rig_of_eight_trials(name: str) -> None:
    made = draft(_newcomer(name))
    assert made.kind == "wrist"
    assert len(made.trials) == 8
    assert {line.channel for lines in made.lines.values() for line in lines} >= {"target.x", "wrist.x"}


@pytest.mark.parametrize(
    ("folder", "kind", "trials"),
    [("emps", "axis", 2), ("kentucky_air_bearing", "body", 1), ("dfki_grasps", "arm", 2)],
)
def test_kinds_of_real_folders(folder: str, kind: str, trials: int) -> None:
    made = draft(real(folder))
    assert (made.kind, len(made.trials)) == (kind, trials)


def test_the_robot_may_be_named(tmp_path: Path) -> None:
    rows = "".join(f"{k / 100:.2f} " + " ".join(f"{0.1 * j + k / 900:.4f}" for j in range(7)) + "\n" for k in range(50))
    (tmp_path / "joint_positions_1.txt").write_text(rows)
    made = draft(tmp_path, "panda")
    channels = [line.channel for lines in made.lines.values() for line in lines]
    assert channels == [f"joint.panda_joint{n}.position" for n in range(1, 8)]
    assert 'robot = "panda"' in made.text()
    with pytest.raises(InputError, match="panda"):
        draft(tmp_path, "pnada")
