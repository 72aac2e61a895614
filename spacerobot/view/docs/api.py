"""The public names, for mkdocstrings."""

from __future__ import annotations

import importlib

import spacerobot

_FURTHER = {
    "Effective mass, further": (
        "spacerobot.dynamics.workspace.workspace_map",
        "spacerobot.dynamics.soft_capture.soft_capture",
        "spacerobot.dynamics.ellipsoid.BeltedEllipsoid",
        "spacerobot.dynamics.limits.wall_limit",
    ),
    "Effects": (
        "spacerobot.effects.effect.Effect",
        "spacerobot.effects.effect.Parameter",
        "spacerobot.effects.registry.all_effects",
    ),
    "Recordings": (
        "spacerobot.recordings.synthetic.synthetic_study",
        "spacerobot.recordings.recording.Recording",
    ),
    "Pictures": (
        "spacerobot.view.scene3d.page.page",
        "spacerobot.view.scene3d.trajectory_film.trajectory_film",
        "spacerobot.view.scene3d.robot_film.robot_film",
        "spacerobot.view.scene3d.study_film.study_film",
        "spacerobot.view.notebook.show.show",
        "spacerobot.view.notebook.explorers.mass_explorer",
        "spacerobot.view.notebook.explorers.collision_explorer",
    ),
}


def api() -> str:
    """Directives for every name of `import spacerobot`, and for what lies one step deeper."""
    lines = ["## `import spacerobot`", ""]
    for name in spacerobot.__all__:
        if name != "__version__":
            lines += [f"::: {_home(getattr(spacerobot, name))}", ""]
    for title, names in _FURTHER.items():
        lines += [f"## {title}", ""]
        for path in names:
            module, _, name = path.rpartition(".")
            if name in spacerobot.__all__:  # said above
                continue
            getattr(importlib.import_module(module), name)  # a name that is gone fails here, by name
            lines += [f"::: {path}", ""]
    return "\n".join(lines)


def _home(thing: object) -> str:
    return f"{thing.__module__}.{thing.__qualname__}"  # type: ignore[attr-defined]
