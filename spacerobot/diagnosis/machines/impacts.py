"""Impacts recorded as pairs of states, just before and just after: which impulse lies between them.

With the contact's Jacobian rows n (normal) and d (tangent) the impulse (p_n, p_t) changes the velocity by
M^-1 (n p_n + d p_t). Coulomb's law holds at every moment of it, so that sliding may end, or turn round, within the
impact (Routh's diagram); Poisson's restitution is the ratio of the impulses after and before the contact is most
compressed (Wang and Mason 1992, J. Appl. Mech. 59, 635-642). Without friction that is Newton's restitution.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from spacerobot.diagnosis.machines.contract import FIRST_NOISE, Machine, Predicted, conditions_of
from spacerobot.diagnosis.machines.doubted import doubted
from spacerobot.diagnosis.machines.measured import through_sensor
from spacerobot.diagnosis.machines.windows import PIECES
from spacerobot.diagnosis.terms.data import Block, TrialData, piece_id
from spacerobot.diagnosis.terms.hypothesis import Believed, Site
from spacerobot.effects.effect import Effect
from spacerobot.effects.laws import CONTACT
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Contact, Coordinate
from spacerobot.effects.sizes import Sizes
from spacerobot.recordings.recording import Recording
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial

AXES = ("x", "y", "yaw")
BEFORE = tuple(f"body.velocity.{a}.before" for a in AXES)
AFTER = tuple(f"body.velocity.{a}.after" for a in AXES)
NORMAL = tuple(f"aux.normal_{a}" for a in AXES)
TANGENT = tuple(f"aux.tangent_{a}" for a in AXES)

HALF = 0.5
"""Restitution to begin with where it is not stated."""


OUTSIDE = 0.1
"""Share of what changes in impacts that may lie beside every impulse: velocities are good to some percent."""

MUCH = 4.0
"""How many times less a turned sign must leave to be the right one."""


class Impacts(Machine):
    """Velocities after planar impacts, from those before and the contact's geometry."""

    metric = "velocities after the impact"
    given = frozenset((*BEFORE, *NORMAL, *TANGENT))
    no_balance = "an impact is recorded as before and after, with nothing in between over which a balance could run"

    def __init__(self, study: Study, trials: Sequence[Trial]) -> None:
        self.name = "impacts"
        values = {n: v for n, v in study.values().items() if n.startswith("body.")}
        unknown = {n: HALF for n in ("body.restitution",) if n in study.baseline.unknown}
        self.base = {"body.restitution": 1.0, **values}
        self.doubted = doubted(study, trials, {*BEFORE, *AFTER, *NORMAL, *TANGENT})
        self._rows: dict[str, dict[str, np.ndarray]] = {}
        cut: list[TrialData] = []
        every = [study.recording(t) for t in trials]
        speed = np.sqrt([np.mean(np.concatenate([r[c].good()[1] for r in every]) ** 2) for c in AFTER])
        for trial, recording in zip(trials, every, strict=True):
            known = {c: recording[c].value for c in (*BEFORE, *NORMAL, *TANGENT)}
            for n, index in enumerate(np.array_split(np.arange(len(recording[AFTER[0]])), PIECES)):
                name, blocks = piece_id(trial.id, n), []
                self._rows[name] = {c: v[index] for c, v in known.items()}
                fine = np.all([np.isfinite(v) for v in self._rows[name].values()], axis=0)
                for channel, size in zip(AFTER, speed, strict=True):
                    series = recording[channel]
                    noise = series.sigma if series.sigma_stated else FIRST_NOISE * float(size)
                    good = series.valid[index] & fine
                    value, weight = np.where(good, series.value[index], 0.0), np.where(good, 1.0 / noise, 0.0)
                    block = Block(series.stream, (channel,), series.time[index], value[None], weight[None])
                    blocks.append(block)
                time = blocks[0].time
                span = float(time[0]), float(time[-1])
                cut.append(TrialData(name, study.condition(trial), {}, tuple(blocks), *span))
        self.trials = tuple(cut)
        self._noise = self._stated(every)
        self.sizes: Mapping[str, Sizes] = {"": Sizes(1.0, 1.0, 1.0, float(speed[0]))}
        sigma = {n: s for n, s in study.sigma.items() if n in self.base}
        self.believed = Believed(self.base, sigma, {}, conditions_of(cut), unknown, zeros=self.doubted.sigma)

    @staticmethod
    def _stated(recordings: Sequence[Recording]) -> np.ndarray | None:
        """Noise of the velocities after and before, shape (2, 3), where the first is stated; unless stated, the second
        is as the first."""
        after = [[r[c].sigma for r in recordings if r[c].sigma_stated] for c in AFTER]
        if not all(after):
            return None
        before = [
            [r[c].sigma for r in recordings if r[c].sigma_stated] or own for c, own in zip(BEFORE, after, strict=True)
        ]
        return np.array([[np.median(some) for some in both] for both in (after, before)])

    def expected(self, values: Mapping[str, float]) -> dict[str, float]:
        """Of the velocities after, with what an impact without friction makes of those before."""
        if self._noise is None:
            return {}
        known = {**self.base, **values}
        inverse = np.array([1.0 / known[f"body.{n}"] for n in ("mass", "mass", "yaw_inertia")])
        n = np.concatenate([np.array([rows[c] for c in NORMAL]) for rows in self._rows.values()], axis=1)
        n = n[:, np.isfinite(n).all(axis=0) & (np.abs(n).sum(axis=0) > 0.0)]
        share = (1.0 + known["body.restitution"]) / (inverse @ n**2)
        turned = np.eye(3)[..., None] - share * inverse[:, None, None] * n[:, None] * n  # (3, 3, T)
        made = np.einsum("ijt,j->it", turned**2, self._noise[1] ** 2).mean(axis=1)
        return dict(zip(AFTER, np.sqrt(self._noise[0] ** 2 + made).tolist(), strict=True))

    def contradiction(self) -> tuple[str, str]:
        """Whether impulses along the rows account for what changes far better with a yaw counted the other way."""
        masses = [self.base[f"body.{n}"] for n in ("mass", "mass", "yaw_inertia")]
        inverse = np.sqrt(1.0 / np.array(masses))[:, None]
        blocks = [[np.where(b.weight[0] > 0.0, b.value[0], np.nan) for b in t.blocks] for t in self.trials]
        rows = [[np.array([self._rows[t.id][c] for c in n]) for n in (BEFORE, NORMAL, TANGENT)] for t in self.trials]
        before, normal, tangent = (np.concatenate(own, axis=1) for own in zip(*rows, strict=True))
        change = (np.concatenate(blocks, axis=1) - before) / inverse
        normal, tangent = inverse * normal, inverse * tangent
        turned = np.array([[1.0], [1.0], [-1.0]])
        left = _outside(change, normal, tangent)
        ways = {
            "aux.tangent_yaw": _outside(change, normal, turned * tangent),
            "aux.normal_yaw": _outside(change, turned * normal, tangent),
            "body.velocity.yaw, before and after": _outside(turned * change, normal, tangent),
        }
        best = min(ways, key=lambda name: ways[name])
        if not left > max(OUTSIDE, MUCH * ways[best]):
            return "", ""
        shares = f"{left:.1%} of what changes is left, {ways[best]:.1%} with {best} turned round"
        return f"no impulses along aux.normal and aux.tangent make these impacts: {shares}", f"scale = -1.0 at {best}"

    def sites(self, effects: Iterable[Effect] | None = None) -> list[Site]:
        """Those that an impulse shows."""
        return [s for s in super().sites(effects) if s.effect.instant]

    def mechanism(self, values: Mapping[str, float], trial: TrialData) -> Mechanism:
        """A body in the plane and its contact; the contact's one parameter is its restitution."""
        mass, inertia = values["body.mass"], values["body.yaw_inertia"]
        coordinates = {
            "target": Coordinate("target", mass),
            "target.y": Coordinate("target.y", mass),
            "target.yaw": Coordinate("target.yaw", inertia, angular=True),
        }
        (stream,) = dict.fromkeys(b.stream for b in trial.blocks)
        return Mechanism(
            coordinates=coordinates,
            ports={n: {n: 1.0} for n in coordinates},
            contact=Contact(CONTACT, (values["body.restitution"], 0.0)),
            sensors={stream: AFTER},
        )

    def predict(self, mechanism: Mechanism, trial: TrialData, initial: np.ndarray) -> Predicted:
        """The velocities after each impact."""
        rows, time = self._rows[trial.id], trial.blocks[0].time
        before, n, d = (
            np.array([rows[c] + self.doubted.brought(mechanism, trial.recorded, c, time) for c in names])
            for names in (BEFORE, NORMAL, TANGENT)
        )
        inverse = np.array([1.0 / mechanism.coordinates[k].mass for k in ("target", "target.y", "target.yaw")])
        assert mechanism.contact is not None
        restitution = mechanism.contact.p[0]
        mu = sum(f.p[0] for f in mechanism.frictions if f.normal == "contact")
        after = before + inverse[:, None] * _impulse(before, n, d, inverse, restitution, mu)
        out = []
        for k, channel in enumerate(AFTER):
            maps = tuple(m for m in mechanism.maps if m.channel == channel)
            out.append(through_sensor(maps, after[k], 1.0)[None])
        self.take_off_beside(out, mechanism, trial)
        return Predicted(tuple(out))


def _outside(change: np.ndarray, normal: np.ndarray, tangent: np.ndarray) -> float:
    """Share of the changes that no impulses along the rows make, all (3, T) in roots of energy; 0 without any."""
    across = np.cross(normal, tangent, axis=0)
    size = np.linalg.norm(across, axis=0)
    told = np.isfinite(size) & (size > 0.0) & np.isfinite(change).all(axis=0)
    whole = float(np.sum(change[:, told] ** 2))
    beside = float(np.sum(np.sum(change * across, axis=0)[told] ** 2 / size[told] ** 2))
    return float(np.sqrt(beside / whole)) if whole > 0.0 else 0.0


def _impulse(
    v: np.ndarray, n: np.ndarray, d: np.ndarray, inverse: np.ndarray, restitution: float, mu: float
) -> np.ndarray:
    """Generalised impulse, shape (3, T), of contacts that close with n . v and slide with d . v, all (3, T).

    Closing and sliding speed are lines over the normal impulse so far, with a kink where the sliding ends: then it
    sticks, or slides on the other way where friction cannot hold it. Compression ends where the contact no longer
    closes; restitution adds its share of the impulse until then.
    """
    nn, nd, dd = ((a * inverse[:, None] * b).sum(axis=0) for a, b in ((n, n), (n, d), (d, d)))
    closing, sliding = (n * v).sum(axis=0), (d * v).sum(axis=0)
    first = -mu * np.sign(sliding)  # tangential over normal impulse, while it slides
    holding = -nd / dd  # and where it sticks
    then = np.clip(holding, -mu, mu)
    slows = (nd + dd * first) * sliding < 0.0
    kink = np.full_like(sliding, np.inf)
    kink[slows] = -sliding[slows] / (nd + dd * first)[slows]
    kink[sliding == 0.0] = 0.0
    opens, opens_then = nn + nd * first, nn + nd * then  # the second is positive, as the inertia matrix is
    with np.errstate(divide="ignore", invalid="ignore"):
        before_kink = -closing / opens
        after_kink = kink - (closing + opens * kink) / opens_then
    compression = np.where((opens > 0.0) & (before_kink <= kink), before_kink, after_kink)
    normal = (1.0 + restitution) * compression
    tangent = first * np.minimum(normal, kink) + then * np.maximum(normal - kink, 0.0)
    return np.asarray(n * normal + d * tangent)


def impact_models(study: Study) -> list[Machine]:
    """The model of impacts of a planar body; none for other studies."""
    if any(study.value(n) is None for n in ("body.mass", "body.yaw_inertia")):
        return []
    wanted = {*BEFORE, *AFTER, *NORMAL, *TANGENT}
    trials = [t for t in study.trials if wanted <= set(_names(study.recording(t)))]
    return [Impacts(study, trials)] if trials else []


def _names(recording: Recording) -> list[str]:
    return list(recording)
