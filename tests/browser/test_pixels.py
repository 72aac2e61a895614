"""The comparison of pictures can fail."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image
from pixels import STORED, UPDATE, difference, like_stored


def _stored(name: str) -> np.ndarray:
    image = Image.open(STORED / f"{name}.png").convert("RGB").resize((960, 640), Image.Resampling.BICUBIC)
    return np.asarray(image, dtype=float) / 255.0


def test_a_blank_or_another_picture_is_not_taken_for_the_stored_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(UPDATE, raising=False)
    for path in STORED.glob("*.png"):
        image = _stored(path.stem)
        like_stored(image, path.stem)
        blank = np.broadcast_to(np.median(image, axis=(0, 1)), image.shape)
        with pytest.raises(AssertionError, match="from the stored picture"):
            like_stored(blank, path.stem)
    for wrong, right in (("scene_ur5", "scene_arm"), ("scene_trial", "scene_held"), ("report_named", "report_unknown")):
        with pytest.raises(AssertionError):
            like_stored(_stored(wrong), right)


def test_difference_counts_what_is_visible() -> None:
    image = np.zeros((10, 10, 3))
    other = image.copy()
    other[0, 0, 1] = 0.5
    other[1, 1, 1] = 0.01
    assert difference(image, other) == pytest.approx(0.01)
    assert difference(image, image) == 0.0
