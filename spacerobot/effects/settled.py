"""An effect whose shape is known: how much there is of it remains open."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from spacerobot.effects.effect import Effect
from spacerobot.effects.form import FormOf
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


class Shaped(Effect):
    """An effect whose shape may be settled."""

    def in_form(self, form: str) -> Effect:
        """The effect in a shape that is known, its numbers in millionths; how much there is of it remains open."""
        try:
            return Settled(self, form)
        except ValueError:
            return super().in_form(form)


class Settled(FormOf):
    """An effect in one shape: a form of the one in any."""

    def __init__(self, plain: Effect, form: str) -> None:
        """Of the effect of which this is a form.

        Raises:
            ValueError: the form does not say as many numbers as the effect's shape has.
        """
        names = [p.name for p in plain.parameters if p.shape]
        self.shape = dict(zip(names, shape_of(form), strict=True))
        open_to = tuple(p for p in plain.parameters if not p.shape)
        super().__init__(plain, form, parameters=open_to, settings=self.shape, together=plain.together)

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The effect in its shape."""
        return self.plain.edit(mechanism, where, {**values, **self.shape})
