"""Planar impacts with friction: what sticks does not slide."""

from __future__ import annotations

import numpy as np

from spacerobot.diagnosis.machines.impacts import _impulse, _outside


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
