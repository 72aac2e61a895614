"""Drives that two joints turn, torques that tell nothing, and joints that rest: what a balance makes of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from helpers_models import ARM, arm_log

from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.machines.grid import Grid
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.selection.both_ends import one_ended
from spacerobot.diagnosis.selection.forward_selection import grow
from spacerobot.diagnosis.selection.part_result import Part
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.effects.registry import all_effects
from spacerobot.model.library import load
from spacerobot.model.robot import Robot

GRAVITY = (0.0, 0.0, -9.81)
DRY, SLOPE = 0.8, 0.3


def coupled(robot: Robot, seed: int) -> Grid:
    """The elbow's drive turns with the shoulder too, and rubs at the sum of both rates."""
    grid = arm_log(robot, seed, {})
    rate = sum(np.gradient(grid.value[f"joint.{j}.position"], grid.step) for j in ("shoulder", "elbow"))
    rate = np.convolve(rate, np.ones(21) / 21.0, "same")  # the noise of differences apart
    rubs = DRY * np.sign(rate) + SLOPE * rate
    more = {f"joint.{j}.torque": grid.value[f"joint.{j}.torque"] + rubs for j in ("shoulder", "elbow")}
    return replace(grid, value={**grid.value, **more})


def model_of(make: Callable[[Robot, int], Grid], joint: str) -> InverseDynamics:
    robot = load(ARM)
    grids: dict[str, tuple[Grid, str, dict[str, float]]] = {
        f"run{n}": (make(robot, n), f"motion {n}", {}) for n in range(2)
    }
    return InverseDynamics(robot, GRAVITY, grids, ("shoulder", "elbow"), compared=[joint])


@pytest.mark.parametrize("joint", ["shoulder", "elbow"])
def test_the_friction_of_a_coupled_drive_comes_back_at_both_joints(joint: str) -> None:
    model = model_of(coupled, joint)
    (site,) = (s for s in model.sites() if s.effect.name == "transmission_coupling")
    assert site.where == "joint.elbow"  # the farther joint's drive, whichever balance it is seen in
    own = [s for s in model.sites() if s.where == f"joint.{joint}"]
    keys = {p: site.key(p) for p in ("coulomb_force_N", "coefficient_Ns_m", "ratio")}

    def fitted(*sites):  # type: ignore[no-untyped-def]
        made = hypothesis(model.believed, sites)
        warm = {keys["coulomb_force_N"]: 0.2, keys["coefficient_Ns_m"]: 0.1, keys["ratio"]: 1.0}
        return Fitter(model, model.trials).fit(made, warm=warm)

    fit = fitted(site)
    alone = fitted(*(s for s in own if s.effect.name in ("coulomb_friction", "viscous_friction")))
    assert fit.cost < 0.3 * alone.cost  # the joint's own rate does not tell when the drive turns
    found = fit.values()
    assert found[keys["ratio"]] == pytest.approx(1.0, abs=0.1)
    assert found[keys["coulomb_force_N"]] == pytest.approx(DRY, rel=0.1)
    assert found[keys["coefficient_Ns_m"]] == pytest.approx(SLOPE, abs=0.1)


def one_sided(robot: Robot, seed: int) -> Grid:
    """The shoulder alone feels what goes with both rates; the elbow's own friction is plain."""
    both, none = coupled(robot, seed), arm_log(robot, seed, {"elbow": (0.6, 0.2, 0.0)})
    return replace(both, value={**both.value, "joint.elbow.torque": none.value["joint.elbow.torque"]})


def test_what_a_drive_does_at_one_joint_the_other_must_bear_out() -> None:
    wanted = [all_effects()[n] for n in ("coulomb_friction", "viscous_friction", "transmission_coupling")]
    label = ("transmission_coupling", "joint.elbow")
    for make, alone in ((coupled, False), (one_sided, True)):
        parts = [Part(grow(model_of(make, joint), effects=wanted)) for joint in ("shoulder", "elbow")]
        assert label in parts[0].chosen.label
        lone = one_ended(parts)
        assert lone == ({0: frozenset({label})} if alone else {})
        by_itself = parts[0].model
        by_itself.refused = frozenset().union(*lone.values())
        assert (label in [s.label for s in by_itself.sites()]) is not alone


def test_either_joint_of_a_coupling_knows_where_else_it_acts() -> None:
    effect = all_effects()["transmission_coupling"]
    for joint, other in (("shoulder", "elbow"), ("elbow", "shoulder")):
        port, there = effect.elsewhere(model_of(coupled, joint).plain(), "joint.elbow") or ("", effect)
        assert port == f"joint.{other}"
        model = model_of(coupled, other)
        (site,) = (s for s in model.sites() if s.label == (effect.name, "joint.elbow"))
        told = {"coulomb_force_N": DRY, "coefficient_Ns_m": SLOPE, "ratio": 1.0}
        costs = []
        for one in (site, model.site(there, "joint.elbow")):
            made = hypothesis(model.believed, [one])
            z = made.start({one.key(name): value for name, value in told.items()})
            fitter = Fitter(model, model.trials)
            state = fitter.state(made, z, fitter.guess())
            costs.append(None if state is None else state.chi2())
        assert costs[0] == pytest.approx(costs[1], rel=1e-9)


def test_a_coupling_of_next_to_nothing_is_none() -> None:
    (site,) = (s for s in model_of(coupled, "elbow").sites() if s.effect.name == "transmission_coupling")
    values = {"coulomb_force_N": 1.0, "coefficient_Ns_m": 0.0, "ratio": 0.05}
    assert site.effect.implausible(values, model_of(coupled, "elbow").sizes[""])
    assert not site.effect.implausible({**values, "ratio": -1.0}, model_of(coupled, "elbow").sizes[""])


def test_a_torque_that_hardly_reads_tells_nothing() -> None:
    def dead(robot: Robot, seed: int) -> Grid:
        grid = arm_log(robot, seed, {})
        return replace(grid, value={**grid.value, "joint.elbow.torque": 0.01 * grid.value["joint.elbow.torque"]})

    assert "where the motion asks for" in model_of(dead, "elbow").not_measured
    assert not model_of(dead, "shoulder").not_measured
    assert not model_of(coupled, "elbow").not_measured


def test_a_joint_at_rest_is_not_asked_which_way_it_slides() -> None:
    """Friction that holds takes whatever sign the rest asks for; a quarter of standing still must not weigh."""

    def resting(robot: Robot, seed: int) -> Grid:
        grid = arm_log(robot, seed, {"elbow": (0.6, 0.2, 0.0)})
        still = grid.time > 0.75 * grid.time[-1]
        last = int(np.argmax(still))
        value = {
            k: np.where(still, v[last], v) if k.endswith("position") else np.where(still, v[last] + 0.5, v)
            for k, v in grid.value.items()
        }
        return replace(grid, value=value)

    model = model_of(resting, "elbow")
    by = {s.label: s for s in model.sites()}
    made = hypothesis(model.believed, [by[(e, "joint.elbow")] for e in ("coulomb_friction", "viscous_friction")])
    found = Fitter(model, model.trials).fit(made).values()
    assert found["coulomb_friction@joint.elbow.force_N"] == pytest.approx(0.6, abs=0.05)
