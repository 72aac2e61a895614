"""Two finished runs side by side: what differs is marked, what agrees is not, nothing of theirs becomes markup."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import pytest
from helpers_report import verdict

import spacerobot
from spacerobot.cli.main import main
from spacerobot.support.errors import InputError
from spacerobot.support.jsonio import dumps
from spacerobot.view.compare.page import page
from spacerobot.view.compare.runs import compare


def run_of(folder: Path, found: dict[str, Any]) -> Path:
    folder.mkdir()
    (folder / "verdict.json").write_text(dumps(found))
    return folder


def shifted(by: float) -> dict[str, Any]:
    """A named verdict whose friction is larger by so many half widths of its interval."""
    found = copy.deepcopy(verdict("named"))
    value = found["effects"][0]["parameters"]["force_N"]
    low, high = value["ci95"]
    value["value"] += by * (high - low) / 2.0
    value["ci95"] = [x + by * (high - low) / 2.0 for x in (low, high)]
    return found


@pytest.mark.parametrize(("by", "differ"), [(0.0, False), (1.5, False), (2.5, True), (-2.5, True)])
def test_a_value_differs_where_the_intervals_do_not_meet(by: float, differ: bool, tmp_path: Path) -> None:
    found = compare(run_of(tmp_path / "a", verdict("named")), run_of(tmp_path / "b", shifted(by)))
    row = next(r for r in found.sections["Effects"] if "Coulomb" in r.what)
    assert row.differ is differ
    back = compare(tmp_path / "b", tmp_path / "a")
    assert [(r.what, r.differ, r.second, r.first) for r in back.sections["Effects"]] == [
        (r.what, r.differ, r.first, r.second) for r in found.sections["Effects"]
    ]


def test_a_run_agrees_with_itself(tmp_path: Path) -> None:
    folder = run_of(tmp_path / "a", verdict("named"))
    assert not [r for rows in compare(folder, folder).sections.values() for r in rows if r.differ]


def test_held_out_errors_have_their_units(tmp_path: Path) -> None:
    told = copy.deepcopy(verdict("named"))
    error = {"rms_before": 1e-3, "rms_after": 1.5e-4}
    told["held_out"]["channels"] = {"target.x": error, "joint.elbow.torque": error, "body.velocity.x.after": error}
    folder = run_of(tmp_path / "a", told)
    rows = {r.what: r.first for r in compare(folder, folder).sections["Held-out error"]}
    assert rows["target.x, after"].split() == ["0.15", "mm"]
    assert rows["body.velocity.x.after, after"].endswith("m/s")
    assert rows["joint.elbow.torque, after, SI"] == "0.00015"  # N where it slides


def test_another_kind_of_verdict_is_marked(tmp_path: Path) -> None:
    found = compare(run_of(tmp_path / "a", verdict("named")), run_of(tmp_path / "b", verdict("unknown")))
    assert found.sections["Verdict"][0].differ
    assert all(r.differ for r in found.sections["Effects"]), "one has it, the other has not"


def test_what_is_in_a_run_does_not_become_markup(tmp_path: Path) -> None:
    evil = {**verdict("named"), "study": "<script>alert(1)</script>"}
    text = page(compare(run_of(tmp_path / "a", evil), run_of(tmp_path / "<b>", evil)))
    assert "<script" not in text
    assert "<b>" not in text
    assert "prefers-color-scheme: dark" in text


def test_overlays_are_compared_channel_by_channel(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    channel = {"rms": 0.002, "unit": "m", "rms_sigmas": 14.5}
    for name, rms in (("a", 0.002), ("b", 0.001)):
        (tmp_path / name).mkdir()
        said = {"title": name, "channels": {"target.x": {**channel, "rms": rms}}}
        (tmp_path / name / "overlay.json").write_text(json.dumps(said))
    asked = ["compare", str(tmp_path / "a"), str(tmp_path / "b"), "--html", str(tmp_path / "c.html"), "--json"]
    assert main(asked) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["sections"]["Residuals, rms"][0]["what"] == "target.x"
    assert "target.x" in (tmp_path / "c.html").read_text()
    assert spacerobot.compare_page(tmp_path / "a", tmp_path / "b", tmp_path / "d.html").is_file()


def test_what_is_no_run_is_refused_in_a_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run_of(tmp_path / "a", verdict("named"))
    (tmp_path / "b").mkdir()
    with pytest.raises(InputError, match="no finished"):
        compare(tmp_path / "a", tmp_path / "b")
    (tmp_path / "b" / "overlay.json").write_text('{"title": "x", "channels": {}}')
    with pytest.raises(InputError, match="cannot be compared"):
        compare(tmp_path / "a", tmp_path / "b")
    (tmp_path / "a" / "verdict.json").write_text(dumps({**verdict("named"), "format": 2}))
    assert main(["compare", str(tmp_path / "a"), str(tmp_path / "a")]) == 2
    assert "newer" in capsys.readouterr().err


def test_an_effect_of_several_parts_has_a_row_for_each(tmp_path: Path) -> None:
    """Two balls with the same drag are two balls; folders of one name are told apart by where they lie."""
    told = verdict("named")
    one = told["effects"][0]
    told["effects"] = [{**one, "part": "ball a"}, {**one, "part": "ball b"}]
    for name in ("monday", "tuesday"):
        (tmp_path / name).mkdir()
        run_of(tmp_path / name / "balls", told)
    found = compare(tmp_path / "monday" / "balls", tmp_path / "tuesday" / "balls")
    rows = [r.what for r in found.sections["Effects"]]
    assert len(rows) == 2 * len(one["parameters"])
    assert {r.partition(":")[0] for r in rows} == {"ball a", "ball b"}
    assert found.names == ("monday/balls", "tuesday/balls")
