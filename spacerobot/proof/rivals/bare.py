"""The bare refit: believed values set free within their deviations, nothing else; what most labs do."""

from __future__ import annotations

from spacerobot.proof.oracle import Bench
from spacerobot.proof.rivals.opinion import Opinion
from spacerobot.proof.rivals.tracks import Track
from spacerobot.recordings.study import Study

MOVED = 3.0
"""Standard deviations beyond which a value counts as moved."""


def bare(study: Study, tracks: tuple[Track, ...]) -> Opinion:
    """Refit the baseline; it speaks up only where a value moves far from what was believed."""
    bench = Bench(study.path.parent)
    fitted = bench.fitted(())
    made = fitted.fit.hypothesis
    moved = [f.key for f, z in zip(made.free, fitted.fit.z, strict=True) if f.prior and abs(z) > MOVED]
    says = f"moved beyond {MOVED:g} sigma: {', '.join(moved)}" if moved else "no value moved"
    return Opinion({c: v for c, v in fitted.channels.items() if c in ("target.x", "wrist.x")}, says, bool(moved))
