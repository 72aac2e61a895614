"""A lab's list of its runs makes the same study as the trials written out by hand; what it cannot say is refused."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.recordings.study import Study, load_study
from spacerobot.support.errors import InputError

HEAD = """format = 1
[baseline]
robot = "pa10_wrist"
[baseline.wrist]
mass = 0.7
stiffness = 1020.0
[streams.mocap]
time = "t"
[streams.mocap.channels]
x = { is = "target.x", unit = "mm", sigma = 0.1 }
"""
LISTED = """[[trials]]
index = "runs.csv"
id = "{run}"
target.mass = "{mass} g"
condition = "{note}"
offset."target.x" = "{zero}"
mocap = "{file}.csv"
"""


def study_of(folder: Path, trials: str, runs: str = "") -> Study:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "study.toml").write_text(HEAD + trials)
    (folder / "runs.csv").write_text(runs)
    for name in "abc":
        (folder / f"{name}.csv").write_text("t,x\n0,1\n0.1,2\n0.2,3\n")
    return load_study(folder)


ROW = st.tuples(
    st.sampled_from("abc"),
    st.integers(1, 50_000),
    st.sampled_from(["", "slow", "fast"]),
    st.one_of(st.none(), st.floats(-9, 9).map(lambda v: round(v, 3))),
)


@settings(max_examples=25, deadline=None)
@given(st.lists(ROW, min_size=1, max_size=4), st.sampled_from(";\t,"), st.booleans())
def test_a_list_is_the_trials_written_out(
    tmp_path_factory: pytest.TempPathFactory, rows: list[tuple[str, int, str, float | None]], by: str, comma: bool
) -> None:
    tmp_path = tmp_path_factory.mktemp("index")
    runs, trials = ["run file mass note zero".replace(" ", by)], ""
    for n, (file, mass, note, zero) in enumerate(rows):
        cell = "" if zero is None else f"{zero:.3f}"
        runs.append(by.join([str(n), file, str(mass), note, cell.replace(".", ",") if comma and by != "," else cell]))
        trials += f'[[trials]]\nid = "{n}"\ntarget.mass = {mass * 1e-3!r}\nmocap = "{file}.csv"\n'
        trials += f'condition = "{note}"\n' if note else ""
        trials += "" if zero is None else f'offset."target.x" = {zero}\n'
    listed = study_of(tmp_path / "listed", LISTED, "\n".join(runs))
    written = study_of(tmp_path / "written", trials)
    for ours, theirs in zip(listed.trials, written.trials, strict=True):
        assert (ours.id, ours.condition, ours.sources) == (theirs.id, theirs.condition, theirs.sources)
        assert ours.overrides == pytest.approx(theirs.overrides)
        assert ours.offsets == pytest.approx(theirs.offsets)
        a, b = listed.recording(ours)["target.x"].value, written.recording(theirs)["target.x"].value
        assert a == pytest.approx(b)


def test_the_list_is_part_of_what_a_result_rests_on(tmp_path: Path) -> None:
    first = study_of(tmp_path, LISTED, "run,file,mass,note,zero\n1,a,9000,,\n").input_hash
    assert study_of(tmp_path, LISTED, "run,file,mass,note,zero\n1,a,9001,,\n").input_hash != first


@pytest.mark.parametrize(
    ("trials", "runs", "said"),
    [
        (LISTED, "run,file,mass,note,zero\n1,a,heavy,,\n", r"runs.csv:2: column 'mass' must hold a number"),
        (LISTED, "run,file,mass,note,zero\n1,a,9000,,\n2,b\n", r"runs.csv:3: a row of another width"),
        (LISTED, "run,file,mass,note,zero\n1,a,-4,,\n", r"runs.csv:2: target.mass must be above 0"),
        (LISTED, "run,file,mass,mass,zero\n1,a,4,,\n", r"runs.csv:1: each column"),
        (LISTED, "run,file,mass,note,zero\n", r"runs.csv: an index needs"),
        (LISTED, "run,file,kilos,note,zero\n1,a,4,,\n", r"unknown column of the index.*kilos"),
        (LISTED.replace("} g", "} mm"), "run,file,mass,note,zero\n1,a,4,,\n", r"a unit of length cannot measure mass"),
        (LISTED.replace("runs.csv", "../runs.csv"), "", r"leaves the data folder"),
        (LISTED.replace("runs.csv", "none.csv"), "", r"no such file"),
        (LISTED + "each = [0, 3]\n", "run,file,mass,note,zero\n1,a,4,,\n", r"without \"each\""),
        (LISTED, "run,file,mass,note,zero\n1,a,4000,,\n1,b,4000,,\n", r"two trials have the same id"),
    ],
)
def test_what_a_list_cannot_say_is_refused_with_its_line(tmp_path: Path, trials: str, runs: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        study_of(tmp_path / "study", trials, runs)


def test_a_cell_leads_no_further_than_the_data_folder(tmp_path: Path) -> None:
    (tmp_path / "secret.csv").write_text("t,x\n0,1\n1,2\n")
    study = study_of(tmp_path / "study", LISTED, "run,file,mass,note,zero\n1,../secret,4000,,\n")
    with pytest.raises(InputError, match="leaves the data folder"):
        study.recording("1")
