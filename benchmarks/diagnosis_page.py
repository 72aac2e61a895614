"""What benchmarks/diagnosis.py measured, as a page."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from benchmarks.timing import with_quartiles


def exponent(size: list[float], seconds: list[float]) -> float:
    """p of seconds ~ size^p, by least squares of the logarithms; NaN of a single point."""
    if len(size) < 2:
        return math.nan
    return float(np.polyfit(np.log(size), np.log(seconds), 1)[0])


def _grows(rows: list[dict[str, Any]], key: str) -> float:
    return exponent([r[key] for r in rows], [r["seconds"]["median"] for r in rows])


def _last(rows: list[dict[str, Any]]) -> str:
    if len(rows) < 2:
        return "-"
    a, b = rows[-2:]
    return f"{b['seconds']['median'] / a['seconds']['median']:.1f} times from {a['trials']} to {b['trials']} trials"


def page(found: dict[str, Any]) -> str:
    """Markdown."""
    catalogue, trials, samples, of_trials = (
        found[key] for key in ("catalogue", "trials", "samples", "search_of_trials")
    )
    full = catalogue[-1]
    lines = [
        f"`{found['study']}`, {found['trials_in_study']} trials, one core. A hypothesis is a set of effects and places that was",
        "screened or fitted; all its values are free in a fit, the trials' own starts too. Growth is the exponent p of",
        "time ~ size^p over the rows of a table: 1 is linear, and a doubling costs 2^p times as much.",
        "",
        f"Refit of the baseline alone: {with_quartiles(found['baseline'])} s.",
        "",
        "| places in the catalogue | hypotheses | of them fitted | search, s | ms per hypothesis | s per place |",
        "|---|---|---|---|---|---|",
    ]
    for row in catalogue:
        median = row["seconds"]["median"]
        lines.append(
            f"| {row['sites']} | {row['hypotheses']} | {row['fitted']} | {with_quartiles(row['seconds'])} "
            f"| {1e3 * median / row['hypotheses']:.3g} | {median / row['sites']:.2f} |"
        )
    lines += [
        "",
        f"With places time grows as p = {_grows(catalogue, 'sites'):.2f}, with hypotheses, of which pairs are the most, as",
        f"p = {_grows(catalogue, 'hypotheses'):.2f}. Target: linear in singles; pairs bounded, as all are screened but few fitted.",
        "",
        f"| trials | search of {of_trials[0]['sites']} places, s | s per trial | fitted | fit of Coulomb friction, s | ms per trial "
        "| iterations |",
        "|---|---|---|---|---|---|---|",
    ]
    for row, whole in zip(trials, of_trials, strict=True):
        lines.append(
            f"| {row['trials']} | {with_quartiles(whole['seconds'])} | {whole['seconds']['median'] / row['trials']:.2f} "
            f"| {whole['fitted']} | {with_quartiles(row['seconds'])} | {1e3 * row['seconds']['median'] / row['trials']:.0f} "
            f"| {row['iterations']} |"
        )
    lines += [
        "",
        f"With trials the search grows as p = {_grows(of_trials, 'trials'):.2f}, the fit, from a cold start, as "
        f"p = {_grows(trials, 'trials'):.2f} (target: 1); the last step of the search costs {_last(of_trials)}.",
        "",
        "| samples, all trials | fit of Coulomb friction, s | us per sample | iterations |",
        "|---|---|---|---|",
    ]
    lines += [
        f"| {row['samples']:,} | {with_quartiles(row['seconds'])} "
        f"| {1e6 * row['seconds']['median'] / row['samples']:.1f} | {row['iterations']} |"
        for row in samples
    ]
    lines += [
        "",
        f"With samples the fit grows as p = {_grows(samples, 'samples'):.2f} (target: at most 1): a simulation's steps do not",
        "depend on how often it is read.",
    ]
    rival = found["sysid"]
    if rival is not None:
        each = full["seconds"]["median"] / full["hypotheses"]
        fitted = full["seconds"]["median"] / full["fitted"]
        lines += [
            "",
            f"One fit of mujoco.sysid on the same files (four values, {rival['iterations']} iterations, step "
            f"{rival['step']:g} s) takes {rival['seconds']:.1f} s: as long as {rival['seconds'] / each:,.0f} hypotheses of "
            f"the full search, most of which are screened only, or {rival['seconds'] / fitted:.0f} "
            "of its fitted ones (target: 10).",
        ]
    return "\n".join(lines)
