"""What of a wrist rig's recordings was left out or weighed otherwise than stated, as the verdict tells it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from spacerobot.diagnosis.answer.record import NoiseFound, Spoiled
from spacerobot.diagnosis.fitting.labels import FORCE, mislabelled
from spacerobot.diagnosis.fitting.spoiled import cleaned
from spacerobot.diagnosis.machines.rig_channels import readable
from spacerobot.diagnosis.terms.data import Block, TrialData, trial_data
from spacerobot.recordings.study import Study

LISTED = 20
"""Moments of a trial that are listed; all are counted."""

CLIPPED = "at the end of the sensor's range"
GLITCH = "beyond anything that the readings around lead to"


def left_out(study: Study, trials: Sequence[TrialData]) -> list[Spoiled]:
    """Readings that were recorded and not used, by trial and channel, and trials that were labelled wrongly."""
    recorded = trial_data(study, readable(study))
    used_by_id = {t.id: t for t in trials}
    unused = [t for t in recorded if t.id not in used_by_id]
    labels = {m.trial: m for m in mislabelled(cleaned(recorded))} if unused else {}
    return [
        Spoiled(
            trial=t.id,
            channel=FORCE,
            why=f"states {labels[t.id].stated:g} kg and moves like the target of {labels[t.id].like:g} kg",
            readings=t.samples,
            times_s=[],
        )
        for t in unused
        if t.id in labels
    ] + [
        Spoiled(
            trial=raw.id,
            channel=raw_block.channels[c],
            why=why,
            readings=int(rows.sum()),
            times_s=[round(float(t), 6) for t in raw_block.time[rows][:LISTED] + raw_block.late],
        )
        for raw in recorded
        if raw.id in used_by_id
        for raw_block, used_block in zip(raw.blocks, used_by_id[raw.id].blocks, strict=True)
        for c, rows, why in _out(raw_block, used_block)
    ]


def _out(raw: Block, used: Block) -> Iterator[tuple[int, np.ndarray, str]]:
    for c in range(len(raw.channels)):
        out = (raw.weight[c] > 0.0) & (used.weight[c] == 0.0)
        top = out & (raw.value[c] == raw.value[c].max())
        ended = int(top.sum()) > 1
        for rows, why in ((top & ended, CLIPPED), (out & ~(top & ended), GLITCH)):
            if rows.any():
                yield c, rows, why


def noise_told(study: Study, trials: Sequence[TrialData]) -> dict[str, NoiseFound]:
    """Channels whose readings were weighed by another noise than is stated."""
    found = {}
    for trial in trials:
        recording = study.recording(trial.recorded)
        for block in trial.blocks:
            for channel, weight in zip(block.channels, block.weight, strict=True):
                series, used = recording[channel], 1.0 / float(weight.max())
                if series.sigma_stated and not np.isclose(used, series.sigma, rtol=1e-6):
                    found[channel] = NoiseFound(sigma=used, stated=series.sigma, unit=series.unit)
    return found
