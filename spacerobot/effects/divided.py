"""A body divided in two: a part of it rides on a spring and a damper, and moves by itself."""

from __future__ import annotations

from spacerobot.effects.laws import DAMPER, SPRING
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate, Force


def divided(
    mechanism: Mechanism, where: str, part: str, share: float, *, stiffness: float, damping: float
) -> tuple[Mechanism, Coordinate]:
    """The mechanism with a share of one coordinate's inertia on a spring of its own; and that part's coordinate.

    Args:
        mechanism: to be edited.
        where: the coordinate.
        part: what the part is called behind the coordinate's name.
        share: less than all of the coordinate's inertia [kg or kg m^2].
        stiffness, damping: between the two.
    """
    own = mechanism.coordinates[where]
    inner = Coordinate(f"{where}.{part}", share, angular=own.angular, carrier=where)
    edited = mechanism.with_mass(where, own.mass - share).with_appendage(
        inner,
        inner.name,
        {inner.name: 1.0, where: -1.0},
        Force(f"{inner.name}.spring", inner.name, SPRING, (stiffness,)),
        Force(f"{inner.name}.damper", inner.name, DAMPER, (damping,)),
    )
    return edited, inner
