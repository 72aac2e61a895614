from __future__ import annotations

import pytest

from spacerobot.model.assemblies import assemblies
from spacerobot.model.library import bundled
from spacerobot.support import resources

WRITTEN = assemblies()


@pytest.mark.parametrize("name", WRITTEN)
def test_the_file_is_what_the_functions_make(name: str) -> None:
    path = resources.folder("urdf") / f"{name}.urdf"
    assert path.read_text(encoding="utf-8") == WRITTEN[name], "run: python -m spacerobot.model.assemblies"


def test_every_bundled_urdf_is_written_by_hand_or_by_the_script() -> None:
    assert set(bundled()) == {"pa10", "pa10c", *WRITTEN}
