"""A body whose tracked point is not its centre of mass: found, or said to be left unexplained."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.recordings.study import Study, load_study
from tests.diagnosis.parts.helpers_plane import in_plane

CENTRE = np.array([0.02, -0.012])
"""Of mass, from the tracked point [m]."""


def tracked(folder: Path, said: str = "") -> Study:
    """Slides that turn, tracked beside the centre of mass; the lab may say where that is."""
    in_plane(folder, turning=4.0)
    for path in folder.glob("*.csv"):
        head, *_ = path.read_text().splitlines()
        rows = np.loadtxt(path, delimiter=",", skiprows=1)
        cos, sin = np.cos(rows[:, 3]), np.sin(rows[:, 3])
        rows[:, 1] -= CENTRE[0] * cos - CENTRE[1] * sin
        rows[:, 2] -= CENTRE[0] * sin + CENTRE[1] * cos
        np.savetxt(path, rows, delimiter=",", header=head, comments="", fmt="%.7f")
    study = folder / "study.toml"
    study.write_text(study.read_text().replace("[streams.camera]\n", f"{said}[streams.camera]\n", 1))
    return load_study(folder)


def test_it_is_found(tmp_path: Path) -> None:
    verdict = diagnose(tracked(tmp_path), jobs=1).verdict
    assert verdict["verdict"] == "named"
    (found,) = verdict["effects"]
    assert (found["effect"], found["where"]) == ("off_centre", "target")
    values = [p["value"] for p in found["parameters"].values()]
    np.testing.assert_allclose(values, CENTRE, atol=0.0005)


@pytest.mark.slow
def test_without_a_name_for_it_something_is_missing_all_the_same(tmp_path: Path) -> None:
    """It leaves seven times the noise, if a hundredth of the way."""
    verdict = diagnose(tracked(tmp_path), jobs=1, without=["off_centre"]).verdict
    assert verdict["verdict"] in ("unknown", "learned")


@pytest.mark.parametrize("sigma", ["", '[baseline.sigma]\n"body.com.x" = "1 mm"\n"body.com.y" = "1 mm"\n'])
def test_what_is_stated_of_it_acts_as_it_does(sigma: str, tmp_path: Path) -> None:
    """And where it may err, the value is fitted, not named."""
    (plain,) = models_for(tracked(tmp_path))
    (model,) = models_for(tracked(tmp_path, f"com = [{CENTRE[0]}, {CENTRE[1]}, 0.0]\n{sigma}"))
    (site,) = [s for s in plain.sites() if s.effect.name == "off_centre"]
    trial = model.trials[0]
    start = np.array([n.guess for n in model.nuisances(trial)])
    centre = dict(zip(("ahead_m", "aside_m"), CENTRE, strict=True))
    missing = site.effect.edit(plain.mechanism(plain.base, trial), "target", centre)
    stated = model.mechanism(model.base, trial)
    shown = [m.predict(one, trial, start).blocks for m, one in ((plain, missing), (model, stated))]
    np.testing.assert_allclose(*shown, atol=1e-12)
    assert ("off_centre" in {s.effect.name for s in model.sites()}) is not bool(sigma)
