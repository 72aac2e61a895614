"""A study's trials simulated and laid over their recordings: the front door."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spacerobot import __version__
from spacerobot.diagnosis.forward.base import ForwardModel, TrialOverlay
from spacerobot.diagnosis.forward.choose import model_of, overlays
from spacerobot.diagnosis.forward.residuals import Residuals, by_channel, residuals
from spacerobot.recordings.channel import SLIDING, joint_of
from spacerobot.recordings.rig_robot import sliding_joints
from spacerobot.recordings.study import Study
from spacerobot.support.errors import NotFoundError
from spacerobot.support.executors.base import Executor
from spacerobot.support.jsonio import plain
from spacerobot.support.showing import Brief, html_table
from spacerobot.support.tables import data_frame

if TYPE_CHECKING:
    import pandas


FORMAT = 1
"""Of overlay.json."""


@dataclass(frozen=True, eq=False, repr=False)
class Overlay(Brief, Mapping[str, TrialOverlay]):
    """Trials of a study, measured and simulated, by their ids.

    Attributes:
        study: what was simulated.
        model: what simulated it.
        trials: in the order of the study.
    """

    study: Study
    model: ForwardModel
    trials: tuple[TrialOverlay, ...]

    def __getitem__(self, trial: str) -> TrialOverlay:
        """The trial of this id.

        Raises:
            NotFoundError: no such trial.
        """
        for found in self.trials:
            if found.id == trial:
                return found
        raise NotFoundError("trial", trial, (t.id for t in self.trials))

    def __iter__(self) -> Iterator[str]:
        return iter(t.id for t in self.trials)

    def __len__(self) -> int:
        return len(self.trials)

    def __repr__(self) -> str:
        return f"Overlay({self.study.title!r}, {len(self)} trials: {self.model.kind})"

    @property
    def residuals(self) -> dict[str, Residuals]:
        """Channel -> its residuals over all trials."""
        return by_channel(self.trials)

    @property
    def not_predicted(self) -> list[str]:
        """Recorded channels that no simulation shows or takes as given; drives and notes are not counted."""
        shown = {c.channel for t in self.trials for c in t.channels}
        recorded = {s.name for t in self.study.trials for s in self.study.recording(t).outputs()}
        return sorted(
            n for n in recorded - shown - self.model.given if not n.startswith("aux.") and not n.endswith(".reference")
        )

    def as_json(self) -> dict[str, Any]:
        """As in overlay.json; SI."""
        found = plain(
            {
                "format": FORMAT,
                "spacerobot": __version__,
                "input_hash": self.study.input_hash,
                "study": str(self.study.path),
                "title": self.study.title,
                "model": self.model.kind,
                "assumptions": list(self.model.assumptions),
                "values": {v.name: {"value": v.value, "unit": v.unit, "source": v.source} for v in self.model.values},
                "channels": {name: found.as_json() for name, found in self.residuals.items()},
                "not_predicted": self.not_predicted,
                "trials": [
                    {
                        "id": t.id,
                        "condition": t.condition,
                        "touches_s": list(t.touches),
                        "channels": {c.channel: residuals([c]).as_json() for c in t.channels if c.time.size},
                    }
                    for t in self.trials
                ],
            }
        )
        assert isinstance(found, dict)
        return found

    def to_frame(self) -> pandas.DataFrame:
        """A row for each channel of each trial: rms, mean and largest residual, SI, as a table of pandas.

        Raises:
            InputError: pandas is not installed.
        """
        found = [(t, c, residuals([c])) for t in self.trials for c in t.channels if c.time.size]
        columns: dict[str, list[Any]] = {
            "trial": [t.id for t, _, _ in found],
            "condition": [t.condition for t, _, _ in found],
            "channel": [c.channel for _, c, _ in found],
            "unit": [c.unit for _, c, _ in found],
        }
        for name in ("rms", "mean", "largest", "sigma", "rms_sigmas", "samples"):
            columns[name] = [getattr(r, name) for _, _, r in found]
        return data_frame(columns)

    def _repr_html_(self) -> str:
        rows = [(n, r.rms, r.mean, r.largest, r.unit, r.rms_sigmas) for n, r in self.residuals.items()]
        head = ("channel", "rms", "mean", "largest", "unit", "rms in noise σ")
        notes = ["Residual: predicted minus measured, all trials together.", *self.model.assumptions]
        return html_table(f"{self.study.title}: {len(self)} trials, {self.model.kind}", rows, head, notes)


def _unwatched() -> None:
    """Progress that nobody watches."""


def overlay(
    study: Study,
    trials: Sequence[str] | None = None,
    *,
    model: str | Path | None = None,
    workers: Executor | None = None,
    report: Callable[[], None] = _unwatched,
) -> Overlay:
    """Simulate trials of a study, each from its own start, beside their recordings.

    Args:
        study: what the lab believes and recorded.
        trials: ids; all if None.
        model: model.toml of a diagnosis, instead of the baseline as it is believed.
        workers: that simulate (a Dask cluster's, for instance), instead of this process.
        report: called after every trial.

    Raises:
        NotFoundError: no such trial.
        InputError: no model of a machine fits the study, or a trial lacks what its start needs.
    """
    if trials is not None:
        study = replace(study, trials=tuple(study.trial(name) for name in dict.fromkeys(trials)))
    found = None if model is None else Path(model)
    simulates = model_of(study, found)
    by_id: dict[str, TrialOverlay] = {}
    slides = sliding_joints(study) if any(joint_of(c) for c in study.channels()) else frozenset()
    coming = (simulates.simulate(t) for t in study.trials) if workers is None else overlays(study, found, workers)
    for done in coming:
        by_id[done.id] = _in_own_units(done, slides)
        report()
    return Overlay(study, simulates, tuple(by_id[t.id] for t in study.trials))


def _in_own_units(trial: TrialOverlay, slides: Collection[str]) -> TrialOverlay:
    """The same with lengths and forces for joints that slide."""
    own = [replace(c, unit=SLIDING.get(c.unit, c.unit)) if joint_of(c.channel) in slides else c for c in trial.channels]
    return replace(trial, channels=tuple(own))
