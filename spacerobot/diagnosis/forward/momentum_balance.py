"""Mass, damping and stiffness of a driven joint from its recording alone, without differentiating it.

The equation m a + c v + k x = u is multiplied by a bump phi that vanishes with its derivatives at both ends of a
short window, and integrated by parts: m <phi'', x> - c <phi', x> + k <phi, x> = <phi, u>. Many windows give as many
linear equations (the weak form, or modulating functions; Shinbrot 1957).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np

from spacerobot.recordings.recording import Recording
from spacerobot.support.errors import InputError

WIDTH = 400
"""Samples from the middle of a bump to its end where the motion is slow; fewer where it is fast."""


def balance(
    recordings: Iterable[Recording],
    joint: str,
    stated: Mapping[str, float],
    wanted: Sequence[str],
    torque: Callable[[np.ndarray], np.ndarray] = np.asarray,
) -> dict[str, float]:
    """The `wanted` ones of mass, damping and stiffness that balance the momentum best.

    Args:
        recordings: with joint.NAME.position and joint.NAME.torque.
        joint: NAME.
        stated: those that are known, SI; absent ones are zero.
        wanted: names to find.
        torque: from what is logged as the joint's torque to the torque [N m or N].

    Raises:
        InputError: the recordings do not determine them.
    """
    if not wanted:
        return {}
    rows, forces = [], []
    for recording in recordings:
        time, x = recording[f"joint.{joint}.position"].good()
        at, logged = recording[f"joint.{joint}.torque"].good()
        u = np.interp(time, at, torque(logged))
        step = float(np.median(np.diff(time)))
        for table, force in _windows(x, u, step, _half_width(x, time.size)):
            known = sum((value * table[name] for name, value in stated.items() if name in table), np.zeros(force.size))
            columns = [table[name] for name in wanted]
            if "stiffness" in wanted:  # where the spring is at rest need not be the log's zero
                columns.append(table["offset"])
            rows.append(np.column_stack(columns))
            forces.append(force - known)
    matrix, right = np.concatenate(rows), np.concatenate(forces)
    scale = np.linalg.norm(matrix, axis=0)
    if not (scale > 0.0).all() or np.linalg.cond(matrix / scale) > 1e6:
        raise InputError("the recording does not determine what is unknown", given=", ".join(wanted), where=joint)
    solved = np.linalg.lstsq(matrix / scale, right, rcond=None)[0] / scale
    found = dict(zip(wanted, (float(v) for v in solved), strict=False))
    if found.get("mass", 1.0) <= 0.0:
        raise InputError(
            "the recording balances only with a negative mass: is the sign of the drive right?",
            given=found["mass"],
            where=f"joint.{joint}",
        )
    return {name: value if name == "mass" else max(value, 0.0) for name, value in found.items()}


def _half_width(x: np.ndarray, samples: int) -> int:
    """About one period of the acceleration's main frequency, in samples."""
    spectrum = np.abs(np.fft.rfft((x - np.linspace(x[0], x[-1], x.size)) * np.hanning(x.size))) ** 2
    frequency = np.fft.rfftfreq(x.size)
    weight = spectrum * frequency**2  # of the velocity: neither the drift nor the noise rules it
    main = float((weight * frequency).sum() / max(weight.sum(), 1e-300))
    return int(np.clip(1.0 / max(main, 1e-9), 8, min(WIDTH, max(8, samples // 8))))


def _windows(
    x: np.ndarray, u: np.ndarray, step: float, half: int
) -> Iterable[tuple[dict[str, np.ndarray], np.ndarray]]:
    """Integrals of position (by name of the law it belongs to) and force against bumps of two widths, shape (W,)."""
    for width in (half, 2 * half):
        if 2 * width + 1 > x.size:
            continue
        s = np.arange(-width, width + 1) / width
        reach = width * step
        bump = (1 - s**2) ** 4
        first = -8 * s * (1 - s**2) ** 3 / reach
        second = (-8 * (1 - s**2) ** 3 + 48 * s**2 * (1 - s**2) ** 2) / reach**2
        every = slice(None, None, max(1, width // 2))

        def against(kernel: np.ndarray, signal: np.ndarray, every: slice = every) -> np.ndarray:
            return np.correlate(signal, kernel, "valid")[every] * step

        offset = np.full(against(bump, x).size, bump.sum() * step)
        table = {
            "offset": offset,
            "mass": against(second, x),
            "damping": -against(first, x),
            "stiffness": against(bump, x),
        }
        yield table, against(bump, u)
