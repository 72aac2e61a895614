"""Pictures of pages as arrays, and their comparison with stored ones."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

STORED = Path(__file__).parent / "stored"
SIZE = (96, 64)
UPDATE = "SPACEROBOT_UPDATE_PICTURES"
"""Environment variable; when it is set, stored pictures are written anew instead of compared."""


FRAMES = 4
"""Pictures taken until two in a row are the same: a slow machine may be a frame behind what was asked of the page."""


def picture(page: Any, selector: str | None = None) -> np.ndarray:
    """What is to be seen once it stands still, (height, width, 3), 0 to 1; of what moves, the last of `FRAMES`."""
    seen = _frame(page, selector)
    for _ in range(FRAMES):
        page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        before, seen = seen, _frame(page, selector)
        if np.array_equal(before, seen):
            break
    return seen


def _frame(page: Any, selector: str | None) -> np.ndarray:
    data = page.locator(selector).screenshot() if selector else page.screenshot()
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), dtype=float) / 255.0


def difference(a: np.ndarray, b: np.ndarray) -> float:
    """Share of pixels that differ visibly."""
    return float(np.mean(np.abs(a - b).max(axis=-1) > 0.06))


def small(image: np.ndarray) -> np.ndarray:
    """Thinned to SIZE, so that fonts and smoothing do not matter."""
    reduced = Image.fromarray((255.0 * image).astype(np.uint8)).resize(SIZE, Image.Resampling.BOX)
    return np.asarray(reduced, dtype=float) / 255.0


def like_stored(image: np.ndarray, name: str, tolerance: float = 0.25) -> None:
    """Assert that a picture is the stored one, up to a share of what the stored one shows at all.

    A blank picture is 1 from every stored one, whatever its colour.
    """
    path = STORED / f"{name}.png"
    found = small(image)
    if os.environ.get(UPDATE):
        STORED.mkdir(exist_ok=True)
        Image.fromarray((255.0 * found).round().astype(np.uint8)).save(path, optimize=True)
    stored = np.asarray(Image.open(path).convert("RGB"), dtype=float) / 255.0
    content = float(np.abs(stored - np.median(stored, axis=(0, 1))).mean())
    apart = float(np.abs(found - stored).mean()) / content
    assert apart < tolerance, f"{name}: {apart:.2f} from the stored picture"
