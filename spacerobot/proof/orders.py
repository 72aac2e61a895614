"""What a batch consists of: so many campaigns of each kind of concealment, each with a seed of its own."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from spacerobot.proof.engine.outsiders import OUTSIDERS
from spacerobot.proof.sizes import DRAWS

KINDS = (
    "nothing_missing",
    "wrong_value",
    "unlabelled",
    "masked",
    "weak 1.05",
    "weak 1.2",
    "weak 1.5",
    "weak 3",
    "rare",
    "imitated",
    "two",
    "outsider",
    "withheld",
    "power",
    "spoiled",
    "relative",
    "law",
)
"""Kinds of concealment, a row of the table each; "power" fills the power curves."""

FAMILIES = ("rig", "spinning", "chaser", "servo arm")
"""Scenes: the air-bed rig, and those in which more moves."""

MOVING = FAMILIES[1:]

CURVES = (
    ("coulomb_friction", "wrist"),
    ("quadratic_damping", "wrist"),
    ("cubic_stiffness", "wrist"),
    ("hertz_contact", "contact"),
    ("arm_compliance", "arm"),
    ("table_tilt", "target"),
    ("hidden_oscillator", "target"),
    ("time_offset", "force_sensor"),
)
"""Effects whose power curve is drawn in full."""

FULL_STRENGTHS = (0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0)
SHORT_STRENGTHS = (1.0, 2.0, 5.0)
"""Strengths, in detection limits, of the full power curves and of the others."""

COVERED = (("viscous_friction", "wrist"), ("payload", "wrist"), ("payload", "target"))
"""What a believed value covers: the right answer is wrong_parameter, so they hide under no other label."""


@dataclass(frozen=True)
class Order:
    """One campaign to be made.

    Attributes:
        kind, family: row of the tables.
        number: which of its kind and family.
        effect: (effect, place) where the batch fixes it; drawn if None.
        limits: strength in detection limits where the batch fixes it.
        seed: of everything in it.
    """

    kind: str
    family: str
    number: int
    effect: tuple[str, str] | None = None
    limits: float | None = None
    seed: int = 0

    @property
    def name(self) -> str:
        """A name that says nothing to who reads the study, and everything to the batch."""
        return f"{self.kind}-{self.family}-{self.number:04d}".replace(" ", "_")


@dataclass(frozen=True)
class Size:
    """How large a batch is: campaigns of each kind, and how often each point of a power curve is tried."""

    counts: dict[str, int]
    withheld_rounds: int
    curve_repeats: int
    short_repeats: int


FULL = Size(
    {
        "nothing_missing": 210,
        "wrong_value": 210,
        "unlabelled": 90,
        "masked": 42,
        "weak 1.05": 12,
        "weak 1.2": 12,
        "weak 1.5": 12,
        "weak 3": 12,
        "rare": 20,
        "imitated": 30,
        "two": 42,
        "outsider": 162,
        "spoiled": 120,
        "relative": 40,
        "law": 120,
    },
    withheld_rounds=2,
    curve_repeats=3,
    short_repeats=2,
)

QUICK = Size(
    {"unlabelled": 1, "wrong_value": 1, "nothing_missing": 1},
    withheld_rounds=0,
    curve_repeats=0,
    short_repeats=0,
)


def schedule(size: Size, seed: int) -> list[Order]:
    """All orders of a batch, each with its own seed drawn from `seed`; a larger batch contains a smaller one's."""
    orders = list(_orders(size))
    return [replace(o, seed=_seed(seed, o)) for o in orders]


def of_family(family: str, counts: Mapping[str, int], seed: int) -> list[Order]:
    """All orders of one family, each with its own seed drawn from `seed`; more of a kind contain fewer."""

    def drawn(text: str) -> int:
        return int.from_bytes(hashlib.sha256(text.encode()).digest()[:4], "big")

    return [
        Order(kind, family, number, seed=drawn(f"{seed} {kind} {number}"))
        for kind, count in counts.items()
        for number in range(count)
    ]


def _orders(size: Size) -> Iterator[Order]:
    turns = ("rig", "spinning", "rig", "chaser", "rig", "servo arm")  # in half of them more moves than the rig
    for kind, count in size.counts.items():
        seen: dict[str, int] = {}
        for i in range(count):
            family = family_of(kind, turns[i % len(turns)])
            number = seen[family] = seen.get(family, -1) + 1
            yield Order(kind, family, number)
    hidden = [key for key in DRAWS if key[0] not in OUTSIDERS]
    number = 0
    for _ in range(size.withheld_rounds):
        for key in hidden:
            yield Order("withheld", _rig_for(key), number, key)
            number += 1
    number = 0
    for key in [k for k in DRAWS if k[0] not in OUTSIDERS]:
        full = key in CURVES
        for limits in FULL_STRENGTHS if full else SHORT_STRENGTHS:
            for _ in range(size.curve_repeats if full else size.short_repeats):
                yield Order("power", _rig_for(key), number, key, limits)
                number += 1


def family_of(kind: str, wished: str) -> str:
    """The scene in which a kind can be played."""
    if kind == "law":
        return "rig"
    if kind == "rare":
        return "spinning" if wished == "spinning" else "rig"
    if wished == "servo arm" and kind.split()[0] not in ("unlabelled", "masked", "weak"):
        return "chaser"  # an arm on servos hides its servos, and nothing else
    return wished


def _rig_for(key: tuple[str, str]) -> str:
    return "spinning" if key[0] in ("contact_friction", "magnus", "eccentric_contact") else "rig"


def _seed(root: int, order: Order) -> int:
    words = [ord(c) for c in f"{order.name} {order.effect} {order.limits}"]
    return int(np.random.SeedSequence([root & 0xFFFFFFFF, root >> 32, *words]).generate_state(1)[0])
