"""A film: bodies that move along a time line, and what is drawn with them. Free of any drawing library.

Poses are rows (x, y, z, qx, qy, qz, qw), metres and a unit quaternion, world axes.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from spacerobot.support.errors import InputError
from spacerobot.view.scene3d.solids import Solid

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Look:
    """How a surface looks.

    Attributes:
        colour: red, green, blue, 0 to 1, as displays take them (sRGB).
        opacity: 0 to 1.
        metal: 0 (paint) to 1 (bare metal).
        rough: 0 (mirror) to 1 (chalk).
        glow: share of the colour that shines by itself.
    """

    colour: tuple[float, float, float] = (0.75, 0.76, 0.78)
    opacity: float = 1.0
    metal: float = 0.1
    rough: float = 0.5
    glow: float = 0.0


@dataclass(frozen=True, eq=False)
class Piece:
    """One solid of one look, in its body's axes; `lines` are drawn as thin lines instead, shape (K, 2, 3)."""

    solid: Solid | None
    look: Look
    lines: Array | None = None


@dataclass(frozen=True, eq=False)
class Body:
    """What moves as one.

    Attributes:
        name: its path in the scene, unique.
        pieces: what it consists of.
        poses: (T, 7), or (1, 7) for a body that never moves.
        kind: "robot", "target", "ghost" or "stage".
        mismatch: (T,), for a ghost: how far the simulation is from it, in sigmas of the sensor; it is coloured by that.
        beside: (T, 7), for a ghost: where the simulation has the same thing, so that the page can draw the
            difference larger than it is.
        stretch: (T,), lengths that the body's z axis is scaled to [m] (a spring), or None.
    """

    name: str
    pieces: tuple[Piece, ...]
    poses: Array
    kind: str = "robot"
    mismatch: Array | None = None
    beside: Array | None = None
    stretch: Array | None = None


@dataclass(frozen=True, eq=False)
class Trail:
    """A line that grows: the path of a point, (T, 3)."""

    name: str
    points: Array
    colour: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Readout:
    """A number to be read along with the picture, (T,), and perhaps what was recorded of it, (T,)."""

    name: str
    unit: str
    values: Array
    digits: int = 2
    recorded: Array | None = None


@dataclass(frozen=True, eq=False)
class Arrow:
    """A force arrow to scale.

    Attributes:
        force: (T,) [N]; nothing is drawn where it is zero.
        point: (T, 3), where it acts [m].
        direction: (3,) or (T, 3), unit vector of a positive force.
        scale: metres of arrow for one newton.
    """

    force: Array
    point: Array
    direction: Array
    scale: float


@dataclass(frozen=True, eq=False)
class MassEllipsoid:
    """Belted effective-mass ellipsoids along the film.

    Attributes:
        centre: (T, 3) [m].
        mobility: (T, 3, 3) [1/kg], world axes.
        scale: metres of radius for one kilogram.
        limit: greatest radius drawn [m].
    """

    centre: Array
    mobility: Array
    scale: float
    limit: float


@dataclass(frozen=True, eq=False)
class View:
    """Where a camera may stand.

    Attributes:
        name: on its button.
        focus: (3,), what it looks at [m].
        reach: radius about the focus that must be seen [m].
        direction: (3,), from the focus to the camera, of any length.
    """

    name: str
    focus: Array
    reach: float
    direction: tuple[float, float, float]


@dataclass(frozen=True)
class Mark:
    """An event on the time line; a quiet one is a tick whose label shows on hover alone."""

    time: float
    label: str
    quiet: bool = False


@dataclass(frozen=True, eq=False)
class Film:
    """A scene in motion.

    Attributes:
        title, subtitle: what it is.
        description: what is to be seen, for readers who cannot.
        time: (T,) [s], ascending.
        bodies, trails, readouts, marks: see there.
        arrow, ellipsoid: see there, or None.
        centre_of_mass: (T, 3) [m], or None.
        centre_label: whose it is.
        chart: name of the readout drawn along the time line, or "".
        place: "ground" or "space".
        views: of the camera; the film opens with the first.
        focus: middle of everything, (3,) [m].
        reach: radius about it that holds everything [m].
        ghost: what ghosts are called on their switch, and what the legend says of them before the scale of colours.
        gains: factors by which ghosts may be drawn further from the simulation than they are; the first is used.
        notes: sentences printed beside the picture.
        floor: height of the ground [m].
    """

    title: str
    subtitle: str
    description: str
    time: Array
    bodies: tuple[Body, ...]
    focus: Array
    reach: float
    views: tuple[View, ...]
    trails: tuple[Trail, ...] = ()
    readouts: tuple[Readout, ...] = ()
    marks: tuple[Mark, ...] = ()
    arrow: Arrow | None = None
    ellipsoid: MassEllipsoid | None = None
    centre_of_mass: Array | None = None
    centre_label: str = ""
    chart: str = ""
    place: str = "ground"
    gains: tuple[float, ...] = (1.0,)
    ghost: tuple[str, str] = ("recording", "the recording; simulated and recorded agree")
    notes: tuple[str, ...] = field(default=())
    floor: float = 0.0

    def __post_init__(self) -> None:
        count = len(self.time)
        if count == 0 or not np.all(np.isfinite(self.time)) or np.any(np.diff(self.time) <= 0.0):
            raise InputError("a film needs ascending times", given=count)
        if not self.views:
            raise InputError("a film needs a view", valid="at least one")
        names = [body.name for body in self.bodies]
        if len(set(names)) != len(names):
            raise InputError("bodies of a film need names of their own", given=sorted(names))
        for body in self.bodies:
            if body.poses.shape not in ((count, 7), (1, 7)) or not np.all(np.isfinite(body.poses)):
                raise InputError(f"poses of {body.name} do not fit the film", given=body.poses.shape)
        for readout in self.readouts:
            if readout.values.shape != (count,):
                raise InputError(f"values of {readout.name} do not fit the film", given=readout.values.shape)
