"""The search index as a script too, so that the search works in a site that is opened from a folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mkdocs.plugins import event_priority

_SHIM = '<script src="{base}javascripts/worker.js"></script>\n'


@event_priority(-100)
def on_post_build(config: Any) -> None:
    """Write search_index.js beside search_index.json."""
    index = Path(config.site_dir) / "search" / "search_index.json"
    text = index.read_text(encoding="utf-8")
    index.with_suffix(".js").write_text(f"var __index = {text}", encoding="utf-8")


def on_post_page(output: str, page: Any, **_: Any) -> str:
    """The shim goes before the theme's own scripts."""
    base = "../" * page.url.count("/")
    return output.replace('<script id="__config"', _SHIM.format(base=base) + '<script id="__config"', 1)
