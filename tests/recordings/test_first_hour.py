"""Raw folders as different labs leave them: what their drafts say without being told."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path, PurePath

import numpy as np
import pytest
from helpers_labs import SPEEDS, rig
from scipy.io import savemat

from spacerobot.recordings.draft import draft, draft_study
from spacerobot.recordings.drafting.approach import Track
from spacerobot.recordings.drafting.masses import is_mass
from spacerobot.recordings.drafting.names import in_ascii, named
from spacerobot.recordings.drafting.pendulum import swing
from spacerobot.recordings.guess import guess
from spacerobot.recordings.study import Study, load_study
from spacerobot.recordings.table import Floats
from spacerobot.support.errors import InputError

MASSES = (12.5, 12.5, 28.0)


def written(folder: Path) -> Study:
    (folder / "study.toml").write_text(draft_study(folder), encoding="utf-8")
    return load_study(folder)


def table(path: Path, columns: Mapping[str, Floats], separator: str = ",") -> None:
    rows = np.column_stack(list(columns.values()))
    head = separator.join(columns)
    np.savetxt(path, rows, "%.6f", separator, header=head, comments="", encoding="utf-8")


def channels(study: Study) -> dict[str, str]:
    return {c.column: c.name for s in study.streams.values() for c in s.channels}


def _structs(folder: Path) -> None:
    runs = np.zeros((1, 3), dtype=[(n, object) for n in ("t", "p_target", "wrist_disp", "FT", "m_target")])
    for n, speed in enumerate(SPEEDS):
        t, target, wrist, force = rig(speed)
        still = np.zeros_like(t)
        wrench = np.column_stack([still, still, -force, still, still, still])
        place = np.column_stack([still, target + 0.4, still])
        runs[0, n] = t[:, None], place, wrist[:, None], wrench, MASSES[n]
    savemat(folder / "campaign.mat", {"runs": runs, "fs": 100.0, "comment": "SI"})


def _groups(folder: Path) -> None:
    import h5py

    with h5py.File(folder / "campaign.h5", "w") as file:
        for n, speed in enumerate(SPEEDS, 1):
            t, target, wrist, force = rig(speed)
            made = file.create_group(f"run{n}")
            for name, value in {"t": t, "p_target": target, "wrist_disp": wrist, "force": force}.items():
                made[name] = value
            made["target_mass"] = MASSES[n - 1]


@pytest.mark.parametrize("write", [_structs, _groups])
def test_structs_and_groups_of_one_file_are_trials_with_their_masses(tmp_path: Path, write) -> None:  # type: ignore[no-untyped-def]
    write(tmp_path)
    study = written(tmp_path)
    assert [t.overrides["target.mass"] for t in study.trials] == list(MASSES)
    for trial, speed in zip(study.trials, SPEEDS, strict=True):
        _, target, wrist, force = rig(speed)
        found = study.recording(trial)
        for channel, truth, within in (
            ("target.x", target, 5e-4),
            ("wrist.x", wrist, 5e-5),
            ("contact.force", force, 0.1),
        ):
            assert abs(np.median(found[channel].value - truth)) < within


@pytest.mark.parametrize("names", [("joint1", "joint2"), ("pose1", "pose2"), ("target1", "target2")])
def test_groups_of_what_is_measured_are_no_trials(tmp_path: Path, names: tuple[str, str]) -> None:
    import h5py

    t, target, wrist, _ = rig(0.05)
    with h5py.File(tmp_path / "one.h5", "w") as file:
        for n, (name, value) in enumerate(zip(names, (target, wrist), strict=True)):
            made = file.create_group(name)
            made["t"], made["position"] = t + 0.001 * n, value
    assert len(draft(tmp_path).trials) == 1


@pytest.mark.parametrize("ending", [pytest.param("xlsx", marks=pytest.mark.slow), "txt"])
def test_a_mass_above_a_table_is_the_targets(tmp_path: Path, ending: str) -> None:
    for n, speed in enumerate(SPEEDS):
        t, target, wrist, force = rig(speed)
        rows = np.column_stack([t, 1e3 * target, 1e3 * wrist, force])
        head = [["Contact test", ""], ["Slider mass [kg]", "0.8"], ["Target mass [g]", f"{1e3 * MASSES[n]:g}"]]
        names = ["Time [s]", "Target [mm]", "Slider [mm]", "Force [N]"]
        if ending == "xlsx":
            from openpyxl import Workbook

            book = Workbook()
            for line in [*([a, float(b) if b else None] for a, b in head), names, *rows.tolist()]:
                book.active.append(line)
            book.save(tmp_path / f"run{n}.xlsx")
        else:
            lines = [": ".join(h) for h in head] + ["\t".join(names)] + ["\t".join(f"{x:.6f}" for x in r) for r in rows]
            (tmp_path / f"run{n}.txt").write_text("\n".join(lines))
    study = written(tmp_path)
    assert [t.overrides["target.mass"] for t in study.trials] == list(MASSES)
    assert "from the file: Target mass [g]" in (tmp_path / "study.toml").read_text()


@pytest.mark.parametrize(
    ("name", "mass"),
    [("Target mass [kg]", True), ("m_target", True), ("Masse Ziel", True), ("mass", True), ("slider mass", False),
     ("m", False), ("target", False)],
)  # fmt: skip
def test_names_of_masses(name: str, mass: bool) -> None:
    assert is_mass(name) is mass


def _pendulum(length: float, middle: float, friction: float) -> tuple[Floats, Floats]:
    """Times and degrees of a bob on a rod, by small steps."""
    step, angle, rate, seen = 1e-3, 0.9, 0.0, []
    for _ in range(20_000):
        rate -= step * (9.80665 / length * np.sin(angle) + friction * np.sign(rate))
        angle += step * rate
        seen.append(angle)
    noise = np.random.default_rng(1).normal(0, 0.03, 2000)
    return np.arange(2000) * 0.01, np.degrees(seen)[::10] + middle + noise


@pytest.mark.parametrize("middle", [0.0, 180.0])
def test_a_pendulum_has_the_length_of_its_period_and_hangs_at_zero(tmp_path: Path, middle: float) -> None:
    for n in range(3):
        t, degrees = _pendulum(0.4, middle, 0.05)
        table(tmp_path / f"Pendel_{n}.csv", {"Zeit [s]": t, "Winkel [°]": degrees}, ";")
    made = draft(tmp_path)
    assert made.kind == "pendulum"
    assert abs(float(made.files["pendulum.urdf"].split('xyz="0 0 -')[1].split('"')[0]) - 0.4) < 0.02
    (tmp_path / "pendulum.urdf").write_text(made.files["pendulum.urdf"])
    study = written(tmp_path)
    position = study.recording(study.trials[0])["joint.axis.position"].value
    assert abs(np.mean(position[-500:])) < 0.02
    assert "which column drives" not in made.text()


def test_what_is_pushed_or_at_rest_swings_by_itself_no_more() -> None:
    t, degrees = _pendulum(0.4, 0.0, 0.05)
    assert swing(Track(t, degrees)) is not None
    assert swing(Track(t, np.random.default_rng(0).normal(0, 1, t.size))) is None
    assert swing(Track(t, np.sin(2 * t) + np.sin(3.7 * t))) is None


@pytest.mark.parametrize("late", [0.02, 0.4])
def test_wrist_and_force_have_their_own_clocks_where_they_turn_back_at_another_time(
    tmp_path: Path, late: float
) -> None:
    """A cable's delay is no clock: that is for the diagnosis to find."""
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, force = rig(speed)
        table(tmp_path / f"essai_{n}_cible.csv", {"temps (s)": t, "position cible (mm)": 1e3 * target})
        table(tmp_path / f"essai_{n}_poignet.csv", {"temps (s)": t + late, "deplacement poignet (mm)": 1e3 * wrist})
        table(tmp_path / f"essai_{n}_effort.csv", {"temps (s)": t - late, "effort (N)": force})
    own = {c.name: s.own_clock for s in written(tmp_path).streams.values() for c in s.channels}
    assert own == {"target.x": False, "wrist.x": late > 0.1, "contact.force": late > 0.1}


def test_cross_talk_as_clear_as_the_pulse_is_not_taken_for_it(tmp_path: Path) -> None:
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, force = rig(speed)
        columns = {"t": t, "target_m": target, "slider_m": wrist, "Fx": 0 * t, "Fy": 0.05 * force, "Fz": force - 3.0}
        table(tmp_path / f"run{n}.csv", columns)
    assert channels(written(tmp_path)) == {"target_m": "target.x", "slider_m": "wrist.x", "Fz": "contact.force"}


def test_a_thruster_on_a_puck_makes_no_wrist(tmp_path: Path) -> None:
    t = np.arange(0, 8, 0.02)
    for n in range(1, 4):
        push = np.where((t > 3) & (t < 4), 0.25, 0.0)
        x = 0.1 * n * t + np.cumsum(np.cumsum(push)) * 0.02**2 / 6
        columns = {"t": t, "puck_x_m": x, "puck_y_m": 0.05 * t, "puck_theta_deg": 3.0 * t, "thrust_x_N": push}
        table(tmp_path / f"puck-6,4kg-take_{n}.csv", columns)
    study = written(tmp_path)
    assert channels(study) == {
        "puck_x_m": "body.position.x", "puck_y_m": "body.position.y", "puck_theta_deg": "body.yaw",
        "thrust_x_N": "body.force.x",
    }  # fmt: skip
    assert [t.overrides["body.mass"] for t in study.trials] == [6.4] * 3


@pytest.mark.parametrize(
    ("name", "unit"),
    [("velocidad_mm_s", "mm/s"), ("rate_deg_s", "deg/s"), ("x_mm", "mm"), ("time_s", "s"), ("v [mm/s]", "mm/s")],
)
def test_a_unit_behind_a_name(name: str, unit: str) -> None:
    assert guess(name).stated == unit


def test_joints_by_letter_and_number_on_a_platform(tmp_path: Path) -> None:
    t = np.arange(0, 4, 0.01)
    names = ["Platform X (mm)", "Platform Y (mm)", "Platform Heading (deg)"]
    names += [f"J{j} {what}" for what in ("angle (deg)", "torque (Nm)", "setpoint (deg)") for j in (1, 2)]
    columns = {"Time (ms)": 1e3 * t} | {name: np.sin((k + 1) * t) for k, name in enumerate(names)}
    table(tmp_path / "floating_1.tsv", columns, "\t")
    found = channels(written(tmp_path))
    assert list(found.values()) == [
        "base.position.x", "base.position.y", "base.yaw", "joint.joint1.position", "joint.joint2.position",
        "joint.joint1.torque", "joint.joint2.torque", "joint.joint1.reference", "joint.joint2.reference",
    ]  # fmt: skip


def test_a_file_for_each_joint_is_one_trial(tmp_path: Path) -> None:
    t = np.arange(0, 4, 0.01)
    for j in (1, 2):
        table(tmp_path / f"gelenk{j}.csv", {"Zeit [s]": t, "Winkel [rad]": np.sin(j * t), "Drehmoment [Nm]": np.cos(t)})
    study = written(tmp_path)
    assert len(study.trials) == 1
    assert sorted(c.name for s in study.streams.values() for c in s.channels) == [
        "joint.joint1.position", "joint.joint1.torque", "joint.joint2.position", "joint.joint2.torque",
    ]  # fmt: skip


@pytest.mark.parametrize(
    "names",
    [
        ("t [s]", "posição alvo [mm]", "posição punho [mm]", "força [N]"),
        ("czas [s]", "położenie celu [mm]", "położenie suwaka [mm]", "siła [N]"),
        ("время [s]", "положение цель [mm]", "положение каретка [mm]", "сила [N]"),
        ("tijd [s]", "positie doel [mm]", "positie slider [mm]", "kracht [N]"),
    ],
)
def test_headers_in_other_languages(tmp_path: Path, names: tuple[str, ...]) -> None:
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, force = rig(speed)
        table(tmp_path / f"run{n}.csv", dict(zip(names, (t, 1e3 * target, 1e3 * wrist, force), strict=True)))
    text = draft_study(tmp_path)
    assert "by what it does in a hit" not in text
    study = written(tmp_path)
    assert list(channels(study).values()) == ["target.x", "wrist.x", "contact.force"]


def test_a_wrist_that_is_counted_against_the_travel_is_turned_round(tmp_path: Path) -> None:
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, force = rig(speed)
        columns = {"t": t, "target_x_m": target, "wrist_x_m": -wrist, "force_N": force}
        table(tmp_path / f"run{n}.csv", columns)
    study = written(tmp_path)
    assert "turned round against its axis" in (tmp_path / "study.toml").read_text()
    assert study.recording(study.trials[0])["wrist.x"].value.max() > 1e-3


@pytest.mark.parametrize(("names", "trials"), [("toss_{:03}", 3), ("camera_{}", 1), ("q{}", 1)])
def test_numbered_matrices_of_one_file_are_trials_unless_they_are_what_is_measured(
    tmp_path: Path, names: str, trials: int
) -> None:
    t = np.arange(0, 4, 0.01)
    swings = np.column_stack([t, np.sin(t), np.cos(t)])
    np.savez(tmp_path / "all.npz", **{names.format(n): swings for n in range(3)})
    made = draft(tmp_path)
    assert len(made.trials) == trials


def test_matrices_without_names_are_joints_where_torques_have_as_many_columns(tmp_path: Path) -> None:
    t = np.arange(0, 4, 0.01)
    swing_of_each = np.sin(t[:, None] * np.arange(1, 6))
    for name in ("positions", "velocity", "torques"):
        np.savetxt(tmp_path / f"traj_{name}.txt", swing_of_each, "%.5f")
    made = draft(tmp_path)
    assert made.kind == "arm"
    found = {line.channel for lines in made.lines.values() for line in lines}
    assert found == {f"joint.joint{j}.{what}" for j in range(1, 6) for what in ("position", "velocity", "torque")}


def test_a_folder_of_nothing_but_counters_says_what_it_holds(tmp_path: Path) -> None:
    t = np.arange(0, 4, 0.01)
    table(tmp_path / "log.csv", {"marker status": 0 * t + 1, "frame error": t % 3})
    with pytest.raises(InputError, match="no column was recognised among marker status, frame error"):
        draft(tmp_path)


def test_times_in_a_file_of_their_own_are_the_clock_of_those_beside_it(tmp_path: Path) -> None:
    t = np.cumsum(np.random.default_rng(0).uniform(0.009, 0.011, 400))
    for n in (1, 2):
        np.savetxt(tmp_path / f"time_{n}.txt", t + n, "%.6f")
        np.savetxt(tmp_path / f"joint_pos_{n}.txt", np.sin(t[:, None] * [1, 2]), "%.6f")
        np.savetxt(tmp_path / f"joint_tau_{n}.txt", np.cos(t[:, None] * [1, 2]), "%.6f")
    study = written(tmp_path)
    assert "rate" not in (tmp_path / "study.toml").read_text()
    assert [t.id for t in study.trials] == ["1", "2"]
    for n, trial in enumerate(study.trials, 1):
        found = study.recording(trial)
        assert set(found) == {f"joint.joint{j}.{what}" for j in (1, 2) for what in ("position", "torque")}
        np.testing.assert_allclose(found["joint.joint1.position"].time, t + n, atol=1e-6)


def test_an_export_of_messages_has_stamps_in_two_columns_and_no_yaw_of_a_quaternion(tmp_path: Path) -> None:
    """The streams' stamps put them beside each other: no rate is asked for."""
    for n, speed in enumerate(SPEEDS, 1):
        t, target, wrist, force = rig(speed)
        still = 0 * t
        pose = {f"transform.translation.{a}": v for a, v in zip("xyz", (target, still, still), strict=True)}
        pose |= {f"transform.rotation.{a}": still + (a == "w") for a in "xyzw"}
        for late, name, columns in (
            (0.00, "vicon_target", pose),
            (0.25, "wrist_state", {"position[0]": wrist, "velocity[0]": np.gradient(wrist, t)}),
            (0.25, "ft_sensor", {f"wrench.force.{a}": v for a, v in zip("xyz", (still, still, -force), strict=True)}),
        ):  # fmt: skip
            seen = t >= late
            stamp = 1_700_000_000 + 100 * n + t[seen]
            times = {"header.stamp.secs": np.floor(stamp), "header.stamp.nsecs": np.round(1e9 * (stamp % 1.0))}
            table(tmp_path / f"bag_{n}_{name}.csv", times | {k: v[seen] for k, v in columns.items()})
    study = written(tmp_path)
    assert "rate" not in (tmp_path / "study.toml").read_text()
    found = channels(study)
    assert found == {
        "transform.translation.x": "target.x", "position[0]": "wrist.x", "wrench.force.z": "contact.force",
    }  # fmt: skip
    assert not any(s.own_clock for s in study.streams.values())
    recording = study.recording(study.trials[0])
    late = recording["wrist.x"].time[0] - recording["target.x"].time[0]
    assert late == pytest.approx(0.25, abs=1e-6)


def test_a_blank_before_kilograms(tmp_path: Path) -> None:
    assert named(PurePath("forsøg 1 - 3,2 kg")).values == (("3.2kg", 3.2, "kg"),)
    assert in_ascii("forsøg Stoß") == "forsog Stoss"
