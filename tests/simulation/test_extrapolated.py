"""A run that asks a learned law for more than recordings have shown says so; one that does not, does not."""

from __future__ import annotations

import warnings
from dataclasses import replace

import pytest

from spacerobot.effects.formula import Formula
from spacerobot.simulation.extrapolated import ExtrapolationWarning
from spacerobot.simulation.parts import EffectAt
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate


def _said(high: float, of: str = "d", where: str = "wrist", kind: str = "force") -> list[str]:
    law = Formula(kind, of, -high, high, (("line", 1.0),))  # type: ignore[arg-type]
    scene = replace(Scene(), effects=(EffectAt(law.name, where, {"a_1": 0.01}),))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        simulate(scene, duration=0.6)
    return [str(w.message) for w in caught if issubclass(w.category, ExtrapolationWarning)]


@pytest.mark.parametrize(
    ("of", "where", "kind"),
    [("d", "wrist", "force"), ("v", "target", "force"), ("d", "contact", "force"), ("N", "wrist", "friction")],
)
def test_a_run_beyond_what_was_recorded_is_said_once(of: str, where: str, kind: str) -> None:
    (said,) = _said(1e-6, of, where, kind)
    assert where in said
    assert "1e-06" in said
    assert _said(1e3, of, where, kind) == []
