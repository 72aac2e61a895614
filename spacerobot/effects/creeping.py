"""Dry friction that is smooth about rest: below a speed it is a damper, so that what it holds creeps."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.form import FormOf
from spacerobot.effects.kernel import Kernel
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.plane import across, along_all
from spacerobot.effects.primitives import Force
from spacerobot.effects.sizes import Sizes

KIND = "creeping"

LEAST = 1e-5
"""Speed [m/s] from which down nobody sees it creep."""

SLOW = 0.5
"""Its speed is at most this share of the typical one: twice it, friction has 96 % of its level. What is not level
wherever it was seen is a damper in disguise."""


def force(d: float, v: float, aux: float, p: Any) -> float:
    """One component of -F tanh(|v|/w) v/|v|; aux is the rate across, p = (force, speed)."""
    speed = math.sqrt(v * v + aux * aux)
    return -p[0] * v / p[1] if speed < 1e-6 * p[1] else -p[0] * math.tanh(speed / p[1]) * v / speed


KERNEL = Kernel(force)


class Creeping(FormOf):
    """Coulomb friction without sticking: the plain one as its speed goes to nothing."""

    limits: ClassVar[Mapping[str, float]] = {"velocity_m_s": LEAST}

    def __init__(self, plain: Effect) -> None:
        own = Parameter("velocity_m_s", "m/s", 1e-3, 1e-3, LEAST, 10.0, (1e-3, 1e-2, 1e-4), log=True, shape=True)
        super().__init__(
            plain,
            KIND,
            title=f"{plain.title} (smooth about rest)",
            phrase=f"{plain.title} (smooth about rest)",
            formula=r"f = -F_c \tanh(v / v_0)",
            source="Andersson, Soderberg, Bjorklund (2007), Tribology International 40, 580-587",
            parameters=(*plain.parameters, own),
            replaces=plain.replaces,
            refines=(plain.name,),
            settings={"kind": KIND},
            carried=plain.carried,
            choices=1 + len(plain.forms),
        )

    def implausible(self, values: Mapping[str, float], sizes: Sizes) -> str:
        """It is level at the speeds that were seen."""
        share = values["velocity_m_s"] * sizes.time / sizes.length
        return "" if share <= SLOW else f"level only beyond {share:.2g} times the typical speed: a damper in disguise"

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """A force that changes its sign smoothly."""
        p, others = (values["force_N"], values["velocity_m_s"]), across(mechanism, where)
        if others:
            return mechanism.with_force(*along_all(self.name, (where, *others), KERNEL, p))
        return mechanism.with_force(Force(f"{self.name} at {where}", where, KERNEL, p))
