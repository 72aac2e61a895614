"""The page on studies names every key that a study may have, and its example runs."""

from __future__ import annotations

import re
from pathlib import Path

from spacerobot.recordings import gears, stream, trial
from spacerobot.recordings.readers import READERS
from spacerobot.recordings.values import GROUPS

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "studies.md").read_text(encoding="utf-8")


def test_every_key_is_on_the_page() -> None:
    values = {key for table in GROUPS.values() for key in table}
    keys = {*gears._KEYS, *stream._KEYS, *stream._CHANNEL_KEYS, *trial._KEYS, *trial._SOURCE_KEYS, *values}
    words = set(re.findall(r"\w+", PAGE))
    assert keys - words == set()
    assert {reader.name for reader in READERS} <= words


def test_the_example_runs() -> None:
    found = re.search(r"```python\n(.*?)```", PAGE, re.DOTALL)
    assert found is not None
    names: dict[str, object] = {}
    exec(found.group(1), names)
    assert len(names["force"]) > 2000  # type: ignore[arg-type]
