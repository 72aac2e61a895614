"""An effect whose shape is known: how much there is of it remains open."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from spacerobot.effects.effect import FORM, Effect, Parameter
from spacerobot.effects.mechanism import Mechanism

MILLIONTH = 1e-6
"""A name holds the numbers of a shape to a millionth (a place [m] to a micrometre): as digits alone, for dots and
spaces part names elsewhere."""


def form_of(shape: Iterable[float]) -> str:
    """The name of a form, of the numbers of its shape."""
    return "_".join(str(round(x / MILLIONTH)) for x in shape)


def shape_of(form: str) -> tuple[float, ...]:
    """The numbers that the name of a form says.

    Raises:
        ValueError: it is no such name.
    """
    return tuple(int(word) * MILLIONTH for word in form.split("_"))


def shaped(effect: Effect) -> tuple[Parameter, ...]:
    """What a form of an effect settles."""
    return tuple(p for p in effect.parameters if p.shape)


class Settled(Effect):
    """An effect in one shape: a form of the one in any."""

    def __init__(self, plain: Effect, form: str) -> None:
        """Of the effect of which this is a form.

        Raises:
            ValueError: the form does not say as many numbers as the effect's shape has.
        """
        names = [p.name for p in shaped(plain)]
        self.plain, self.shape = plain, dict(zip(names, shape_of(form), strict=True))
        given = {
            "name": plain.name + FORM + form,
            "title": plain.title,
            "phrase": plain.phrase,
            "formula": plain.formula,
            "source": plain.source,
            "kind": plain.kind,
            "together": plain.together,
            "parameters": tuple(p for p in plain.parameters if not p.shape),
            "settings": self.shape,
        }
        for key, value in given.items():
            setattr(self, key, value)  # an instance is an effect of its own, as a class of the catalogue is

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Those of the effect in any shape."""
        return self.plain.places(mechanism)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The effect in its shape."""
        return self.plain.edit(mechanism, where, {**values, **self.shape})
