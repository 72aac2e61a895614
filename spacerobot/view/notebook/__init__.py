"""Pictures, scenes and sliders in Jupyter."""

from spacerobot.view.notebook.explorer import Explorer
from spacerobot.view.notebook.explorers import collision_explorer, mass_explorer
from spacerobot.view.notebook.show import Shown, show

__all__ = ["Explorer", "Shown", "collision_explorer", "mass_explorer", "show"]
