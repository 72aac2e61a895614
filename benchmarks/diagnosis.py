"""Diagnosis: time per hypothesis beside one fit of mujoco.sysid on the same files, and how it grows."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any

from benchmarks.diagnosis_page import page as page
from benchmarks.timing import spread
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.pool import Pool
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.selection.search import search
from spacerobot.diagnosis.terms.candidates import candidate_sites
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.diagnosis.terms.hypothesis import Label
from spacerobot.recordings.study import Study, load_study, resolve_study

NAME, TITLE = "diagnosis", "Diagnosis"
STUDY = "guide-friction"
PLAIN, START = (("coulomb_friction", "wrist"),), {"coulomb_friction@wrist.force_N": 0.1}


def measure(quick: bool) -> dict[str, Any]:
    """Search with the full catalogue, its growth, and the rival."""
    study = load_study(resolve_study(STUDY))
    whole = _Bench(study)
    trials, places, repeats = len(whole.workshop.trials), len(whole.sites), 1 if quick else 5
    catalogue = [2] if quick else [places // 4, places // 2, places]
    counts = [2, trials] if quick else [3, 6, trials]
    thinned = [4] if quick else [4, 2, 1]
    searches = [whole.searched(n, min(repeats, 3)) for n in catalogue]
    fewer = [{**_Bench(study, n).searched(catalogue[0], min(repeats, 3)), "trials": n} for n in counts[:-1]]
    return {
        "study": STUDY,
        "trials_in_study": trials,
        "baseline": _repeated(lambda: whole.fitted((), {}), repeats),
        "catalogue": searches,
        "trials": [{**_Bench(study, n).one_fit(repeats), "trials": n} for n in counts],
        "samples": [_Bench(study, every=n).one_fit(repeats) for n in thinned],
        "search_of_trials": [*fewer, {**searches[0], "trials": trials}],
        "sysid": None if quick else _sysid(study),
    }


class _Bench:
    """The first trials of the study, every so many samples of them, ready to be fitted by this process."""

    def __init__(self, study: Study, count: int | None = None, every: int = 1) -> None:
        self._of = study, count, every
        self.workshop = self._opened()
        model = self.workshop.model
        mechanism = model.mechanism({**model.base, **self.workshop.trials[0].overrides})
        self.sites = candidate_sites(mechanism, model.believed)
        self.fitted((), {})  # compiles

    def _opened(self) -> Workshop:
        study, count, every = self._of
        workshop = Workshop(study)
        workshop.trials = tuple(_thinned(t, every) for t in workshop.trials[:count])
        workshop.model = workshop.make_model(study, workshop.trials)
        return workshop

    def fitted(self, label: Label, start: dict[str, float]) -> Fit:
        found = self.workshop.run(Task(label, start))
        assert found is not None
        return found

    def one_fit(self, repeats: int) -> dict[str, Any]:
        """Of Coulomb friction, from a cold start."""
        fit = self.fitted(PLAIN, START)
        samples = sum(t.samples for t in self.workshop.trials)
        seconds = _repeated(lambda: self.fitted(PLAIN, START), repeats)
        return {"samples": samples, "iterations": fit.iterations, "seconds": seconds}

    def searched(self, places: int, repeats: int) -> dict[str, Any]:
        """The search among the first places of the catalogue, from the baseline's fit on."""
        found, taken = None, []
        for _ in range(repeats):
            with Pool(self._opened(), 1) as pool:  # anew each time: fitters remember derivatives
                found, seconds = _spent(lambda pool=pool: search(pool, self.sites[:places], lambda *_: None))
            taken.append(seconds)
        assert found is not None
        tried = len({*found.screened, *found.fits})
        return {"sites": places, "hypotheses": tried, "fitted": len(found.fits), "seconds": asdict(spread(taken))}


def _thinned(trial: TrialData, every: int) -> TrialData:
    blocks = (
        replace(b, time=b.time[::every], value=b.value[:, ::every], weight=b.weight[:, ::every]) for b in trial.blocks
    )
    return replace(trial, blocks=tuple(blocks))


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


def _repeated(work: Callable[[], object], repeats: int) -> dict[str, float]:
    return asdict(spread([_spent(work)[1] for _ in range(repeats)]))
