"""A table of text: the first byte chooses how a study says that it is laid out, the rest is the file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from fuzz.target import Target
from spacerobot.recordings.recording import load_trial
from spacerobot.recordings.study import load_study

_STREAMS = (
    'time = "t"\nchannels.x = { is = "target.x" }',
    'time = "t"\nsort = true\nrepeated = "drop"\nmissing = [-999]\nchannels.x = { is = "target.yaw", unwrap = true }',
    'time = 0\ntime_unit = "us"\nheader_rows = 0\nchannels.1 = { is = "target.x", unit = "mm", sigma = 1e-3 }',
    'rate = 100\nchannels.0 = { is = "contact.force", scale = 1e6, offset = -3 }',
    'rate = 10\nreshape = 2\nchannels.1 = { is = "joint.S1.position" }',
    'time = 0\nseparator = "semicolon"\ndecimal = ","\nchannels.1 = { is = "target.x" }',
    'time = 0\nseparator = "space"\nrows = [1, 4]\nchannels.1 = { is = "target.x" }',
    'time = 0\nencoding = "utf-16-le"\nchannels.1 = { is = "target.x" }',
    'time = 0\nformat = "text"\nencoding = "shift_jis"\nchannels.1 = { is = "target.x" }',
    'time = 0\ncompression = "gz"\nchannels.1 = { is = "target.x" }',
    'time = 0\ncompression = "xz"\nchannels.1 = { is = "target.x" }',
    'time = 0\ncompression = "bz2"\nchannels.1 = { is = "target.x" }',
    'kind = "events"\nchannels.0 = { is = "body.velocity.x", moment = "before" }',
    'time = 0\nclock = "own"\nchannels.1 = { is = "target.x" }\nchannels."2" = { is = "target.y" }',
)

_STUDY = """format = 1
[baseline]
robot = "pa10_wrist"
[streams.s]
{}
[[trials]]
id = "a"
s = "input.{}"
"""


def studies(folder: Path, streams: tuple[str, ...], suffix: str) -> Callable[[bytes], None]:
    """What reads an input as the file of one of several streams, chosen by its first byte."""
    loaded = []
    for index, text in enumerate(streams):
        own = folder / str(index)
        own.mkdir()
        (own / "study.toml").write_text(_STUDY.format(text, suffix))
        loaded.append(load_study(own))

    def read(data: bytes) -> None:
        study = loaded[(data[0] if data else 0) % len(loaded)]
        (study.root / f"input.{suffix}").write_bytes(data[1:])
        load_trial(study.streams, study.root, study.trials[0])

    return read


def _prepare(folder: Path) -> Callable[[bytes], None]:
    return studies(folder, _STREAMS, "csv")


_TABLE = b"t,x,y\n0,1,2\n0.1,2,3\n0.2,4,5\n0.3,5,-999\n"
_SEEDS = (
    b"\x00" + _TABLE,
    b"\x01# a comment\n" + _TABLE.replace(b"\n", b"\r\n"),
    b"\x021 2 3\n2 3 4\n3 4 nan\n",
    b"\x050,0;1,5\n0,1;2,5\n0,2;3,5\n",
    b"\x07" + "0,1\n1,2\n2,3\n".encode("utf-16-le"),
    b"\x00\xff\xfe" + _TABLE.decode().encode("utf-16-le"),
    b"\x00\xef\xbb\xbf" + _TABLE,
    b'\x0d"t";"x"\n"0";"1"\n"1700000000.5";"2"\n',
)
_WORDS = ("nan", "inf", "1e999", "-1", ";", "\t", "|", '"', "\r\n", "\x00", "\xef\xbb\xbf", "\xff\xfe", "%",
         "//", "1.5.2",
          "9" * 40, "NaN(ind)", "1_0", "0x1", "١", "1,5", "\x1f\x8b\x08", "BZh9", "\xfd7zXZ", "\x85",
          "\x0b")  # fmt: skip

TARGET = Target("csv", _prepare, _SEEDS, _WORDS, cases=300_000)
