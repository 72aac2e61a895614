"""What spacecraft and targets share: the drawn bus with its panels, and the checks of their measures."""

from __future__ import annotations

from numbers import Real

import numpy as np
from lxml import etree

from spacerobot.model import shapes
from spacerobot.support.errors import InputError

COLOURS = {
    "foil_gold": "0.80 0.62 0.25 1",
    "bus_white": "0.90 0.90 0.92 1",
    "panel_blue": "0.08 0.14 0.42 1",
    "bus_dark": "0.18 0.19 0.22 1",
}


def draw_bus(body: etree._Element, size: tuple[float, float, float], *, panels: bool) -> None:
    """Draw a bus with edges `size` [m] on a link, its panels along y; the box alone collides."""
    x, y, z = size
    shapes.add_shape(body, "box", (x, y, 0.9 * z), (0, 0, 0), material="foil_gold")
    shapes.add_shape(body, "box", (1.01 * x, 1.01 * y, 0.06 * z), (0, 0, 0.47 * z), material="bus_white")
    shapes.add_shape(body, "box", (1.01 * x, 1.01 * y, 0.06 * z), (0, 0, -0.47 * z), material="bus_white")
    shapes.add_shape(body, "cylinder", (0.16 * y, 0.12 * x), (-0.56 * x, 0, 0), rpy=shapes.ALONG_X, material="bus_dark")
    shapes.add_shape(body, "box", size, (0, 0, 0))
    if panels:
        for side in (-1, 1):
            shapes.add_shape(
                body,
                "cylinder",
                (0.025 * y, 0.3 * y),
                (0, side * 0.65 * y, 0),
                rpy=shapes.ALONG_Y,
                material="bus_dark",
            )
            for i in range(3):
                centre = side * (1.05 + 0.54 * i) * y
                shapes.add_shape(body, "box", (0.8 * x, 0.5 * y, 0.02 * z), (0, centre, 0), material="panel_blue")


def require_number(spec: object, *names: str) -> None:
    """Refuse a spec in which one of the named attributes is no finite number."""
    for name in names:
        value = getattr(spec, name)
        if isinstance(value, bool) or not isinstance(value, Real) or not np.isfinite(float(value)):
            raise InputError(f"{name} is not a finite number", given=value)


def require_triples(spec: object, *names: str) -> None:
    """Refuse a spec in which one of the named attributes is neither None nor three finite numbers."""
    for name in names:
        value = getattr(spec, name)
        if value is not None and not _finite(value, (3,)):
            raise InputError(f"{name} is not three finite numbers", given=value)


def _finite(value: object, *shapes: tuple[int, ...]) -> bool:
    try:
        array = np.asarray(value)
    except ValueError:
        return False
    return array.shape in shapes and array.dtype.kind in "iuf" and bool(np.all(np.isfinite(array)))


def inertia_matrix(given: object, mass: float, size: tuple[float, float, float], what: str) -> np.ndarray:
    """Shape (3, 3): inertia from three moments, a matrix, or that of a uniform box if None [kg m^2].

    Args:
        given: the user's value.
        mass: [kg].
        size: edges of the box [m].
        what: whose it is, for the error.
    """
    if given is None:
        return shapes.solid_box(mass, size)
    matrix = np.asarray(given, dtype=float) if _finite(given, (3,), (3, 3)) else np.zeros(0)
    if matrix.shape == (3,):
        matrix = np.diag(matrix)
    if matrix.shape != (3, 3) or not np.allclose(matrix, matrix.T, atol=1e-9 * np.abs(matrix).max()):
        raise InputError(f"{what} inertia is neither three moments nor a symmetric matrix", given=given)
    return 0.5 * (matrix + matrix.T)
