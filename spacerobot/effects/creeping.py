"""Dry friction that is smooth about rest: below a speed it is a damper, so that what it holds creeps."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import ClassVar

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.form import FormOf
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.plane import across, along_all
from spacerobot.effects.primitives import Force
from spacerobot.effects.sizes import Sizes

KIND = "creeping"

CREEP = "creep_m_s"
"""Name of the speed below which it is a damper."""

LEAST = 1e-5
"""Speed [m/s] from which down nobody sees it creep."""

SLOW = 0.125
"""Its speed is at most this share of the typical one. Simulators smooth friction at a hundredth to a tenth of the
speeds that they are for; a seal whose drag saturates at a third of them is a damper, and no dry friction."""


def along(v: float, aux: float, creep: float) -> float:
    """The share of a friction that acts along one direction, from -1 to 1: tanh(|v| / w) v / |v|.

    Args:
        v: speed along it.
        aux: speed across it.
        creep: w.
    """
    speed = math.sqrt(v * v + aux * aux)
    return v / creep if speed < 1e-6 * creep else math.tanh(speed / creep) * v / speed


class Creeping(FormOf):
    """A friction without sticking: the plain one as its speed goes to nothing."""

    limits: ClassVar[Mapping[str, float]] = {CREEP: LEAST}

    def __init__(self, plain: Effect, kernel: Kernel, level: str) -> None:
        """Of a friction, its law smoothed, p = (parameters of the plain one, speed), and its level in LaTeX."""
        self.kernel = kernel
        own = Parameter(CREEP, "m/s", 1e-3, 1e-3, LEAST, 10.0, (1e-3, 1e-2, 1e-4), log=True, shape=True)
        super().__init__(
            plain,
            KIND,
            title=f"{plain.title} (smooth about rest)",
            phrase=f"{plain.title} (smooth about rest)",
            formula=rf"f = -{level} \tanh(v / v_0)",
            source=f"{plain.source}; smoothed as by Andersson, Soderberg, Bjorklund (2007), Tribology Int. 40, 580-587",
            parameters=(*plain.parameters, own),
            refines=(plain.name,),
            settings={"kind": KIND},
        )

    def implausible(self, values: Mapping[str, float], sizes: Sizes) -> str:
        """It is as the plain one at the speeds that were seen."""
        share = values[CREEP] * sizes.time / sizes.length
        if share > SLOW:
            return f"level only beyond {share:.2g} times the typical speed: a damper in disguise"
        return self.plain.implausible(values, sizes)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A force that changes its sign smoothly."""
        p, others = tuple(values[q.name] for q in self.parameters), across(mechanism, where)
        if others:
            return mechanism.with_force(*along_all(self.name, (where, *others), self.kernel, p))
        return mechanism.with_force(Force(f"{self.name} at {where}", where, self.kernel, p))
