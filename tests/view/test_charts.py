"""The report's pictures: in the page's colours, by attributes alone, saying what they show."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from spacerobot.view import plotting
from spacerobot.view.report import charts
from spacerobot.view.report.evidence import Surface, Trace
from spacerobot.view.report.inline import THEME, inline


def _trace(**changed: object) -> Trace:
    time = np.linspace(0.0, 1.0, 5)
    known: dict[str, object] = {
        "trial": "01", "condition": "", "channel": "target.x", "unit": "m", "sigma": 0.1, "time": time,
        "measured": time, "before": time + 0.2, "after": time, "held_out": True,
    }  # fmt: skip
    return Trace(**{**known, **changed})  # type: ignore[arg-type]


def test_a_picture_has_no_style_no_colour_and_no_name_of_its_own() -> None:
    picture = charts.traces_chart([_trace()]).inline()
    root = ElementTree.fromstring(picture)
    assert not [e for e in root.iter() if e.tag == "style" or "style" in e.attrib], "a page's policy refuses these"
    assert not re.findall(r'"#[0-9a-f]{6}"', picture), "a colour that is not the page's stays as it is in the dark"
    assert {f"var({name})" for name in THEME.values()} >= set(re.findall(r"var\([^)]*\)", picture))
    names = {e.get("id") for e in root.iter() if e.get("id")}
    assert names == set(re.findall(r"#([\w-]+)", picture)), "every name is referred to, every reference is found"
    other = ElementTree.fromstring(charts.traces_chart([_trace(trial="02")]).inline())
    assert not names & {e.get("id") for e in other.iter() if e.get("id")}, "two pictures of a page share no name"
    assert picture == charts.traces_chart([_trace()]).inline()


def test_a_colour_beside_the_theme_is_seen() -> None:
    with plotting.style():
        figure = plotting.canvas()
        figure.subplots().plot([0.0, 1.0], color=plotting.PURPLE)
    assert plotting.PURPLE.lower() in inline(figure, "x")


def test_residuals_are_drawn_as_far_off_as_they_are() -> None:
    """Twice the noise above what was measured, and a gap where nothing was."""
    measured = np.array([0.0, 0.25, np.nan, 0.75, 1.0])
    figure = charts.traces_chart([_trace(measured=measured)]).figure
    above, below = figure.axes
    before = np.asarray(below.lines[0].get_ydata(), dtype=float)
    np.testing.assert_allclose(before[[0, 1, 3, 4]], 2.0)
    assert np.isnan(before[2])
    dots = above.patches[0].get_path().vertices
    np.testing.assert_allclose(dots[::2, 1], [0.0, 0.25, 0.75, 1.0])


def test_points_say_what_they_are_under_the_pointer() -> None:
    x = np.array([1.0, np.nan, 3.0])
    surface = Surface("wrist", "velocity", "m/s", "N", x, np.array([2.0, 5.0, 4.0]), np.array([0.5, 0.5, np.inf]))
    root = ElementTree.fromstring(charts.surface_chart(surface).inline())
    said = [t.text or "" for p in root.iter("use") for t in p.iter("title")]
    assert len(said) == 2
    assert said[0].startswith("1")
    assert "3 points" in root.attrib["aria-label"]


@pytest.mark.parametrize("text", ["</svg><script>x</script>", "$\\frac$", "a&b", "ß<i>"])
def test_no_text_becomes_markup_or_mathematics(text: str) -> None:
    picture = charts.traces_chart([_trace(channel=text)]).inline()
    root = ElementTree.fromstring(picture)
    assert text in root.attrib["aria-label"]
    assert any((e.text or "").startswith(text) for e in root.iter("text"))
    assert "<script" not in picture


@pytest.mark.parametrize("value", [0.0, 1e-300, 1e150, np.nan])
def test_values_of_any_size_are_drawn(value: float) -> None:
    time = np.linspace(0.0, 1.0, 5)
    charts.traces_chart([_trace(measured=np.full(5, value), before=time * 0, after=time * 0, sigma=None)]).inline()


def test_bars_and_rivals_stand_in_their_order() -> None:
    assert charts.improvement_chart({}) is None
    chart = charts.improvement_chart({"rms_before": 8.0, "rms_after": 2.0, "noise_floor": 1.0})
    assert chart is not None
    widths = [p.get_width() for p in chart.figure.axes[0].patches]
    np.testing.assert_allclose(widths, np.array([8.0, 2.0, 1.0]) * widths[2])
    rivals = [
        {"held_out": s, "effects": [{"effect": e, "where": "wrist"}]}
        for s, e in ((-3.0, "backlash"), (0.0, "coulomb_friction"))
    ]
    chart = charts.rivals_chart(rivals)
    assert chart is not None
    lengths = [p.get_width() for p in chart.figure.axes[0].patches]
    assert lengths[0] < lengths[1], "the best first, with the shortest bar"
    assert "Coulomb" in chart.figure.axes[0].texts[0].get_text()
