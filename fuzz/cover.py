"""Coverage-guided fuzzing of one target in this process: python -m fuzz.cover TARGET FOLDER CASES."""

from __future__ import annotations

import random
import resource
import sys
from pathlib import Path

import atheris

sys.dont_write_bytecode = True
with atheris.instrument_imports(include=["spacerobot", "zipfile", "tomllib", "csv", "trimesh", "yourdfpy"]):
    from fuzz.corpus import inputs
    from fuzz.targets import TARGETS
from fuzz.mutator import edited
from fuzz.tally import Tally
from fuzz.target import as_bytes, dictionary
from fuzz.watch import SECONDS, Watch, scratch

MEGABYTES = 1000


def main(name: str, folder: Path, cases: int) -> None:
    """Fuzz the target until it has read `cases` inputs in all, those of an interrupted run included."""
    target = TARGETS[name]
    tally = Tally(folder)
    corpus = folder / "corpus"
    corpus.mkdir(exist_ok=True)
    seeds = inputs(target)
    for index, seed in enumerate(seeds):
        (corpus / f"seed-{index:03d}").write_bytes(seed)
    (folder / "words").write_text(dictionary(target.words))
    work = scratch(name)
    watch, read = Watch(work), target.prepare(work)

    def one(data: bytes) -> None:
        outcome, words, seconds = watch.case(read, data)
        if seconds > SECONDS and outcome != "defect":
            outcome, words = "defect", "slow"
        if tally.tried % 64 == 0:
            tally.memory = max(tally.memory, 1024.0 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
        tally.add(outcome, words, seconds, data)

    words = as_bytes(target.words)

    def mutate(data: bytes, longest: int, seed: int) -> bytes:
        dice = random.Random(seed)
        if dice.random() < 0.4:  # from a whole one: most of what the corpus gathers is refused at the gate
            data = dice.choice(seeds)
        if not target.text or dice.random() < 0.25:
            return bytes(atheris.Mutate(data, longest))
        return edited(data, dice, words)[:longest]

    options = {
        "runs": max(cases - tally.tried, 1),
        "max_len": target.longest,
        "len_control": 0,
        "mutate_depth": 2,
        "dict": folder / "words",
        "timeout": 120,
        "report_slow_units": 120,  # of wall time, which a busy machine has no end of; the watch counts its own
        "rss_limit_mb": MEGABYTES,
        "artifact_prefix": f"{folder}/killed-",
        "print_final_stats": 0,
        "verbosity": 0,
        "seed": 1,
    }
    atheris.Setup([sys.argv[0], *(f"-{k}={v}" for k, v in options.items()), str(corpus)], one, custom_mutator=mutate)
    atheris.Fuzz()


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]).resolve(), int(sys.argv[3]))
