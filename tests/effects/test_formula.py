"""A learned law in closed form: its name, laws of the catalogue that it holds, the file that it is written to."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.answer.law_file import law_file
from spacerobot.effects import registry
from spacerobot.effects.effect import Placed
from spacerobot.effects.formula import WORDS, Formula, FormulaLaw, evaluated, spoken
from spacerobot.effects.registry import effect
from spacerobot.simulation.reduced.run import simulate
from spacerobot.simulation.rig import rig

FORMULAS = st.builds(
    Formula,
    kind=st.just("force"),
    of=st.sampled_from(["d", "v"]),
    low=st.floats(-1.0, -1e-3),
    high=st.floats(1e-3, 1.0),
    words=st.lists(st.tuples(st.sampled_from(sorted(WORDS)), st.floats(1e-6, 1e6)), min_size=1, max_size=3).map(tuple),
)


@given(formula=FORMULAS)
def test_a_name_holds_all_of_a_formula(formula: Formula) -> None:
    assert spoken(formula.name) == formula
    assert effect(formula.name).name == formula.name


@given(x=st.floats(-3.0, 3.0), word=st.sampled_from(sorted(WORDS)))
def test_what_is_compiled_is_what_is_written(x: float, word: str) -> None:
    text = WORDS[word].python.format(x=f"({x!r})", place="0.3", width="0.7", length="0.7", exponent="0.7")
    value = eval(text, {"math": math, "max": max, "min": min, "abs": abs})
    assert evaluated(word, np.array([x]), 0.3, 0.7)[0] == pytest.approx(value, rel=1e-12, abs=1e-15)


def _track(name: str, values: dict[str, float], where: str = "wrist") -> np.ndarray:
    mechanism = Placed(effect(name), where, values).apply(rig({"target.mass": 9.0}))
    run = simulate(mechanism, position={"target": -0.01}, velocity={"target": 0.08}, end=1.2, tolerance=1e-10)
    return np.asarray(run.states(np.linspace(0.0, 1.2, 200))[0])


def _law(kind: str, of: str, *words: str) -> FormulaLaw:
    low, high = (-9.0, 9.0) if of == "z" else (-0.3, 0.3)
    return FormulaLaw(Formula(kind, of, low, high, tuple((w, 1e4) for w in words)))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("law", "values", "known", "numbers"),
    [
        (_law("force", "v", "line"), {"a_1": 6.0}, "viscous_friction", {"coefficient_Ns_m": 6.0}),
        (_law("force", "v", "odd"), {"a_1": 40.0}, "quadratic_damping", {"coefficient_Ns2_m2": 40.0}),
        (_law("force", "d", "cube"), {"a_1": 2e5}, "cubic_stiffness", {"k3_N_m3": 2e5}),
        (_law("friction", "d", "one"), {"a_1": 0.3}, "coulomb_friction", {"force_N": 0.3}),
        (
            _law("memory", "z", "one"),
            {"a_1": 150.0, "rate_1_s": 12.5},
            "maxwell",
            {"stiffness_N_m": 150.0, "relaxation_s": 0.08},
        ),
    ],
)
def test_a_plain_formula_is_a_law_of_the_catalogue(
    law: FormulaLaw, values: dict[str, float], known: str, numbers: dict[str, float]
) -> None:
    np.testing.assert_allclose(_track(law.name, values), _track(known, numbers), atol=2e-8)
    assert np.abs(_track(known, numbers) - _track(law.name, dict.fromkeys(values, 0.0))).max() > 1e-5  # it is seen


@pytest.mark.parametrize(
    ("law", "values", "where"),
    [
        (_law("force", "v", "down", "one"), {"a_1": 11.0, "a_2": 0.1}, "wrist"),
        (_law("force", "d", "cube", "rise"), {"a_1": 1e5, "a_2": 2.0, "a_2_place": 0.01, "a_2_width": 3e-3}, "wrist"),
        (_law("friction", "d", "rise"), {"a_1": 1.6, "a_1_place": 0.008, "a_1_width": 0.003}, "wrist"),
        (_law("friction", "N", "line"), {"a_1": 0.06}, "wrist"),
        (_law("memory", "z", "one", "up"), {"a_1": 150.0, "a_2": -20.0, "rate_1_s": 5.0}, "wrist"),
        (_law("force", "d", "square", "cube"), {"a_1": 1e6, "a_2": 1e9}, "contact"),
        (_law("force", "v", "line"), {"a_1": 0.5}, "target"),
    ],
)
def test_the_file_that_a_law_is_written_to_is_the_same_law(
    law: FormulaLaw, values: dict[str, float], where: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    registry.all_effects()
    monkeypatch.setattr(registry, "_effects", dict(registry._effects))
    path = tmp_path / "my_law.py"
    path.write_text(law_file(law, values, where), encoding="utf-8")
    assert registry.load_effects(path) == ["my_law"]
    drafted = effect("my_law")
    starts = {p.name: p.starts[0] for p in drafted.parameters}
    assert list(starts.values()) == pytest.approx([values[p.name] for p in law.parameters])
    np.testing.assert_allclose(_track("my_law", starts, where), _track(law.name, values, where), atol=1e-9)
    compile(path.read_text(encoding="utf-8"), str(path), "exec")
