from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.locate.locate import locate
from spacerobot.diagnosis.terms.data import Block, TrialData
from spacerobot.diagnosis.terms.hypothesis import Believed
from spacerobot.effects.laws import DAMPER
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate, Force, Input, Readout
from spacerobot.recordings.dataroot import recordings_folder

ROOT = recordings_folder() or Path("nowhere")

AXIS = "joint.axis"
POSITION, DRIVE = f"{AXIS}.position", f"{AXIS}.torque"


class Axis:
    """A driven mass on a damper, mass and damping unknown: no contact, nothing written for it."""

    def __init__(self, mass: float, damping: float) -> None:
        unknown = {f"{AXIS}.mass": mass, f"{AXIS}.damping": damping}
        self.believed = Believed({}, {}, {}, ("all",), unknown)
        self.base: dict[str, float] = {}

    def mechanism(self, values: Mapping[str, float], trial: TrialData) -> Mechanism:
        return Mechanism(
            {AXIS: Coordinate(AXIS, values[f"{AXIS}.mass"])},
            {AXIS: {AXIS: 1.0}},
            forces=(Force("damper", AXIS, DAMPER, (values[f"{AXIS}.damping"],), role="damper"),),
            inputs=(Input("motor", AXIS, DRIVE),),
            readouts={POSITION: Readout(POSITION, "position", AXIS)},
            sensors={"drive": (POSITION, DRIVE)},
        )


def trial(time: np.ndarray, position: np.ndarray, force: np.ndarray, sigma: tuple[float, float]) -> TrialData:
    weight = np.array([np.full(time.size, 1.0 / s) for s in sigma])
    block = Block("drive", (POSITION, DRIVE), time, np.array([position, force]), weight)
    return TrialData("one", "all", {}, (block,), float(time[0]), float(time[-1]))


def driven(friction: float, seed: int = 0) -> TrialData:
    """Ten seconds of a smooth motion, and the force that it takes."""
    time = np.arange(0.0, 10.0, 2e-3)
    x = 0.1 * np.sin(2.0 * time) + 0.03 * np.sin(5.3 * time)
    v = 0.2 * np.cos(2.0 * time) + 0.159 * np.cos(5.3 * time)
    a = -0.4 * np.sin(2.0 * time) - 0.8427 * np.sin(5.3 * time)
    rng = np.random.default_rng(seed)
    force = 20.0 * a + 50.0 * v + friction * np.sign(v) + 0.5 * rng.normal(size=time.size)
    return trial(time, x + 1e-6 * rng.normal(size=time.size), force, (1e-6, 0.5))


def test_friction_of_a_driven_axis() -> None:
    top = locate(Axis(22.0, 40.0), (driven(3.0),)).rows[0]
    assert (top.balance, top.phase, top.depends_on) == (AXIS, "all", "sign of velocity")
    assert top.coefficient == pytest.approx(3.0, rel=0.1)
    assert top.share > 0.9


def test_a_frictionless_axis_closes_though_its_mass_and_damping_are_guesses() -> None:
    found = locate(Axis(22.0, 40.0), (driven(0.0),))
    assert found.found(0.05) == ()
    assert found.totals[0].chi2 < 1.3 * found.totals[0].freedom


@pytest.mark.real
def test_emps_drive_has_dry_friction() -> None:
    scipy_io = pytest.importorskip("scipy.io")
    file = ROOT / "real" / "emps" / "DATA_EMPS.mat"
    if not file.is_file():
        pytest.skip("no EMPS recording under SPACEROBOT_DATA")
    data = {k: np.ravel(v) for k, v in scipy_io.loadmat(file).items() if not k.startswith("_")}
    force = float(data["gtau"][0]) * data["vir"]
    found = locate(Axis(95.0, 200.0), (trial(data["t"], data["qm"], force, (1e-6, 20.0)),))
    top = found.rows[0]
    assert top.depends_on == "sign of velocity"
    assert top.p < 0.01
    assert top.coefficient == pytest.approx(20.4, abs=1.5)  # published, with viscous friction and an offset
    assert {r.depends_on for r in found.found()} & {"direction of motion", "constant"}  # friction is not symmetric
