"""Diagnosis: time per hypothesis beside one fit of mujoco.sysid on the same files, and how it grows."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from spacerobot.diagnosis.candidates import candidate_sites
from spacerobot.diagnosis.pool import Pool, Task, Workshop
from spacerobot.diagnosis.search import Found, search
from spacerobot.recordings.study import load_study, resolve_study

NAME, TITLE = "diagnosis", "Diagnosis"
STUDY = "guide-friction"
PLAIN = (("coulomb_friction", "wrist"),)


def measure(quick: bool) -> dict[str, Any]:
    """Search with the full catalogue, its growth, and the rival."""
    study = load_study(resolve_study(STUDY))
    workshop = Workshop(study)
    mechanism = workshop.model.mechanism({**workshop.model.base, **workshop.trials[0].overrides})
    sites = candidate_sites(mechanism, workshop.model.believed)
    with Pool(workshop, 1) as pool:
        pool.here(Task((), {}))  # compiles
        baseline, base_seconds = _spent(lambda: pool.here(Task((), {})))
        assert baseline is not None

        def searched(count: int) -> Found:
            return search(pool, sites[:count], lambda *_: None, baseline=baseline)

        catalogue = []
        for count in [2] if quick else [len(sites) // 4, len(sites) // 2, len(sites)]:
            found, seconds = _spent(lambda count=count: searched(count))
            tried = len({*found.screened, *found.fits})
            catalogue.append({"sites": count, "hypotheses": tried, "fitted": len(found.fits), "seconds": seconds})
        ids = [t.id for t in workshop.trials]
        trials = []
        for count in [2] if quick else [3, 6, 12]:
            without = tuple(ids[count:])
            bare = pool.here(Task((), {}, without=without))
            assert bare is not None
            task = Task(PLAIN, {"coulomb_friction@wrist.force_N": 0.1}, near=None, without=without)
            _, seconds = _spent(lambda task=task: pool.here(task))
            trials.append({"trials": count, "seconds": seconds})
    return {
        "study": STUDY,
        "trials_in_study": len(ids),
        "baseline_seconds": base_seconds,
        "catalogue": catalogue,
        "trials": trials,
        "sysid": None if quick else _sysid(study),
    }


def _sysid(study: Any) -> dict[str, Any] | None:
    try:
        from spacerobot.proof.rivals import sysid as rival
        from spacerobot.proof.rivals.tracks import tracks_of

        tracks = tracks_of(study)
        _, seconds = _spent(lambda: rival._identified(study, tracks))
    except ImportError:
        return None
    return {"seconds": seconds, "iterations": rival.ITERATIONS, "step": rival.STEP}


def _spent(work: Callable[[], Any]) -> tuple[Any, float]:
    begun = time.process_time()
    found = work()
    return found, time.process_time() - begun


def page(found: dict[str, Any]) -> str:
    """Markdown."""
    full = found["catalogue"][-1]
    each = full["seconds"] / full["hypotheses"]
    lines = [
        f"`{found['study']}`, {found['trials_in_study']} trials, one core. A hypothesis is a set of effects and places that was",
        "screened or fitted; all its values are free in a fit, the trials' own starts too. Each number is one run.",
        "",
        f"Refit of the baseline alone: {found['baseline_seconds']:.2f} s.",
        "",
        "| places in the catalogue | hypotheses | of them fitted | search, s | s per hypothesis | s per place |",
        "|---|---|---|---|---|---|",
    ]
    for row in found["catalogue"]:
        lines.append(
            f"| {row['sites']} | {row['hypotheses']} | {row['fitted']} | {row['seconds']:.1f} "
            f"| {row['seconds'] / row['hypotheses']:.3f} | {row['seconds'] / row['sites']:.2f} |"
        )
    lines += ["", "| trials | fit of Coulomb friction from a cold start, s | s per trial |", "|---|---|---|"]
    lines += [
        f"| {row['trials']} | {row['seconds']:.2f} | {row['seconds'] / row['trials']:.3f} |" for row in found["trials"]
    ]
    rival = found["sysid"]
    if rival is not None:
        lines += [
            "",
            f"One fit of mujoco.sysid on the same files (four values, {rival['iterations']} iterations, step "
            f"{rival['step']:g} s) takes {rival['seconds']:.1f} s: as long as {rival['seconds'] / each:.0f} hypotheses of "
            f"the full search, most of which are screened only, or {rival['seconds'] / (full['seconds'] / full['fitted']):.0f} "
            "of its fitted ones (target: 10).",
        ]
    return "\n".join(lines)
