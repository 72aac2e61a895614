"""Every number of a scene has a unit, and every unit a number."""

from __future__ import annotations

import dataclasses

from spacerobot.simulation.scene import Scene
from spacerobot.simulation.scene_toml import TABLES
from spacerobot.simulation.scene_units import UNITS

NO_NUMBERS = {"contact.law", "contact.bilateral", "spacecraft.panels"}
OF_A_SCENE = {"robot", "base", "joints", "tip", "approach", "effects", "backend", "title", *TABLES}


def test_every_number_of_a_scene_has_a_unit() -> None:
    parts = {f"{part}.{f.name}" for part, kind in TABLES.items() for f in dataclasses.fields(kind)} - NO_NUMBERS
    plain = {f.name for f in dataclasses.fields(Scene)} - OF_A_SCENE
    plain = plain - {"hand_speed"} | {"chaser.hand_speed"}  # which the file has in a table of its own
    assert set(UNITS) == parts | plain


def test_units_are_those_of_the_docstrings() -> None:
    """Where a docstring states one unit for a field, it is this one."""
    for part, kind in TABLES.items():
        said = " ".join((kind.__doc__ or "").split())
        for field in dataclasses.fields(kind):
            name = f"{part}.{field.name}"
            if name in UNITS and UNITS[name] != "1":
                own = said.partition(f"{field.name}: ")[2]
                assert UNITS[name].partition(",")[0].split(" or ")[0] in own, name
