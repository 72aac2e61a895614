"""A figure with sliders: drag, and it is drawn again."""

from __future__ import annotations

import base64
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure

from spacerobot.support.errors import InputError
from spacerobot.view.plotting import png


@dataclass(frozen=True)
class Slide:
    """One slider.

    Attributes:
        label: what a person reads, with its unit.
        value: at the start.
        low, high, step: of the slider.
    """

    label: str
    value: float
    low: float
    high: float
    step: float


class Explorer:
    """A figure as a function of numbers that a person drags.

    In Jupyter it is a widget; in an export of the notebook it is the picture that was last drawn.

    Args:
        draw: takes the sliders' values by name and returns a figure and a line of text.
        slides: by the names of `draw`'s arguments.

    Raises:
        InputError: ipywidgets is not installed.
    """

    def __init__(self, draw: Callable[..., tuple[Figure, str]], slides: dict[str, Slide]) -> None:
        try:
            import ipywidgets
        except ImportError:
            raise InputError("sliders need ipywidgets", valid="pip install 'spacerobot[notebooks]'") from None
        self._draw = draw
        self.sliders = {
            name: ipywidgets.FloatSlider(
                value=s.value, min=s.low, max=s.high, step=s.step, description=s.label, continuous_update=False,
                style={"description_width": "12em"}, layout={"width": "38em"},
            )
            for name, s in slides.items()
        }  # fmt: skip
        self.picture = ipywidgets.Image(format="png", layout={"max_width": "100%"})
        self.text = ipywidgets.Label()
        self.widget = ipywidgets.VBox([*self.sliders.values(), self.text, self.picture])
        for slider in self.sliders.values():
            slider.observe(self._redraw, names="value")
        self._redraw()

    def _redraw(self, _: Any = None) -> None:
        try:
            figure, text = self._draw(**{name: slider.value for name, slider in self.sliders.items()})
        except InputError as error:  # a corner of the sliders that physics does not allow
            self.text.value = str(error)
            return
        self.picture.value, self.text.value = png(figure), text

    def _repr_mimebundle_(self, **_: Any) -> dict[str, Any]:
        found: dict[str, Any] = dict(self.widget._repr_mimebundle_())
        found["image/png"] = base64.b64encode(self.picture.value).decode()
        found["text/plain"] = self.text.value
        return found
