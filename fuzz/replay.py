"""A short run without coverage: python -m fuzz.replay TARGET CASES. Seeds and kept inputs, then edits of them.

Needs nothing but the package, takes seconds and is the same every time; what CI runs. Prints the counts as JSON.
"""

from __future__ import annotations

import json
import random
import sys
import tempfile
from pathlib import Path

from fuzz.binary.kinds import KINDS
from fuzz.corpus import inputs
from fuzz.mutator import edited
from fuzz.tally import Tally
from fuzz.target import as_bytes
from fuzz.targets import TARGETS
from fuzz.watch import Watch, scratch


def replay(name: str, cases: int) -> dict[str, object]:
    """Counts and defects of one target."""
    dice = random.Random(name)
    with tempfile.TemporaryDirectory() as folder:
        tally = Tally(Path(folder))
        if name in KINDS:
            from fuzz.containers import Harness

            harness = Harness(KINDS[name], scratch(name))
            batch = [harness.seed(dice) for _ in range(cases)]
            for data, said in zip(batch, harness.batch(batch), strict=True):
                tally.add(*said, data)
        else:
            target, work = TARGETS[name], scratch(name)
            watch, read = Watch(work), target.prepare(work)
            words, seeds = as_bytes(target.words), inputs(target)
            for data in (*seeds, *(edited(dice.choice(seeds), dice, words) for _ in range(cases))):
                tally.add(*watch.case(read, data), data)
        return tally.report()


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    print(json.dumps(replay(sys.argv[1], int(sys.argv[2]))))
