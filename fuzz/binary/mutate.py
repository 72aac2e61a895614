"""Damage done to a file that was whole: to its numbers, its lengths, its order."""

from __future__ import annotations

import random

_NUMBERS = (
    0, 1, -1, 2, 7, 8, 255, 256, 32767, 32768, 65535, 2**31 - 1, 2**31, 2**32 - 1, 2**63 - 1, 2**63, 10**9, 10**12,
)  # fmt: skip


def damaged(data: bytes, dice: random.Random, words: tuple[bytes, ...]) -> bytes:
    """`data` after one to six edits."""
    found = bytearray(data)
    for _ in range(dice.choice((1, 1, 1, 2, 2, 3, 6))):
        dice.choice(_EDITS)(found, dice, words)
        if not found:
            break
    return bytes(found)


def _place(found: bytearray, dice: random.Random, size: int) -> int:
    # Headers and tables lie at the beginning and at the end: half of all edits go there.
    top = max(len(found) - size, 0)
    pick = dice.random()
    if pick < 0.3:
        return min(top, int(dice.expovariate(1 / 200)))
    if pick < 0.5:
        return max(0, top - int(dice.expovariate(1 / 100)))
    return dice.randint(0, top)


def _byte(found: bytearray, dice: random.Random, _: tuple[bytes, ...]) -> None:
    found[_place(found, dice, 1)] = dice.randrange(256)


def _flip(found: bytearray, dice: random.Random, _: tuple[bytes, ...]) -> None:
    found[_place(found, dice, 1)] ^= 1 << dice.randrange(8)


def _number(found: bytearray, dice: random.Random, _: tuple[bytes, ...]) -> None:
    size = dice.choice((1, 2, 4, 4, 8, 8))
    at = _place(found, dice, size)
    if dice.random() < 0.7:
        at -= at % size
    value = dice.choice((*_NUMBERS, len(found), at, dice.randrange(1000)))
    found[at : at + size] = (value % 2 ** (8 * size)).to_bytes(size, dice.choice(("little", "little", "big")))


def _shifted(found: bytearray, dice: random.Random, _: tuple[bytes, ...]) -> None:
    size = dice.choice((2, 4, 8))
    at = _place(found, dice, size)
    value = int.from_bytes(found[at : at + size], "little") + dice.choice((-1, 1, 8, -8, 1 << 16, 1 << 24))
    found[at : at + size] = (value % 2 ** (8 * size)).to_bytes(size, "little")


def _word(found: bytearray, dice: random.Random, words: tuple[bytes, ...]) -> None:
    word = dice.choice(words)
    at = _place(found, dice, len(word))
    found[at : at + (len(word) if dice.random() < 0.6 else 0)] = word


def _cut(found: bytearray, dice: random.Random, _: tuple[bytes, ...]) -> None:
    del found[_place(found, dice, 1) :]


def _drop(found: bytearray, dice: random.Random, _: tuple[bytes, ...]) -> None:
    at = _place(found, dice, 1)
    del found[at : at + dice.choice((1, 2, 4, 8, 64))]


def _copy(found: bytearray, dice: random.Random, _: tuple[bytes, ...]) -> None:
    size = dice.choice((4, 8, 32, 128, 512))
    source, at = _place(found, dice, size), _place(found, dice, size)
    chunk = found[source : source + size]
    found[at : at + (len(chunk) if dice.random() < 0.7 else 0)] = chunk


_EDITS = (_byte, _byte, _flip, _flip, _number, _number, _number, _shifted, _word, _copy, _cut, _drop)
