"""A force sensor on a clock of its own: set beside the cameras' by the touch, its offset fitted with all else."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacerobot.diagnosis.answer.clock_offsets import clock_offsets
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.forward.wrist_rig import WristRig
from spacerobot.diagnosis.machines.clock_scan import best_offset
from spacerobot.diagnosis.selection.admission import admit
from spacerobot.diagnosis.terms.candidates import candidate_sites
from spacerobot.diagnosis.terms.data import Block, trial_data
from spacerobot.recordings.study import Study, load_study
from tests.diagnosis.rigs import write_study

AHEAD = (6.8123, -2.4004, 0.0371, 41.5)
"""Seconds that the force sensor's clock is ahead of the cameras', a number for each trial."""

PLANTED = [("coulomb_friction", "wrist", {"force_N": 0.3})]
TRUTH = {"wrist.equivalent_damping": 0.0}


def read(file: Path) -> tuple[str, np.ndarray]:
    head, *rows = file.read_text().splitlines()
    return head, np.array([[float(cell) for cell in row.split(",")] for row in rows])


def own_clock(study: Study) -> Study:
    """The same study with the force sensor's times as its own clock has them."""
    folder = study.path.parent
    for trial, ahead in zip(study.trials, AHEAD, strict=True):
        file = folder / trial.sources["force"].file
        head, rows = read(file)
        rows[:, 0] += ahead
        np.savetxt(file, rows, "%.6f", ",", header=head, comments="")
    text = study.path.read_text()
    assert "[streams.force]\n" in text
    study.path.write_text(text.replace("[streams.force]\n", '[streams.force]\nclock = "own"\n'))
    return load_study(study.path)


@pytest.fixture(scope="module")
def studies(tmp_path_factory: pytest.TempPathFactory) -> tuple[Study, Study]:
    one, other = (tmp_path_factory.mktemp("rig") for _ in range(2))
    one_clock, two = (write_study(f, planted=PLANTED, truth=TRUTH) for f in (one, other))
    return one_clock, own_clock(two)


def test_every_offset_and_the_physics_are_found(studies: tuple[Study, Study]) -> None:
    """Delays of seconds to either side; what else is fitted is what one clock gives, and hardly less sure."""
    task = Task((("coulomb_friction", "wrist"),), {"coulomb_friction@wrist.force_N": 0.2})
    found = []
    for study in studies:
        workshop = Workshop(study)
        fit = workshop.run(task)
        assert fit is not None
        assert fit.chi2 < 1.05 * fit.samples
        found.append((workshop, fit))
    (_, plain), (workshop, fit) = found
    force = "coulomb_friction@wrist.force_N"
    low, high = fit.errors()[force]
    assert abs(fit.values()[force] - plain.values()[force]) < 2.0 * (high - low)
    offsets = clock_offsets(studies[1], workshop, fit, 1.0)
    assert [(o.where, o.against) for o in offsets] == [("force", "mocap")] * len(AHEAD)
    for one, ahead in zip(offsets, AHEAD, strict=True):
        delay = one.parameters["delay_s"]
        assert isinstance(delay.value, float)
        assert delay.ci95 is not None
        low, high = delay.ci95
        assert isinstance(low, float)
        assert isinstance(high, float)
        assert 0.0 < high - low < 2e-3
        assert abs(delay.value - ahead) < high - low  # within twice the interval's half: four standard errors


@pytest.mark.parametrize("off", [-0.06, 0.025, 0.11])
def test_an_offset_is_found_from_other_rings_of_the_contact(studies: tuple[Study, Study], off: float) -> None:
    """Begun where the force's rings fit one, two or many rings on: a fit has to come back from there."""
    workshop = Workshop(studies[1])
    task = Task((("coulomb_friction", "wrist"),), {"coulomb_friction@wrist.force_N": 0.3})
    right = workshop.run(task)
    assert right is not None
    own = {name: start + np.array([*np.zeros(start.size - 1), off]) for name, start in right.initials().items()}
    found = workshop.fitter().fit(right.hypothesis, warm=right.values(), initials=own)
    assert found.cost < right.cost + 1.0
    for name, start in right.initials().items():
        assert abs(found.initials()[name][-1] - start[-1]) < 2e-4


@given(late=st.floats(-0.2, 0.2), period=st.floats(0.008, 0.05), seen=st.floats(5.0, 40.0))
def test_a_ring_that_dies_out_tells_its_offset(late: float, period: float, seen: float) -> None:
    """To two steps, with `seen` readings in each of its periods: fewer than two would show another ring."""

    def ring(time: np.ndarray) -> np.ndarray:
        since = np.maximum(time - 0.4, 0.0)
        return np.asarray([np.sin(2.0 * np.pi * since / period) * np.exp(-since / (4.0 * period))])

    time = np.arange(0.0, 1.2, period / seen)
    value = ring(time - late)
    block = Block("force", ("contact.force",), time, value, np.full_like(value, 100.0), "own")
    assert abs(best_offset([block], lambda channels, time: ring(time)) - late) < 1e-3


def test_all_that_is_on_a_clock_tells_its_offset() -> None:
    """Whichever comes last: a channel that shows next to nothing does not outweigh one that does."""

    def pulse(time: np.ndarray) -> np.ndarray:
        return np.asarray([np.exp(-(((time - 0.5) / 0.01) ** 2))])

    time = np.arange(0.0, 1.0, 1e-3)
    blocks = [
        Block(name, (name,), time, pulse(time - late), np.full((1, time.size), weight), "own")
        for name, late, weight in (("contact.force", 0.04, 100.0), ("hand.x", -0.1, 1.0))
    ]
    for order in (blocks, blocks[::-1]):
        assert abs(best_offset(order, lambda channels, time: pulse(time)) - 0.04) < 1e-3


def test_one_clock_has_no_offset(studies: tuple[Study, Study]) -> None:
    workshop = Workshop(studies[0])
    fit = workshop.run(Task((), {}, max_iterations=2))
    assert fit is not None
    assert clock_offsets(studies[0], workshop, fit, 1.0) == []


def test_a_late_sensor_is_its_clock(studies: tuple[Study, Study]) -> None:
    """Where each trial's offset is free, no delay of the sensor can show; on one clock it can."""
    for study, possible in zip(studies, (True, False), strict=True):
        trials = trial_data(study)
        workshop = Workshop(study)
        mechanism = workshop.model.mechanism({**workshop.model.base, **trials[0].overrides})
        effects = {s.effect.name for s in candidate_sites(mechanism, workshop.model.believed)}
        assert ("time_offset" in effects) is possible
        assert "low_pass" in effects


def test_overlay_draws_both_streams_on_one_clock(studies: tuple[Study, Study]) -> None:
    plain, own = (WristRig.of(s) for s in studies)
    for trial in studies[0].trials:
        force, other = (m.simulate(trial) for m in (plain, own))
        one, two = (next(c for c in o.channels if c.channel == "contact.force") for o in (force, other))
        assert abs(two.time[0] - one.time[0]) < 0.05
        at = [float(c.time[np.argmax(c.measured)]) for c in (one, two)]
        assert abs(at[0] - at[1]) < 0.01
    assert any("clock of its own" in said for said in own.assumptions)
    assert not any("clock of its own" in said for said in plain.assumptions)


@pytest.mark.parametrize("lost", ["force", "track"])
def test_where_no_touch_shows_it_says_so_and_stops(tmp_path: Path, lost: str) -> None:
    study = own_clock(write_study(tmp_path))
    file = tmp_path / ("00_force.csv" if lost == "force" else "00_mocap.csv")
    head, rows = read(file)
    if lost == "force":
        rows[:, 1] = 0.25 * np.random.default_rng(0).standard_normal(len(rows))
    else:
        rows[:, 1] -= 0.5
    np.savetxt(file, rows, "%.6f", ",", header=head, comments="")
    with pytest.raises(Exception, match=r"stream force's own clock cannot be found in trial 00") as error:
        admit(load_study(study.path))
    assert "[[trials]]" in str(error.value) or "study.toml" in str(error.value)
