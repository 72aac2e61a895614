"""What of a scene its hand and its mechanism are made from."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from spacerobot.model.robot import Robot
from spacerobot.simulation.hand import Hand
from spacerobot.simulation.parts import ContactLaw, EffectAt, Motion, Servo, Target, Wrist


class Outline(Protocol):
    """The part of `Scene` that `scene_mechanism` reads; see there for the meaning of each."""

    @property
    def prepared(self) -> Robot: ...  # noqa: D102
    @property
    def start(self) -> np.ndarray: ...  # noqa: D102
    @property
    def base(self) -> str | None: ...  # noqa: D102
    @property
    def joints(self) -> str: ...  # noqa: D102
    @property
    def pose(self) -> tuple[float, ...] | None: ...  # noqa: D102
    @property
    def approach(self) -> tuple[float, ...]: ...  # noqa: D102
    @property
    def gravity(self) -> tuple[float, ...]: ...  # noqa: D102
    @property
    def axes(self) -> np.ndarray: ...  # noqa: D102
    @property
    def level(self) -> np.ndarray: ...  # noqa: D102
    @property
    def wrist(self) -> Wrist: ...  # noqa: D102
    @property
    def contact(self) -> ContactLaw: ...  # noqa: D102
    @property
    def target(self) -> Target: ...  # noqa: D102
    @property
    def servo(self) -> Servo | None: ...  # noqa: D102
    @property
    def motion(self) -> Motion: ...  # noqa: D102
    @property
    def hand(self) -> Hand: ...  # noqa: D102
    @property
    def effects(self) -> tuple[EffectAt, ...]: ...  # noqa: D102
