"""A sensor mounted askew, cross-talk, a camera's axes: a factor on another column, believed 0 with a sigma."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.recordings.study import Study, load_study
from spacerobot.support.errors import InputError
from tests.diagnosis.rigs import write_study
from tests.diagnosis.test_unheld_values import changed

TRUE = 0.05


def askew(study: Study, stream: str, column: int, size: float) -> None:
    """Give a stream another column, "beside", of which the channel lacks TRUE times."""
    random = np.random.default_rng(7)
    for trial in study.trials:
        file = study.root / trial.sources[stream].file
        head, *rows = file.read_text().splitlines()
        table = np.array([[float(cell) for cell in row.split(",")] for row in rows])
        beside = size * np.sin(3.0 * table[:, 0] + random.uniform(0, 6.0)) + 0.3 * size
        table[:, column] -= TRUE * beside
        table = np.column_stack([table, beside])
        np.savetxt(file, table, "%.7f", ",", header=f"{head},beside", comments="")


@pytest.mark.parametrize(
    ("stream", "column", "size", "channel"),
    [("mocap", 1, 0.03, "target.x"), ("force", 1, 8.0, "contact.force")],
)
def test_a_doubted_factor_is_found_and_a_trusted_one_is_missed(
    tmp_path: Path, stream: str, column: int, size: float, channel: str
) -> None:
    study = write_study(tmp_path)
    askew(study, stream, column, size)
    line = f'is = "{channel}",'
    held = Workshop(load_study(study.path)).run(Task((), {}))
    found = Workshop(changed(study, (line, f"{line} plus = {{ beside = [0, 0.03] }},"))).run(Task((), {}))
    assert held is not None
    assert found is not None
    assert held.chi2 > 1.1 * held.samples
    assert found.chi2 < 1.05 * found.samples
    assert found.values()[f"{channel}|beside.factor"] == pytest.approx(TRUE, abs=0.004)


def test_a_factor_needs_a_sigma_above_zero(tmp_path: Path) -> None:
    study = write_study(tmp_path)
    askew(study, "force", 1, 1.0)
    line = 'is = "contact.force",'
    with pytest.raises(InputError, match="above 0"):
        changed(study, (line, f"{line} plus = {{ beside = [0, 0] }},"))
