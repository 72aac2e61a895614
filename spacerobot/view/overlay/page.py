"""The overlay's page: one HTML file that needs no other, with every figure inside."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files
from typing import Any

import numpy as np
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup
from matplotlib.figure import Figure

from spacerobot import __version__
from spacerobot.diagnosis.forward.base import ForwardModel, TrialOverlay
from spacerobot.diagnosis.forward.residuals import Residuals, residuals
from spacerobot.recordings.study import Study
from spacerobot.view.overlay.figures import readable
from spacerobot.view.overlay.thinning import extremes
from spacerobot.view.plotting import png_uri
from spacerobot.view.report.evidence import Trace
from spacerobot.view.report.inline import inline
from spacerobot.view.report.page import assets, policy
from spacerobot.view.report.traces_json import embedded
from spacerobot.view.report.words import number

POINTS = 1000
"""Samples of one channel that the page carries, about."""


def page(
    study: Study,
    model: ForwardModel,
    trials: list[TrialOverlay],
    channels: Mapping[str, Residuals],
    pictures: Mapping[str, bytes],
    glance: Figure,
    left_out: list[str],
) -> str:
    """The page as HTML text.

    Args:
        study: what was simulated.
        model: the forward model.
        trials: all of them.
        channels: residuals by channel, all trials together.
        pictures: of the trials that are drawn, as PNG, by trial id.
        glance: every trial's residuals in one figure.
        left_out: recorded channels that the baseline does not predict.
    """
    data, kept = embedded([trace for trial in trials for trace in traces_of(trial)])
    scripts, styles = assets()
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters["figure"] = lambda value: number(value, 3)
    template = environment.from_string(
        files("spacerobot.view").joinpath("templates/overlay.html").read_text(encoding="utf-8")
    )
    return template.render(
        study=study,
        model=model,
        trials=trials,
        rows=[_row(r) for r in channels.values()],
        by_trial={t.id: [_row(residuals([c])) for c in t.channels if c.time.size] for t in trials},
        images={trial: png_uri(picture) for trial, picture in pictures.items()},
        glance=inline(glance, "Every trial's residual over its noise, or its spread where none is stated, by channel"),
        left_out=left_out,
        estimated=[r.channel for r in channels.values() if not r.sigma_stated],
        version=__version__,
        data=Markup(data),  # noqa: S704 - JSON with every bracket escaped
        kept=kept,
        count=sum(len(t.channels) for t in trials),
        scripts=scripts,
        styles=styles,
        policy=policy(scripts, styles),
    )


def traces_of(trial: TrialOverlay) -> list[Trace]:
    """A trial's channels as the page's explorer takes them, long records thinned so that no peak is lost."""
    return [
        Trace(
            trial=trial.id,
            condition=trial.condition,
            channel=c.channel,
            unit=c.unit,
            sigma=c.sigma if c.sigma > 0.0 and np.isfinite(c.sigma) else None,
            time=c.time[kept],
            measured=c.measured[kept],
            before=c.simulated[kept],
            after=np.zeros(0),
        )
        for c in trial.channels
        if c.time.size
        for kept in [extremes(POINTS, c.measured, c.residual)]
    ]


def _row(found: Residuals) -> dict[str, Any]:
    factor, unit = readable(found.unit, found.rms)
    return {
        "channel": found.channel,
        "unit": unit,
        "samples": found.samples,
        "rms": found.rms * factor,
        "mean": found.mean * factor,
        "largest": found.largest * factor,
        "spread": found.spread * factor,
        "sigma": found.sigma * factor,
        "sigmas": found.rms_sigmas,
        "chi2": found.chi2_per_sample,
        "stated": found.sigma_stated,
    }
