"""The documentation opened from its folder: silent, nothing fetched, formulas typeset, search and scenes at work."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

SITE = Path(__file__).resolve().parents[2] / "site"
PAGES = ["index", "howto", "commands", "physics", "effects", "formats", "api", "notebooks/index"]

pytestmark = pytest.mark.skipif(not (SITE / "index.html").is_file(), reason="no site: `make docs` builds it")


def at_home(requests: list[str]) -> bool:
    return all(r.startswith((SITE.as_uri(), "data:", "blob:", "about:")) for r in requests)


NOTEBOOKS = sorted(f"notebooks/{p.stem}" for p in SITE.glob("notebooks/0?_*[a-z].html"))
LONG = ("notebooks/04_from_touch_to_tumble",)


@pytest.mark.parametrize(
    "name", [*PAGES, *(pytest.param(n, marks=pytest.mark.slow) if n in LONG else n for n in NOTEBOOKS)]
)
def test_page_opens_in_silence(name: str, visit: Any) -> None:
    seen = visit((SITE / f"{name}.html").as_uri())
    seen.page.wait_for_load_state("load")
    seen.page.wait_for_timeout(500)  # for what scripts ask for; a worker of the search may never be idle
    assert not seen.errors
    assert not [m for m in seen.console if "GPU stall" not in m]  # swiftshader reading back a scene's pixels
    assert at_home(seen.requests)
    assert "FORMULA" not in seen.page.locator("article").inner_text()
    broken = "Array.from(document.images).filter(i => i.complete && !i.naturalWidth).map(i => i.src)"
    assert seen.page.evaluate(broken) == []


def test_formulas_are_drawn_as_formulas(visit: Any) -> None:
    page = visit((SITE / "physics.html").as_uri()).page
    formula = page.locator("math[display=block]").first
    box = formula.bounding_box()
    assert box["height"] > 30, "a fraction is higher than a line of text"
    assert page.locator("math[display=inline]").count() > 5


def test_search_finds_without_a_server(visit: Any) -> None:
    page = visit((SITE / "index.html").as_uri(), width=1280).page
    page.keyboard.press("/")
    page.keyboard.type("coulomb friction")
    page.wait_for_selector(".md-search-result__item")
    assert "effects" in page.locator(".md-search-result__link").first.get_attribute("href")


def test_a_scene_plays_inside_a_notebooks_page(visit: Any) -> None:
    page = visit((SITE / "notebooks" / "03_the_collision.html").as_uri(), width=1280, height=900).page
    frame = page.locator("iframe").first
    frame.scroll_into_view_if_needed()
    inside = page.frame_locator("iframe").first
    clock = inside.locator("#clock")
    clock.wait_for()
    first = clock.inner_text()
    for _ in range(40):
        inside.locator("body").press("ArrowRight")
        page.wait_for_timeout(250)
        if clock.inner_text() != first:
            return
    raise AssertionError(f"the clock stands at {first}")
