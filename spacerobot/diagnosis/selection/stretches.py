"""Knocks that struck bodies in single trials: found in what a choice leaves over, and cut out of it.

No other trial foretells a knock, so no held-out error can speak for it. It is found by what it does: momentum changes
at once (`locate/kinks.py`). The trial is cut there, each stretch with a start of its own, and the part's effects are
sought again; what lies between the end of one stretch and the start of the next is the knock.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.noise import correlation_time, reweighted, split
from spacerobot.diagnosis.fitting.profile import LEVEL_95
from spacerobot.diagnosis.locate.kinks import MARGIN, MOMENTS, Track, kinks
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.touch import Moment
from spacerobot.diagnosis.machines.windows import overlap
from spacerobot.diagnosis.selection.growth import Growth
from spacerobot.diagnosis.selection.held_out import start_of
from spacerobot.diagnosis.terms.data import TrialData
from spacerobot.effects.effect import Effect
from spacerobot.effects.primitives import Readout
from spacerobot.support.errors import SimulationError

FEW = 8
"""Predictions next to the end of a stretch by whose parabola its rate there is told: they are smooth."""

TRIFLE = 0.1
"""A stretch with less than this share of the rms that all stretches leave over has nothing missing that counts."""

CLEAR = 3.0
"""Standard errors from nothing at which a coordinate was struck: of several a few lie beyond two of them by chance."""

AFTER = 3.0
"""Uncertainties of a bend's moment within which a drive that changed may have made it."""

AGAIN = 3
"""Bends at changes of a drive that are its own doing: two may be chance."""

SPLIT = 2.0
"""Times the mean square of two windows that one over their common end leaves, where something happened there."""

FREELY = 1e-3
"""How much the readings at a window's start count beside all its readings, in telling how it begins."""

NEAR = 1e-3
"""Share of a stretch that may lie between it and the next."""


@dataclass(frozen=True)
class Knock:
    """What struck a body in one trial.

    Attributes:
        effect: of the catalogue that it is.
        where: the coordinate that it changed.
        trial: the only one in which it acts.
        moment: when.
        impulse: what it brought [N s or N m s], with its 95 % interval.
    """

    effect: Effect
    where: str
    trial: str
    moment: Moment
    impulse: tuple[float, float, float]


def momentary(catalogue: Iterable[Effect], model: Machine) -> dict[str, Effect]:
    """The effects that strike once, by the places at which they may."""
    plain = model.plain()
    return {where: e for e in catalogue if e.once for where in e.places(plain)}


def bends(growth: Growth, places: Mapping[str, Effect]) -> dict[str, list[Moment]]:
    """By recorded trial, the moments at which what the choice leaves over is bent.

    Not where a stretch is predicted far better than all are: nothing that counts is missing there. Nor when a recorded
    drive changes, if that comes again or is told no better than to a while: what is wrong with a drive bends a track at
    many of its changes. That a controller answers a knock is no reason against it.
    """
    bench = growth.bench
    windows = _left(growth)
    own = _tracked(growth, windows, places)
    least = TRIFLE**2 * float(np.mean([_mean_square(some) for _, some in own])) if own else 0.0
    bent = _kinks(own, least)
    # a corner at a window's end is told by one that goes on there, and leaves more than either
    for shifted in _tracked(growth, _left(growth, _between([t for t, _ in windows])), places):
        sides = [(t, _mean_square(some)) for t, some in own if overlap(t, shifted[0])]
        most = max((square for _, square in sides), default=0.0)
        ends = [(t.end, 2.0 * MARGIN * (t.end - t.start)) for t, _ in sides]
        found = _kinks([shifted], max(least, SPLIT * most))
        bent += [(t, m) for t, m in found if any(abs(m.time - at) < near for at, near in ends)]
    driven = [_driven(bench.model, t, m) for t, m in bent]
    out: dict[str, list[Moment]] = {}
    for (trial, moment), with_drive in zip(bent, driven, strict=True):
        apart = 2.0 * MARGIN * (trial.end - trial.start)
        if not with_drive or (sum(driven) < AGAIN and moment.high - moment.low < apart):
            out[trial.recorded] = _told_apart([*out.get(trial.recorded, []), moment], apart)
    return {name: some for name, some in out.items() if some}


def _tracked(
    growth: Growth, rest: Iterable[tuple[TrialData, np.ndarray]], places: Mapping[str, Effect]
) -> list[tuple[TrialData, list[Track]]]:
    """Of windows with what is left over of them, the tracks of what may be struck."""
    model, fit = growth.bench.model, growth.after.fit
    both = ((t, [k for k, r in _tracks(model, fit, t, left) if r.of in places]) for t, left in rest)
    return [(t, tracks) for t, tracks in both if tracks]


def _kinks(tracked: Iterable[tuple[TrialData, list[Track]]], least: float) -> list[tuple[TrialData, Moment]]:
    """Where they are bent, of those of which more than this mean square is left over."""
    return [(t, m) for t, tracks in tracked if _mean_square(tracks) > least for m in kinks(tracks)]


def _driven(model: Machine, trial: TrialData, moment: Moment) -> bool:
    """Whether a recorded drive changed when the track is bent, as well as that is told."""
    return not model.steady(trial, moment.low - AFTER * (moment.high - moment.low), moment.high)


def _between(windows: Sequence[TrialData]) -> dict[str, list[Moment]]:
    """By trial that is cut into windows, the middles of these: no corner can be told from a window's own start."""
    middles: dict[str, list[Moment]] = {}
    for t in windows:
        middle = 0.5 * (t.start + t.end)
        middles.setdefault(t.recorded, []).append(Moment(middle, middle, middle))
    return {name: some for name, some in middles.items() if len(some) > 1}


def _left(growth: Growth, cuts: Mapping[str, Sequence[Moment]] | None = None) -> list[tuple[TrialData, np.ndarray]]:
    """What the choice leaves over of every window, shape (S,) each; those that no fit looked at begin as they show.

    Args:
        growth: that led to the choice.
        cuts: by trial, where its windows end instead; of other trials none is looked at.
    """
    bench, fit = growth.bench, growth.after.fit
    if cuts is None:
        out = [(t, fit.trials[t.id].residual) for t in bench.trials]
        every = bench.model.everything()
        others = [t for t in every.trials if t.id not in fit.trials]
    else:
        out, every = [], bench.model.cut_at(cuts).everything()
        others = [t for t in every.trials if t.recorded in cuts]
    fitter = Fitter(every, reweighted(others, bench.weights))
    for trial in fitter.trials:
        with contextlib.suppress(SimulationError):
            start = start_of(fitter, every, fit.hypothesis, fit.z, trial, head=1.0, trust=FREELY)
            residual, keep = fitter.residual(fit.hypothesis, fit.z, trial, start)
            out.append((trial, np.where(keep, residual, 0.0)))
    return sorted(out, key=lambda one: (one[0].recorded, one[0].start))


def _mean_square(tracks: Sequence[Track]) -> float:
    return float(np.mean(np.concatenate([t.rest for t in tracks]) ** 2))


def _told_apart(moments: Sequence[Moment], least: float) -> list[Moment]:
    """Moments that are closer than this [s] are one: a touch that lasted a little."""
    out: list[Moment] = []
    for one in sorted(moments, key=lambda m: m.time):
        if out and one.time - out[-1].time < least:
            last = out.pop()
            begun, ended = last.begins, one.ends
            lasts = ended - begun, max(one.low - last.high, 0.0), ended - begun
            one = Moment(0.5 * (begun + ended), last.low, max(last.high, one.high), lasts)
        out.append(one)
    return out


def _tracks(model: Machine, fit: Fit, trial: TrialData, left: np.ndarray) -> list[tuple[Track, Readout]]:
    """What a fit leaves over, shape (S,), of each channel that shows a coordinate itself."""
    mechanism = model.trial_mechanism(fit.hypothesis, fit.z, trial)
    rest, out = split(left, trial), []
    for channel, residual in rest.items():
        readout = mechanism.readouts.get(channel)
        if readout is None or readout.kind not in ("position", "velocity"):
            continue
        good = next(b.weight[b.channels.index(channel)] > 0.0 for b in trial.blocks if channel in b.channels)
        if good.sum() > 4:
            out.append((Track(trial.channel(channel)[0], residual[good], readout.kind == "velocity"), readout))
    return out


def struck(growth: Growth, moments: Mapping[str, Sequence[Moment]], places: Mapping[str, Effect]) -> list[Knock]:
    """How large each knock was, by what lies between the stretches before and after it.

    A coordinate whose jump is not clear was not struck.
    """
    model, fit, out = growth.bench.model, growth.after.fit, []
    pieces = sorted(growth.bench.trials, key=lambda t: t.start)
    for trial, some in moments.items():
        own = [p for p in pieces if p.recorded == trial]
        for moment in some:
            before = next((p for p in reversed(own) if p.end <= moment.time + NEAR * (p.end - p.start)), None)
            after = next((p for p in own if p.start >= moment.time - NEAR * (p.end - p.start)), None)
            if before is None or after is None or not _meet(before, after, moment):
                continue
            one, other = (_rates(model, fit, piece, moment.time) for piece in (before, after))
            jump = {w: other[w][0] - one[w][0] for w in places if w in one and w in other}
            error = {w: float(np.hypot(one[w][1], other[w][1])) for w in jump}
            mechanism = model.trial_mechanism(fit.hypothesis, fit.z, before)
            brought = model.impulse(mechanism, before, jump)
            for where, value in brought.items():
                alone = abs(model.impulse(mechanism, before, {w: error[w] * (w == where) for w in jump})[where])
                wide = float(np.sqrt(LEVEL_95)) * alone
                if abs(value) > CLEAR * alone:
                    out.append(Knock(places[where], where, trial, moment, (value, value - wide, value + wide)))
    return out


def foretold(knocks: Sequence[Knock], trials: Sequence[TrialData]) -> dict[str, set[float]]:
    """By recorded trial, the moments of knocks that another trial had as well: so late in it, and the same way.

    What comes again is no accident. It is something that the machine does and its model leaves out; its shares in all
    trials would be taken for as many knocks. At random one knock in a hundred would be so: moments agree to one of
    those that are tried, and so do the signs of two coordinates.
    """
    begins = {name: min(t.start for t in trials if t.recorded == name) for name in {t.recorded for t in trials}}
    length = {name: max(t.end for t in trials if t.recorded == name) - start for name, start in begins.items()}
    kicks: dict[tuple[str, float], dict[str, float]] = {}
    for k in knocks:
        kicks.setdefault((k.trial, k.moment.time), {})[k.where] = k.impulse[0]
    out: dict[str, set[float]] = {}
    for (trial, time), size in kicks.items():
        for (other, again), other_size in kicks.items():
            apart = abs((time - begins[trial]) - (again - begins[other]))
            both = size.keys() & other_size.keys()
            alike = len(both) > 1 and all(size[w] * other_size[w] > 0.0 for w in both)
            if trial != other and alike and apart < min(length[trial], length[other]) / MOMENTS:
                out.setdefault(trial, set()).add(time)
    return out


def _meet(before: TrialData, after: TrialData, moment: Moment) -> bool:
    reach = 0.5 * min(before.end - before.start, after.end - after.start)
    return moment.low - before.end < reach and after.start - moment.high < reach


def _rates(model: Machine, fit: Fit, trial: TrialData, at: float) -> dict[str, tuple[float, float]]:
    """By coordinate, its rate at one end of a stretch as predicted, and that number's standard deviation.

    That is how well a line through the stretch's readings is known, where neighbours err alike.
    """
    out: dict[str, tuple[float, float]] = {}
    for track, readout in _tracks(model, fit, trial, fit.trials[trial.id].residual):
        time, value, weight = trial.channel(readout.channel)
        rest = track.rest / weight
        shown = readout.sign * (value + rest)
        scatter = float(np.sqrt(np.mean(rest**2) * correlation_time(rest)))
        some = np.argsort(np.abs(time - at))[:FEW]
        *_, slope, value_there = np.polyfit(time[some] - at, shown[some], 2)
        if track.rate:
            found = float(value_there), scatter / float(np.sqrt(time.size))
        else:
            found = float(slope), scatter / float(np.sqrt(np.square(time - time.mean()).sum()))
        if readout.of not in out or found[1] < out[readout.of][1]:
            out[readout.of] = found
    return out
