"""Structured fuzzing of the binary readers: python -m fuzz.containers KIND FOLDER CASES.

Files are parsed as in the product: by `readers.child`, restrained as it restrains itself, in a process of its own. Only
that such a process serves several files, so that a hundred thousand of them take minutes.
"""

from __future__ import annotations

import os
import random
import resource
import shutil
import struct
import sys
import time
from pathlib import Path

import h5py
import rosbags.highlevel  # noqa: F401 - here rather than in every child
import scipy.io  # noqa: F401

from fuzz.binary.kinds import KINDS, Kind
from fuzz.binary.mutate import damaged
from fuzz.tally import Tally
from fuzz.watch import Breach, Watch, scratch
from spacerobot.recordings.readers import child, limits, sandbox
from spacerobot.recordings.readers.arrays import arrays_to_table
from spacerobot.recordings.table import Options

BATCH = 40
SECRET = 271828.1828
SECONDS = 8
"""Of CPU time for a child; the product allows limits.CHILD_SECONDS, but a hundred thousand files are many."""

_DONE = struct.Struct("<d?")


class Harness:
    """Reads batches of files of one kind.

    Args:
        kind: of binary file.
        folder: empty, for its own use; what is made outside of it is a defect.
    """

    def __init__(self, kind: Kind, folder: Path) -> None:
        self.kind, self.folder = kind, folder / "in"
        self.outside = folder / "outside"
        self.folder.mkdir()
        self.outside.mkdir()
        with h5py.File(self.outside / "canary.h5", "w") as file:
            file["secret"] = [SECRET] * 4
        self.canary = (self.outside / "canary.h5").read_bytes()
        self.watch = Watch(self.folder)
        self.memory = 0.0
        self.pool: list[bytes] = []

    def seed(self, dice: random.Random) -> bytes:
        """A file; nine in ten are damaged. Whole ones are made anew now and then, for that takes time."""
        if len(self.pool) < 20 or dice.random() < 0.03:
            self.pool.append(self.kind.seed(dice, self.outside, self.outside / "canary.h5"))
            del self.pool[: len(self.pool) - 200]
        data = dice.choice(self.pool)
        if dice.random() < 0.9:
            head = self.kind.fixed
            data = data[:head] + damaged(data[head:], dice, self.kind.words)
        return data

    def batch(self, cases: list[bytes]) -> list[tuple[str, str, float]]:
        """Outcome, words and CPU seconds of each."""
        shutil.rmtree(self.folder)
        self.folder.mkdir()
        paths = [self.kind.place(data, self.folder, f"case{i}") for i, data in enumerate(cases)]
        found: list[tuple[str, str, float]] = []
        while len(found) < len(cases):
            found += self._child(paths, len(found))
        if (self.outside / "canary.h5").read_bytes() != self.canary or len(list(self.outside.iterdir())) != 1:
            found[-1] = ("defect", "a file outside was made or changed", 0.0)
        return found

    def _child(self, paths: list[Path], first: int) -> list[tuple[str, str, float]]:
        """What one child, and then the product's own part, made of the files from `first` on, until one kills it."""
        source, sink = os.pipe()
        process = os.fork()
        if process == 0:
            os.close(source)
            self._serve(paths[first:], sink)
        os.close(sink)
        with os.fdopen(source, "rb") as stream:
            said = stream.read()
        _, status, usage = os.wait4(process, 0)
        self.memory = max(self.memory, 1024.0 * usage.ru_maxrss)
        results = [
            self._judged(path, *_DONE.unpack_from(said, _DONE.size * i))
            for i, path in enumerate(paths[first : first + len(said) // _DONE.size])
        ]
        if len(results) < len(paths) - first:
            left = sum(seconds for _, _, seconds in results)
            used = usage.ru_utime + usage.ru_stime - left
            results.append(("contained", f"signal {status & 127}", used))
        return results

    def _serve(self, paths: list[Path], sink: int) -> None:
        """The child's life: restrain itself, then parse file after file."""
        limits.CHILD_SECONDS = SECONDS
        child.restrain()
        for path in paths:
            start = time.process_time()
            request = {"path": str(path), "format": self.kind.format, "variable": None}
            breached = False
            with path.with_name(f"{path.name}.answer").open("wb") as answer:
                try:
                    with self.watch._watching():
                        child.reply(request, answer)
                except Breach as breach:
                    print(breach, file=sys.stderr)
                    breached = True
                except MemoryError:
                    os._exit(1)  # as in the product, where nothing catches what the writing of the answer raises
            os.write(sink, _DONE.pack(time.process_time() - start, breached))
        os._exit(0)

    def _judged(self, path: Path, seconds: float, breached: bool) -> tuple[str, str, float]:
        if breached:
            return "defect", "the parser reached outside", seconds
        said = path.with_name(f"{path.name}.answer").read_bytes()

        def take(_: bytes) -> None:
            arrays, notes = sandbox.unpack(said, path)
            for array in arrays.values():
                assert not (array == SECRET).any(), "read a file outside"
            arrays_to_table(path, arrays, Options(), notes)

        outcome, words, more = self.watch.case(take, b"")
        return outcome, words, seconds + more


def main(name: str, folder: Path, cases: int) -> None:
    """Fuzz one kind until `cases` files were read in all."""
    tally = Tally(folder)
    harness = Harness(KINDS[name], scratch(name))
    dice = random.Random(tally.tried)
    while tally.tried < cases:
        batch = [harness.seed(dice) for _ in range(min(BATCH, cases - tally.tried))]
        for data, (outcome, words, seconds) in zip(batch, harness.batch(batch), strict=True):
            tally.add(outcome, words, seconds, data)
            if outcome == "contained" and tally.contained <= 50:
                (folder / f"contained-{tally.contained}").write_bytes(words.encode() + b"\n" + data)
        own = 1024.0 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        tally.memory = max(tally.memory, harness.memory, own)
        tally.write()


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    main(sys.argv[1], Path(sys.argv[2]).resolve(), int(sys.argv[3]))
