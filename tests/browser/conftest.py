"""Headless chromium for pages; tests skip, saying why, where it or its driver is absent."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

ARGUMENTS = [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--force-device-scale-factor=1",
    "--hide-scrollbars",
]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.browser)
            item.add_marker(pytest.mark.xdist_group("browser"))


def chromium_path() -> str | None:
    named = os.environ.get("SPACEROBOT_CHROMIUM")
    return named or next((p for p in map(shutil.which, ("chromium", "chromium-browser", "google-chrome")) if p), None)


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed (extra 'browser')")
    path = chromium_path()
    if path is None:
        pytest.skip("no chromium on this machine")
    with api.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=ARGUMENTS)
        yield browser
        browser.close()


@dataclass
class Visit:
    """An open page and what went on in it."""

    page: Any
    console: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    def calm(self, own: str) -> None:
        """Nothing said on the console, nothing thrown, nothing asked for but the page itself."""
        assert not self.errors
        assert not self.console
        assert {r.partition("#")[0] for r in self.requests} == {own}


@pytest.fixture
def visit(chromium: Any) -> Iterator[Any]:
    contexts = []

    def opened(address: str, *, width: int = 960, height: int = 640, script: str = "", **options: Any) -> Visit:
        context = chromium.new_context(viewport={"width": width, "height": height}, **options)
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(60_000)
        found = Visit(page)
        page.on("console", lambda m: found.console.append(f"{m.type}: {m.text}"))
        page.on("pageerror", lambda e: found.errors.append(str(e)))
        page.on("request", lambda r: found.requests.append(r.url))
        if script:
            page.add_init_script(script)
        page.goto(address)
        return found

    yield opened
    for context in contexts:
        context.close()
