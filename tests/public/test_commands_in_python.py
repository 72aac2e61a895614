"""Whatever the command line does has a public function: every command, every action, every option."""

from __future__ import annotations

import argparse
import dataclasses
import inspect
from collections.abc import Iterator

import pytest

import spacerobot
from spacerobot.cli.main import COMMANDS, build_parser

OF_COMMANDS = {
    "robots": "robots",
    "mass": "effective_mass",
    "simulate": "simulate",
    "paper": "paper",
    "overlay": "overlay",
    "diagnose": "diagnose",
    "compare": "compare",
    "effects": "all_effects",
    "view": "film",
    "prove": "prove",
    "sweep": "run_sweep",
    "study example": "example_recordings",
    "study new": "new_study",
    "study check": "check_study",
    "study schema": "study_schema",
    "study table": "study_table",
}
"""Command, with its action -> the function that does the same."""

WITHOUT = {"demo"}
"""Strings others together."""

OF_THE_TERMINAL = {"--json", "--overwrite", "--verbose", "--deg", "--list"}
"""How something is printed, or read from a line; results are objects in Python, and angles radians."""

OF_OPTIONS = {
    "robots": "--tip load.tip --wrist attach_wrist --chaser float_base --package-dir load.package_dirs "
    "--out Robot.urdf",
    "mass": "--q effective_mass.pose --set effective_mass.others --direction effective_mass.direction --aim aim "
    "--frame effective_mass.frame --base effective_mass.base --joints effective_mass.joints "
    "--slider effective_mass.slider --servo-stiffness Servo.stiffness --servo-damping Servo.damping "
    "--frequency effective_mass.omega --wrist-stiffness effective_mass.wrist_stiffness "
    "--target-mass effective_mass.target_mass --restitution impact.restitution --speed impact.approach_speed "
    "--pictures mass_pictures --to mass_pictures.end --out mass_pictures.out",
    "simulate": "--base Scene.base --joints Scene.joints --q Scene.pose --set Scene.others --frame Scene.tip "
    "--servo-stiffness Servo.stiffness --servo-damping Servo.damping --spacecraft-mass SpacecraftSpec.mass "
    "--hand-speed Scene.hand_speed --wrist-mass Wrist.mass --wrist-stiffness Wrist.stiffness "
    "--wrist-damping Wrist.damping --equivalent-damping Wrist.equivalent_damping "
    "--guide-friction Wrist.guide_friction --contact-stiffness ContactLaw.stiffness "
    "--contact-damping ContactLaw.damping --law ContactLaw.law --exponent ContactLaw.exponent "
    "--chi-over-k ContactLaw.chi_over_k --bilateral ContactLaw.bilateral --mu ContactLaw.mu "
    "--adhesion ContactLaw.adhesion --target-mass Target.mass --target-inertia Target.inertia "
    "--contact-point Target.contact_point --attitude Target.attitude --spin Target.spin --speed Target.speed "
    "--gap Target.gap --approach Scene.approach --gravity Scene.gravity --effect Scene.effects "
    "--effects load_effects --backend Scene.backend --duration Scene.duration --tolerance simulate.tolerance "
    "--rate simulate.rate --out Trajectory.save",
    "paper": "--out Paper.write --seed paper.seed --equivalent-damping paper.equivalent_damping",
    "overlay": "--trials overlay.trials --model overlay.model --dask overlay.workers --data load_study.data "
    "--out write_overlay",
    "diagnose": "--out save_diagnosis --data load_study.data --seed diagnose.seed --jobs diagnose.jobs "
    "--dask diagnose.workers --effects diagnose.effects_files --without diagnose.without",
    "compare": "--html compare_page",
    "effects": "--effects load_effects",
    "view": "--html write_page --live live_view --trial film.trial --data load_study.data --q film.pose "
    "--to mass_film.end --map mass_film --direction mass_film.direction --joints mass_film.joints",
    "prove": "--out prove.out --quick prove.quick --kinds prove.kinds --scenes prove.scenes --share prove.share "
    "--minutes prove.minutes "
    "--seed prove.seed --resume prove.resume --again prove_again --jobs prove.jobs --dask prove.dask "
    "--no-rivals prove.rivals --docs prove.docs --page prove.name",
    "sweep": "--out run_sweep.out --dask run_sweep.dask --jobs run_sweep.jobs --seed run_sweep.seed",
    "study new": "--out new_study.out --robot new_study.robot --rig new_study.rig --files new_study.files",
    "study check": "--data load_study.data",
    "study example": "",
    "study schema": "",
    "study table": "--out study_table --runs study_table.runs",
}
"""Command -> its options, each with the function or class that does it, and with which argument, field or method."""


def options() -> Iterator[tuple[str, list[str]]]:
    """Every command, with its action, and its options by their long names."""
    for command in COMMANDS:
        every = next(a for a in build_parser(command)._actions if isinstance(a, argparse._SubParsersAction))
        yield from _within(command, every.choices[command])


def _within(name: str, parser: argparse.ArgumentParser) -> Iterator[tuple[str, list[str]]]:
    deeper = [a for a in parser._actions if isinstance(a, argparse._SubParsersAction)]
    for action in deeper:
        for word, choice in action.choices.items():
            yield from _within(f"{name} {word}", choice)
    if not deeper:
        yield name, [a.option_strings[-1] for a in parser._actions if a.option_strings and a.dest != "help"]


FOUND = dict(options())


def table(name: str) -> dict[str, str]:
    """Option -> what does it."""
    words = OF_OPTIONS[name].split()
    return dict(zip(words[::2], words[1::2], strict=True))


def has(said: str) -> bool:
    """Whether there is such a function or class, and such an argument, field or method of it."""
    name, _, part = said.partition(".")
    if name not in spacerobot.__all__:
        return False
    thing = getattr(spacerobot, name)
    if not part:
        return callable(thing)
    if not inspect.isclass(thing):
        return part in inspect.signature(thing).parameters
    return hasattr(thing, part) or part in {f.name for f in dataclasses.fields(thing)}


def test_every_command_has_its_function() -> None:
    assert set(FOUND) - WITHOUT == set(OF_COMMANDS)
    assert all(has(name) for name in OF_COMMANDS.values())


@pytest.mark.parametrize("name", sorted(set(FOUND) - WITHOUT))
def test_every_option_has_its_argument(name: str) -> None:
    own = table(name)
    assert set(FOUND[name]) - OF_THE_TERMINAL == set(own)
    assert [said for said in own.values() if not has(said)] == []


def test_the_check_can_fail() -> None:
    for wrong in ("no_such_function", "diagnose.no_such_argument", "Scene.no_such_field"):
        assert not has(wrong)
