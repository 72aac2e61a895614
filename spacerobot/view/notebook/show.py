"""What a notebook shows: figures as pictures, films and pages as frames that need nothing else."""

from __future__ import annotations

from html import escape
from typing import Any

from matplotlib.figure import Figure

from spacerobot.diagnosis.forward.base import TrialOverlay
from spacerobot.model.robot import Robot
from spacerobot.recordings.study import Study
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.trajectory import Trajectory
from spacerobot.view.overlay.figures import trial_figure
from spacerobot.view.plotting import png
from spacerobot.view.scene3d.choose import film
from spacerobot.view.scene3d.film import Film
from spacerobot.view.scene3d.page import page


class Shown:
    """A picture or a frame, as a notebook takes it.

    Args:
        picture: PNG, or None.
        html: of a whole page, or None.
        height: of the frame [px].
        title: for those who cannot see it.
    """

    def __init__(self, picture: bytes | None, html: str | None = None, height: int = 520, title: str = "") -> None:
        self.picture, self.html, self.height, self.title = picture, html, height, title

    def _repr_mimebundle_(self, **_: Any) -> dict[str, Any]:
        import base64

        found: dict[str, Any] = {"text/plain": self.title or "picture"}
        if self.picture is not None:
            found["image/png"] = base64.b64encode(self.picture).decode()
        if self.html is not None:
            found["text/html"] = (
                f'<iframe srcdoc="{escape(self.html)}" title="{escape(self.title)}" sandbox="allow-scripts" '
                f'style="width: 100%; height: {self.height}px; border: 1px solid #ccc"></iframe>'
            )
        return found


def show(
    what: Figure | Film | Robot | Scene | Trajectory | Study | TrialOverlay, *, title: str = "", height: int = 520
) -> Shown:
    """A picture or a scene to end a cell with.

    Args:
        what: a figure of this package; a trial of an overlay; or a film, or what one can be made of: a robot, a scene,
            a trajectory, a study (its whole page goes into the notebook's output, 1 to 4 MB).
        title: for those who cannot see it; a film brings its own.
        height: of a film's frame [px].
    """
    if isinstance(what, TrialOverlay):
        return Shown(png(trial_figure(what)), title=title or f"trial {what.id}, simulated and recorded")
    if isinstance(what, Robot | Scene | Trajectory | Study):
        what = film(what)
    if isinstance(what, Film):
        return Shown(None, page(what), height, title or what.description)
    return Shown(png(what), title=title)
