"""What a diagnosis hands over, whatever machine it was of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from spacerobot.diagnosis.answer.record import Verdict, written
from spacerobot.diagnosis.fitting.adequacy import Left
from spacerobot.diagnosis.selection.judge import Judgement
from spacerobot.diagnosis.selection.search_state import Found
from spacerobot.simulation.scene import Scene
from spacerobot.support.showing import Brief, brief, html_table
from spacerobot.support.tables import data_frame

if TYPE_CHECKING:
    import pandas

if TYPE_CHECKING:  # loads statistics that a wrist rig's diagnosis does without
    from spacerobot.diagnosis.selection.part_result import Part


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis(Brief):
    """Everything a diagnosis found.

    Attributes:
        answer: what is said, typed.
        evidence: what reports are made from, as a dict.
        found: every fit and screen of a wrist rig; None for other machines.
        judgement: of a wrist rig, what was decided, on which fit; None for other machines.
        left: of a wrist rig, what the finalists leave over, by set of effects.
        model: of other machines, what was found as TOML, for `spacerobot overlay --model`.
        scene: of a wrist rig, its first trial as the chosen model has it.
        law_file: of a law that was learned and has a formula, a Python file that defines it as an effect.
        parts: of other machines, what was found at each joint, body or sensor.
    """

    answer: Verdict
    evidence: Mapping[str, Any]
    found: Found | None = None
    judgement: Judgement | None = None
    left: Mapping[tuple[tuple[str, str], ...], Left] = field(default_factory=dict)
    parts: tuple[Part, ...] = ()
    scene: Scene | None = None
    model: str | None = None
    law_file: str | None = None

    @cached_property
    def verdict(self) -> dict[str, Any]:
        """The answer as verdict.json has it."""
        found: dict[str, Any] = written(self.answer)
        return found

    def __repr__(self) -> str:
        named = " + ".join(f"{e['effect']} at {e['where']}" for e in self.verdict["effects"])
        sure = f"confidence {self.verdict['confidence']:.2f}"
        return f"Diagnosis({brief(self.verdict['study'])}, {self.verdict['verdict']}: {named or 'no effect'}, {sure})"

    def to_frame(self) -> pandas.DataFrame:
        """A row for each fitted parameter of what was found, and for each believed value that moved.

        Columns: effect, where, parameter, value, low, high (95 %), unit, as a table of pandas.

        Raises:
            InputError: pandas is not installed.
        """
        names = ("effect", "where", "parameter", "value", "low", "high", "unit")
        return data_frame(dict(zip(names, map(list, zip(*self._rows(), strict=True)), strict=False)))

    def _rows(self) -> list[tuple[Any, ...]]:
        laws = [{**law, "effect": "learned_law"} for law in self.verdict.get("learned", ())]
        found = [
            (e["effect"], e["where"], name, p["value"], *_ends(p), p["unit"])
            for e in [*self.verdict["effects"], *laws]
            for name, p in e["parameters"].items()
        ]
        moved = self.verdict["parameters"].items()
        return found + [("", *name.rpartition(".")[::2], p["value"], *_ends(p), p["unit"]) for name, p in moved]

    def _repr_html_(self) -> str:
        v = self.verdict
        title = f"{v['study']}: {v['verdict']} (confidence {v['confidence']:.2f})"
        overall, unit = v["held_out"]["overall"], v["held_out"].get("unit", "sigma")
        notes = [*v.get("why", ())]
        if overall["rms_before"] is not None and overall["rms_after"] is not None:
            of = "sensor sigmas" if unit == "sigma" else "each channel's spread"
            notes.append(
                f"Held-out data, in {of}: {overall['rms_before']:.3g} before, {overall['rms_after']:.3g} after."
            )
        if v["next_experiment"]:
            notes.append(f"Next: {v['next_experiment']['change']}. {v['next_experiment']['why']}")
        return html_table(title, self._rows(), ("effect", "where", "parameter", "value", "95 %", "", "unit"), notes)


def _ends(value: Mapping[str, Any]) -> tuple[Any, Any]:
    """Of an interval; a whole number, such as a filter's order, has none."""
    low, high = value["ci95"] or (None, None)
    return low, high
