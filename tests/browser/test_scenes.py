"""Scenes in a real browser: they load in silence, and the time line moves what it should."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pixels import difference, like_stored, picture

sys.path.insert(0, str(Path(__file__).parent.parent / "view"))
from helpers_scene import free, held

from spacerobot.model.library import load
from spacerobot.recordings.study import load_study
from spacerobot.view.live.live_view import live_view
from spacerobot.view.scene3d.page import page as page_of
from spacerobot.view.scene3d.robot_film import robot_film
from spacerobot.view.scene3d.serve import PageServer
from spacerobot.view.scene3d.study_film import study_film
from spacerobot.view.scene3d.trajectory_film import trajectory_film

FILMS = {
    "arm": lambda: robot_film(load("pa10_wrist")),
    "ur5": lambda: robot_film(load("ur5")),
    "held": lambda: trajectory_film(*reversed(held())),
    "free": lambda: trajectory_film(*reversed(free())),
    "trial": lambda: study_film(load_study("guide-friction"), "04"),
}
QUICK = ("free", "trial")
"""Of which there is one in every run: a robot, and a recorded trial."""

MOMENTS = {"arm": (0.3, 5.2), "ur5": (0.4, 2.1), "held": (0.05, 0.4), "free": (0.1, 0.32), "trial": (0.5, 2.8)}
CANVAS = "#pane canvas"


@pytest.fixture(scope="session")
def pages(tmp_path_factory: pytest.TempPathFactory, chromium: Any) -> dict[str, str]:
    folder = tmp_path_factory.mktemp("scenes")
    addresses = {}
    for name, film in FILMS.items():
        path = folder / f"{name}.html"
        path.write_text(page_of(film()), encoding="utf-8")
        addresses[name] = path.as_uri()
    return addresses


def drawn(page: Any) -> None:
    """Wait until what was asked for is on the screen."""
    page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")


def alone(page: Any) -> None:
    """Leave the canvas alone on the page."""
    page.add_style_tag(content=".card, #views { visibility: hidden !important; }")


def seek(page: Any, t: float) -> None:
    page.evaluate(
        "t => { const line = document.getElementById('time'); line.value = t;"
        " line.dispatchEvent(new Event('input')); }",
        t,
    )
    drawn(page)


@pytest.mark.parametrize("name", [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in FILMS])
def test_scene_loads_in_silence_and_its_time_line_moves_it(name: str, pages: dict[str, str], visit: Any) -> None:
    first, second = MOMENTS[name]
    seen = visit(f"{pages[name]}#t={first}")
    page = seen.page
    alone(page)
    drawn(page)
    before = picture(page, CANVAS)
    assert before.std() > 0.02, "nothing was drawn"
    seek(page, second)
    after = picture(page, CANVAS)
    assert difference(before, after) > 0.002
    seek(page, first)
    assert difference(before, picture(page, CANVAS)) < 0.001
    like_stored(before, f"scene_{name}")
    seen.calm(pages[name])


def test_play_runs_and_pauses(pages: dict[str, str], visit: Any) -> None:
    seen = visit(f"{pages['held']}#t=0.1")
    page = seen.page
    clock = page.locator("#clock")
    at = clock.inner_text()
    page.keyboard.press(" ")
    page.wait_for_function("at => document.getElementById('clock').textContent !== at", arg=at)
    assert page.locator("#play").get_attribute("aria-label") == "Pause"
    page.keyboard.press(" ")
    stopped = clock.inner_text()
    page.wait_for_timeout(400)
    assert clock.inner_text() == stopped
    page.keyboard.press("ArrowRight")
    assert float(clock.inner_text().split()[0]) > float(stopped.split()[0])
    seen.calm(pages["held"])


@pytest.mark.slow
def test_reduced_motion_is_respected_and_motion_otherwise_starts_itself(pages: dict[str, str], visit: Any) -> None:
    still = visit(pages["arm"], reduced_motion="reduce")
    assert still.page.locator("#play").get_attribute("aria-label") == "Play"
    moving = visit(pages["arm"], reduced_motion="no-preference")
    assert moving.page.locator("#play").get_attribute("aria-label") == "Pause"


@pytest.mark.slow
def test_the_spring_is_seen_to_work(pages: dict[str, str], visit: Any) -> None:
    page = visit(f"{pages['arm']}#t=11.2&view=side", width=1280, height=800).page
    alone(page)
    drawn(page)
    rest = picture(page, CANVAS)
    seek(page, 12.0)
    assert difference(rest, picture(page, CANVAS)) > 0.0005


@pytest.mark.slow
def test_switches_and_views_change_the_picture(pages: dict[str, str], visit: Any) -> None:
    seen = visit(f"{pages['trial']}#t=2.8")
    page = seen.page
    drawn(page)
    before = picture(page)
    page.get_by_role("checkbox", name="recording").uncheck()
    drawn(page)
    without = picture(page)
    assert difference(before, without) > 0.003
    page.get_by_role("checkbox", name="recording").check()
    page.get_by_role("combobox", name="difference").select_option("1")
    drawn(page)
    assert difference(before, picture(page)) > 0.001
    page.get_by_role("button", name="Contact").click()
    drawn(page)
    assert difference(before, picture(page)) > 0.05
    seen.calm(pages["trial"])


def test_words_are_there_for_those_who_do_not_see(pages: dict[str, str], visit: Any) -> None:
    page = visit(f"{pages['free']}#t=0.3").page
    assert "40 kg body" in str(page.locator("#pane").get_attribute("aria-label"))
    for button in page.get_by_role("button").all():
        assert button.get_attribute("aria-label") or button.inner_text()
    names = page.locator("#readouts dt").all_inner_texts()
    values = page.locator("#readouts dd").all_inner_texts()
    assert dict(zip(names, values, strict=True))["contact force"].endswith("N")


def test_a_browser_without_webgl_is_told_in_words(pages: dict[str, str], visit: Any) -> None:
    script = "HTMLCanvasElement.prototype.getContext = () => null;"
    seen = visit(pages["arm"], script=script)
    assert seen.page.locator("#trouble").is_visible()
    assert "WebGL" in seen.page.locator("#trouble").inner_text()
    assert not seen.errors


def test_hostile_words_do_nothing(tmp_path: Path, visit: Any) -> None:
    from dataclasses import replace

    words = "</script><script>window.hit = 1</script><img src=x onerror='window.hit = 1'>"
    film = robot_film(load("wrist"))
    film = replace(film, title=words, description=words, marks=tuple(replace(m, label=words) for m in film.marks))
    film = replace(film, readouts=tuple(replace(r, name=words) for r in film.readouts))
    path = tmp_path / "hostile.html"
    path.write_text(page_of(film), encoding="utf-8")
    seen = visit(path.as_uri())
    assert seen.page.evaluate("window.hit") is None
    assert words in seen.page.locator("h1").inner_text()
    seen.calm(path.as_uri())


def test_live_page_works_over_loopback(visit: Any) -> None:
    server = PageServer(lambda: page_of(robot_film(load("wrist"))))
    server.start()
    try:
        seen = visit(f"{server.url}#t=0")
        drawn(seen.page)
        assert np.ptp(picture(seen.page)) > 0.2
        seen.calm(server.url)
    finally:
        server.close()


def test_sliders_move_the_arm_and_follow_python(visit: Any) -> None:
    with live_view("pa10_wrist") as view:
        seen = visit(view.url)
        assert seen.page.locator("#joints input[type=range]").count() == len(view.sliders)
        assert not seen.page.locator("#bar").is_visible(), "a still has no time line"
        mass = seen.page.locator("#readouts dd").first
        before, told = picture(seen.page, CANVAS), mass.inner_text()
        elbow = "#joints input[type=range][aria-label=E1]"
        seen.page.locator(elbow).evaluate("e => { e.value = 0.5; e.dispatchEvent(new Event('input')); }")
        seen.page.wait_for_function("told => document.querySelector('#readouts dd').textContent !== told", arg=told)
        assert view.positions["E1"] == pytest.approx(0.5)
        assert mass.inner_text() == f"{view.still()['readouts'][0]:.2f} kg"
        drawn(seen.page)
        assert difference(before, picture(seen.page, CANVAS)) > 0.002
        view.pose = {"E1": 1.5}
        seen.page.wait_for_function("where => Math.abs(document.querySelector(where).value - 1.5) < 1e-6", arg=elbow)
        assert not seen.errors
        assert not seen.console
        assert {r.partition("?")[0] for r in seen.requests} == {view.url, f"{view.url}/pose"}
