"""Planar impacts with friction: what sticks does not slide."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.machines.impacts import _impulse, _outside
from spacerobot.recordings.study import Study, load_study


def test_what_friction_can_hold_no_longer_slides_after_the_impact() -> None:
    """Off the centre, so that normal and tangential impulses are coupled; and what it cannot hold slides on."""
    n, d = np.array([[0.0], [1.0], [0.3]]), np.array([[1.0], [0.0], [0.5]])
    before, inverse = np.array([[0.4], [-1.0], [0.0]]), np.array([1.0, 1.0, 10.0])
    slides = []
    for mu in (5.0, 0.01):
        after = before + inverse[:, None] * _impulse(before, n, d, inverse, 0.5, mu)
        slides.append(float((d * after).sum()))
    assert abs(slides[0]) < 1e-12
    assert abs(slides[1]) > 0.1


def test_a_row_counted_the_other_way_shows_whatever_the_impulses() -> None:
    random = np.random.default_rng(5)
    n, d = random.normal(size=(2, 3, 40))
    change = n * random.normal(size=40) + d * random.normal(size=40)
    turned = np.array([[1.0], [1.0], [-1.0]])
    assert _outside(change, n, d) < 1e-12
    assert min(_outside(change, n, turned * d), _outside(change, turned * n, d), _outside(turned * change, n, d)) > 0.2
    assert _outside(np.zeros((3, 4)), n[:, :4], d[:, :4]) == 0.0


NOISE = 0.004, 0.004, 0.04


def _study(folder: Path, slower: float) -> Study:
    """Frictionless impacts off the centre, whose restitution falls by `slower` up to the fastest; noise stated."""
    random = np.random.default_rng(8)
    zero, one = np.zeros(60), np.ones(60)
    n = np.array([zero, one, random.uniform(-0.1, 0.1, 60)])
    before = random.uniform((-1.0, -1.0, -1.0), (1.0, -0.3, 1.0), (60, 3)).T
    inverse = np.array([1.0, 1.0, 200.0])[:, None]
    closing = (n * before).sum(axis=0)
    restitution = 0.6 * (1.0 - slower * np.abs(closing))
    after = before - inverse * n * (1.0 + restitution) * closing / (inverse * n**2).sum(axis=0)
    noise = np.array(NOISE)[:, None] * random.normal(size=(2, 3, 60))
    np.savetxt(
        folder / "impacts.csv", np.vstack([before + noise[0], after + noise[1], n, one, zero, zero]).T, "%.9f", ","
    )
    names = [f"body.velocity.{a}" for _ in range(2) for a in ("x", "y", "yaw")]
    of = [f', moment = "{m}", sigma = {s}' for m in ("before", "after") for s in NOISE]
    names += [f"aux.{row}_{a}" for row in ("normal", "tangent") for a in ("x", "y", "yaw")]
    channels = "".join(
        f'{k} = {{ is = "{name}"{more} }}\n' for k, (name, more) in enumerate(zip(names, [*of, *6 * [""]], strict=True))
    )
    (folder / "study.toml").write_text(
        'format = 1\n[baseline]\nbase = "free"\n[baseline.body]\nmass = 1.0\nyaw_inertia = 0.005\n'
        'restitution = "unknown"\n[streams.log]\nkind = "events"\nheader_rows = 0\n[streams.log.channels]\n'
        f'{channels}[[trials]]\nid = "all"\nlog = "impacts.csv"\n'
    )
    return load_study(folder)


@pytest.mark.parametrize(("slower", "said"), [(0.0, "nothing_missing"), (0.4, "unknown")])
def test_what_is_left_beyond_stated_noise_is_not_nothing(tmp_path: Path, slower: float, said: str) -> None:
    """Restitution that falls with speed has no name here; a steady one leaves the noise of both speeds."""
    verdict = diagnose(_study(tmp_path, slower), jobs=1).verdict
    assert verdict["verdict"] == said
    (part,) = verdict["parts"]
    loud = max(part["rms_over_stated_noise"].values())
    assert loud > 2.0 if slower else loud == pytest.approx(1.0, abs=0.2)
