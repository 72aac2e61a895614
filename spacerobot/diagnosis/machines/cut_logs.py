"""Logs of an arm's joints, each trial smoothed as far as its own pace allows and cut into pieces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from spacerobot.diagnosis.machines.doubted import Doubted
from spacerobot.diagnosis.machines.grid import Grid
from spacerobot.diagnosis.machines.joint_factors import Brought, asked_for, brought
from spacerobot.diagnosis.machines.joint_log import JointLog, Motion, kinematics
from spacerobot.diagnosis.machines.rigid import Rigid
from spacerobot.diagnosis.machines.stated_noise import Lens, still_below
from spacerobot.diagnosis.machines.test_functions import Bump
from spacerobot.diagnosis.machines.torque_pieces import FEWEST, Cutter, Recorded
from spacerobot.diagnosis.machines.windows import PIECES
from spacerobot.diagnosis.terms.data import TrialData

SHARP = 5
"""Least samples to either side of the test function through which velocities are taken, for laws with kinks."""

POINTS = 20
"""Points to either side at which a balance's test function is evaluated; faster logs are smoothed and thinned."""


@dataclass(frozen=True, eq=False)
class CutLogs:
    """Pieces of all trials.

    Attributes:
        trials: the pieces whose readings are compared.
        motion: of all pieces, by id.
        bump: the test function that the balance of each compared piece is seen through.
        lenses: of the compared pieces, in order.
    """

    trials: list[TrialData] = field(default_factory=list)
    motion: dict[str, Motion] = field(default_factory=dict)
    bump: dict[str, Bump] = field(default_factory=dict)
    lenses: list[Lens] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class LogCutter:
    """What smooths and cuts them.

    Attributes:
        cutter: of a smoothed log.
        arm, heavier: rigid, as it is believed, and with one more of each link of doubted mass.
        doubted: of the joints' channels.
        noise: standard deviations by channel.
    """

    cutter: Cutter
    arm: Rigid
    heavier: Sequence[Rigid]
    doubted: Doubted
    noise: Mapping[str, float]

    def cut(
        self,
        grids: Mapping[str, tuple[Grid, str, Mapping[str, float]]],
        raw: Mapping[str, JointLog],
        pace: float,
    ) -> CutLogs:
        """All trials.

        Args:
            grids: trial -> log, condition, overrides.
            raw: the logs smoothed by the sharpest test function.
            pace: half width of the balance's test functions [s].
        """
        out, cutter = CutLogs(), self.cutter
        for key, (grid, condition, overrides) in grids.items():
            own_pace = min(pace, (grid.time[-1] - grid.time[0]) / PIECES / FEWEST / 2.0)
            thin = max(1, int(own_pace / grid.step / POINTS))
            sharp = max(SHARP, 3 * thin)  # or noise folds over
            log = raw[key] if sharp == SHARP else kinematics(grid, cutter.joints, sharp)
            log = log.thinned(thin, self.arm, self.heavier)
            half = max(SHARP, round(own_pace / log.step))
            narrow = Bump.of(sharp, grid.step)
            beside = self._brought(key, grid, log, narrow, thin)
            slow = np.array([still_below(self.noise, j, narrow) for j in cutter.compared])
            pieces, every = cutter.pieces(Recorded(key, condition, overrides, log, half, beside), slow)
            out.motion.update({p.trial.id: p.motion for p in (*every, *pieces)})
            out.bump.update({p.trial.id: p.bump for p in pieces})
            out.lenses.extend(Lens(narrow, p.bump, thin) for p in pieces)
            out.trials.extend(p.trial for p in pieces)
        return out

    def _brought(self, key: str, grid: Grid, log: JointLog, lens: Bump, thin: int) -> dict[str, Brought]:
        """By doubted factor, what one more of it adds to a trial's log."""
        joints = self.cutter.joints
        out, motion = {}, (log.position, log.velocity, log.acceleration)
        rates = all(f"joint.{j}.velocity" in grid.value for j in joints)
        for channel in grid.value:
            for name, column in self.doubted.of(key, channel, grid.time).items():
                own = brought(channel, column, joints, lens, thin, rates=rates)
                out[name] = replace(own, rigid=asked_for(own, motion, log.turn, self.arm, self.doubted.sigma[name]))
        return out
