"""Reports in a real browser: silent, interactive, the same without scripts, readable in print, dark and light."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest
from pixels import difference, like_stored, picture

sys.path.insert(0, str(Path(__file__).parent.parent / "view"))
from helpers_report import KINDS, evidence, verdict

import spacerobot
from spacerobot.view.report import write_report


@pytest.fixture(scope="session")
def reports(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    folder = tmp_path_factory.mktemp("reports")
    addresses = {}
    for kind in KINDS:
        write_report(verdict(kind), evidence(), folder / f"{kind}.html")
        addresses[kind] = (folder / f"{kind}.html").as_uri()
    return addresses


@pytest.mark.parametrize("kind", KINDS)
def test_report_loads_in_silence(kind: str, reports: dict[str, str], visit: Any) -> None:
    seen = visit(reports[kind], width=1100, height=900)
    page = seen.page
    assert page.locator("#headline").is_visible()
    assert page.locator("#explorer canvas").count() == 2
    assert not page.locator(".fallback").is_visible()
    wide = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    assert wide <= 0, "the page is wider than the window"
    like_stored(picture(page), f"report_{kind}", 0.4)
    seen.calm(reports[kind])


def test_the_plot_answers_pointer_and_keys(reports: dict[str, str], visit: Any) -> None:
    seen = visit(reports["named"])
    page = seen.page
    plot = page.locator("#plot")
    plot.scroll_into_view_if_needed()
    before = picture(page, "#plot")
    page.locator("#pick-channel").select_option("contact.force")
    force = picture(page, "#plot")
    assert difference(before, force) > 0.005
    page.locator("#next-trial").click()
    assert page.locator("#pick-trial").input_value() == "02"
    page.locator("#previous").click()
    plot.focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowRight")
    said = page.locator("#readout").inner_text()
    assert said.startswith("t = 0.07")
    assert "chosen model" in said
    whole = picture(page, "#plot")
    page.keyboard.press("+")
    assert difference(whole, picture(page, "#plot")) > 0.005
    page.keyboard.press("0")
    assert difference(whole, picture(page, "#plot")) < 0.02
    page.locator("#show-before").uncheck()
    assert difference(whole, picture(page, "#plot")) > 0.002
    seen.calm(reports["named"])


def test_dragging_zooms_both_halves(reports: dict[str, str], visit: Any) -> None:
    page = visit(reports["named"]).page
    over = page.locator("#plot-values .u-over")
    over.scroll_into_view_if_needed()
    below = picture(page, "#plot-residuals")
    box = over.bounding_box()
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 60)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 60, steps=4)
    page.mouse.up()
    assert difference(below, picture(page, "#plot-residuals")) > 0.005


def test_dark_and_light(reports: dict[str, str], visit: Any) -> None:
    light = visit(reports["named"], color_scheme="light").page
    dark = visit(reports["named"], color_scheme="dark").page
    bright, dim = picture(light).mean(), picture(dark).mean()
    assert bright > 0.75
    assert dim < 0.3
    light.locator("#theme").click()
    assert picture(light).mean() < 0.3
    light.wait_for_timeout(500)  # a browser writes down what a page keeps behind the page's back
    light.reload()
    assert picture(light).mean() < 0.3, "the choice is kept"
    dark.locator("#theme").click()
    assert picture(dark).mean() > 0.75


def test_without_scripts_the_story_and_the_plots_are_there(reports: dict[str, str], visit: Any) -> None:
    seen = visit(reports["named"], java_script_enabled=False)
    page = seen.page
    assert page.locator(".fallback svg").first.is_visible()
    assert not page.locator("#explorer").is_visible()
    assert not page.locator("#theme").is_visible()
    assert not seen.errors


def test_print_shows_static_plots_on_white(reports: dict[str, str], visit: Any) -> None:
    page = visit(reports["named"], color_scheme="dark").page
    page.emulate_media(media="print")
    assert page.locator(".fallback svg").first.is_visible()
    assert not page.locator("#explorer").is_visible()
    assert not page.locator("header.top").is_visible()
    assert picture(page).mean() > 0.75
    assert len(page.pdf()) > 20_000


@pytest.mark.parametrize("width", [360, 760])
def test_narrow_windows_scroll_down_only(width: int, reports: dict[str, str], visit: Any) -> None:
    page = visit(reports["ambiguous"], width=width).page
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_keys_reach_everything(reports: dict[str, str], visit: Any) -> None:
    page = visit(reports["named"]).page
    reached = []
    for _ in range(40):
        page.keyboard.press("Tab")
        reached.append(page.evaluate("document.activeElement.id || document.activeElement.textContent.trim()"))
    assert reached[0] == "Skip to the verdict"
    assert {"theme", "pick-channel", "pick-trial", "plot", "reset"} <= set(reached)


def test_hostile_evidence_does_nothing(tmp_path: Path, visit: Any) -> None:
    words = "</script><script>window.hit = 1</script><img src=x onerror='window.hit = 1'>"
    shown, told = evidence(), verdict("named")
    shown["study"]["title"] = told["study"] = words
    shown["formulas"][0]["latex"] = r"\text{" + words + "}"
    for trace in shown["traces"]:
        trace["channel"] = trace["trial"] = words
    for hypothesis in shown["hypotheses"]:
        hypothesis["lost"] = words
    path = tmp_path / "hostile.html"
    write_report(told, shown, path)
    seen = visit(path.as_uri())
    assert seen.page.evaluate("window.hit") is None
    assert words in seen.page.locator(".study").inner_text()
    seen.calm(path.as_uri())


def test_an_overlay_is_looked_into_as_a_report_is(tmp_path: Path, visit: Any) -> None:
    """Its plot answers, nothing is wider than the window, and it has a dark side."""
    made = spacerobot.overlay(spacerobot.load_study("guide-friction"), ["03", "12"])
    spacerobot.write_overlay(made, tmp_path / "o")
    seen = visit((tmp_path / "o" / "overlay.html").as_uri(), width=1100, height=900)
    page = seen.page
    assert page.locator("#explorer canvas").count() == 2
    assert not page.locator(".fallback").is_visible()
    wide = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    assert wide <= 0, "the page is wider than the window"
    page.locator("#plot").focus()
    page.keyboard.press("ArrowRight")
    said = page.locator("#readout").inner_text()
    assert "simulated" in said
    assert "chosen model" not in said
    before = page.evaluate("getComputedStyle(document.body).backgroundColor")
    page.locator("#theme").click()
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") != before
