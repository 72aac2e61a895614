"""What must not matter does not: when a recording began, the trials' order and names, units, signs, the noise."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.fitting.fitted import Fit
from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.recordings.study import load_study
from spacerobot.support.jsonio import plain
from tests.diagnosis.rigs import write_study

FORCE = 0.35
KEY = "coulomb_friction@wrist.force_N"
LABEL = (("coulomb_friction", "wrist"),)


def written(folder: Path, seed: int = 1) -> None:
    write_study(
        folder, planted=[("coulomb_friction", "wrist", {"force_N": FORCE})], masses=(9.0,), speeds=(0.06, 0.09, 0.12),
        seed=seed,
    )  # fmt: skip


def rewritten(folder: Path, change: Callable[[np.ndarray, int], np.ndarray], digits: int = 9) -> None:
    """Every table changed: (rows x columns, number of the trial) -> the same."""
    for path in sorted(folder.glob("*.csv")):
        table = change(np.loadtxt(path, delimiter=",", skiprows=1), int(path.name[1]))
        head = path.read_text().split("\n", 1)[0]
        np.savetxt(path, table, f"%.{digits}f", ",", header=head, comments="")


def later(seconds: float) -> Callable[[Path], None]:
    """All clocks begin so much later, and a minute more from trial to trial."""

    def change(table: np.ndarray, trial: int) -> np.ndarray:
        table[:, 0] += seconds + 60.0 * trial
        return table

    return lambda folder: rewritten(folder, change)


def turned_round(folder: Path) -> None:
    """The trials in the reverse order, under other names."""
    path = folder / "study.toml"
    head, *trials = path.read_text().split("[[trials]]\n")
    named = [re.sub(r'^id = "(.*)"', rf'id = "{"zyx"[i]}\1"', text) for i, text in enumerate(trials)]
    path.write_text(head + "".join(f"[[trials]]\n{text}" for text in reversed(named)))


def in_other_units(folder: Path) -> None:
    """Milliseconds and millimetres; the force sensor is wired the wrong way round and says so."""

    def change(table: np.ndarray, trial: int) -> np.ndarray:
        return table * ([1e3, 1e3, 1e3] if table.shape[1] == 3 else [1e3, -1.0])

    rewritten(folder, change)
    path = folder / "study.toml"
    text = path.read_text().replace('time = "time_s"', 'time = "time_s"\ntime_unit = "ms"')
    text = text.replace("sigma = 0.00015 }", 'sigma = 0.15, unit = "mm" }')
    path.write_text(text.replace('is = "contact.force"', 'is = "contact.force", scale = -1'))


SAME: dict[str, Callable[[Path], None]] = {
    "seconds later": later(37.25),
    "seconds since 1970": later(1_763_740_000.5),
    "order and names": turned_round,
    "units and signs": in_other_units,
}


def fitted(folder: Path) -> Fit:
    fit = Workshop(load_study(folder)).run(Task(LABEL, {KEY: 0.3}))
    assert fit is not None
    return fit


@pytest.fixture(scope="module")
def plainly(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    folder = tmp_path_factory.mktemp("plainly")
    written(folder)
    return fitted(folder)


@pytest.mark.parametrize("how", SAME)
def test_the_same_fit(plainly: Fit, tmp_path: Path, how: str) -> None:
    written(tmp_path)
    SAME[how](tmp_path)
    found = fitted(tmp_path)
    more = abs(found.samples - plainly.samples)  # a reading at the very end may be rounded to beyond it
    assert more <= 2
    assert found.cost == pytest.approx(plainly.cost, abs=0.05 + 4.0 * more)
    assert found.values()[KEY] == pytest.approx(plainly.values()[KEY], abs=1e-4)


def test_a_channel_in_a_unit_that_is_not_said_is_seen(plainly: Fit, tmp_path: Path) -> None:
    """What is the same above is so because the study says how it was changed."""
    written(tmp_path)
    rewritten(tmp_path, lambda table, trial: table * ([1.0, 1.01, 1.01] if table.shape[1] == 3 else 1.0))
    assert fitted(tmp_path).cost > plainly.cost + 5.0


def said(folder: Path) -> dict[str, Any]:
    verdict = plain(diagnose(load_study(folder), jobs=1).verdict)
    assert isinstance(verdict, dict)
    return verdict


@pytest.mark.slow
@pytest.mark.parametrize("how", ["as it is", *SAME])
def test_the_same_verdict(plainly: Fit, tmp_path: Path, how: str) -> None:
    written(tmp_path)
    SAME.get(how, lambda folder: None)(tmp_path)
    verdict = said(tmp_path)
    assert verdict["verdict"] == "named"
    (entry,) = verdict["effects"]
    assert (entry["effect"], entry["where"]) == LABEL[0]
    assert entry["parameters"]["force_N"]["value"] == pytest.approx(plainly.values()[KEY], abs=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, 3, 4])
def test_the_same_verdict_whatever_the_noise(tmp_path: Path, seed: int) -> None:
    written(tmp_path, seed)
    verdict = said(tmp_path)
    assert verdict["verdict"] == "named"
    (entry,) = verdict["effects"]
    assert (entry["effect"], entry["where"]) == LABEL[0]
    assert entry["parameters"]["force_N"]["value"] == pytest.approx(FORCE, abs=0.02)


LENGTH, TIME, MASS = 5.0, 4.0, 60.0


def of_another_size(folder: Path) -> None:
    """A rig whose every length, time and mass is so many times larger: it moves as the first does."""
    force = MASS * LENGTH / TIME**2
    rewritten(folder, lambda t, trial: t * ([TIME, LENGTH, LENGTH] if t.shape[1] == 3 else [TIME, force]))
    units = {"mass": MASS, "stiffness": MASS / TIME**2, "damping": MASS / TIME}

    def larger(found: re.Match[str]) -> str:
        kind = found[1].rsplit("_", 1)[-1].rsplit(".", 1)[-1]
        return f"{found[1]} = {float(found[2]) * units[kind]:.12g}"

    path = folder / "study.toml"
    text = re.sub(r"(?m)^((?:\w+\.)*\w*(?:mass|stiffness|damping)) = ([\d.e+-]+)", larger, path.read_text())
    text = re.sub(r"sigma = 0.00015", f"sigma = {LENGTH * 0.00015:.12g}", text)
    path.write_text(re.sub(r"sigma = 0.25", f"sigma = {force * 0.25:.12g}", text))


SLOSH = {"mass_kg": 1.6, "frequency_Hz": 2.6, "damping_ratio": 0.04}


@pytest.mark.slow
@pytest.mark.parametrize("larger", [False, True])
def test_the_same_verdict_of_a_rig_of_another_size(tmp_path: Path, larger: bool) -> None:
    write_study(tmp_path, planted=[("hidden_oscillator", "target", SLOSH)], masses=(9.0, 23.2, 51.0))
    if larger:
        of_another_size(tmp_path)
    verdict = said(tmp_path)
    assert verdict["verdict"] == "named", verdict["why"]
    (entry,) = verdict["effects"]
    assert (entry["effect"], entry["where"]) == ("hidden_oscillator", "target")
    mass, rate = (MASS, 1.0 / TIME) if larger else (1.0, 1.0)
    assert entry["parameters"]["mass_kg"]["value"] == pytest.approx(mass * SLOSH["mass_kg"], rel=0.25)
    assert entry["parameters"]["frequency_Hz"]["value"] == pytest.approx(rate * SLOSH["frequency_Hz"], rel=0.05)
