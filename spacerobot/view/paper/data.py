"""Everything that the paper's page shows, computed once: for figures, page and JSON."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import Any

import numpy as np

from spacerobot.support.progress import Progress
from spacerobot.theory import assumptions, contact_time, equations, frequencies, response, restitution, table1
from spacerobot.view.paper.curves import Curve, curve
from spacerobot.view.paper.limits import (
    FrequencyCheck,
    HandMassCheck,
    PullCheck,
    ServoCheck,
    SpeedCheck,
    frequency_check,
    hand_mass_check,
    pull_check,
    servo_check,
    speed_check,
)
from spacerobot.view.paper.sweeps import Sweep, sweeps
from spacerobot.view.paper.trials import AVERAGED_OVER, TRIALS, Trial, campaign


@dataclass(frozen=True)
class Condition:
    """One spring and one target mass: theory and the mean of its trials.

    Attributes:
        stiffness: k_w, N/m.
        target_mass: m_t, kg.
        trials: how many.
        restitution: mean of the trials.
        restitution_sd: their standard deviation.
        contact_time: mean, s.
        contact_time_sd: s.
        theory_restitution: Eq. 18 with c_w + c_eq.
        theory_restitution_wrist: Eq. 18 with c_w alone.
        theory_contact_time: Eq. 16, s.
        adhesive_share: share of Eq. 16's time in which the force would have to pull.
        frequency_ratio: omega_c/omega_w.
    """

    stiffness: float
    target_mass: float
    trials: int
    restitution: float
    restitution_sd: float
    contact_time: float
    contact_time_sd: float
    theory_restitution: float
    theory_restitution_wrist: float
    theory_contact_time: float
    adhesive_share: float
    frequency_ratio: float


@dataclass(frozen=True)
class PaperData:
    """All results.

    Attributes:
        seed: of the trials.
        equivalent_damping: c_eq, N s/m.
        curves: Figs. 5 and 6, one for each spring.
        trials: simulated, all conditions.
        conditions: means over the trials.
        findings: (spring stiffness, target mass) -> findings of the eight assumptions.
        frequencies: Eq. 5 against the exact frequencies.
        pull: the adhesive force before the end of Eq. 14.
        hand_mass: M -> infinity.
        servo: the same for an arm whose joints servos hold.
        speed: restitution over the speed.
        sweeps: four assumptions broken by degrees.
    """

    seed: int
    equivalent_damping: float
    curves: tuple[Curve, ...]
    trials: tuple[Trial, ...]
    conditions: tuple[Condition, ...]
    findings: dict[tuple[float, float], tuple[assumptions.Finding, ...]]
    frequencies: FrequencyCheck
    pull: PullCheck
    hand_mass: HandMassCheck
    servo: ServoCheck
    speed: SpeedCheck
    sweeps: tuple[Sweep, ...]


def compute(seed: int, equivalent_damping: float, *, verbose: bool = False) -> PaperData:
    """Compute everything; some ten seconds.

    Args:
        seed: of the simulated trials.
        equivalent_damping: c_eq, N s/m.
        verbose: show progress although nobody watches.
    """
    with Progress("paper", 10, verbose=verbose) as progress:
        trials = tuple(campaign(seed, equivalent_damping))
        progress.advance(note="trials")
        curves = []
        for spring in table1.SPRINGS:
            curves.append(curve(spring, equivalent_damping))
            progress.advance(note=spring.label)
        findings = {
            (spring.stiffness, mass): assumptions.examine(spring, mass, equivalent_damping=equivalent_damping)
            for spring in table1.SPRINGS
            for mass in table1.TARGET_MASSES
        }
        progress.advance(note="assumptions")
        swept = sweeps(equivalent_damping)
        progress.advance(note="sweeps")
        checks = (
            frequency_check(),
            pull_check(equivalent_damping),
            hand_mass_check(),
            servo_check(),
            speed_check(equivalent_damping),
        )
        progress.advance(3, note="limits")
    conditions = _conditions(trials, equivalent_damping)
    return PaperData(seed, equivalent_damping, tuple(curves), trials, conditions, findings, *checks, sweeps=swept)


def _conditions(trials: tuple[Trial, ...], equivalent_damping: float) -> tuple[Condition, ...]:
    groups: dict[tuple[float, float], list[Trial]] = defaultdict(list)
    for trial in trials:
        groups[trial.stiffness, trial.target_mass].append(trial)
    springs = {spring.stiffness: spring for spring in table1.SPRINGS}
    out = []
    for (stiffness, mass), group in groups.items():
        spring, lumped = springs[stiffness], table1.WRIST_MASS + mass
        full = table1.reduced(spring, lumped, equivalent_damping=equivalent_damping)
        e = np.array([t.restitution for t in group])
        tau = np.array([t.contact_time for t in group])
        out.append(
            Condition(
                stiffness=stiffness,
                target_mass=mass,
                trials=len(group),
                restitution=float(e.mean()),
                restitution_sd=float(e.std(ddof=1)),
                contact_time=float(tau.mean()),
                contact_time_sd=float(tau.std(ddof=1)),
                theory_restitution=restitution.displacement_zero(full),
                theory_restitution_wrist=restitution.displacement_zero(table1.reduced(spring, lumped, damping="wrist")),
                theory_contact_time=contact_time.displacement_zero(full),
                adhesive_share=response.adhesion(full, spring.hand_speed).share,
                frequency_ratio=frequencies.frequency_ratio(table1.three_masses(spring, mass)),
            )
        )
    return tuple(out)


TABLE1_HEADER = (
    "k_w [N/m]",
    "c_w [N s/m]",
    "mean hand speed [m/s]",
    "m_w [kg]",
    "k_c [N/m]",
    "M [kg]",
    "m_t [kg]",
)


def table1_rows() -> list[list[str]]:
    """Table 1 as text, one row to a spring."""
    targets = " / ".join(f"{m:g}" for m in table1.TARGET_MASSES)
    return [
        [
            f"{s.stiffness:g}",
            f"{s.damping:g}",
            f"{s.hand_speed:g}",
            f"{table1.WRIST_MASS:g}",
            f"{table1.CONTACT_STIFFNESS:g}",
            f"{table1.HAND_MASS:g}",
            targets,
        ]
        for s in table1.SPRINGS
    ]


def as_json(data: PaperData) -> dict[str, Any]:
    """What `spacerobot paper --json` prints and paper.json holds; SI, plain names with units."""
    pull = data.pull.adhesion
    return {
        "seed": data.seed,
        "equivalent_damping_Ns_m": data.equivalent_damping,
        "averaged_over_s": AVERAGED_OVER,
        "trials_per_condition": TRIALS,
        "table1": {
            "springs": table1.SPRINGS,
            "wrist_mass_kg": table1.WRIST_MASS,
            "target_mass_kg": table1.TARGET_MASSES,
            "contact_stiffness_N_m": table1.CONTACT_STIFFNESS,
            "hand_mass_kg": table1.HAND_MASS,
            "inferred": {
                "contact_damping_Ns_m": table1.CONTACT_DAMPING,
                "equivalent_damping_Ns_m": table1.EQUIVALENT_DAMPING,
                "hand_speed_m_s": [s.hand_speed for s in table1.SPRINGS],
            },
        },
        "equations": equations.EQUATIONS,
        "curves": data.curves,
        "conditions": data.conditions,
        "trials": data.trials,
        "equation_5": {
            "says": "As printed, Eq. 5 does not give the natural frequencies of Eqs. 2 to 4.",
            "printed_low_branch_rad_s": data.frequencies.known,
            "exact_low_branch_rad_s": data.frequencies.exact_there,
            "equations_9_and_10_rad_s": data.frequencies.limit,
            "over_contact_stiffness": data.frequencies,
        },
        "equation_14": {
            "says": "Before the end of Eq. 14 the force pulls at the target; a unilateral contact ends earlier.",
            "stiffness_N_m": data.pull.stiffness,
            "target_mass_kg": data.pull.target_mass,
            "force_zero_s": pull.start,
            "end_s": pull.end,
            "adhesive_share_of_time": pull.share,
            "adhesive_peak_N": pull.peak_force,
            "adhesive_share_of_peak_force": pull.peak_share,
        },
        "hand_mass": data.hand_mass,
        "servo_arm": data.servo,
        "speed": data.speed,
        "assumptions": [
            {
                "number": a.number,
                "says": a.says,
                "broken_by": a.broken_by,
                "measure": a.measure,
                "findings": [
                    {
                        "stiffness_N_m": stiffness,
                        "target_mass_kg": mass,
                        "measure": found[a.number - 1].measure,
                        "contact_time_relative_change": found[a.number - 1].contact_time,
                        "restitution_change": found[a.number - 1].restitution,
                    }
                    for (stiffness, mass), found in data.findings.items()
                ],
            }
            for a in assumptions.ASSUMPTIONS
        ],
        "sweeps": data.sweeps,
    }
