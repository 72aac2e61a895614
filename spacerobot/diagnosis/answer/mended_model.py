"""The chosen models of a study as a file that `spacerobot overlay STUDY --model FILE` runs again."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.hypothesis import Hypothesis, hypothesis
from spacerobot.effects.registry import effect
from spacerobot.recordings.document import read_document
from spacerobot.recordings.study import Study
from spacerobot.support.errors import InputError, NotFoundError
from spacerobot.support.formats import require_format

FILE = "model.toml"

FORMAT = 1

RUNS = "spacerobot overlay STUDY --model model.toml"
"""How a found model is run; a scene for `simulate` is a wrist that meets a target, which these machines are not."""


@dataclass(frozen=True)
class Found:
    """What a model's file says of one part.

    Attributes:
        part: name of its model.
        values: of the baseline, by dotted name, and of the effects by "effect@where.parameter".
        effects: (effect, where) each.
    """

    part: str
    values: Mapping[str, float]
    effects: tuple[tuple[str, str], ...]

    def hypothesis(self, model: Machine) -> tuple[Hypothesis, np.ndarray]:
        """It as a hypothesis of a study's model, with the parameters that make it what was found.

        Raises:
            NotFoundError: an effect that cannot sit there.
        """
        sites = {s.label: s for s in model.sites([effect(name) for name, _ in self.effects])}
        for label in self.effects:
            if label not in sites:
                raise NotFoundError("effect", "@".join(label), ["@".join(s) for s in sites], where=FILE)
        made = hypothesis(model.believed, [sites[label] for label in self.effects], dict(self.values))
        return made, np.array([f.z(self.values[f.key]) if f.key in self.values else 0.0 for f in made.free])


def model_text(study: Study, parts: Sequence[Part]) -> str:
    """The file's text, TOML; its values are SI."""
    lines = [
        f"# What was found: the baseline's values as fitted, and the effects. Run it with\n# {RUNS}",
        f"format = {FORMAT}",
        f"study = {json.dumps(study.title)}",
        f"input_hash = {json.dumps(study.input_hash)}",
    ]
    for part in parts:
        lines += ["", "[[parts]]", f"part = {json.dumps(part.name)}"]
        labels = ", ".join(f"[{json.dumps(e)}, {json.dumps(w)}]" for e, w in part.fit.hypothesis.label)
        lines += [f"effects = [{labels}]", "[parts.values]"]
        lines += [f"{json.dumps(key)} = {float(value)!r}" for key, value in part.fit.values().items()]
    return "\n".join(lines) + "\n"


def read_model(path: Path) -> tuple[Found, ...]:
    """The parts of a model's file.

    Raises:
        InputError: it cannot be read, or is no such file.
    """
    document = read_document(path).data
    if "format" in document:
        require_format(document["format"], FORMAT, "model", str(path), "diagnose the study again")
    try:
        parts = tuple(
            Found(str(p["part"]), {str(k): float(v) for k, v in p["values"].items()}, tuple(map(_label, p["effects"])))
            for p in document["parts"]
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(
            f"no model of `diagnose`: {error}", valid="[[parts]] with part, effects and values", where=str(path)
        ) from None
    require_format(document.get("format"), FORMAT, "model", str(path))
    return parts


def _label(pair: Any) -> tuple[str, str]:
    name, where = pair
    return str(name), str(where)
