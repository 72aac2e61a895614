"""A load on a link whose place there is known: how heavy it is remains open."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from spacerobot.effects.effect import FORM, Effect
from spacerobot.effects.mechanism import Mechanism

AXES = ("x_m", "y_m", "z_m")
"""Names of the parameters that say where a load is, in its link's frame."""


UM = 1e-6
"""A name holds a place to a micrometre [m]: as digits alone, for dots and spaces part names elsewhere."""


def form_of(place: Iterable[float]) -> str:
    """The name of a form, of a place [m]."""
    return "_".join(str(round(x / UM)) for x in place)


def place_of(form: str) -> tuple[float, float, float]:
    """The place [m] that the name of a form says.

    Raises:
        ValueError: it is no such name.
    """
    x, y, z = (int(word) * UM for word in form.split("_"))
    return x, y, z


class LoadAt(Effect):
    """A load at a place: a form of the one at any."""

    def __init__(self, plain: Effect, place: tuple[float, float, float]) -> None:
        """Of the effect of which this is a form, at a place [m] in the link's frame."""
        self.plain, self.place = plain, dict(zip(AXES, place, strict=True))
        given = {
            "name": plain.name + FORM + form_of(place),
            "title": plain.title,
            "phrase": plain.phrase,
            "formula": plain.formula,
            "source": plain.source,
            "kind": plain.kind,
            "together": plain.together,
            "parameters": plain.parameters[:1],
            "settings": self.place,
        }
        for key, value in given.items():
            setattr(self, key, value)  # an instance is an effect of its own, as a class of the catalogue is

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Links that move."""
        return self.plain.places(mechanism)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The load at its place."""
        return self.plain.edit(mechanism, where, {**values, **self.place})
