"""The child process of `sandbox`: limits itself, parses one file, writes its arrays to standard output."""

from __future__ import annotations

import json
import os
import resource
import sys
from pathlib import Path
from typing import IO

from spacerobot.recordings.readers import limits
from spacerobot.recordings.readers.bag import bag_arrays, topics
from spacerobot.recordings.readers.hdf5 import hdf5_arrays
from spacerobot.recordings.readers.mat import mat_arrays
from spacerobot.recordings.readers.xlsx import sheets, xlsx_arrays
from spacerobot.recordings.table import Floats
from spacerobot.support.errors import InputError

_PARTS = {"bag:parts": topics, "xlsx:parts": sheets}


def answer(request: dict[str, str | None]) -> tuple[dict[str, Floats], list[str]]:
    """The arrays of the file that the request names, never more than `limits.ARRAY_VALUES` numbers.

    Of a request for its parts: no arrays, and their names for remarks.
    """
    path, variable = Path(str(request["path"])), request["variable"]
    if request["format"] in _PARTS:
        return {}, _PARTS[request["format"]](path)
    if request["format"] == "bag":
        arrays, notes = bag_arrays(path, variable)
    elif request["format"] == "xlsx":
        arrays, notes = xlsx_arrays(path, variable)
    elif request["format"] == "mat":
        arrays, notes = mat_arrays(path), []
    else:
        arrays, notes = hdf5_arrays(path), []
    if sum(a.size for a in arrays.values()) > limits.ARRAY_VALUES:
        raise InputError("the file holds too many numbers", valid=f"at most {limits.ARRAY_VALUES}")
    return arrays, notes


def restrain() -> None:
    """Limit this process's memory, time, files and cores."""
    pages = int(Path("/proc/self/statm").read_text().split()[0]) if Path("/proc/self/statm").exists() else 0
    memory = pages * os.sysconf("SC_PAGE_SIZE") + limits.CHILD_BYTES
    seconds = int(limits.CHILD_SECONDS)
    for kind, limit in (
        (resource.RLIMIT_AS, memory),
        (resource.RLIMIT_CPU, seconds),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_FSIZE, limits.CHILD_BYTES // 4),
    ):
        resource.setrlimit(kind, (limit, limit))


def main(source: IO[bytes], sink: IO[bytes]) -> None:
    """Read a request, write the answer, within the limits."""
    request = json.loads(source.read())
    restrain()
    reply(request, sink)


def reply(request: dict[str, str | None], sink: IO[bytes]) -> None:
    """Write the answer: a line of JSON, then the numbers."""
    try:
        arrays, notes = answer(request)
    except InputError as error:
        sink.write(json.dumps({"error": error.what}).encode() + b"\n")
        return
    except MemoryError:
        sink.write(json.dumps({"error": f"needs more than {limits.CHILD_BYTES} bytes of memory"}).encode() + b"\n")
        return
    except Exception as error:  # a parser of foreign formats may raise anything; the parent reports it
        reason = f"not a {request['format']} file that can be read: {type(error).__name__}: {error}"
        sink.write(json.dumps({"error": reason[:280]}).encode() + b"\n")
        return
    shapes = [[name, list(array.shape)] for name, array in arrays.items()]
    sink.write(json.dumps({"arrays": shapes, "notes": notes}).encode() + b"\n")
    for array in arrays.values():
        sink.write(array.tobytes())


if __name__ == "__main__":
    main(sys.stdin.buffer, sys.stdout.buffer)
