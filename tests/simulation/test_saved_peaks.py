"""What a trajectory says of its peaks is the same after it was written and read."""

from __future__ import annotations

from pathlib import Path

from spacerobot.simulation.scene import Scene
from spacerobot.simulation.simulate import simulate
from spacerobot.simulation.trajectory import Trajectory


def test_peaks_come_back_as_they_were(tmp_path: Path) -> None:
    made = simulate(Scene(), duration=0.5)
    read = Trajectory.load(made.save(tmp_path / "run"))
    for name in ("force", "deflection"):
        here, there = getattr(made, f"peak_{name}"), getattr(read, f"peak_{name}")
        assert (there.value, there.time) == (here.value, here.time)
    assert made.peak_force != made.peak_deflection
