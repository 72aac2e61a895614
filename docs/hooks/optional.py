"""Pages that may be there: they join the navigation if they are."""

from __future__ import annotations

from pathlib import Path
from typing import Any

PAGES = {
    "Proof": "proof.md",
    "Real recordings": "real-recordings.md",
    "Benchmarks": "benchmarks.md",
    "Sweeps": "sweep.md",
    "Licences": "licences.md",
}


def on_config(config: Any) -> Any:
    """Add the optional pages that exist to the navigation's last group."""
    here = [{title: page} for title, page in PAGES.items() if (Path(config.docs_dir) / page).is_file()]
    if here:
        config.nav.append({"Evidence": here})
    return config
