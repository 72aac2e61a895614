from __future__ import annotations

import dataclasses

import pytest

from spacerobot.theory import assumptions, table1
from spacerobot.theory.kelvin_voigt import contact_time as hit_time

SOFT, STIFF = table1.SPRINGS[0], table1.SPRINGS[3]


def test_all_eight_are_examined_in_order() -> None:
    findings = assumptions.examine(SOFT, 9.0)
    assert [f.number for f in findings] == [a.number for a in assumptions.ASSUMPTIONS] == list(range(1, 9))
    assert all(f.contact_time != 0 or f.restitution != 0 for f in findings)


def test_what_breaks_where() -> None:
    soft = {f.number: f for f in assumptions.examine(SOFT, 9.0)}
    stiff = {f.number: f for f in assumptions.examine(STIFF, 51.0)}
    assert stiff[3].contact_time > 5 * soft[3].contact_time > 0  # a stiff wrist shows the arm's compliance
    assert stiff[5].measure < 4 < 11 < soft[5].measure
    assert abs(stiff[6].restitution) < abs(soft[6].restitution)  # a heavy target does not mind the wrist
    assert soft[6].restitution < 0
    assert soft[7].restitution < -0.2, "half the speed, the same friction"
    assert soft[8].contact_time == pytest.approx(-soft[8].measure)


def test_series_arm_is_the_exact_series_spring() -> None:
    finding = assumptions.examine(STIFF, 9.0)[2]
    base = table1.reduced(STIFF, 9.7)
    series = 1 / (1 / base.stiffness + 1 / assumptions.JOINT_STIFFNESS)
    expected = hit_time(base.mass, series, base.damping) / hit_time(base.mass, base.stiffness, base.damping) - 1
    assert finding.contact_time == pytest.approx(expected, rel=1e-12)


def test_hardening_against_integration() -> None:
    from .integration import hit

    base = dataclasses.replace(table1.reduced(SOFT, 9.7), damping=0.0)
    x = 0.1 / base.frequency
    for _ in range(60):  # the deflection X at which the cubic part is the given share of the linear one
        k3 = assumptions.HARDENING * base.stiffness / x**2
        reference = hit(lambda d, v, k3=k3: base.stiffness * d + k3 * d**3, base.mass, 0.1, "displacement_zero", 1.0)
        if abs(reference.peak_deflection / x - 1) < 1e-12:
            break
        x = reference.peak_deflection
    linear = hit_time(base.mass, base.stiffness, 0.0)
    found = assumptions.examine(SOFT, 9.0)[3].contact_time
    assert found == pytest.approx(reference.time / linear - 1, rel=1e-8)
