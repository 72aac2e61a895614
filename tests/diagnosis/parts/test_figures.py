"""Figures of others, measured like for like: what is fitted to has not been predicted from itself."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.view.table.literature import Figure, _among, _folds


def piece(name: str, moves: float) -> TrialData:
    time = np.linspace(0.0, 1.0, 11)
    value = np.vstack([moves * time, 1e-4 * np.sin(9.0 * time)])
    block = Block("mocap", ("body.position.x", "body.position.z"), time, value, np.ones_like(value))
    return TrialData(name, "", {}, (block,), 0.0, 1.0)


PIECES = tuple(piece(f"{run}@{k}", 0.05 if k else 0.001) for run in ("one", "two") for k in range(4))
SLIDING = Figure(
    "sliding",
    {"body.position.x": 1.0},
    "mm",
    (2.0,),
    (1.0,),
    still={"body.position.z": 1e-3},
    moving={"body.position.x": 0.02},
    alone=True,
)
PART = SimpleNamespace(growth=SimpleNamespace(bench=SimpleNamespace(left_out=[("one", ("one@0",))])))


def test_only_pieces_that_slide_count() -> None:
    assert [t.id for t in PIECES if _among(SLIDING, t)] == [f"{run}@{k}" for run in ("one", "two") for k in (1, 2, 3)]


def test_a_recording_is_left_out_whole() -> None:
    pieces = [t for t in PIECES if _among(SLIDING, t)]
    assert _folds(SLIDING, PART, pieces) == [("one", ("one@1", "one@2", "one@3"))]  # type: ignore[arg-type]


@pytest.mark.parametrize("count", [2, 5, 8])
def test_every_other_piece_is_left_out_once(count: int) -> None:
    figure = Figure("y", {"body.position.x": 1.0}, "mm", (2.0,), (1.0,), alone=True, interleaved=True)
    folds = _folds(figure, PART, PIECES[:count])  # type: ignore[arg-type]
    assert len(folds) == 2
    assert sorted(i for _, ids in folds for i in ids) == sorted(t.id for t in PIECES[:count])
    assert all(len(ids) < count for _, ids in folds)
