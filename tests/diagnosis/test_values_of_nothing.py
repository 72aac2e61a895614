"""Values that may be nothing: a fit that gives up what is stated of them may find that they are."""

from __future__ import annotations

import pytest

from spacerobot.diagnosis.terms.hypothesis import Believed, hypothesis
from spacerobot.recordings.values import may_be_nothing


@pytest.mark.parametrize(
    ("name", "may"),
    [
        ("wrist.equivalent_damping", True),
        ("joint.elbow.damping", True),
        ("wrist.mass", False),
        ("target.inertia.z", False),
    ],
)
def test_a_damping_may_be_nothing_and_a_mass_may_not(name: str, may: bool) -> None:
    believed = Believed(values={name: 2.0}, sigma={name: 0.1}, scatter={}, conditions=(), freed=(name,))
    (free,) = hypothesis(believed, ()).free
    assert (free.value(free.bounds[0]) == 0.0) is may is may_be_nothing(name)
    assert free.value(free.bounds[0]) >= 0.0
