"""A track whose zero is elsewhere than the rig's is refused with the zero it needs, not diagnosed."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.overlay import overlay
from spacerobot.diagnosis.selection.admission import admit
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError
from tests.diagnosis.rigs import write_study


def moved(folder: Path, column: int, by: float) -> None:
    """One column of the camera's files, by so much."""
    for path in folder.glob("*_mocap.csv"):
        table = np.loadtxt(path, delimiter=",", skiprows=1)
        table[:, column] += by
        head = path.read_text().split("\n", 1)[0]
        np.savetxt(path, table, "%.7f", ",", header=head, comments="")


@pytest.mark.parametrize(("column", "channel"), [(1, "target.x"), (2, "wrist.x")])
@pytest.mark.parametrize("by", [1.234, -0.15])
def test_it_is_told_by_how_much_and_what_is_stated_is_taken(
    tmp_path: Path, column: int, channel: str, by: float
) -> None:
    write_study(tmp_path, masses=(9.0,))
    admit(load_study(tmp_path))
    moved(tmp_path, column, by)
    with pytest.raises(InputError, match=f"{channel} reads .* its zero is elsewhere") as refused:
        admit(load_study(tmp_path))
    told = re.search(rf'offset."{channel}" = (\S+) in', str(refused.value))
    assert told is not None
    assert float(told[1]) == pytest.approx(-by, abs=1e-3)
    path = tmp_path / "study.toml"
    path.write_text(re.sub(r"(?m)^(target.mass = .*)$", rf'\1\noffset."{channel}" = {told[1]}', path.read_text()))
    admit(load_study(tmp_path))


def test_an_overlay_draws_it_and_says_so(tmp_path: Path) -> None:
    write_study(tmp_path, masses=(9.0,))
    moved(tmp_path, 2, 1.234)
    assert any("its zero is elsewhere" in said for said in overlay(load_study(tmp_path)).model.assumptions)


def test_a_few_lost_markers_are_no_zero(tmp_path: Path) -> None:
    """One reading in a hundred is anywhere: it says nothing of where the others have theirs."""
    write_study(tmp_path, masses=(9.0,))
    random = np.random.default_rng(3)
    for path in tmp_path.glob("*_mocap.csv"):
        table = np.loadtxt(path, delimiter=",", skiprows=1)
        lost = random.random(table.shape[0]) < 0.01
        table[lost, 1:] = random.uniform(-1.0, 1.0, (lost.sum(), 2))
        np.savetxt(path, table, "%.7f", ",", header="time_s,x_target_m,x_wrist_m", comments="")
    admit(load_study(tmp_path))


@pytest.mark.parametrize("by", [1.234, -0.15])
def test_a_force_tells_it_where_no_wrist_is_tracked(tmp_path: Path, by: float) -> None:
    write_study(tmp_path, masses=(9.0,))
    path = tmp_path / "study.toml"
    path.write_text("".join(x for x in path.read_text().splitlines(True) if "wrist.x" not in x))
    admit(load_study(tmp_path))
    moved(tmp_path, 1, by)
    with pytest.raises(InputError, match=r"target\.x reads .* its zero is elsewhere") as refused:
        admit(load_study(tmp_path))
    told = re.search(r'offset\."target\.x" = (\S+) in', str(refused.value))
    assert told is not None
    assert float(told[1]) == pytest.approx(-by, abs=2e-3)  # what a target goes on by until a force shows


@pytest.mark.parametrize("late", [0.02, 0.06, 0.3])
def test_a_force_that_is_late_is_no_zero_elsewhere(tmp_path: Path, late: float) -> None:
    write_study(tmp_path, masses=(23.2,))
    path = tmp_path / "study.toml"
    path.write_text("".join(x for x in path.read_text().splitlines(True) if "wrist.x" not in x))
    for force in tmp_path.glob("*_force.csv"):
        table = np.loadtxt(force, delimiter=",", skiprows=1)
        table[:, 1] = np.interp(table[:, 0] - late, table[:, 0], table[:, 1])
        np.savetxt(force, table, "%.7f", ",", header=force.read_text().split("\n", 1)[0], comments="")
    admit(load_study(tmp_path))
