"""The front door: a study in, a verdict with its evidence out."""

from __future__ import annotations

import itertools
import os
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from spacerobot.diagnosis.answer.clock_offsets import clock_offsets
from spacerobot.diagnosis.answer.evidence import evidence_of_rig
from spacerobot.diagnosis.answer.held_out import of_rivals
from spacerobot.diagnosis.answer.learned import draft_of
from spacerobot.diagnosis.answer.next_trial import WHY_RIG, next_trial
from spacerobot.diagnosis.answer.record import NextExperiment
from spacerobot.diagnosis.answer.result import Diagnosis
from spacerobot.diagnosis.answer.verdict import verdict_of_rig
from spacerobot.diagnosis.fitting.fit_store import Apart, Store
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.mended_scene import scene_of
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Workshop
from spacerobot.diagnosis.learning.settle import settle
from spacerobot.diagnosis.locate.located import Located
from spacerobot.diagnosis.selection.admission import admit, has_wrist
from spacerobot.diagnosis.selection.beyond import NEAR, again, apart, of_whole_robot
from spacerobot.diagnosis.selection.check import why_not
from spacerobot.diagnosis.selection.decide import conclude
from spacerobot.diagnosis.selection.glimpse import glimpsed
from spacerobot.diagnosis.selection.intervals import with_intervals
from spacerobot.diagnosis.selection.judge import Judgement
from spacerobot.diagnosis.selection.limits import Limit, Limits
from spacerobot.diagnosis.selection.own_filter import own_labels, sought, with_filters
from spacerobot.diagnosis.selection.own_filter import told as own_filters_told
from spacerobot.diagnosis.selection.precompile import help_compiling
from spacerobot.diagnosis.selection.search import search
from spacerobot.diagnosis.selection.search_state import Found, Report, silent
from spacerobot.diagnosis.terms.candidates import acting_as
from spacerobot.diagnosis.terms.hypothesis import Label, Site
from spacerobot.diagnosis.terms.kinds import AMBIGUOUS, WRONG_PARAMETER
from spacerobot.effects.effect import Effect
from spacerobot.effects.registry import all_effects
from spacerobot.recordings.lacking import refuse_draft
from spacerobot.recordings.study import Study
from spacerobot.support.executors.base import Executor
from spacerobot.support.workers import one_thread

PASSES = 3
"""How often what was found of a robot that moves is fitted, each time about what the one before found."""


@one_thread()
def diagnose(
    study: Study,
    *,
    jobs: int | None = None,
    seed: int = 0,
    without: Sequence[str] = (),
    effects_files: Sequence[str] = (),
    report: Report = silent,
    store: Store | None = None,
    workers: Executor | None = None,
) -> Diagnosis:
    """Say where simulation and recording part, and which physics was left out.

    Args:
        study: what the lab believes and recorded: a wrist that meets a floating target, or any other machine, which
            is then diagnosed part by part (see `diagnose_parts`).
        jobs: processes; all cores if None.
        seed: kept in the verdict; nothing hangs on it: flips of signs and copies' noise are a quadrature, one for all.
        without: effects to leave out of the catalogue.
        effects_files: Python files with further effects (they are run).
        report: told of progress.
        store: keeps every finished fit, so that a diagnosis that was stopped goes on where it was.
        workers: that fit a wrist rig's hypotheses (a Dask cluster's, for instance) instead of this machine's processes.

    Raises:
        InputError: the study cannot be diagnosed: it is a draft, or nothing that was recorded can be compared with
            the baseline.
    """
    refuse_draft(study)
    began = time.perf_counter()
    report("reading the recordings", 0, 1)
    models = admit(study)
    jobs = jobs or os.cpu_count() or 1
    if not has_wrist(study):
        from spacerobot.diagnosis.diagnose_parts import diagnose_parts  # takes half a second to load

        return diagnose_parts(
            study,
            models,
            report=report,
            began=began,
            jobs=jobs,
            seed=seed,
            without=without,
            files=effects_files,
            store=store,
        )
    workshop = Workshop(study)
    if jobs > 1:
        help_compiling(workshop)
    effects = [e for e in all_effects().values() if e.name not in without]
    passed = itertools.count()

    def pooled(about: Workshop) -> Pool:
        number = next(passed)
        kept = store if store is None or not number else Apart(store, f"pass-{number}")
        return Pool(about, jobs, effects_files, kept, workers)

    workshop, near = glimpsed(of_whole_robot(workshop), pooled, effects, report)
    begin: Callable[[Pool], Found] = partial(_first, effects=effects, report=report, near=near)
    for number in range(PASSES):
        with pooled(workshop) as pool:
            # with the believed values: a refit that lacks the physics bends them until every balance is a little wrong
            locating = pool.aside(_located)
            decided = conclude(pool, begin(pool), report)
            found, chosen = decided.found, decided.judgement.chosen
            own = sought(pool, found, chosen, report)
            if number < PASSES - 1 and (own or apart(workshop, chosen) > NEAR):
                locating.cancel()
                if own:
                    begin = partial(again, found=found, report=report, but_for=partial(own_labels, workshop))
                    workshop = with_filters(workshop, own)
                else:
                    begin = partial(again, found=found, report=report)
                    workshop = of_whole_robot(workshop, chosen)
                continue
            report("intervals", 0, 1)
            decided, profiled = with_intervals(pool, decided)
            chosen = decided.judgement.chosen
            sizes = pool.aside(_limits, chosen, decided.found.singles, decided.inflation)  # beside what follows
            settled = settle(pool, decided, profiled, report)
            decided, judgement, held, learnt = settled.decided, settled.judgement, settled.held, settled.learnt
            found, left_of, inflation = decided.found, decided.left_of, decided.inflation
            if judgement.chosen is not chosen:
                sizes.cancel()
                looked_for = () if learnt else found.singles  # what hides beside a law without a name has no limit
                sizes = pool.aside(_limits, judgement.chosen, looked_for, inflation)
            report("locating", 0, 1)
            located = locating()
            smallest = sizes()
            break
    base = found.baseline
    further = (
        _next_trial(workshop, judgement.alternatives[:2])
        if judgement.verdict == AMBIGUOUS and len(judgement.alternatives) > 1
        else None
    )
    verdict = verdict_of_rig(
        study,
        workshop.model,
        workshop.trials,
        judgement,
        seed=seed,
        seconds=time.perf_counter() - began,
        inflation=inflation,
        located=located,
        held=held,
        limits=smallest,
        next_experiment=further,
        profiled=settled.profiled,
        why=[
            *why_not(settled.checks),
            *_not_shown(decided.withdrawn),
            *own_filters_told(study, workshop),
            *_stood_for(workshop, judgement),
        ],
        learnt=learnt,
        clocks=clock_offsets(study, workshop, judgement.chosen, inflation),
    )
    left = {f.hypothesis.label: left_of[id(f)] for f in [base, judgement.chosen] if id(f) in left_of}
    evidence = evidence_of_rig(
        study,
        workshop.trials,
        found,
        judgement,
        verdict,
        before=held.before.residual if held else base.residuals(),
        after=held.after.residual if held else judgement.chosen.residuals(),
        held_out=held is not None,
        unseen=of_rivals(workshop.trials, held),
        left=(left_of[id(base)], left_of.get(id(judgement.chosen), left_of[id(base)])),
        located=located,
        checks=settled.checks,
        withdrawn=decided.withdrawn,
    )
    scene = scene_of(study, workshop.model, judgement.chosen)
    draft = None if learnt is None else draft_of(learnt)
    return Diagnosis(verdict, evidence, found, judgement, left, scene=scene, law_file=draft)


def _first(pool: Pool, effects: Sequence[Effect], report: Report, near: Fit | None) -> Found:
    return search(pool, pool.workshop.model.sites(effects), report, near)


def _limits(workshop: Workshop, chosen: Fit, sites: Sequence[Site], inflation: float) -> list[Limit]:
    limits = Limits(workshop.fitter(), workshop.model.believed, chosen, inflation)
    return list(limits.of(sites))


def _next_trial(workshop: Workshop, pair: Sequence[Fit]) -> NextExperiment | None:
    """The middle trial at another speed, or with another target."""
    trial = workshop.trials[len(workshop.trials) // 2]
    starts = {trial.id: np.array([n.guess for n in workshop.model.nuisances(trial)])}
    return next_trial(pair, workshop.model, [trial], starts, why=WHY_RIG)


def _not_shown(withdrawn: Mapping[Label, str]) -> list[str]:
    return [f"{' + '.join(f'{e} at {w}' for e, w in label)} is not named: {why}" for label, why in withdrawn.items()]


def _located(workshop: Workshop) -> Located:
    from spacerobot.diagnosis.locate.locate import locate  # takes half a second to load, best in another process

    return locate(workshop.model, workshop.model.from_rest(workshop.trials))


def _stood_for(workshop: Workshop, judgement: Judgement) -> list[str]:
    """Of values that are stated wrongly, what else acts exactly so."""
    if judgement.verdict != WRONG_PARAMETER:
        return []
    free, values, plain = judgement.chosen.hypothesis.free, judgement.chosen.values(), workshop.model.plain()
    return [
        f"{one.phrase or one.title} at {where} acts exactly as {f.key}: it may be that instead"
        for f in free
        if f.key in judgement.moved
        for one, where in acting_as(plain, f.key, values[f.key] > f.centre)
    ]
