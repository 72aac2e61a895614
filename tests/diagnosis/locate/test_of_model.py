from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.locate.of_model import _with_drive, locate_model
from spacerobot.diagnosis.locate.samples import Grid
from spacerobot.diagnosis.locate.windows import Splines, Windows
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.machines.contract import Machine
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.machines.simulated import Simulated
from spacerobot.recordings.dataroot import recordings_folder
from spacerobot.recordings.study import load_study
from tests.diagnosis.parts.test_weak_thrusters import air_bed

STUDIES = Path(__file__).resolve().parents[3] / "examples" / "studies" / "real"


def models(name: str) -> dict[str, Machine]:
    top = recordings_folder()
    if top is None or not (top / "real" / name).exists():
        pytest.skip("the real recordings are not here: set SPACEROBOT_DATA")
    return {m.name: m for m in models_for(load_study(STUDIES / name))}


@pytest.mark.slow
@pytest.mark.real
def test_dry_friction_in_the_joints_of_a_real_arm() -> None:
    found = {name: locate_model(m) for name, m in models("franka_exciting").items()}
    # The joints resist both by the sign of their velocity and by its size: which of the two explains more of a joint's
    # residual is close in some. Where something else leads (joint 2: a constant torque), the sign must still be seen.
    dry = {name: next(r for r in f.rows if r.depends_on == "sign of velocity") for name, f in found.items()}
    assert len(dry) == 7
    assert all(row.p < 0.01 for row in dry.values())
    leads = [name for name, f in found.items() if f.rows[0].depends_on in ("sign of velocity", "velocity")]
    assert len(leads) >= 5
    assert sum(found[name].rows[0] is dry[name] for name in leads) >= 4
    assert all(dry[name].coefficient > 0.1 for name in leads)
    assert all(f.totals[0].unit == "N m" for f in found.values())


@pytest.mark.real
def test_a_real_drive() -> None:
    (model,) = models("emps").values()
    assert isinstance(model, InverseDynamics)
    top = locate_model(model).rows[0]
    assert (top.balance, top.depends_on) == ("joint.axis", "sign of velocity")
    assert locate_model(model).totals[0].unit == "N"


def test_what_a_held_command_brings_is_what_it_brought(tmp_path: Path) -> None:
    """It is written at both ends of its jumps; a smooth curve through such pairs brought five hundred times as much."""
    (model,) = models_for(air_bed(tmp_path, 1.0, 1.0))
    assert isinstance(model, Simulated)
    windows = Windows((Splines(1.0, 7.0, 24),))
    fine = np.linspace(1.0, 7.0, 60_001)
    for name, trial in model.recorded.items():
        drive, block = model.drives[name], _with_drive(model, trial).blocks[-1]
        brought = Grid.of(windows, block.time, 0.25).weights(0) @ block.value.T
        held = np.array([np.interp(fine, drive.time, drive.value[c]) for c in block.channels])
        meant = windows.values(fine, 0) @ held.T * (fine[1] - fine[0])
        assert np.abs(brought - meant).max() < 0.1 * np.abs(meant).max()
