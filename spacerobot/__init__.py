"""Contact between a space robot's compliant wrist and a free-flying body, and why the recording differs.

The names below are loaded on first use, so that `import spacerobot` stays cheap.
"""

from __future__ import annotations

import importlib
from typing import Any

__version__ = "0.1.0"

_LAZY: dict[str, str] = {
    "attach_wrist": "spacerobot.model.wrist",
    "float_base": "spacerobot.model.spacecraft",
    "load": "spacerobot.model.library",
    "effective_mass": "spacerobot.dynamics.effective_mass",
    "effective_mass_batch": "spacerobot.dynamics.batch",
    "apparent_mass": "spacerobot.dynamics.apparent_mass",
    "impact": "spacerobot.dynamics.impact",
    "Scene": "spacerobot.simulation.scene",
    "Wrist": "spacerobot.simulation.parts",
    "ContactLaw": "spacerobot.simulation.parts",
    "Target": "spacerobot.simulation.parts",
    "simulate": "spacerobot.simulation.simulate",
    "Trajectory": "spacerobot.simulation.trajectory",
    "Study": "spacerobot.recordings.study",
    "load_study": "spacerobot.recordings.study",
    "diagnose": "spacerobot.diagnosis.diagnose",
    "Diagnosis": "spacerobot.diagnosis.diagnose",
}
"""Public name -> module that defines it."""

__all__ = ["__version__", *_LAZY]


def __getattr__(name: str) -> Any:
    module = _LAZY.get(name)
    if module is None:
        raise AttributeError(f"module 'spacerobot' has no attribute {name!r}")
    return getattr(importlib.import_module(module), name)
