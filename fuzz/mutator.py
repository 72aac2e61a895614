"""Edits that leave a text readable for the most part: what a bit flip breaks at the gate never comes to the rooms."""

from __future__ import annotations

import random
import re

_TOKEN = re.compile(rb'"[^"\n]*"|[\w.+-]+')
_VALUES = (b"0", b"1", b"-1", b"2.5", b"1e-9", b"1e308", b"1e999", b"nan", b"inf", b"true", b'""', b'"x"', b"[]",
           b"[1, 2, 3]", b"{}", b"[[1]]", b"1" * 30, b'"\\u0000"', b"'", b'"', b",", b"\n", b"")  # fmt: skip


def edited(data: bytes, dice: random.Random, words: tuple[bytes, ...]) -> bytes:
    """One to four tokens or lines of `data` replaced, doubled, swapped or left out; its first byte is kept."""
    for _ in range(dice.choice((1, 1, 2, 4))):
        edit = dice.choice((_token, _token, _token, _value, _line, _swapped))
        data = data[:1] + edit(data[1:], dice, words)
    return data


def _token(data: bytes, dice: random.Random, words: tuple[bytes, ...]) -> bytes:
    found = list(_TOKEN.finditer(data))
    if not found:
        return data + dice.choice(words)
    old = dice.choice(found)
    new = dice.choice((dice.choice(words), dice.choice(_VALUES), dice.choice(found).group()))
    if old.group().startswith(b'"') and not new.startswith(b'"') and dice.random() < 0.7:
        new = b'"' + new + b'"'
    return data[: old.start()] + new + data[old.end() :]


def _value(data: bytes, dice: random.Random, words: tuple[bytes, ...]) -> bytes:
    """What follows an equals sign or a comma."""
    found = list(re.finditer(rb"[=,:>]\s*([^,\n=<]*)", data))
    if not found:
        return data
    old = dice.choice(found)
    new = dice.choice((dice.choice(_VALUES), dice.choice(found).group(1), b'"' + dice.choice(words) + b'"'))
    return data[: old.start(1)] + new + data[old.end(1) :]


def _line(data: bytes, dice: random.Random, words: tuple[bytes, ...]) -> bytes:
    lines = data.split(b"\n")
    at = dice.randrange(len(lines))
    what = dice.random()
    if what < 0.3:
        del lines[at]
    elif what < 0.6:
        lines.insert(dice.randrange(len(lines) + 1), lines[at])
    else:
        lines.insert(at, dice.choice(words) + b" = " + dice.choice((*_VALUES, b'"' + dice.choice(words) + b'"')))
    return b"\n".join(lines)


def _swapped(data: bytes, dice: random.Random, words: tuple[bytes, ...]) -> bytes:
    lines = data.split(b"\n")
    first, second = dice.randrange(len(lines)), dice.randrange(len(lines))
    lines[first], lines[second] = lines[second], lines[first]
    return b"\n".join(lines)
