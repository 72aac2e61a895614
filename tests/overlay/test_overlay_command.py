"""`spacerobot overlay`: page, JSON, figures, a folder of its own, and refusals."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from spacerobot.cli.main import main
from spacerobot.view.overlay.figures import readable
from spacerobot.view.overlay.thinning import broken, envelope, extremes
from tests.overlay.studies import axis_study


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("overlay")
    assert main(["overlay", "guide-friction", "--trials", "03", "01,12", "--out", str(out)]) == 0
    return out


def test_the_page_needs_no_other_file(folder: Path) -> None:
    text = (folder / "overlay.html").read_text(encoding="utf-8")
    assert text.count("<img") == 3, "a picture of each trial, for readers without scripts"
    assert text.count("<svg viewBox") == 1, "all residuals at a glance, in the page's own colours"
    assert "var(--after)" in text
    assert not re.search(r'(src|href)="(?!data:|#)', text)
    for words in ("contact.damping is not stated", "Trial 03", "χ² per sample", "Nothing is fitted"):
        assert words in text


def test_a_figure_for_each_trial(folder: Path) -> None:
    assert {p.name for p in folder.glob("*.png")} == {"trial_01.png", "trial_03.png", "trial_12.png"}
    for path in folder.glob("*.png"):
        assert path.read_bytes().startswith(b"\x89PNG")


def test_json_holds_the_residual_figures(folder: Path) -> None:
    found = json.loads((folder / "overlay.json").read_text(encoding="utf-8"))
    assert [t["id"] for t in found["trials"]] == ["03", "01", "12"]
    for trial in found["trials"]:
        for c in trial["channels"].values():
            assert c["rms_sigmas"] == pytest.approx(np.sqrt(c["chi2_per_sample"]))
            assert c["rms_sigmas"] == pytest.approx(c["rms"] / c["sigma"])
            assert abs(c["largest"]) >= c["rms"] >= abs(c["mean"])
    pooled = found["channels"]["target.x"]
    each = [t["channels"]["target.x"] for t in found["trials"]]
    assert pooled["samples"] == sum(c["samples"] for c in each)
    assert pooled["rms"] ** 2 * pooled["samples"] == pytest.approx(sum(c["rms"] ** 2 * c["samples"] for c in each))


def test_a_finished_run_is_reused_and_another_refused(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    before = (folder / "overlay.html").stat().st_mtime_ns
    arguments = ["overlay", "guide-friction", "--out", str(folder)]
    assert main([*arguments, "--trials", "03", "01", "12", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["page"] == str(folder / "overlay.html")
    assert (folder / "overlay.html").stat().st_mtime_ns == before
    assert main([*arguments, "--trials", "02"]) == 2
    assert "--overwrite" in capsys.readouterr().err


def test_without_a_folder_it_only_speaks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["overlay", str(axis_study(tmp_path)), "--json"]) == 0
    captured = capsys.readouterr()
    answer = json.loads(captured.out)
    assert captured.err == ""
    assert answer["channels"]["joint.slide.position"]["rms_sigmas"] < 2
    assert sorted(p.name for p in tmp_path.iterdir()) == ["axis.urdf", "log.csv", "study.toml"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["guide-frction"], "did you mean 'guide-friction'"),
        (["guide-friction", "--trials", "99"], "unknown trial; given: 99"),
        (["guide-friction", "--trials", ","], "no trial is named"),
        (["guide-friction", "--data", "/nowhere"], "the data folder does not exist"),
    ],
)
def test_refusals(capsys: pytest.CaptureFixture[str], arguments: list[str], message: str) -> None:
    assert main(["overlay", *arguments]) == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert captured.err.count("\n") == 1
    assert captured.out == ""


def test_a_study_that_no_model_serves_says_what_one_needs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "b.csv").write_text("t,z\n0,1\n0.1,2\n0.2,3\n")
    (tmp_path / "study.toml").write_text(
        'format = 1\n[baseline.body]\nmass = 1.0\n[streams.s]\ntime = "t"\n[streams.s.channels]\n'
        'z = { is = "aux.z" }\n[[trials]]\nid = "1"\ns = "b.csv"\n'
    )
    assert main(["overlay", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert "no forward model" in error
    assert "target's track" in error


def test_thinning_keeps_every_peak() -> None:
    time = np.linspace(0.0, 1.0, 20_001)
    value = np.sin(40.0 * time)
    value[[777, 13_333]] = 9.0, -8.0
    t, y = envelope(time, value, 400)
    assert t.size <= 420
    assert (np.diff(t) > 0).all()
    assert (y.max(), y.min()) == (9.0, -8.0)
    assert {t[0], t[-1]} == {0.0, 1.0}


def test_a_line_breaks_where_it_should() -> None:
    time = np.arange(10.0)
    t, y = broken(time, time.copy(), np.array([0.0, 4.0, 8.0]))
    assert np.isnan(y).sum() == 2
    assert t[np.isnan(y)].tolist() == [4.0, 8.0]
    thin_t, thin_y = envelope(*broken(np.arange(5000.0), np.ones(5000), np.array([2500.0])), 100)
    assert np.isnan(thin_y).sum() == 1
    assert thin_t[np.isnan(thin_y)] == [2500.0]


@pytest.mark.parametrize(
    ("unit", "size", "expected"),
    [
        ("m", 0.002, (1e3, "mm")),
        ("m", 3e-6, (1e6, "µm")),
        ("m", 2.0, (1.0, "m")),
        ("N", 0.2, (1.0, "N")),
        ("1", 1e-9, (1.0, "1")),
    ],
)
def test_units_that_read_well(unit: str, size: float, expected: tuple[float, str]) -> None:
    assert readable(unit, size) == expected


def test_thinned_records_keep_every_peak() -> None:
    """The least and the largest of each record, and no more samples than were asked for, about."""
    random = np.random.default_rng(1)
    one, two = random.standard_normal((2, 20_000))
    one[1234], two[17_001] = 50.0, -60.0
    kept = extremes(1000, one, two)
    assert kept.size <= 1100
    assert {1234, 17_001} <= set(kept.tolist())
    assert (np.diff(kept) > 0).all()
    assert extremes(1000, one[:500]).size == 500
