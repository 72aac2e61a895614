"""Which files are of one kind (a stream), and which belong to one trial."""

from __future__ import annotations

import itertools
import re
from collections.abc import Container, Sequence
from dataclasses import dataclass

from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.names import identifier, in_ascii, is_measured, same
from spacerobot.recordings.drafting.vocabulary import TRACKERS
from spacerobot.recordings.trial import _GROUPS, _KEYS


@dataclass
class Group:
    """Files of one kind.

    Attributes:
        name: of the stream.
        files: in the order of the folder.
    """

    name: str
    files: list[Found]

    @property
    def leanest(self) -> Found:
        """The file with the fewest names for its columns: what it has, all have."""
        return min(self.files, key=lambda f: (len(set(f.columns())), f.relative))


@dataclass
class Trial:
    """Files recorded together.

    Attributes:
        id: its name.
        files: stream -> file.
        question: what could not be told, None where all is clear.
        window: first and last time that count, s, in the recording's own time; None for all.
    """

    id: str
    files: dict[str, Found]
    question: str | None = None
    window: tuple[float, float] | None = None


def groups_of(files: Sequence[Found]) -> list[Group]:
    """Files with the same columns and format, apart where words in their names say that they measure other things.

    A file without a header goes with those of as many columns and the same words; one with columns to spare goes with
    those that lack them.
    """
    alike: list[list[Found]] = []
    for file in sorted(files, key=lambda f: -len(f.columns())):
        home = next((members for members in alike if _like(file, members[0])), None)
        alike.append([file]) if home is None else home.append(file)
    found: list[Group] = []
    for members in sorted((sorted(m, key=lambda f: f.relative) for m in alike), key=lambda m: m[0].relative):
        for part in _apart(members):
            found.append(Group(_name(part, members, [g.name for g in found]), part))
    return found


def _like(file: Found, other: Found) -> bool:
    if file.format != other.format:
        return False
    if file.format in TRACKERS and file.variable == other.variable:
        return True
    mine, theirs = file.columns(), other.columns()
    if mine == theirs:
        return True
    if len(mine) == len(theirs) and not (any(mine) and any(theirs)):
        return file.named.words == other.named.words
    return len(set(mine) - {""}) > 2 and set(mine) < set(theirs)


def _apart(members: list[Found]) -> list[list[Found]]:
    """Members by what their names say is measured, and by all their words where one trial's numbers come with several.

    All are one where neither tells them apart.
    """
    by_measured: dict[frozenset[str], list[Found]] = {}
    for file in members:
        by_measured.setdefault(frozenset(w for w in file.named.words if is_measured(w)), []).append(file)
    return [part for same_measured in by_measured.values() for part in _by_words(same_measured)]


def _by_words(members: list[Found]) -> list[list[Found]]:
    by_words: dict[tuple[str, ...], list[Found]] = {}
    for file in members:
        by_words.setdefault(file.named.words, []).append(file)
    keys = [{f.named.keys for f in part} for part in by_words.values()]
    shared = any(a & b for a, b in itertools.combinations(keys, 2)) and any(k for ks in keys for k in ks)
    return list(by_words.values()) if shared else [members]


def _name(part: list[Found], members: list[Found], taken: list[str]) -> str:
    common = [w for w in part[0].named.words if all(w in f.named.words for f in part)]
    everywhere = {w for w in common if all(w in f.named.words for f in members)} if len(part) < len(members) else set()
    telling = [w for w in common if w not in everywhere] or common
    name = re.sub(r"[^\w-]+", "_", in_ascii("_".join(telling)), flags=re.ASCII).strip("_")[:30] or "log"
    if name in (*_KEYS, *_GROUPS):
        name += "_log"
    return unused(name, taken)


def unused(name: str, taken: Container[str]) -> str:
    """`name`, with a number behind it where it is taken."""
    return next(n for n in itertools.chain([name], (f"{name}_{i}" for i in itertools.count(2))) if n not in taken)


def trials_of(groups: Sequence[Group]) -> list[Trial]:
    """The trials, in order; files that share a number, a date or a folder are together.

    Where no name tells which files belong together, each is a trial of its own that asks.
    """
    if all(len(g.files) == 1 for g in groups) and len({g.files[0].named.keys for g in groups}) == 1:
        only = identifier("_".join(groups[0].files[0].named.keys)) or "01"
        return [Trial(only, {g.name: g.files[0] for g in groups})]
    if len(groups) == 1:
        own = _distinct(groups[0])
        return _in_order([Trial(n, {groups[0].name: f}) for n, f in zip(own, groups[0].files, strict=True)])
    return _together(groups, _by_all(groups) or _by_one(groups) or [_distinct(g) for g in groups])


def _by_all(groups: Sequence[Group]) -> list[list[str]] | None:
    """Keys made of all numbers of the names, where they tell a group's files apart and two groups share some."""
    keyed = [["_".join(map(same, f.named.keys)) for f in g.files] for g in groups]
    told = all(len(set(k)) == len(k) for k in keyed)
    shared = any(set(a) & set(b) - {""} for a, b in itertools.combinations(keyed, 2))
    if not (told and shared):
        return None
    return [[key or own for key, own in zip(k, _distinct(g), strict=True)] for k, g in zip(keyed, groups, strict=True)]


def _by_one(groups: Sequence[Group]) -> list[list[str]] | None:
    """Keys made of one number or date of each name: those that most of the groups' files share."""
    choices: list[list[list[str]]] = []
    for group in groups:
        width = min(len(f.named.keys) for f in group.files)
        columns = [[same(f.named.keys[p]) for f in group.files] for p in range(-width, 0)]
        choices.append([c for c in columns if len(set(c)) == len(c)])
    if not all(choices):
        return None
    best = max(itertools.islice(itertools.product(*choices), 4096), key=lambda keyed: _agreement(keyed)[0])
    agreed, all_of = _agreement(best)
    return list(best) if agreed == all_of or agreed > 1 else None


def _agreement(keyed: Sequence[Sequence[str]]) -> tuple[int, int]:
    """Keys that all groups have, and those that any has."""
    sets = [set(k) for k in keyed]
    return len(set.intersection(*sets)), len(set.union(*sets))


def _distinct(group: Group) -> list[str]:
    """A short name for each file of a group: its first number that no other has, else all that differs."""
    files = group.files
    width = min(len(f.named.keys) for f in files)
    if len(files) > 1:
        for position in range(width):
            column = [identifier(f.named.keys[position]) for f in files]
            if len(set(column)) == len(column) and all(column):
                return column
    constant = set.intersection(*({*f.named.keys, *f.named.words} for f in files)) if len(files) > 1 else set()
    names = []
    for file in files:
        parts = [k for k in file.named.keys if k not in constant]
        plain = "_".join(parts or [w for w in file.named.words if w not in constant] or file.named.keys)
        names.append(identifier(plain) or "01")
    if len(set(names)) < len(names):
        names = [identifier("_".join((*f.named.keys, *f.named.words, *(v[0] for v in f.named.values)))) for f in files]
    return [n or "01" for n in names]


def _together(groups: Sequence[Group], keyed: Sequence[Sequence[str]]) -> list[Trial]:
    """Trials by key; each is called by the shortest name that one of its files gives it."""
    found: dict[str, Trial] = {}
    names: dict[str, list[str]] = {}
    for group, keys in zip(groups, keyed, strict=True):
        for key, file, own in zip(keys, group.files, _distinct(group), strict=True):
            found.setdefault(key, Trial(key, {})).files[group.name] = file
            names.setdefault(key, []).append(own)
    for key, trial in found.items():
        trial.id = min(names[key], key=len)
        if len(trial.files) == 1:
            others = ", ".join(g.name for g in groups if g.name not in trial.files)
            trial.question = f"does a file of {others} belong to this trial"
    return _in_order(list(found.values()))


def _ordered(name: str) -> list[tuple[int, int, str]]:
    """Numbers as numbers: run2 before run10."""
    return [(0, int(t), "") if t.isdigit() else (1, 0, t) for t in re.findall(r"\d+|\D+", name)]


def _in_order(trials: list[Trial]) -> list[Trial]:
    """The trials by their ids, each made its own."""
    taken: set[str] = set()
    for trial in trials:
        trial.id = unused(identifier(trial.id) or "01", taken)
        taken.add(trial.id)
    return sorted(trials, key=lambda t: _ordered(t.id))
