"""A diagnosis of machines other than a wrist rig: every joint, body and sensor of the study on its own."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TypeVar

import numpy as np

from spacerobot.diagnosis.answer.evidence import evidence_of_parts
from spacerobot.diagnosis.answer.learned import draft_of
from spacerobot.diagnosis.answer.mended_model import model_text
from spacerobot.diagnosis.answer.part_verdict import verdict_of
from spacerobot.diagnosis.answer.result import Diagnosis
from spacerobot.diagnosis.fitting.fit_store import Kept, Store
from spacerobot.diagnosis.learning.learned_part import LearnedPart, settle_part
from spacerobot.diagnosis.locate.of_model import locate_model
from spacerobot.diagnosis.locate.readings import NothingToBalance
from spacerobot.diagnosis.machines.contract import Machine, Refused
from spacerobot.diagnosis.machines.touch import Moment
from spacerobot.diagnosis.selection.both_ends import one_ended
from spacerobot.diagnosis.selection.checks import checks_of_part
from spacerobot.diagnosis.selection.conclusion import retained
from spacerobot.diagnosis.selection.felt import Felt
from spacerobot.diagnosis.selection.felt_together import Alone, Shapes, alone, felt_by, shapes_of, told
from spacerobot.diagnosis.selection.forward_selection import MOST, grow
from spacerobot.diagnosis.selection.meetings import meetings
from spacerobot.diagnosis.selection.moment import with_free_moment
from spacerobot.diagnosis.selection.one_amount import at_odds
from spacerobot.diagnosis.selection.one_clock import not_borne_out
from spacerobot.diagnosis.selection.part_fold import settled
from spacerobot.diagnosis.selection.part_limits import PartLimits
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.selection.search_state import Report, silent
from spacerobot.diagnosis.selection.shown_elsewhere import settled_by_others
from spacerobot.diagnosis.selection.stretches import bends, foretold, momentary, struck
from spacerobot.effects.effect import Effect
from spacerobot.effects.registry import all_effects, load_effects
from spacerobot.recordings.study import Study
from spacerobot.support.copies import Copies, Waiting
from spacerobot.support.workers import one_thread

T = TypeVar("T")


@dataclass(frozen=True)
class _Held:
    """What searches of the parts have in common.

    Attributes:
        models: the machines.
        without: effects to leave out of the catalogue.
        threads: of a part's fits.
        store: keeps them.
        report: told of progress; nobody from a process of its own.
        alone: parts that were asked what they feel together, once in each process.
    """

    models: Sequence[Machine]
    without: Sequence[str]
    threads: int
    store: Store | None
    report: Report
    alone: dict[int, Alone] = field(default_factory=dict)

    def catalogue(self) -> list[Effect]:
        """Effects on offer."""
        return [e for e in all_effects().values() if e.name not in self.without]


def diagnose_parts(
    study: Study,
    models: Sequence[Machine],
    *,
    report: Report,
    began: float,
    jobs: int = 1,
    seed: int = 0,
    without: Sequence[str] = (),
    files: Sequence[str] = (),
    store: Store | None = None,
) -> Diagnosis:
    """Say of each part of the study where simulation and recording part, and which physics was left out.

    Args:
        study: what the lab believes and recorded.
        models: its machines.
        report: told of progress.
        began: when the diagnosis did, as `time.perf_counter` has it.
        jobs: parts at a time, in processes of their own; of a single part, threads of its fits.
        seed: kept in the verdict; nothing hangs on it.
        without: effects to leave out of the catalogue.
        files: with further effects.
        store: keeps every finished fit, so that a diagnosis that was stopped goes on where it was.
    """
    every = range(len(models))
    alone = jobs if len(models) == 1 else 1
    held = _Held(models, without, alone, store, report)
    apart = partial(_apart, replace(held, report=silent), files)
    with Copies(held, min(jobs, len(models)), apart) as copies:

        def asked(
            some: Sequence[int], places: Sequence[str], known: Mapping[str, np.ndarray]
        ) -> list[tuple[Felt, Felt]]:
            return _done(copies.each(_felt, [(k, places, known) for k in some]), report, "what the parts feel together")

        shapes = shapes_of(models, held.catalogue(), asked)
        parts = _done(copies.each(_search, [(k, True, shapes) for k in every]), report, "searching the parts")
        if unlike := at_odds(parts):
            shapes = {label: form for label, form in shapes.items() if label not in unlike}
            some = sorted(set().union(*unlike.values()))
            anew = copies.each(_search, [(k, True, shapes) for k in some])
            parts = _with(parts, some, _done(anew, report, "searching again, each for itself"))
        if lone := one_ended(parts):
            anew = copies.each(_search, [(k, True, shapes, but) for k, but in lone.items()])
            parts = _with(parts, list(lone), _done(anew, report, "searching again, without what no other joint feels"))
        parts = settled_by_others(parts)
        again = sorted(not_borne_out(parts))
        anew = copies.each(_search, [(k, False, shapes, lone.get(k, frozenset())) for k in again])
        parts = _with(parts, again, _done(anew, report, "searching again, on one clock"))
        done = _done(copies.each(_judge, [(part,) for part in parts]), report, "locating and checking")
    report("judging", 0, 1)
    verdict = verdict_of(study, done, seed=seed, seconds=time.perf_counter() - began)
    evidence = evidence_of_parts(study, done, verdict)
    laws = [p.learnt for p in done if isinstance(p, LearnedPart) and p.learnt is not None]
    drafts = [draft for law in sorted(laws, key=lambda law: -law.lead) if (draft := draft_of(law)) is not None]
    return Diagnosis(
        verdict,
        evidence,
        parts=tuple(done),
        model=model_text(study, done),
        law_file=drafts[0] if drafts else None,
    )


def _apart(held: _Held, files: Sequence[str]) -> _Held:
    """In a process of its own."""
    for file in files:
        load_effects(file)
    return held


def _with(parts: Sequence[Part], places: Sequence[int], anew: Sequence[Part]) -> list[Part]:
    """The parts, some of them searched anew."""
    by = dict(zip(places, anew, strict=True))
    return [by.get(k, part) for k, part in enumerate(parts)]


def _done(waiting: Sequence[Waiting[T]], report: Report, what: str) -> list[T]:
    out = []
    for done, one in enumerate(waiting):
        report(what, done, len(waiting))
        out.append(one())
    return out


@one_thread()
def _felt(held: _Held, k: int, places: Sequence[str], known: Mapping[str, np.ndarray]) -> tuple[Felt, Felt]:
    """What numbers of what is at places that all parts share would do for one part."""
    if k not in held.alone:
        held.alone[k] = alone(held.models[k], held.catalogue())
    return felt_by(held.alone[k], places, known)


@one_thread()
def _search(held: _Held, place: int, relative: bool, shapes: Shapes, but: Refused = frozenset()) -> Part:
    """One part's search; without effects that act between clocks unless these are wanted, and without what is not."""
    model = told(held.models[place], shapes, but)
    how = ("" if relative else " on one clock") + (f" without {sorted(but)}" if but else "")
    what, kept = f"{model.name} ({place + 1} of {len(held.models)})", Kept(held.store, f"{place + 1} {model.name}{how}")
    offered = [] if model.not_measured else held.catalogue()  # nothing shows where nothing was read
    wanted = [e for e in offered if relative or not e.relative]
    return _searched(model, wanted, held.threads, partial(_tell, held.report, what), kept)


@one_thread()
def _judge(held: _Held, part: Part) -> Part:
    """A part with what was decided without each of its trials, and with what is checked or learned of it."""
    located = None
    with contextlib.suppress(NothingToBalance):
        located = locate_model(part.model, part.trials)
    growth, unseen = settled(part.growth)
    part = replace(part, growth=growth)
    checks = checks_of_part(part.model, part.trials, part.growth.before.fit, part.fit)
    if part.fit.hypothesis.sites:
        checks = (*checks, unseen.check(f"held out, {part.name}", whole=False))
    judged = replace(part, located=located, checks=checks, unseen=unseen)
    done = settle_part(judged, partial(_of, held.report, part.name))
    return replace(done, limits=tuple(PartLimits(done.growth).of(done.growth.sites)))


def _searched(
    model: Machine, catalogue: Sequence[Effect], threads: int, reached: Callable[[int], None], kept: Kept
) -> Part:
    """One part's search; where single trials show that it was knocked, once more with these cut there."""
    if met := meetings(model):
        model = model.apart(met)
    growth = grow(model, effects=catalogue, threads=threads, reached=reached, kept=kept)
    within = kept.within("with a free moment")
    if (free := with_free_moment(growth, within)) is not None:
        model, kept = free, within
        growth = grow(model, effects=catalogue, threads=threads, reached=reached, kept=kept)
    places = momentary(catalogue, model)
    found = bends(growth, places) if places else {}
    if not found:
        return Part(growth)

    def between(moments: Mapping[str, Sequence[Moment]], what: str) -> Part:
        cut = model.cut_at(moments)
        again = grow(cut, effects=catalogue, threads=threads, reached=reached, kept=kept.within(what))
        again = retained(again, growth.after)
        return Part(again, knocks=tuple(struck(again, moments, places)), uncut=growth)

    part = between(found, "between knocks")
    if not part.knocks:
        return Part(growth)
    if not (repeated := foretold(part.knocks, part.growth.bench.trials)):
        return part
    rest = {trial: [m for m in some if m.time not in repeated.get(trial, ())] for trial, some in found.items()}
    single = {trial: some for trial, some in rest.items() if some}
    return between(single, "between knocks of single trials") if single else Part(growth)


def _of(report: Report, part: str, what: str, done: int, total: int) -> None:
    report(f"{part}: {what}", done, total)


def _tell(report: Report, what: str, size: int) -> None:
    report(what, size, MOST)
