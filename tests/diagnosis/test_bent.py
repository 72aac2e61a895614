"""What is added to a robot's small motions is right to first order about where it was found."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.workshop import Workshop
from spacerobot.diagnosis.machines.bent import Bent, is_effect
from spacerobot.diagnosis.machines.whole_rig import WholeRig, rig_model
from spacerobot.diagnosis.selection.bending import beyond
from spacerobot.diagnosis.selection.confirm import difference
from spacerobot.diagnosis.selection.precompile import as_believed
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.effects.registry import effect
from tests.diagnosis.moving_robots import moving_robot


def _moved(workshop: Workshop, share: float) -> Fit:
    """As believed, but for the target's speed and the rate of a joint of the first trial, and the wrist's spring."""
    fit = as_believed(workshop)
    trial = workshop.trials[0]
    own = workshop.model.nuisances(trial)
    initial = fit.trials[trial.id].initial.copy()
    for n, nuisance in enumerate(own):
        if nuisance.rate and nuisance.coordinate in ("target", "joint.W1.position"):
            initial[n] += share * (4e-3 if nuisance.coordinate == "target" else 1e-2)
    z = fit.z.copy()
    z[[f.key for f in fit.hypothesis.free].index("wrist.stiffness")] += share * 4.0
    return replace(fit, z=z, trials={**fit.trials, trial.id: replace(fit.trials[trial.id], initial=initial)})


def _level(bent: Bent) -> Bent:
    """Without what it knows of other values and starts."""
    return replace(bent, values={}, own=(), shown={c: (time, rows[:1]) for c, (time, rows) in bent.shown.items()})


def test_bent_motions_differ_in_the_second_order(tmp_path: Path) -> None:
    workshop = Workshop(moving_robot(tmp_path, "free", floating=True))
    trial = workshop.trials[0]
    workshop.trials = (trial,)
    bent = beyond(workshop, as_believed(workshop))
    near = Workshop(workshop.study, partial(rig_model, beyond=bent))
    assert difference(near, as_believed(near), trial) < 1e-2
    whole, half = (difference(near, _moved(near, share), trial) for share in (1.0, 0.5))
    assert half < 0.35 * whole
    level = Workshop(workshop.study, partial(rig_model, beyond={k: _level(b) for k, b in bent.items()}))
    assert difference(level, _moved(level, 1.0), trial) > 4.0 * whole
    found = bent[trial.recorded]
    assert found.touches((0.1, 0.2, 0.3))[0] == 0.1 + found.later[0]
    assert np.abs(found.later).max() < 0.01
    assert found.touches(()) == ()


def test_friction_at_a_joint_acts_by_the_whole_robots_velocity(tmp_path: Path) -> None:
    """Small motions alone have it otherwise: what an effect adds to them grows with it."""
    workshop = Workshop(moving_robot(tmp_path, "free", floating=True))
    workshop.trials = (workshop.trials[0],)
    believed = as_believed(workshop)
    bent = beyond(workshop, believed)
    near = Workshop(workshop.study, partial(rig_model, beyond=bent))
    rest = {k: replace(b, **_without_effects(b)) for k, b in bent.items()}
    blind = Workshop(workshop.study, partial(rig_model, beyond=rest))
    site = near.model.site(effect("coulomb_friction"), "joint.W1")
    apart = []
    for other in (near, blind):
        made = hypothesis(other.model.believed, [site])
        size = {site.key("force_N"): 0.2 * site.effect.parameters[0].starts[0]}
        apart.append(difference(other, replace(believed, hypothesis=made, z=made.start(size)), workshop.trials[0]))
    assert apart[0] < 0.5 * apart[1]


def _without_effects(bent: Bent) -> dict[str, Any]:
    """Its values and rows but for those of effects."""
    values = {n: v for n, v in bent.values.items() if not is_effect(n)}
    own = [*range(1 + len(bent.values), 1 + len(bent.values) + len(bent.own))]
    keep = [0, *(1 + k for k, n in enumerate(bent.values) if n in values), *own]
    return {"values": values, "shown": {c: (time, rows[keep]) for c, (time, rows) in bent.shown.items()}}


def test_sizes_are_those_of_what_moves(tmp_path: Path) -> None:
    """An arm that stands in a plane turns about the axes across it; effects at its other joints are left out."""
    model = Workshop(moving_robot(tmp_path, "free", floating=True)).model
    assert isinstance(model, WholeRig)
    moving = {where for where in model.places if where.startswith("joint.")}
    assert {"joint.S2", "joint.E1", "joint.W1"} <= moving
    assert not moving & {"joint.E2", "joint.W2"}
    assert {s.where for s in model.sites() if s.where.startswith("joint.")} <= moving
    trial = model.trials[0]
    for where in ("joint.S2", "joint.E1"):
        _, value, _ = trial.channel(f"{where}.position")
        assert 0.2 < model.places[where].length / float(np.std(value)) < 5.0
