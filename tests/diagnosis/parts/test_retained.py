"""What whole trials have shown of drag, where a knock cuts one of them and the pieces are too short to name it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.machines.touch import Moment
from spacerobot.diagnosis.selection.conclusion import retained
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.effects.registry import effect
from tests.diagnosis.parts.helpers_balls import balls

DRAG = 0.003


def whole_and_cut(folder: Path, drag: float) -> tuple[Growth, Growth]:
    """Growths of two falls, and of these with the second one cut, as if nothing had been worth naming there."""
    (model,) = models_for(balls(folder, {"light": (0.6, drag)}, stated=False, noise=0.1))
    offered = [effect("quadratic_drag")]
    cut = grow(model.cut_at({model.trials[1].recorded: [Moment(1.4, 1.3, 1.5)]}), effects=offered)
    return grow(model, effects=offered), replace(cut, after=cut.before)


def test_drag_that_whole_falls_showed_stays_where_their_pieces_are_predicted_better_with_it(tmp_path: Path) -> None:
    whole, cut = whole_and_cut(tmp_path, DRAG)
    found = retained(cut, whole.after)
    assert found.after.label == (("quadratic_drag", "target"),)
    assert found.after.fit.values()["quadratic_drag@target.coefficient_Ns2_m2"] == pytest.approx(DRAG, rel=0.1)
    assert found.after.error < found.before.error


def test_drag_that_the_pieces_do_not_bear_out_does_not(tmp_path: Path) -> None:
    """Of a ball that feels none, whatever a whole fall seemed to show."""
    whole, _ = whole_and_cut(tmp_path / "light", DRAG)
    _, cut = whole_and_cut(tmp_path / "heavy", 0.0)
    assert not retained(cut, whole.after).after.sites
