"""A study's trials on a real scheduler's workers: the same answer; and what cannot be asked together."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from spacerobot.cli.main import main
from tests.overlay.studies import axis_study


@pytest.mark.slow
def test_a_cluster_gives_the_same_answer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    distributed = pytest.importorskip("distributed")
    answers = []
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address=None, silence_logs=50
    ) as cluster:
        for study in ("guide-friction", str(axis_study(tmp_path))):
            for more in ([], ["--dask", cluster.scheduler_address]):
                wanted = ["--trials", "12", "03"] if study == "guide-friction" else []
                assert main(["overlay", study, *wanted, "--json", *more]) == 0
                answers.append(json.loads(capsys.readouterr().out))
    assert answers[0] == answers[1]
    assert [t["id"] for t in answers[1]["trials"]] == ["12", "03"]
    assert answers[2] == answers[3]


def test_nobody_answers(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("spacerobot.support.executors.cluster.PATIENCE", 0.5)
    for command in ("overlay", "diagnose"):
        assert main([command, "guide-friction", "--dask", "tcp://127.0.0.1:1"]) == 2
        assert "no Dask scheduler answers" in capsys.readouterr().err


def test_jobs_and_dask_exclude_each_other(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["diagnose", "guide-friction", "--dask", "tcp://127.0.0.1:1", "--jobs", "2"]) == 2
    assert "--dask or --jobs" in capsys.readouterr().err
