"""Notebooks as pages: executed (or kept from an execution of the very same sources), with text and pictures."""

from __future__ import annotations

import base64
import html
import logging
import os
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

from spacerobot.view.notebook.execute import KEEP, executed

log = logging.getLogger("mkdocs.hooks.notebooks")
_HERE = Path(__file__).resolve().parents[2]
SOURCE = _HERE / "notebooks"


def on_files(files: Files, config: Any) -> Files:
    """One page for each notebook, its pictures and scenes beside it."""
    nav = next(entry for entry in config.nav if "Notebooks" in entry)
    pages: list[Any] = ["notebooks/index.md"]
    index = ["# Notebooks", "", "One question each. They are executed whenever this site is built.", ""]
    for path in sorted(SOURCE.glob("*.ipynb")):
        text, title, others = _page(path)
        uri = f"notebooks/{path.stem}.md"
        files.append(File.generated(config, uri, content=text))
        for name, content in others.items():
            files.append(File.generated(config, f"notebooks/{name}", content=content))
        pages.append({title: uri})
        index.append(f"{len(pages) - 1}. [{title}]({path.stem}.md)")
    files.append(File.generated(config, "notebooks/index.md", content="\n".join(index) + "\n"))
    nav["Notebooks"] = pages
    return files


def _page(path: Path) -> tuple[str, str, dict[str, bytes | str]]:
    log.info("running %s, unless it is kept", path.name)
    notebook, others = executed(path), {}
    lines = ["---", "hide: [toc]", "---", ""]  # scenes need the width
    for number, cell in enumerate(notebook.cells):
        if cell.cell_type == "markdown":
            lines += [cell.source, ""]
            continue
        lines += ["```python", cell.source, "```", ""]
        for k, out in enumerate(cell.outputs):
            name = f"{path.stem}_{number}_{k}"
            if out.output_type == "stream" and out.name == "stdout":
                lines += ["```text", out.text.rstrip(), "```", ""]
            elif out.output_type in ("display_data", "execute_result"):
                lines += [*_shown(out.data, name, others), ""]
    title = next(line.removeprefix("# ") for line in notebook.cells[0].source.splitlines() if line.startswith("# "))
    link = f"*This page is the notebook `notebooks/{path.name}`, executed.*"
    return "\n".join([*lines, link, ""]), title, others


def _shown(data: Any, name: str, others: dict[str, bytes | str]) -> list[str]:
    alt = data.get("text/plain", "").strip("'").replace("[", "(").replace("]", ")").replace("\n", " ")
    if "text/html" in data:
        frame = re.search(r'srcdoc="([^"]*)"', data["text/html"])
        if frame is None:
            return []
        others[f"{name}.html"] = html.unescape(frame[1])
        words = html.escape(alt, quote=True)
        return [f'<iframe src="{name}.html" title="{words}" sandbox="allow-scripts" loading="lazy"></iframe>']
    if "image/png" not in data:
        return []
    others[f"{name}.png"] = base64.b64decode(data["image/png"])
    moved = "application/vnd.jupyter.widget-view+json" in data
    note = ["", "*With sliders when the notebook runs in Jupyter.*"] if moved else []
    return [f"![{alt}]({name}.png)", *note]


def on_startup(**_: Any) -> None:
    """Kernels compute with one thread each; what they made is kept for the next build."""
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    os.environ.setdefault(KEEP, str(_HERE / "build" / "notebooks"))
