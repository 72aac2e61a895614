"""A motor whose link rides on a spring, in counts: found from whatever trials there are, at its true values."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import StateSpace, chirp, lsim, square

from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.gauss_newton import Fitter
from spacerobot.diagnosis.machines import simulated
from spacerobot.diagnosis.machines.axis import axis
from spacerobot.diagnosis.machines.contract import FIRST_NOISE
from spacerobot.diagnosis.machines.simulated import Simulated
from spacerobot.diagnosis.machines.sizes import sizes_of
from spacerobot.diagnosis.machines.windows import Drive
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed, Hypothesis, Site, hypothesis

NAME = "joint.motor"
MOTOR, LINK, STIFFNESS, FRICTION = 2.7e-3, 4.4e-3, 1.1, 0.1
TIME = np.arange(0.0, 4.0, 0.002)
DRIVES = {
    "swept": 100.0 * chirp(TIME, 0.3, 4.0, 8.0),
    "fixed": 110.0 * np.sin(2.0 * np.pi * 5.0 * TIME),
    "high": 100.0 * chirp(TIME, 3.0, 4.0, 8.0),
    "step": 60.0 * square(2.0 * np.pi * 0.5 * TIME),
}


def shown(drive: np.ndarray) -> np.ndarray:
    """The motor's angle, from rest, as the linear equations have it exactly."""
    a = np.array(
        [
            [0, 1, 0, 0],
            [-STIFFNESS / MOTOR, -FRICTION / MOTOR, STIFFNESS / MOTOR, 0],
            [0, 0, 0, 1],
            [STIFFNESS / LINK, 0, -STIFFNESS / LINK, 0],
        ]
    )
    b, c = np.array([[0], [1 / MOTOR], [0], [0]]), np.array([[1, 0, 0, 0]])
    return np.asarray(lsim(StateSpace(a, b, c, np.zeros((1, 1))), drive, TIME)[1])


def motor(*names: str, window: float = 4.0) -> Simulated:
    """These trials of it, its inertia and friction unknown; a counter reads whole counts."""
    angles = {n: np.round(shown(DRIVES[n])) for n in names}
    every = np.concatenate(list(angles.values()))
    rate = np.concatenate([np.gradient(x, TIME) for x in angles.values()])
    sizes = sizes_of(np.concatenate([DRIVES[n] for n in names]), every, rate)
    weight = np.full((1, TIME.size), 1.0 / (FIRST_NOISE * sizes.length))
    recorded = [
        TrialData(n, n, {}, (Block("log", (f"{NAME}.position",), TIME, angles[n][None], weight),), 0.0, TIME[-1])
        for n in names
    ]
    drives = {n: Drive(TIME, {f"{NAME}.torque": DRIVES[n]}) for n in names}
    unknown = {f"{NAME}.mass": sizes.mass, f"{NAME}.damping": sizes.of("N s/m")}
    believed = Believed({}, {}, {}, names, unknown)
    build = axis("motor", "log", angular=True)
    return Simulated("motor", build, recorded, drives, believed=believed, sizes={"": sizes}, window=window)


@pytest.mark.parametrize("absolute", ["of its size", "of metres"])
def test_where_a_window_starts_moves_it_as_much_as_it_should(absolute: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nothing pulls a joint back, all that follows moves with its start: to the integrator's last digits, and
    not with errors that stand for a wrist's millimetres in a machine that moves by tens."""
    model = motor("fixed")
    curved = next(s for s in model.sites() if s.label == ("quadratic_damping", NAME))  # what is straight is exact
    made = hypothesis(model.believed, (curved,), {curved.key(p.name): 0.0 for p in curved.effect.parameters})
    fitter, (trial,) = Fitter(model, model.trials), model.trials
    if absolute == "of metres":
        model._absolute = 1.0
        monkeypatch.setattr(simulated, "LOOSEST", 1e-5)
        fitter._starts_by = {trial.id: [0.02, 0.02]}
    state = fitter.state(made, made.start({f"{NAME}.mass": 1.25e-3, f"{NAME}.damping": 0.1}), fitter.guess())
    assert state is not None
    column = fitter.jacobian(made, state, trial)[:, len(made.free)]
    right = column == pytest.approx(column[0], rel=0.01)
    assert right == (absolute == "of its size")


def link_site(model: Simulated) -> Site:
    """Where a link may hide."""
    return next(s for s in model.sites() if s.label == ("joint_flexibility", NAME))


def found(model: Simulated) -> tuple[Fit, Site, Fit]:
    """The rigid fit, and what its promise of a link is fitted to."""
    bench, site = Bench(model), link_site(model)
    rigid = bench.baseline()
    bench.sharpen(rigid)
    rigid = bench.again(rigid)
    (promise,) = bench.promises(rigid, [site])
    fit = bench.fitted(rigid, promise)
    assert fit is not None
    return rigid, site, fit


@pytest.mark.parametrize("names", [("swept", "fixed", "step"), ("fixed", "high")])
def test_a_link_on_a_spring_is_found_beside_a_rigid_fit_that_made_up_for_it(names: tuple[str, ...]) -> None:
    """Above its resonance the motor moves alone, and a rigid fit says less inertia than the link alone has."""
    rigid, site, fit = found(motor(*names))
    assert fit.cost < 0.01 * rigid.cost
    values = fit.values()
    assert values[f"{NAME}.mass"] == pytest.approx(MOTOR + LINK, rel=0.03)
    assert values[site.key("link_inertia_kg_m2")] == pytest.approx(LINK, rel=0.05)
    assert values[site.key("stiffness_N_m")] == pytest.approx(STIFFNESS, rel=0.05)
    if "high" in names:
        assert rigid.values()[f"{NAME}.mass"] < LINK


def with_its_link(model: Simulated) -> tuple[Hypothesis, dict[str, float]]:
    """The truth as a hypothesis, and its values."""
    site = link_site(model)
    link = {"link_inertia_kg_m2": LINK, "stiffness_N_m": STIFFNESS, "damping_Ns_m": 0.0}
    values = {f"{NAME}.mass": MOTOR + LINK, f"{NAME}.damping": FRICTION, **{site.key(n): v for n, v in link.items()}}
    return hypothesis(model.believed, (site,), values), values


def left(model: Simulated) -> dict[str, float]:
    """By window, rms of what the truth leaves from where its readings have it begin [counts]."""
    made, values = with_its_link(model)
    fitter = Fitter(model, model.trials)
    state = fitter.state(made, made.start(values), fitter.guess())
    assert state is not None
    return {t.id: float(np.sqrt(np.mean((state.raw[t.id] / t.blocks[0].weight[0].max()) ** 2))) for t in model.trials}


def test_a_window_begins_with_its_link_as_the_trial_up_to_there_has_swung_it(monkeypatch: pytest.MonkeyPatch) -> None:
    model = motor("step", "swept", window=0.8)
    assert len(model.trials) == 10
    assert max(left(model).values()) < 12.0  # of a motion of hundreds; where a window begins is told by some readings
    monkeypatch.setattr(simulated, "riding", lambda mechanism: [])  # as it would ride along after a long rest
    assert max(left(motor("step", "swept", window=0.8)).values()) > 50.0


def test_a_link_goes_on_through_a_window_whose_readings_are_kept_aside() -> None:
    model = motor("step", "swept", window=0.8)
    aside = [t.id for t in model.trials if t.recorded == "step"][1]
    whole, rest = left(model), left(model.but_for([aside]))
    assert aside not in rest
    for name, own in rest.items():
        assert own < max(1.5 * whole[name], 12.0)


@pytest.mark.slow
@pytest.mark.parametrize("pace", [0.3, 2.5])
def test_a_resonance_far_from_the_pace_of_the_motion_is_found(pace: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """The spring a tenth and six times as stiff: whatever a catalogue's starts are, a row of frequencies is tried."""
    stiff = pace**2 * STIFFNESS
    monkeypatch.setitem(globals(), "STIFFNESS", stiff)
    _, site, fit = found(motor("swept", "fixed", "step"))
    assert fit.values()[site.key("link_inertia_kg_m2")] == pytest.approx(LINK, rel=0.1)
    assert fit.values()[site.key("stiffness_N_m")] == pytest.approx(stiff, rel=0.1)
