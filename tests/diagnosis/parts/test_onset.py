"""What hides behind a measured joint begins where the record has it begin: undeflected at rest, else riding along."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import StateSpace, lsim

from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.selection.bench import Bench
from spacerobot.diagnosis.terms.hypothesis import hypothesis
from spacerobot.recordings.study import load_study
from tests.diagnosis.parts.helpers_axis import HEAD, axis_urdf

STEP, MASS, LINK, DAMPING = 0.005, 2.0, 0.8, 1.0
NAME = "joint.j"


def left(folder: Path, drive: np.ndarray, stiffness: float, rub: float, begin: int = 0) -> float:
    """Share of the rigid fit's chi-squared that the true link leaves of a log that begins at a sample."""
    motor, x = MASS - LINK, rub
    a = [[0, 1, 0, 0], [-stiffness / motor, -(DAMPING + x) / motor, stiffness / motor, x / motor],
         [0, 0, 0, 1], [stiffness / LINK, x / LINK, -stiffness / LINK, -x / LINK]]  # fmt: skip
    time = STEP * np.arange(drive.size)
    b, c = [[0], [1 / motor], [0], [0]], [[1, 0, 0, 0]]
    q = lsim(StateSpace(a, b, c, [[0]]), drive, time)[1]
    table = np.column_stack([time, q, drive])[begin:]
    folder.mkdir()
    np.savetxt(folder / "run.csv", table, "%.12g", ",", header="t,q,u", comments="")
    (folder / "axis.urdf").write_text(axis_urdf(MASS))
    text = HEAD + f'[baseline.joint.j]\ndamping = {DAMPING}\n[[trials]]\nid = "run"\ncondition = "a"\nlog = "run.csv"\n'
    (folder / "study.toml").write_text(text)
    (model,) = models_for(load_study(folder / "study.toml"))
    site = next(s for s in model.sites() if s.label == ("joint_flexibility", NAME))
    link = {"link_inertia_kg_m2": LINK, "stiffness_N_m": stiffness, "damping_Ns_m": rub}
    values = {site.key(n): v for n, v in link.items()}
    bench = Bench(model)
    made = hypothesis(model.believed, (site,), values)
    state = bench.fitter().state(made, made.start(values), bench.fitter().guess())
    assert state is not None
    return state.chi2() / bench.baseline().chi2


@pytest.mark.parametrize("seed", range(3))
def test_a_record_that_begins_with_its_drive_begins_undeflected(seed: int, tmp_path: Path) -> None:
    """At rest, under a drive that is there at once: as if it had ridden along, it would ring for all of the record."""
    random, time = np.random.default_rng(seed), STEP * np.arange(2000)
    waves = [np.cos(2.0 * np.pi * f * time + random.uniform(-1.0, 1.0)) for f in random.uniform(0.3, 5.0, 5)]
    assert left(tmp_path / "log", 10.0 * np.sum(waves, axis=0), 400.0, 0.4) < 2e-3


def test_a_record_cut_out_of_a_slow_motion_begins_riding_along(tmp_path: Path) -> None:
    """Amid a swing of 0.7 Hz, a link of 8 Hz is bent by its own inertia."""
    time = STEP * np.arange(6000)
    drive = 40.0 * np.sin(2.0 * np.pi * 0.7 * time) + 40.0 * np.sin(2.0 * np.pi * 1.9 * time)
    assert left(tmp_path / "log", drive, 2000.0, 2.0, begin=3040) < 0.5  # undeflected: 14
