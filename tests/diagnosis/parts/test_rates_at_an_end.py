"""How fast a body moves at the end of a stretch: as its readings say, whether its model is right or not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.machines.touch import Moment
from spacerobot.diagnosis.selection import stretches
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.stretches import nearby
from spacerobot.effects.registry import all_effects
from tests.diagnosis.parts.helpers_plane import in_plane

NOISE, TIME = 0.002, np.arange(0.0, 20.0, 0.1)
LEFT: dict[str, tuple[Callable[[np.ndarray], np.ndarray], float, float]] = {
    "nothing": (lambda t: 0.0 * t, 0.0, 0.0),
    "another rate": (lambda t: 0.05 * t - 0.1, 0.05, -0.1),
    "a pull": (lambda t: 0.01 * t**2, 0.0, 0.0),
}


@pytest.mark.parametrize("left", LEFT)
def test_what_is_left_over_near_an_end_is_told_with_its_own_error(left: str) -> None:
    of, slope, value = LEFT[left]
    random, inside, errors = np.random.default_rng(1), 0, []
    for _ in range(200):
        found, error = nearby(TIME, of(TIME) + NOISE * random.standard_normal(TIME.size))
        inside += bool(abs(found[0] - slope) < 3.0 * error[0] and abs(found[1] - value) < 3.0 * error[1])
        errors.append(error[0])
    assert inside > 180
    whole = NOISE / np.sqrt(np.square(TIME - TIME.mean()).sum())
    assert (float(np.median(errors)) < 2.0 * whole) == (left != "a pull")  # all readings, where a line is all there is


@pytest.mark.parametrize("straight", [stretches.STRAIGHT, np.inf])
def test_a_knock_is_as_large_as_it_was_where_the_model_lacks_what_brakes(
    straight: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a line through all that is left over, whatever its bends, it would be of another size."""
    monkeypatch.setattr(stretches, "STRAIGHT", straight)
    knock = (2.2, (0.10, -0.06, 0.004))
    (model,) = models_for(in_plane(tmp_path, lambda v: -0.6 * v, {1: knock}))
    moments = {"s1": [Moment(2.2, 2.15, 2.25)]}
    growth = grow(model.cut_at(moments), effects=[])
    found = stretches.struck(growth, moments, stretches.momentary(all_effects().values(), model))
    size = {k.where: k.impulse[0] for k in found}
    right = [size.get(w, 0.0) for w in ("target", "target.y", "target.yaw")] == pytest.approx(knock[1], rel=0.2)
    assert right == (straight < np.inf)
