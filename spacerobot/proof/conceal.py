"""Hiding physics in a campaign, one way for each kind of concealment."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.fitting.starts import fit_from
from spacerobot.diagnosis.machines.wrist_rig import RigModel
from spacerobot.diagnosis.terms.data import trial_data
from spacerobot.proof.campaign import Belief, Campaign, Readings, noisy, perform, write_study
from spacerobot.proof.draws import by_factors, to_digits
from spacerobot.proof.engine.laws import LARGEST, LAWS
from spacerobot.proof.orders import COVERED, Order
from spacerobot.proof.scenes import hideable, scene
from spacerobot.proof.sizes import Kind, kind, peak_stroke
from spacerobot.proof.spoiled import WAYS
from spacerobot.proof.strength import DRAWN, NEAR, Strength, measure, reach
from spacerobot.proof.whole.orders import FAMILY
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError
from spacerobot.support.scratch import scratch


@dataclass(frozen=True, eq=False)
class Concealed:
    """A campaign ready to be sealed.

    Attributes:
        campaign: with what is hidden in it, and the belief that the lab will state.
        readings: as recorded.
        expected: what an honest answer says: "named", "wrong_parameter", "nothing_missing", "learned" or "unknown";
            "spoiled" where it names what is hidden, or says what the recordings suffer from.
        parameters: believed values that are wrong, where that is what is hidden; where nothing is, those that may be
            called wrong, because they were drawn that far off.
        withheld: effect that the diagnosis must do without, None if it has them all.
        strength: size in detection limits, None where nothing is hidden.
        variance_ratio: residual variance after the baseline's refit over the noise variance.
        way: of `WAYS` in which the recordings are spoiled; none where they are as the study says.
    """

    campaign: Campaign
    readings: Readings
    expected: str
    parameters: tuple[str, ...] = ()
    withheld: str | None = None
    strength: float | None = None
    variance_ratio: float = 1.0
    way: str = ""

    def about(self) -> dict[str, Any]:
        """What the seal says beside the effects."""
        return {
            "expected": self.expected,
            "parameters": list(self.parameters),
            "withheld": self.withheld,
            "strength": self.strength,
            "variance_ratio": self.variance_ratio,
            "spoiled": self.way,
            "contact.damping": self.campaign.as_built.get("contact.damping"),
        }


STRONG = (3.0, 40.0)
"""Strengths, in detection limits, between which an ordinary hidden effect is drawn, evenly in the logarithm."""

APART = {
    "hertz_contact": "law",
    "hunt_crossley": "law",
    "coulomb_friction": "dry",
    "stribeck_friction": "dry",
    "asymmetric_friction": "dry",
}
"""Of two hidden effects, no more than one of a group; and never two at one sensor."""

TUNED = {
    "cubic_stiffness": "wrist.stiffness",
    "backlash": "wrist.stiffness",
    "end_stop": "wrist.stiffness",
    "arm_compliance": "wrist.stiffness",
    "hertz_contact": "contact.stiffness",
    "hunt_crossley": "contact.stiffness",
}
"""Which constant a lab would have tuned so that one speed looks right; equivalent damping for all others."""

WRONG = {
    "wrist.stiffness": ((0.06, 0.15), (-0.12, -0.05)),
    "wrist.mass": ((0.08, 0.2), (-0.18, -0.07)),
    "wrist.equivalent_damping": ((3.5, 5.0), (-0.6, -0.48)),
    "contact.stiffness": ((0.2, 0.5), (-0.4, -0.15)),
    "target.mass": ((0.015, 0.04), (-0.04, -0.015)),
    "target.yaw_inertia": ((0.12, 0.3), (-0.25, -0.1)),
}
"""Believed value -> shares by which it may be wrong; at least five standard deviations of the believed value."""


def conceal(order: Order) -> Concealed:
    """Make the campaign of an order.

    Raises:
        SimulationError, InputError: it could not be made; the batch draws another.
    """
    rng = np.random.default_rng(order.seed)
    return MAKERS[order.kind.split()[0]](order, rng)


def _nothing(order: Order, rng: np.random.Generator) -> Concealed:
    campaign = scene(order.family, rng)
    return Concealed(campaign, noisy(campaign, perform(campaign)), "nothing_missing", parameters=campaign.unlucky())


def _wrong_value(order: Order, rng: np.random.Generator) -> Concealed:
    campaign = scene(order.family, rng)
    choices = [n for n in WRONG if n in campaign.belief.sigma]
    name = str(rng.choice(choices))
    share = float(rng.uniform(*WRONG[name][int(rng.integers(2))]))
    belief, built, trials = campaign.belief, campaign.as_built, campaign.trials
    if name in belief.values:
        true = built[name]
        digits = 4 - int(np.floor(np.log10(abs(true))))
        belief = replace(belief, values={**belief.values, name: round(true * (1.0 + share), digits)})
    else:
        trials = tuple(
            replace(t, overrides={**t.overrides, name: round(float(t.overrides[name]) * (1.0 + share), 3)})
            for t in trials
        )
        built = {**built, f"{name} over believed": built[f"{name} over believed"] / (1.0 + share)}
    changed = replace(campaign, belief=belief, as_built=built, trials=trials)
    return Concealed(changed, noisy(changed, perform(changed)), "wrong_parameter", parameters=(name,))


def _unlabelled(order: Order, rng: np.random.Generator) -> Concealed:
    def choose(key: tuple[str, str]) -> bool:  # of a whole machine, joints and the wrist in turn
        return order.family != FAMILY or (key[1] == "wrist") == bool(order.number % 2)

    hidden, found = _one(order, rng, limits=order.limits or _strength(rng), choose=choose)
    return _as_effect(order, hidden, found)


def _masked(order: Order, rng: np.random.Generator) -> Concealed:
    hidden, found = _one(order, rng, limits=_strength(rng, lowest=6.0), choose=lambda k: k[1] != "mocap")
    campaign = mask(hidden, found.clean)
    return _as_effect(order, campaign, found)


def _weak(order: Order, rng: np.random.Generator) -> Concealed:
    hidden, found = _one(order, rng, variance_ratio=float(order.kind.split()[1]))
    return _as_effect(order, hidden, found)


def _rare(order: Order, rng: np.random.Generator) -> Concealed:
    campaign = scene(order.family, rng)
    strokes = sorted(peak_stroke(t) for t in campaign.trials)
    choice = str(rng.choice(["end_stop", "external_impulse"]))
    if choice == "end_stop":
        travel = strokes[-2] + 0.35 * (strokes[-1] - strokes[-2])
        made = Kind("end_stop", "wrist", lambda s: {"travel_m": travel, "stiffness_N_m": 1e3 * s}, 200.0)
    else:
        drawn = kind("external_impulse", "target", rng, campaign)
        made = replace(drawn, trials=(int(rng.integers(len(campaign.trials))),))
    hidden, found = reach(campaign, made, limits=_strength(rng, lowest=5.0), near=DRAWN)
    return _as_effect(order, hidden, found)


def _imitated(order: Order, rng: np.random.Generator) -> Concealed:
    hidden, found = _one(
        order,
        rng,
        limits=_strength(rng),
        choose=lambda k: k[1] in ("force_sensor", "mocap") and k[0] in ("low_pass", "time_offset", "sensor_inertia"),
    )
    return _as_effect(order, hidden, found)


def _two(order: Order, rng: np.random.Generator) -> Concealed:
    campaign = scene(order.family, rng)
    for _ in range(100):
        first, second = (_draw(campaign, rng) for _ in range(2))
        group = {_group(first), _group(second)}
        sensors = {first[1], second[1]} & {"force_sensor", "mocap"}
        apart = order.family != FAMILY or "wrist" in (first[1], second[1])
        if apart and len(group) == 2 and not (len(sensors) == 1 and first[1] == second[1]):
            break
    one, _ = reach(campaign, kind(*first, rng, campaign), limits=_strength(rng, lowest=8.0), near=DRAWN)
    other, _ = reach(campaign, kind(*second, rng, campaign), limits=_strength(rng, lowest=8.0), near=DRAWN)
    both = campaign.with_missing(*one.missing, *other.missing)
    return _as_effect(order, both, measure(both))


def _group(key: tuple[str, str]) -> str:
    effect, where = key
    return where if where.startswith("joint.") else APART.get(effect, effect)


def _outsider(order: Order, rng: np.random.Generator) -> Concealed:
    hidden, found = _one(order, rng, variance_ratio=_plain(rng), outside=True)
    made = _as_effect(order, hidden, found)
    return replace(made, expected="unknown")


def _withheld(order: Order, rng: np.random.Generator) -> Concealed:
    hidden, found = _one(order, rng, variance_ratio=_plain(rng))
    made = _as_effect(order, hidden, found)
    return replace(made, expected="unknown", withheld=hidden.missing[0].effect)


def _spoiled(order: Order, rng: np.random.Generator) -> Concealed:
    """Each way in turn, without anything hidden and with friction in the wrist."""
    way = list(WAYS)[order.number % len(WAYS)]
    campaign, strength = scene(order.family, rng), None
    if order.number % 2:  # there are an odd number of ways, so that each comes with and without
        drawn = kind("coulomb_friction", "wrist", rng, campaign)
        campaign, found = reach(campaign, drawn, limits=_strength(rng, lowest=8.0), near=DRAWN)
        clean, strength = found.clean, found.limits
    else:
        clean = perform(campaign)
    handed, readings = WAYS[way].spoil(campaign, clean, rng)
    return Concealed(handed, readings, "spoiled", parameters=WAYS[way].values, strength=strength, way=way)


RELATIVES: tuple[tuple[str, str, str], ...] = (
    ("low_pass", "force_sensor", "filter"),
    ("coulomb_friction", "wrist", "trend"),
    ("low_pass", "mocap", "filter"),
    ("scale", "force_sensor", "trend"),
    ("quadratic_damping", "wrist", "trend"),
)
"""Effects that are hidden in another form than the plain one: a filter of higher order, a strength that changes."""


def _relative(order: Order, rng: np.random.Generator) -> Concealed:
    effect, where, how = RELATIVES[order.number % len(RELATIVES)]
    campaign = scene(order.family, rng)
    plain = kind(effect, where, rng, campaign)
    if how == "filter":
        drawn = replace(plain, form=(int(rng.choice([2, 4])), str(rng.choice(["butterworth", "bessel"]))))
    else:
        most = 0.7 / (len(campaign.trials) - 1)  # to a third of what it was, or to nearly twice as much
        drawn = replace(plain, trend=float(rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 1.0) * most))
    hidden, found = reach(campaign, drawn, limits=_strength(rng, lowest=15.0), near=DRAWN)
    return _as_effect(order, hidden, found)


def _law(order: Order, rng: np.random.Generator) -> Concealed:
    """Laws of no catalogue in turn, on the plain rig: what moves besides has no port at which a law is learned."""
    name = list(LAWS)[order.number % len(LAWS)]
    law, campaign = LAWS[name], scene("rig", rng)
    values = law.numbers(rng, max(peak_stroke(t) for t in campaign.trials))
    hidden, found = reach(campaign, Kind(name, law.where, values, LARGEST), variance_ratio=_plain(rng), near=DRAWN)
    return replace(_as_effect(order, hidden, found), expected="learned")


def _as_effect(order: Order, hidden: Campaign, found: Strength) -> Concealed:
    covered = [m for m in hidden.missing if m.label in COVERED]
    expected = "wrong_parameter" if covered and len(covered) == len(hidden.missing) else "named"
    return Concealed(
        hidden,
        noisy(hidden, found.clean),
        expected,
        parameters=tuple(covers(m.label) for m in covered),
        strength=found.limits,
        variance_ratio=found.variance_ratio,
    )


def covers(label: tuple[str, str]) -> str:
    """The believed value that can stand for an effect."""
    return {
        ("viscous_friction", "wrist"): "wrist.equivalent_damping",
        ("payload", "wrist"): "wrist.mass",
        ("payload", "target"): "target.mass",
    }[label]


def _one(
    order: Order,
    rng: np.random.Generator,
    *,
    limits: float | None = None,
    variance_ratio: float | None = None,
    choose: Callable[[tuple[str, str]], bool] = lambda key: True,
    outside: bool = False,
) -> tuple[Campaign, Strength]:
    campaign = scene(order.family, rng, effect=order.effect)
    key = order.effect or _draw(campaign, rng, choose, outside=outside)
    near = NEAR if order.limits is not None or order.kind.startswith("weak") else DRAWN
    return reach(campaign, kind(*key, rng, campaign), limits=limits, variance_ratio=variance_ratio, near=near)


def _draw(
    campaign: Campaign,
    rng: np.random.Generator,
    choose: Callable[[tuple[str, str]], bool] = lambda key: True,
    *,
    outside: bool = False,
) -> tuple[str, str]:
    keys = [k for k in hideable(campaign, outside=outside) if choose(k) and k not in COVERED]
    if not keys:
        raise InputError("nothing of the kind can be hidden in this scene", given=campaign.title)
    return keys[int(rng.integers(len(keys)))]


def _strength(rng: np.random.Generator, lowest: float = STRONG[0]) -> float:
    return by_factors(rng, lowest, STRONG[1])


def _plain(rng: np.random.Generator) -> float:
    """Residual variance over noise variance of what must not be overlooked: enough to tell a rival's prediction."""
    return 1.0 + by_factors(rng, 0.2, 2.0)


def mask(campaign: Campaign, clean: Readings) -> Campaign:
    """The campaign with one constant of the belief tuned on one trial, as a lab tunes c_eq, and stated as such."""
    name = TUNED.get(campaign.missing[0].effect, "wrist.equivalent_damping")
    middle = campaign.trials[len(campaign.trials) // 2]
    loose = Belief(
        campaign.belief.head,
        {n: campaign.as_built.get(n, v) for n, v in campaign.belief.values.items()},
        {name: 0.5, "target.mass": 1e-4},
    )
    alone = replace(campaign, belief=loose, trials=(middle,))
    with scratch() as folder:
        write_study(folder, alone, {middle.id: clean[middle.id]}, exact=True)
        study = load_study(folder)
        data = trial_data(study)
        model = RigModel(study, data)
        fit = fit_from(Fitter(model, data), model.believed, (), {})
    tuned = fit.values()[name]
    stated: Mapping[str, float] = {**campaign.belief.values, name: to_digits(tuned, 3)}
    sigma = dict(campaign.belief.sigma)
    if name != "wrist.equivalent_damping":
        sigma[name] = max(0.05, sigma.get(name, 0.0))  # who tuned it knows no better
    return replace(campaign, belief=replace(campaign.belief, values=stated, sigma=sigma))


MAKERS: dict[str, Callable[[Order, np.random.Generator], Concealed]] = {
    "nothing_missing": _nothing,
    "wrong_value": _wrong_value,
    "unlabelled": _unlabelled,
    "power": _unlabelled,
    "masked": _masked,
    "weak": _weak,
    "rare": _rare,
    "imitated": _imitated,
    "two": _two,
    "outsider": _outsider,
    "withheld": _withheld,
    "spoiled": _spoiled,
    "relative": _relative,
    "law": _law,
}
