"""A robot: its URDF, the Pinocchio model built from it, and the names that the rest of the house needs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from spacerobot.support.errors import InputError, NotFoundError
from spacerobot.support.showing import html_table
from spacerobot.support.tables import data_frame

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, eq=False)
class Robot:
    """A loaded robot; immutable, and its Pinocchio model must not be changed in place.

    Attributes:
        name: what it was loaded as.
        urdf: its URDF text.
        model: Pinocchio model with reflected rotor inertia in `model.armature` [kg m^2 or kg].
        chain: names of the moving joints from base to tip, without free-flyer and wrist slider.
        tip: frame of the wrist mount (with a wrist) or of the arm's tip (without).
        slider: name of the wrist's prismatic joint, or None without a wrist.
        contact: frame at the end of the slider that touches the target, or None without a wrist.
        floating: whether the base is a free-flyer (the first joint of `model`).
        mesh_dirs: folders in which the URDF's meshes are found.
        armature: whether rotor inertia counts (False leaves `model.armature` at zero).
        mended: links whose inertia no body can have, and how far it was moved.
    """

    name: str
    urdf: str
    model: pin.Model
    chain: tuple[str, ...]
    tip: str
    slider: str | None = None
    contact: str | None = None
    floating: bool = False
    mesh_dirs: tuple[Path, ...] = field(default=())
    armature: bool = True
    mended: tuple[str, ...] = ()

    def __repr__(self) -> str:
        wrist = f", wrist at {self.tip}" if self.slider else f", tip {self.tip}"
        base = "floating" if self.floating else "fixed"
        return f"Robot({self.name!r}, {len(self.chain)} joints{wrist}, {base} base, {self.mass:.4g} kg)"

    @property
    def mass(self) -> float:
        """Mass of everything that moves [kg]."""
        return float(pin.computeTotalMass(self.model))

    def frame_id(self, name: str) -> int:
        """Index of a frame; a link goes before a joint of the same name.

        Raises:
            NotFoundError: no such frame; names the nearest.
        """
        if not self.model.existFrame(name):
            raise NotFoundError("frame", name, [f.name for f in self.model.frames])
        try:
            return int(self.model.getFrameId(name))
        except ValueError:  # Pinocchio takes no side between a link and a joint of one name
            return int(self.model.getFrameId(name, pin.FrameType.BODY))

    def joint_id(self, name: str) -> int:
        """Index of a joint in `model.joints`.

        Raises:
            NotFoundError: no such joint; names the nearest.
        """
        if name not in self.model.names:
            raise NotFoundError("joint", name, list(self.model.names)[1:])
        return int(self.model.getJointId(name))

    def links_on(self, joints: Iterable[str]) -> tuple[str, ...]:
        """Links that move with one of these joints, base to tip.

        Raises:
            NotFoundError: no such joint; names the nearest.
        """
        moved = {j for name in joints for j in self.model.subtrees[self.joint_id(name)]}
        return tuple(f.name for f in self.model.frames if f.type == pin.FrameType.BODY and f.parentJoint in moved)

    def configuration(
        self, pose: np.ndarray | None = None, *, slider: float = 0.0, others: dict[str, float] | None = None
    ) -> np.ndarray:
        """Full configuration of `model`.

        Args:
            pose: shape (len(chain),), joint positions [rad or m], base to tip; neutral if None.
            slider: wrist slider displacement along its joint axis [m].
            others: positions of further joints by name (fingers); neutral where absent.

        Returns:
            shape (nq,), with the free-flyer at the world origin if the base floats.
        """
        q = pin.neutral(self.model)
        values = dict(others or {})
        if pose is not None:
            pose = np.asarray(pose, dtype=float)
            if pose.shape != (len(self.chain),):
                raise InputError(
                    "pose has the wrong length",
                    given=list(np.atleast_1d(pose)),
                    valid=f"{len(self.chain)} values, one per joint: {', '.join(self.chain)}",
                )
            values.update(zip(self.chain, pose.tolist(), strict=True))
        if self.slider is not None:
            values.setdefault(self.slider, slider)
        for name, value in values.items():
            if not np.isfinite(value):
                raise InputError("joint position is not finite", given=value, where=f"joint {name}")
            joint = self.model.joints[self.joint_id(name)]
            if joint.nq == 2 and joint.nv == 1:  # continuous joint: cosine and sine
                q[joint.idx_q : joint.idx_q + 2] = np.cos(value), np.sin(value)
            elif joint.nq == 1:
                q[joint.idx_q] = value
            else:
                raise InputError("joint cannot be set by one number", given=name)
        return q

    def writer(self, joints: Sequence[str]) -> Callable[[np.ndarray], np.ndarray]:
        """Writes full configurations, shape (..., nq), from positions of some joints, (..., len(joints)) [rad or m].

        The others stay neutral. Without the checks that `configuration` makes each time.

        Raises:
            NotFoundError: no such joint; names the nearest.
        """
        still, own = self.configuration(), [self.model.joints[self.joint_id(name)] for name in joints]
        plain = [i for i, joint in enumerate(own) if joint.nq == 1]
        where = [own[i].idx_q for i in plain]
        turning = [(i, joint.idx_q) for i, joint in enumerate(own) if joint.nq == 2]
        return partial(_written, still=still, plain=(plain, where), turning=turning)

    def joint_rows(self) -> list[dict[str, Any]]:
        """The chain from base to tip, then the wrist's slider: limits and reflected rotor inertia, SI."""
        rows = []
        for name in (*self.chain, *([self.slider] if self.slider else [])):
            joint = self.model.joints[self.joint_id(name)]
            angle = not joint.shortname().startswith("JointModelP")  # PX, PY, PZ, PrismaticUnaligned
            bounded = joint.nq == 1
            rows.append(
                {
                    "name": name,
                    "unit": "rad" if angle else "m",
                    "lower": float(self.model.lowerPositionLimit[joint.idx_q]) if bounded else -np.inf,
                    "upper": float(self.model.upperPositionLimit[joint.idx_q]) if bounded else np.inf,
                    "velocity_limit": float(self.model.velocityLimit[joint.idx_v]),
                    "effort_limit": float(self.model.effortLimit[joint.idx_v]),
                    "rotor_inertia": float(self.model.armature[joint.idx_v]),
                }
            )
        return rows

    def to_frame(self) -> pandas.DataFrame:
        """A row for each joint of the chain and the wrist's slider: limits and rotor inertia, SI, as a table of pandas.

        Raises:
            InputError: pandas is not installed.
        """
        rows = self.joint_rows()
        columns = {key: [row[key] for row in rows] for key in rows[0] if key != "name"} if rows else {}
        return data_frame(columns, index=[row["name"] for row in rows], name="joint")

    def _repr_html_(self) -> str:
        keys = ("name", "lower", "upper", "unit", "velocity_limit", "effort_limit", "rotor_inertia")
        rows = [tuple(row[key] for key in keys) for row in self.joint_rows()]
        head = ("joint", "from", "to", "unit", "fastest, unit/s", "most, N m or N", "rotor inertia, kg m² or kg")
        base = "a floating base" if self.floating else "a fixed base"
        wrist = f"wrist at {self.tip}, contact frame {self.contact}" if self.slider else f"tip {self.tip}"
        return html_table(f"{self.name}: {self.mass:.4g} kg on {base}, {wrist}", rows, head, self.mended)

    def velocity_index(self, name: str) -> int:
        """Index into the velocity vector of a one-degree-of-freedom joint."""
        return int(self.model.joints[self.joint_id(name)].idx_v)


def _written(
    positions: np.ndarray,
    *,
    still: np.ndarray,
    plain: tuple[list[int], list[int]],
    turning: list[tuple[int, int]],
) -> np.ndarray:
    """A neutral configuration with the positions of some joints: of plain ones by (which, where), and turning ones."""
    which, where = plain
    q = np.empty((*positions.shape[:-1], still.size))
    q[...] = still
    q[..., where] = positions[..., which]
    for i, at in turning:  # continuous joints: cosine and sine
        q[..., at], q[..., at + 1] = np.cos(positions[..., i]), np.sin(positions[..., i])
    return q
