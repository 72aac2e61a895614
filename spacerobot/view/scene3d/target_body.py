"""The free-flying target as it is drawn: a satellite's bus whose face carries the contact point."""

from __future__ import annotations

import numpy as np

from spacerobot.model.target import TargetSpec, target_body
from spacerobot.simulation.parts.target import TARGET_EDGE as EDGE
from spacerobot.simulation.room import cube_centre
from spacerobot.view.scene3d.film import Array, Body, Look, Piece
from spacerobot.view.scene3d.robot_body import urdf_pieces
from spacerobot.view.scene3d.solids import Solid, cylinder

_PROBE = Look((0.55, 0.57, 0.6), metal=0.8, rough=0.35)
_PUCK = Look((0.2, 0.22, 0.26), metal=0.5, rough=0.4)


def target_pieces(point: Array, *, panels: bool) -> tuple[Piece, ...]:
    """Pieces of a target in axes at its centre of mass, x along the approach.

    Args:
        point: (3,), its contact point [m]. The bus is drawn with its front there if the point lies within it, and
            with a probe up to the point otherwise.
        panels: with solar panels (a satellite), or without (a body on an air bed).
    """
    spec = TargetSpec(panels=panels, size=(EDGE, EDGE, EDGE))
    shift = cube_centre(point)
    place = np.eye(4)
    place[:3, 3] = shift
    pieces = [
        Piece(None if p.solid is None else p.solid.moved(place), p.look, None if p.lines is None else p.lines + shift)
        for p in urdf_pieces(target_body(spec).urdf, "target")
    ]
    ahead = point[0] - EDGE / 2.0
    if ahead > 1e-6:
        pieces.append(Piece(_along_x(0.012, ahead, np.array([EDGE / 2.0 + ahead / 2.0, point[1], point[2]])), _PROBE))
    pieces.append(Piece(_along_x(0.03, 0.004, point - [0.002, 0.0, 0.0]), _PUCK))
    return tuple(pieces)


def _along_x(radius: float, length: float, centre: Array) -> Solid:
    place = np.eye(4)
    place[:3, :3] = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
    place[:3, 3] = centre
    return cylinder(radius, length).moved(place)


def as_ghost(
    pieces: tuple[Piece, ...], name: str, poses: Array, beside: Array, mismatch: Array, opacity: float = 0.4
) -> Body:
    """The same shape, translucent, coloured by how far the simulation (`beside`) is from it, (T,) [sigma]."""
    look = Look((0.0, 0.62, 0.45), opacity=opacity, metal=0.0, rough=0.6)
    solid = tuple(Piece(p.solid, look) for p in pieces if p.solid is not None)
    return Body(name, solid, poses, kind="ghost", mismatch=mismatch, beside=beside)
