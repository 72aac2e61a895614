"""A fit that is kept is found again for the very same task alone: whatever decides a fit is part of its name."""

from __future__ import annotations

from dataclasses import fields, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.fit_store import Kept, of_fit, task_name
from spacerobot.diagnosis.fitting.workshop import Task


def near(z: float, label: str = "preload", freed: tuple[str, ...] = ()) -> Any:
    made = SimpleNamespace(label=((label, "wrist"),), freed=freed, sites=(), only=())
    return SimpleNamespace(hypothesis=made, z=np.array([z]))


USUAL = Task((("preload", "wrist"),), {"a": 1.0}, initials={"01": np.array([1.0, 2.0])}, near=near(0.5))

OTHER: dict[str, list[Any]] = {
    "label": [(("preload", "target"),), ()],
    "start": [{"a": 1.0 + 1e-15}, {"b": 1.0}, {}],
    "initials": [None, {"01": np.array([1.0, 2.1])}, {"02": np.array([1.0, 2.0])}],
    "hopeless": [5.0],
    "max_iterations": [41],
    "near": [None, near(0.6), near(0.5, "adhesion"), near(0.5, freed=("wrist.mass",))],
    "loose": [True],
    "eager": [True],
    "patient": [True],
    "only": [(((("preload", "wrist")), ("01",)),)],
    "freed": [("wrist.mass",)],
    "along": [("a",), ("b",)],
}


def test_every_field_of_a_task_is_tried() -> None:
    assert set(OTHER) == {f.name for f in fields(Task)}


@pytest.mark.parametrize("name", OTHER)
def test_another_task_has_another_name(name: str) -> None:
    for value in OTHER[name]:
        assert task_name(replace(USUAL, **{name: value})) != task_name(USUAL)
    assert task_name(replace(USUAL)) == task_name(USUAL)


class Shelf(dict[str, Any]):
    """A store that tells its names."""

    def save(self, name: str, value: Any) -> None:
        self[name] = value

    def load(self, name: str) -> Any | None:
        return self.get(name)


def test_what_follows_from_a_fit_is_kept_under_all_that_decides_it() -> None:
    def made(label: str, centre: float, step: float) -> Any:
        free = [SimpleNamespace(key="k", centre=centre, step=step)]
        return SimpleNamespace(label=((label, "wrist"),), free=free, freed=())

    def fit(label: str = "preload", centre: float = 1.0, step: float = 0.1, z: float = 0.5) -> Any:
        return SimpleNamespace(hypothesis=made(label, centre, step), z=np.array([z]))

    shelf = Shelf()
    asked = [
        ("shoulder", "figures", fit(), [1]), ("elbow", "figures", fit(), [1]), ("shoulder", "sizes", fit(), [1]),
        ("shoulder", "figures", fit("adhesion"), [1]), ("shoulder", "figures", fit(centre=2.0), [1]),
        ("shoulder", "figures", fit(step=0.2), [1]), ("shoulder", "figures", fit(z=0.6), [1]),
        ("shoulder", "figures", fit(), [2]),
    ]  # fmt: skip
    for number, (model, kind, one, about) in enumerate(asked):
        assert Kept(shelf, model).values(kind, one, about, lambda n=number: n, int) == number
    assert len(shelf) == len(asked)
    assert Kept(shelf, "shoulder").values("figures", fit(), [1], lambda: -1, int) == 0
    assert of_fit(fit(z=0.6)) != of_fit(fit())
