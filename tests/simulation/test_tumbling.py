"""Laws that a tumbling box must keep: free fall, angular momentum, Coulomb's deceleration, no gain of energy."""

from __future__ import annotations

import numpy as np
import pytest

from spacerobot.simulation.tumbling import tumble

HALF = np.array([0.05, 0.05, 0.05])
MASS, INERTIA = 0.37, np.array([8e-4, 8e-4, 8e-4])
GRAVITY = np.array([0.0, 0.0, -9.81])
STEP = 1.0 / 600.0


def run(start: np.ndarray, steps: int, *, inertia: np.ndarray = INERTIA, restitution: float = 0.0, mu: float = 0.0):
    out = np.zeros((steps, 13))
    tumble(start, steps, STEP, 1, HALF, MASS, inertia, GRAVITY, 0.0, restitution, mu, out)
    return out


def state(height: float, spin=(0.0, 0.0, 0.0), speed=(0.0, 0.0, 0.0), turn=(1.0, 0.0, 0.0, 0.0)) -> np.ndarray:
    return np.array([*turn, 0.0, 0.0, height, *spin, *speed])


def energy(rows: np.ndarray) -> np.ndarray:
    return (
        0.5 * MASS * (rows[:, 10:13] ** 2).sum(axis=1)
        + 0.5 * INERTIA[0] * (rows[:, 7:10] ** 2).sum(axis=1)
        + (MASS * 9.81 * rows[:, 6])
    )


def test_it_falls_freely_above_the_plane() -> None:
    rows = run(state(1.0, speed=(0.3, 0.0, 0.0)), 60)
    assert rows[-1, 12] == pytest.approx(-9.81 * 60 * STEP, rel=1e-12)
    assert rows[-1, 4] == pytest.approx(0.3 * 60 * STEP, rel=1e-12)


def test_angular_momentum_stays_in_flight() -> None:
    inertia = np.array([4e-4, 8e-4, 1.1e-3])
    rows = run(state(1.0, spin=(3.0, 4.0, -2.0)), 120, inertia=inertia)

    def momentum(row: np.ndarray) -> np.ndarray:
        w, x, y, z = row[:4]
        turn = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )
        return turn @ (inertia * (turn.T @ row[7:10]))

    first, last = momentum(rows[0]), momentum(rows[-1])
    assert np.linalg.norm(last - first) < 0.02 * np.linalg.norm(first)  # first order in the step
    assert np.linalg.norm(rows[-1, :4]) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("mu", [0.0, 0.1, 0.3])
def test_a_sliding_box_is_slowed_by_mu_g(mu: float) -> None:
    rows = run(state(0.05, speed=(1.0, 0.0, 0.0)), 120, mu=mu)
    assert rows[-1, 10] == pytest.approx(1.0 - mu * 9.81 * 120 * STEP, abs=0.01)


def test_it_stops_and_stays() -> None:
    rows = run(state(0.05, speed=(0.2, 0.0, 0.0)), 240, mu=0.4)
    assert abs(rows[-1, 10]) < 1e-4  # as far as the sweeps go
    assert rows[-1, 6] == pytest.approx(0.05, abs=1e-3)


def test_a_flat_fall_comes_back_with_the_restitution() -> None:
    rows = run(state(0.15), 110, restitution=0.5)
    hit = int(np.argmax(rows[:, 12] > 0.0))
    assert rows[hit, 12] == pytest.approx(-0.5 * rows[hit - 1, 12], rel=0.03)


def test_energy_never_grows_without_restitution() -> None:
    tilted = np.array([0.9, 0.3, 0.2, 0.1]) / np.linalg.norm([0.9, 0.3, 0.2, 0.1])
    rows = run(state(0.12, spin=(5.0, -3.0, 2.0), speed=(0.5, 0.2, 0.0), turn=tuple(tilted)), 400, mu=0.3)
    assert np.diff(energy(rows)).max() < 2e-3 * energy(rows)[0]
    assert energy(rows)[-1] < energy(rows)[0]
