"""An effect in one of its forms: an effect of its own, as a class of the catalogue is, beside the plain one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spacerobot.effects.effect import FORM, Effect
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.sizes import Sizes


class FormOf(Effect):
    """Base of forms. An implementer gives what of the plain effect is otherwise, and `edit`."""

    def __init__(self, plain: Effect, form: str, **otherwise: Any) -> None:
        """Of the effect of which this is a form; `otherwise` holds the class attributes that are the form's own."""
        self.plain = plain
        alike = ("title", "phrase", "formula", "source", "kind", "parameters", "replaces", "carried")
        own = {"name": plain.name + FORM + form, "choices": 1 + len(plain.forms)}
        given = own | {key: getattr(plain, key) for key in alike} | otherwise
        for key, value in given.items():
            setattr(self, key, value)

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """As the plain one."""
        return self.plain.places(mechanism)

    def implausible(self, values: Mapping[str, float], sizes: Sizes) -> str:
        """As the plain one."""
        return self.plain.implausible(values, sizes)
