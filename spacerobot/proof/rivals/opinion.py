"""What a rival makes of a study."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from spacerobot.proof.rivals.tracks import Track
from spacerobot.recordings.study import Study


@dataclass(frozen=True)
class Opinion:
    """What a rival made of a study.

    Attributes:
        held_out: channel -> rms of its prediction of conditions not seen [m].
        says: what it reports about missing physics, in its own terms.
        flagged: whether that is more than nothing.
    """

    held_out: dict[str, float]
    says: str
    flagged: bool


Rival = Callable[[Study, tuple[Track, ...]], Opinion]
