"""Effective mass in a real browser: the page of pictures, a path, a map, and a notebook's frame."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pixels import difference, like_stored, picture

from spacerobot.model.library import load
from spacerobot.view.mass.films import map_film, path_film
from spacerobot.view.mass.page import MassQuestion, mass_files
from spacerobot.view.notebook.show import show
from spacerobot.view.scene3d.page import page as page_of
from spacerobot.view.scene3d.robot_film import robot_film

POSE = np.radians([0, 45, 0, 90, 0, -45, 0])
END = np.radians([0, 10, 0, 60, 0, 20, 0])
X = np.array([1.0, 0.0, 0.0])
CANVAS = "#pane canvas"


@pytest.mark.slow
def test_pictures_page_is_silent_and_its_pictures_are_seen(tmp_path: Path, visit: Any) -> None:
    path = tmp_path / "mass.html"
    path.write_text(str(mass_files(MassQuestion(load("pa10_wrist"), POSE, X, END))["mass.html"]), encoding="utf-8")
    seen = visit(path.as_uri())
    sizes = seen.page.evaluate("Array.from(document.images).map(i => [i.naturalWidth, i.width, i.alt.length])")
    assert len(sizes) == 4
    assert all(natural > 300 and shown > 300 and words > 20 for natural, shown, words in sizes)
    assert not seen.errors
    assert not seen.console
    assert all(r.startswith(("file:", "data:")) for r in seen.requests)
    assert "7.84" in seen.page.locator("p").first.inner_text()


@pytest.mark.parametrize("name", ["path", "map"])
@pytest.mark.slow
def test_scenes_of_mass_load_in_silence_and_move(name: str, tmp_path: Path, visit: Any) -> None:
    film = path_film(load("pa10_wrist"), POSE, END, X) if name == "path" else map_film(load("pa10_wrist"), POSE, X)
    path = tmp_path / f"{name}.html"
    path.write_text(page_of(film), encoding="utf-8")
    pictures = []
    for at in (1.0, 4.0):
        seen = visit(f"{path.as_uri()}#t={at}")
        seen.page.add_style_tag(content=".card, #views { visibility: hidden !important; }")
        seen.page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        pictures.append(picture(seen.page, CANVAS))
        seen.calm(path.as_uri())
    assert difference(*pictures) > 0.002
    like_stored(pictures[0], f"mass_{name}")


@pytest.mark.slow
def test_a_notebooks_frame_shows_its_scene(tmp_path: Path, visit: Any) -> None:
    path = tmp_path / "cell.html"
    frame = show(robot_film(load("pa10_wrist")))._repr_mimebundle_()["text/html"]
    path.write_text(f"<!DOCTYPE html><title>cell</title>{frame}", encoding="utf-8")
    seen = visit(path.as_uri())
    inside = seen.page.frame_locator("iframe")
    inside.locator("#clock").wait_for()
    before = picture(seen.page, "iframe")
    assert before.std() > 0.02
    inside.locator("body").press("ArrowRight")
    for _ in range(20):
        inside.locator("body").press("Shift+ArrowRight")
    seen.page.wait_for_timeout(300)
    assert difference(before, picture(seen.page, "iframe")) > 0.001
    assert not seen.errors
    assert {r.partition("#")[0] for r in seen.requests if not r.startswith("about:")} == {path.as_uri()}
