"""What a diagnosis hands over, whatever machine it was of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from spacerobot.diagnosis.adequacy import Left
from spacerobot.diagnosis.found import Found
from spacerobot.diagnosis.judge import Judgement
from spacerobot.simulation.scene import Scene

if TYPE_CHECKING:  # loads statistics that a wrist rig's diagnosis does without
    from spacerobot.diagnosis.models.part import Part


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """Everything a diagnosis found.

    Attributes:
        verdict: verdict.json as a dict.
        evidence: what reports are made from, as a dict.
        found: every fit and screen of a wrist rig; None for other machines.
        judgement: of a wrist rig, what was decided, on which fit; None for other machines.
        left: of a wrist rig, what the finalists leave over, by set of effects.
        model: of other machines, what was found as TOML, for `spacerobot overlay --model`.
        scene: of a wrist rig, its first trial as the chosen model has it.
        parts: of other machines, what was found at each joint, body or sensor.
    """

    verdict: Mapping[str, Any]
    evidence: Mapping[str, Any]
    found: Found | None = None
    judgement: Judgement | None = None
    left: Mapping[tuple[tuple[str, str], ...], Left] = field(default_factory=dict)
    parts: tuple[Part, ...] = ()
    scene: Scene | None = None
    model: str | None = None
