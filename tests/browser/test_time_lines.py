"""The curve along a scene's time line lies over the slider that it belongs to, at any width."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from spacerobot.recordings.study import load_study
from spacerobot.view.scene3d.page import page as page_of
from spacerobot.view.scene3d.study_film import study_film

HIGHEST = """() => {
  const line = document.getElementById('chart').getBoundingClientRect();
  const canvas = document.querySelector('#chart canvas'), box = canvas.getBoundingClientRect();
  const ink = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  let best = canvas.height, at = 0;
  for (let x = 0; x < canvas.width; x += 1)
    for (let y = 0; y < best; y += 1)
      if (ink.data[4 * (y * canvas.width + x) + 3] > 10) { best = y; at = x; }
  return [box.left - line.left, box.width - line.width, at / canvas.width];
}"""
"""Where the canvas begins and how much wider it is than the line [px]; where the curve is highest, a share of it."""


@pytest.mark.parametrize("width", [700, 1100])
@pytest.mark.slow
def test_the_curve_lies_over_its_time_line(visit: Any, tmp_path: Path, width: int) -> None:
    film = study_film(load_study("guide-friction"), "04")
    force = next(r for r in film.readouts if r.name == film.chart)
    highest = film.time[abs(force.recorded if force.recorded is not None else force.values).argmax()]
    file = tmp_path / "trial.html"
    file.write_text(page_of(film), encoding="utf-8")
    seen = visit(file.as_uri(), width=900)
    seen.page.set_viewport_size({"width": width, "height": 600})
    seen.page.wait_for_timeout(1500)
    left, wide, at = seen.page.evaluate(HIGHEST)
    assert abs(left) < 1.0
    assert abs(wide) <= 1.0
    assert abs(at - (highest - film.time[0]) / (film.time[-1] - film.time[0])) < 0.01
    seen.calm(file.as_uri())
