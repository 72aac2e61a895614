"""Contact between a space robot's compliant wrist and a free-flying body, and why the recording differs.

The names below are loaded on first use, so that `import spacerobot` stays cheap.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

__version__ = "0.1.0"

if TYPE_CHECKING:
    from spacerobot.diagnosis.answer.result import Diagnosis as Diagnosis
    from spacerobot.diagnosis.diagnose import diagnose as diagnose
    from spacerobot.diagnosis.overlay import Overlay as Overlay
    from spacerobot.diagnosis.overlay import overlay as overlay
    from spacerobot.diagnosis.study_check import check_study as check_study
    from spacerobot.dynamics.apparent_mass import ApparentMass as ApparentMass
    from spacerobot.dynamics.apparent_mass import apparent_mass as apparent_mass
    from spacerobot.dynamics.batch import effective_mass_batch as effective_mass_batch
    from spacerobot.dynamics.effective_mass import EffectiveMass as EffectiveMass
    from spacerobot.dynamics.effective_mass import effective_mass as effective_mass
    from spacerobot.dynamics.impact import Impact as Impact
    from spacerobot.dynamics.impact import impact as impact
    from spacerobot.dynamics.limits import wall_limit as wall_limit
    from spacerobot.dynamics.soft_capture import SoftCapture as SoftCapture
    from spacerobot.dynamics.soft_capture import soft_capture as soft_capture
    from spacerobot.dynamics.workspace import WorkspaceMap as WorkspaceMap
    from spacerobot.dynamics.workspace import workspace_map as workspace_map
    from spacerobot.effects.registry import all_effects as all_effects
    from spacerobot.effects.registry import effect as effect
    from spacerobot.effects.registry import load_effects as load_effects
    from spacerobot.model.library import load as load
    from spacerobot.model.library import robots as robots
    from spacerobot.model.robot import Robot as Robot
    from spacerobot.model.spacecraft import SpacecraftSpec as SpacecraftSpec
    from spacerobot.model.spacecraft import float_base as float_base
    from spacerobot.model.wrist import WristSpec as WristSpec
    from spacerobot.model.wrist import aim as aim
    from spacerobot.model.wrist import attach_wrist as attach_wrist
    from spacerobot.recordings.draft import draft_study as draft_study
    from spacerobot.recordings.example import example_recordings as example_recordings
    from spacerobot.recordings.new_study import new_study as new_study
    from spacerobot.recordings.recording import Recording as Recording
    from spacerobot.recordings.study import Study as Study
    from spacerobot.recordings.study import load_study as load_study
    from spacerobot.recordings.study_schema import study_schema as study_schema
    from spacerobot.recordings.synthetic import synthetic_study as synthetic_study
    from spacerobot.simulation.parts import ContactLaw as ContactLaw
    from spacerobot.simulation.parts import EffectAt as EffectAt
    from spacerobot.simulation.parts import Servo as Servo
    from spacerobot.simulation.parts import Target as Target
    from spacerobot.simulation.parts import Wrist as Wrist
    from spacerobot.simulation.prediction import predict as predict
    from spacerobot.simulation.scene import Scene as Scene
    from spacerobot.simulation.scene_file import read_scene as read_scene
    from spacerobot.simulation.simulate import simulate as simulate
    from spacerobot.simulation.trajectory import Trajectory as Trajectory
    from spacerobot.support.errors import InputError as InputError
    from spacerobot.sweep.run import run_sweep as run_sweep
    from spacerobot.view.capture.hit_figure import hit_figure as hit_figure
    from spacerobot.view.capture.tumble_figure import base_turn as base_turn
    from spacerobot.view.capture.tumble_figure import compare_tumbles as compare_tumbles
    from spacerobot.view.capture.tumble_figure import tumble_figure as tumble_figure
    from spacerobot.view.compare.page import compare_page as compare_page
    from spacerobot.view.compare.runs import Comparison as Comparison
    from spacerobot.view.compare.runs import compare as compare
    from spacerobot.view.live.live_view import LiveView as LiveView
    from spacerobot.view.live.live_view import live_view as live_view
    from spacerobot.view.mass.choose import mass_film as mass_film
    from spacerobot.view.mass.frequency_figure import frequency_figure as frequency_figure
    from spacerobot.view.mass.frequency_figure import responses as responses
    from spacerobot.view.mass.map_figure import map_figure as map_figure
    from spacerobot.view.mass.map_figure import slice_map as slice_map
    from spacerobot.view.mass.page import mass_pictures as mass_pictures
    from spacerobot.view.mass.path_figure import path_figure as path_figure
    from spacerobot.view.notebook.explorers import collision_explorer as collision_explorer
    from spacerobot.view.notebook.explorers import mass_explorer as mass_explorer
    from spacerobot.view.notebook.show import show as show
    from spacerobot.view.overlay.figures import trial_figure as trial_figure
    from spacerobot.view.overlay.write import write_overlay as write_overlay
    from spacerobot.view.paper.paper import Paper as Paper
    from spacerobot.view.paper.paper import paper as paper
    from spacerobot.view.proof.prove import prove as prove
    from spacerobot.view.proof.prove_again import prove_again as prove_again
    from spacerobot.view.report.plots import report_figures as report_figures
    from spacerobot.view.report.save import save_diagnosis as save_diagnosis
    from spacerobot.view.scene3d.choose import film as film
    from spacerobot.view.scene3d.page import write_page as write_page
    from spacerobot.view.table.of_studies import study_table as study_table

_LAZY: dict[str, str] = {
    # robots
    "Robot": "model.robot",
    "load": "model.library",
    "robots": "model.library",
    "attach_wrist": "model.wrist",
    "aim": "model.wrist",
    "WristSpec": "model.wrist",
    "float_base": "model.spacecraft",
    "SpacecraftSpec": "model.spacecraft",
    # effective mass
    "EffectiveMass": "dynamics.effective_mass",
    "effective_mass": "dynamics.effective_mass",
    "effective_mass_batch": "dynamics.batch",
    "ApparentMass": "dynamics.apparent_mass",
    "apparent_mass": "dynamics.apparent_mass",
    "WorkspaceMap": "dynamics.workspace",
    "workspace_map": "dynamics.workspace",
    "soft_capture": "dynamics.soft_capture",
    "SoftCapture": "dynamics.soft_capture",
    "Impact": "dynamics.impact",
    "impact": "dynamics.impact",
    "wall_limit": "dynamics.limits",
    # a meeting, simulated
    "Scene": "simulation.scene",
    "Wrist": "simulation.parts",
    "ContactLaw": "simulation.parts",
    "Target": "simulation.parts",
    "Servo": "simulation.parts",
    "EffectAt": "simulation.parts",
    "read_scene": "simulation.scene_file",
    "simulate": "simulation.simulate",
    "Trajectory": "simulation.trajectory",
    "predict": "simulation.prediction",
    "run_sweep": "sweep.run",
    "paper": "view.paper.paper",
    "Paper": "view.paper.paper",
    # studies
    "Study": "recordings.study",
    "load_study": "recordings.study",
    "draft_study": "recordings.draft",
    "example_recordings": "recordings.example",
    "new_study": "recordings.new_study",
    "check_study": "diagnosis.study_check",
    "study_table": "view.table.of_studies",
    "study_schema": "recordings.study_schema",
    "synthetic_study": "recordings.synthetic",
    "Recording": "recordings.recording",
    "Overlay": "diagnosis.overlay",
    "overlay": "diagnosis.overlay",
    "write_overlay": "view.overlay.write",
    "Diagnosis": "diagnosis.answer.result",
    "diagnose": "diagnosis.diagnose",
    "save_diagnosis": "view.report.save",
    "all_effects": "effects.registry",
    "effect": "effects.registry",
    "load_effects": "effects.registry",
    "compare": "view.compare.runs",
    "Comparison": "view.compare.runs",
    "compare_page": "view.compare.page",
    "prove": "view.proof.prove",
    "prove_again": "view.proof.prove_again",
    # pictures
    "show": "view.notebook.show",
    "film": "view.scene3d.choose",
    "live_view": "view.live.live_view",
    "LiveView": "view.live.live_view",
    "mass_film": "view.mass.choose",
    "write_page": "view.scene3d.page",
    "mass_pictures": "view.mass.page",
    "mass_explorer": "view.notebook.explorers",
    "collision_explorer": "view.notebook.explorers",
    "path_figure": "view.mass.path_figure",
    "slice_map": "view.mass.map_figure",
    "map_figure": "view.mass.map_figure",
    "responses": "view.mass.frequency_figure",
    "frequency_figure": "view.mass.frequency_figure",
    "hit_figure": "view.capture.hit_figure",
    "base_turn": "view.capture.tumble_figure",
    "tumble_figure": "view.capture.tumble_figure",
    "compare_tumbles": "view.capture.tumble_figure",
    "trial_figure": "view.overlay.figures",
    "report_figures": "view.report.plots",
    # what was given wrong
    "InputError": "support.errors",
}
"""Public name -> module under spacerobot that defines it; a test holds that type checkers read the same above."""

__all__ = ["__version__", *_LAZY]


if not TYPE_CHECKING:  # a type checker would take any name for one of ours

    def __getattr__(name: str) -> object:
        module = _LAZY.get(name)
        if module is None:
            raise AttributeError(f"module 'spacerobot' has no attribute {name!r}")
        found = getattr(importlib.import_module(f"spacerobot.{module}"), name)
        globals()[name] = found
        return found


def __dir__() -> list[str]:
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
