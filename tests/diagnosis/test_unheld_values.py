"""What no sigma holds is fitted: a constant that is there to absorb, an absent value, a zero that was found."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.fitting.workshop import Task, Workshop
from spacerobot.diagnosis.machines.rig_values import together
from spacerobot.diagnosis.terms.candidates import candidate_sites
from spacerobot.recordings.study import Study, load_study
from tests.diagnosis.rigs import BELIEVED, write_study

FRICTION = "coulomb_friction@wrist.force_N"
PLANTED = [("coulomb_friction", "wrist", {"force_N": 0.3})]
NO_MORE = {"wrist.equivalent_damping": 0.0}


def changed(study: Study, *edits: tuple[str, str]) -> Study:
    text = study.path.read_text()
    for old, new in edits:
        assert old in text, old
        text = text.replace(old, new, 1)
    study.path.write_text(text)
    return load_study(study.path)


@pytest.mark.parametrize("stated", [0.5, 6.0])
def test_a_constant_that_absorbs_does_not_hold_off_what_was_left_out(tmp_path: Path, stated: float) -> None:
    """Whatever number it has, without a sigma friction is what it is; and nothing acts as it does beside it."""
    study = write_study(tmp_path, planted=PLANTED, truth=NO_MORE, believed={"wrist.equivalent_damping": stated})
    workshop = Workshop(changed(study, ('"wrist.equivalent_damping" = 0.15\n', "")))
    fit = workshop.run(Task((("coulomb_friction", "wrist"),), {FRICTION: 0.2}))
    assert fit is not None
    assert fit.chi2 < 1.05 * fit.samples
    low, high = fit.errors()[FRICTION]
    assert abs(fit.values()[FRICTION] - 0.3) < 1.5 * (high - low)
    mechanism = workshop.model.mechanism({**workshop.model.base, **workshop.trials[0].overrides})
    assert "viscous_friction" not in {s.effect.name for s in candidate_sites(mechanism, workshop.model.believed)}


def test_the_damping_goes_with_it(tmp_path: Path) -> None:
    """Less damping than is believed of the wrist alone: the constant falls below zero, and the rig has their sum."""
    study = write_study(tmp_path, truth={"wrist.damping": 1.0, "wrist.equivalent_damping": 0.0})
    workshop = Workshop(changed(study, ('"wrist.equivalent_damping" = 0.15\n', "")))
    fit = workshop.run(Task((), {"wrist.equivalent_damping": 0.0}))
    assert fit is not None
    low, high = fit.errors()["wrist.equivalent_damping"]
    assert abs(fit.values()["wrist.equivalent_damping"] - (1.0 - BELIEVED["wrist.damping"])) < 1.5 * (high - low)
    assert fit.chi2 < 1.05 * fit.samples


def test_a_rig_whose_damping_nobody_stated_has_one(tmp_path: Path) -> None:
    study = write_study(tmp_path)
    lines = [line for line in study.path.read_text().splitlines() if "damping" not in line]
    study.path.write_text("\n".join(lines) + "\n")
    workshop = Workshop(load_study(study.path))
    fit = workshop.run(Task((), {"wrist.equivalent_damping": 4.0}))
    assert fit is not None
    assert fit.chi2 < 1.05 * fit.samples
    both = BELIEVED["wrist.damping"] + 5.0
    assert fit.values()["wrist.equivalent_damping"] == pytest.approx(both, rel=0.05)


def test_no_constant_is_below_zero_in_the_rig() -> None:
    both = {"wrist.damping": 2.0, "wrist.equivalent_damping": -0.5}
    assert together(both) == {"wrist.damping": 1.5, "wrist.equivalent_damping": 0.0}
    assert together({"wrist.damping": 2.0}) == {"wrist.damping": 2.0}


@pytest.mark.parametrize("key", ["mass", "stiffness"])
def test_an_absent_value_is_fitted(tmp_path: Path, key: str) -> None:
    study = write_study(tmp_path)
    stated = next(line for line in study.path.read_text().splitlines() if line.startswith(f"{key} = "))
    unknown = (f"{stated}\n", f'{key} = "unknown"\n')
    workshop = Workshop(changed(study, (f'"wrist.{key}" = 0.01\n', ""), unknown))
    fit = workshop.run(Task((), {}))
    assert fit is not None
    assert fit.chi2 < 1.05 * fit.samples
    assert fit.values()[f"wrist.{key}"] == pytest.approx(BELIEVED[f"wrist.{key}"], rel=0.01)


def test_a_zero_that_was_found_is_found_again(tmp_path: Path) -> None:
    """Half a millimetre off with 0.3 mm stated: the fit takes it back; held exact it cannot."""
    study = write_study(tmp_path)
    off = 5e-4
    for trial in study.trials:
        file = tmp_path / trial.sources["mocap"].file
        head, *rows = file.read_text().splitlines()
        table = np.array([[float(cell) for cell in row.split(",")] for row in rows])
        table[:, 1] += off
        np.savetxt(file, table, "%.7f", ",", header=head, comments="")
    held = Workshop(load_study(study.path)).run(Task((), {}))
    line = 'is = "target.x",'
    found = Workshop(changed(study, (line, f"{line} offset_sigma = 3e-4,"))).run(Task((), {}))
    assert held is not None
    assert found is not None
    assert held.chi2 > 1.3 * held.samples
    assert found.chi2 < 1.05 * found.samples
    assert found.values()["target.x.zero"] == pytest.approx(off, abs=5e-5)
