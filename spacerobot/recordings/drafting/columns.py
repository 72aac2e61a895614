"""What each column measures, by its name, the file's name and its neighbours: thing, quantity and axis."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.drafting.languages import words_in
from spacerobot.recordings.drafting.numbered import joint_of, motors
from spacerobot.recordings.drafting.vocabulary import (
    ARM,
    COMMAND,
    CONVERTER,
    DIMENSION,
    NOT_READINGS,
    QUANTITY,
    REAL,
    STAMPS,
    THINGS,
    TRACKERS,
    TURN,
)
from spacerobot.recordings.drafting.vocabulary import words as words_of
from spacerobot.recordings.guess import Guess, guess, is_time
from spacerobot.recordings.units import UNITS

_LATERAL = {
    "x": "x",
    "y": "y",
    "z": "z",
    "yaw": "yaw",
    "theta": "yaw",
    "heading": "yaw",
    "psi": "yaw",
    "att": "yaw",
    "rz": "yaw",
}
_JOINT = re.compile(r"(?:^|[a-z])(\d{1,2})$")
_PLACE = re.compile(r"(.+?)(?:\[(\d{1,2})\]|_(\d{1,2})|(?<=[A-Za-z])(\d{1,2}))")
_PLACES = ("p", "r", "s")
"""What mathematics calls a place, beside the name of a thing: p_target, r_wrist."""
_OF_JOINTS = words_of("q dq qd qdot tau joint joints theta effort efforts torques current currents moment")
"""Words of arrays that hold a number for each joint."""
_OF_STATES = words_of("position velocity effort")
"""Arrays of a message of joint states, which its file's name says that it is."""
_PLACED = ("px", "py", "pz")
"""Last words of a place in space, of whatever link."""
_OF_MOTORS = ("position", "velocity", "torque", "current", "voltage")


@dataclass(frozen=True)
class Reading:
    """What a column seems to be.

    Attributes:
        column: how a study names it.
        index: of the column in its file.
        thing: "target", "wrist", "hand", "base", the joint's number as text or its name after "joint:", a body's own
            name after "body:", or "" where the name is silent.
        quantity: "position", "velocity", "torque", "force", "current", "voltage", "orientation", "angular_velocity"
            (about x or y; about z it is the velocity of the yaw), or "" if unknown.
        axis: "x", "y", "z", "w", "yaw" or "".
        unit: unit that name or file states, None where neither does.
        command: whether it is what was asked for, not what was measured.
        plain: what `guess` makes of the name alone.
    """

    column: str
    index: int
    thing: str
    quantity: str
    axis: str
    unit: str | None
    command: bool
    plain: Guess


def readings(file: Found, joints: Sequence[str]) -> list[Reading]:
    """The readings of a file, without its clock, counters and what no sensor gave.

    Args:
        file: the file.
        joints: names of the robot's joints from base to tip, empty where no robot is at hand.
    """
    clock = file.clock
    columns = file.called.columns
    names = file.called.names()
    words = [words_in(n) for n in names]
    words = [[w for w in ws if len(ws) == 1 or w not in ("n", "m", "mm", "deg", "rad")] or ws for ws in words]
    actual = {w for ws in words for w in ws}
    unnamed = sum(not c.names for c in columns)
    others = _of_others(words, file.named.words)
    found: list[Reading] = []
    arrays = _arrays(names)
    numbered = motors([ws if c.names else [] for ws, c in zip(words, columns, strict=True)])
    for j in file.usable:
        if j == clock or (clock is not None and len(file.table.columns[j].values) != file.rows):
            continue
        own = words[j] if columns[j].names else []
        if (own[:1] and own[0] in others) or is_time(columns[j]):
            continue
        if (NOT_READINGS.intersection(own) and not joints) or STAMPS.intersection(own[-1:]):
            continue
        if own[-1:] == ["f"] and [*own[:-1], "i"] in words:
            own = own[:-1]  # final beside initial, no force
        reading: Reading | None = _reading(file, j, names[j], own, joints, actual)
        if (
            reading is not None
            and own
            and own[-1] in ("x", "y", "z", "w")
            and TURN & set(own)
            and [*own[:-1], "w"] in words
        ):
            reading = replace(reading, quantity="orientation", axis=own[-1])  # a quaternion's parts, by the fourth
        if reading is not None and j in numbered and reading.quantity in _OF_MOTORS and not reading.axis:
            reading = replace(reading, thing=joint_of(numbered[j], joints))
        if reading is not None and (stem := stem_of(names[j])) in arrays:
            said = [*own, *words_in(stem)]
            said += file.named.words if _OF_STATES.intersection(said) else ()
            reading = _in_array(reading, said, _place(names[j]), arrays[stem], joints)
        if reading is not None and not own and unnamed >= len(names) - 1:
            reading = _by_place(file, reading, clock, joints)
        if reading is not None:
            found.append(reading)
    return [replace(r, column=file.table.names()[r.index]) for r in _no_wishes(found)]


def _of_others(words: Sequence[Sequence[str]], file: Sequence[str]) -> set[str]:
    """First words of columns that are another machine's: RED's own log has RED_Px, and BLACK_Px as RED heard it."""
    rest: dict[str, set[tuple[str, ...]]] = {}
    for own in words:
        if len(own) > 1:
            rest.setdefault(own[0], set()).add(tuple(own[1:]))
    mine = next((rest[w] for w in file if len(rest.get(w, ())) > 1), set())
    return {first for first, own in rest.items() if first not in file and len(own & mine) > 1}


def _reading(
    file: Found, index: int, name: str, words: list[str], joints: Sequence[str], neighbours: set[str]
) -> Reading:
    plain = guess(name, file.table.columns[index].unit)
    stated = plain.stated
    command = bool(COMMAND.intersection(words)) or ("target" in words and bool(REAL & neighbours))
    said = [w for w in words if w not in REAL] if REAL & set(words) and len(words) > 1 else words
    if "current" in words and len(REAL & set(words)) > 1:
        said.append("current")  # another word says that it was measured
    if "target" in words and command:
        said = [w for w in said if w != "target"]
    if "torque" in said and "wrench" in said:
        said = [w for w in said if w != "wrench"]  # which has both
    if words[-1:] in (["tx"], ["ty"], ["tz"]) or (words[-2:-1] and words[-2] in ("tx", "ty", "tz")):
        said = [*said, "torque"] if "fx" in neighbours else said
    quantity = _quantity(said) or (DIMENSION.get(UNITS[stated].dimension, "") if stated else "")
    if not quantity or (quantity == "position" and stated is None):
        quantity = _of_file(file) or quantity
    if stated in UNITS and DIMENSION.get(UNITS[stated].dimension) not in (None, quantity):
        quantity = DIMENSION[UNITS[stated].dimension]  # the unit is the surer word
    axis = next((_LATERAL[w] for w in said if w in _LATERAL), "")
    if not axis:
        axis = next((w[-1] for w in said if re.fullmatch(r"(?:v|d|f|p|t|m|w|force|pos|vel)[xyz]", w)), "")
    spin = any(re.fullmatch(r"w[xyz]", w) for w in said)
    if quantity in ("velocity", "position") and (spin or {"angular", "gyro", "omega", "rotation"} & set(words)):
        if quantity == "velocity" and axis in ("x", "y"):
            quantity = "angular_velocity"
        else:
            axis = "yaw" if axis in ("", "z", "yaw") else ""
    if ({"quat", "quaternion", "orientation"} & set(words) and axis != "yaw") or (
        TURN.intersection(words) and file.format in TRACKERS
    ):
        quantity, axis = "orientation", next((w[-1] for w in reversed(words) if re.fullmatch(r"q?[wxyz]", w)), "")
    thing = _joint(name, said, joints)
    if thing.startswith("joint:") and quantity == "position" and said[-1:] and said[-1] in _PLACED:
        thing = f"body:{thing.removeprefix('joint:')}"  # where the link is, not how far its joint has turned
    if not thing:
        thing = next((t for w in said for t, called in THINGS.items() if w in called), "")
    if not thing:
        # The last of several: topics go from the general to the particular, vrpn_client_node-wrist-pose.
        thing = next((t for w in reversed(file.named.words) for t, called in THINGS.items() if w in called), "")
    if not thing and (own := [w for w in file.named.words if re.fullmatch(r"joint\d+", w)]):
        place = int(own[0].removeprefix("joint"))
        thing = f"joint:{joints[place - 1]}" if 0 < place <= len(joints) else f"joint:{own[0]}"
    if thing in ("wrist", "hand") and ARM & neighbours:
        thing = f"body:{next(w for w in said if w in THINGS[thing])}" if THINGS[thing] & set(said) else ""
    elif thing == "" and (link := next((w for w in said if w in ARM), "")):
        thing = f"body:{link}"
    if thing in THINGS and not quantity and set(words) <= {*THINGS[thing], *_LATERAL, *_PLACES, *CONVERTER}:
        quantity = "position"  # a thing alone is where it is
    if file.format in TRACKERS and "." in name and quantity in ("position", "orientation"):
        body = name.split(".")[0]
        mine = next((t for w in words_in(body) for t, called in THINGS.items() if w in called), "")
        thing = mine or f"body:{body}"
    return Reading(name, index, thing, quantity, axis, stated, command, plain)


def _by_place(file: Found, reading: Reading, clock: int | None, joints: Sequence[str]) -> Reading | None:
    """A column without a name: the n-th joint, or the n-th axis, where the file's name says what it holds."""
    quantity = _of_file(file)
    readable = [j for j in range(len(file.table.columns)) if j != clock]
    place = readable.index(reading.index)
    words = set(file.named.words)
    if quantity and ("joint" in words or "joints" in words or (joints and len(readable) == len(joints))):
        thing = f"joint:{joints[place]}" if place < len(joints) else f"joint:joint{place + 1}"
        return Reading(str(reading.index), reading.index, thing, quantity, "", None, False, reading.plain)
    if quantity in ("position", "force") and len(readable) in (2, 3, 6) and place < 3:
        return Reading(
            str(reading.index), reading.index, reading.thing, quantity, "xyz"[place], None, False, reading.plain
        )
    return reading


def joints_by_place(files: Mapping[str, Found]) -> dict[str, tuple[str, ...]]:
    """Stream -> joints of files without names, as many in files of positions as in those of torques or currents.

    Args:
        files: stream -> one of its files.
    """
    widths: dict[str, tuple[str, int]] = {}
    for stream, file in files.items():
        if not any(c.names for c in file.table.columns):
            widths[stream] = _of_file(file), sum(j != file.clock for j in range(len(file.table.columns)))
    driven = {n for quantity, n in widths.values() if quantity in ("torque", "current")}
    placed = {n for quantity, n in widths.values() if quantity == "position"}
    return {
        stream: tuple(f"joint{j + 1}" for j in range(n))
        for stream, (_, n) in widths.items()
        if n > 1 and n in driven & placed
    }


def _of_file(file: Found) -> str:
    """What the file's name says that it holds; a letter alone is an axis, an input or an output of something."""
    return _quantity([w for w in file.named.words if w not in ("x", "y", "z", "u")])


def stem_of(name: str) -> str:
    """What comes before a number at the end: "q[3]" and "actual_q_3" are places in "q" and "actual_q"."""
    found = _PLACE.fullmatch(name)
    return found.group(1) if found else ""


def _place(name: str) -> int:
    found = _PLACE.fullmatch(name)
    return int(next(filter(None, found.groups()[1:]))) if found else 0


def _arrays(names: Sequence[str]) -> dict[str, int]:
    """Stem -> how many columns are numbered behind it, from 0 and without a gap: an array of the logger's program."""
    places: dict[str, set[int]] = {}
    for name in names:
        if stem := stem_of(name):
            places.setdefault(stem, set()).add(_place(name))
    return {stem: len(own) for stem, own in places.items() if len(own) > 1 and own == set(range(len(own)))}


def _in_array(reading: Reading, words: list[str], place: int, width: int, joints: Sequence[str]) -> Reading:
    """A column of an array: an axis of a vector or a wrench, a part of a pose, or a joint, by its place."""
    if reading.quantity == "orientation":
        return reading
    a_joint = reading.thing.startswith("joint:")  # by a number from 1; but q0 is the first joint's
    of_joints = a_joint or width == len(joints) or (_OF_JOINTS.intersection(words) and width != 3)
    if reading.quantity and of_joints and (not reading.thing or a_joint):
        joint = joints[place] if place < len(joints) else f"joint{place + 1}"
        return replace(reading, thing=f"joint:{joint}", axis="")
    if a_joint or reading.axis or width not in (2, 3, 6, 7) or not reading.quantity:
        return reading
    if place < 3:
        return replace(reading, axis="xyz"[place])
    if reading.quantity == "force":
        return replace(reading, quantity="torque", axis="xyz"[place - 3]) if width == 6 else reading
    return replace(reading, quantity="orientation" if reading.quantity == "position" else "", axis="")


def _joint(name: str, words: list[str], joints: Sequence[str]) -> str:
    """The joint that a column's name means: by its own name, else by its number."""
    flat = re.sub(r"[^a-z0-9]", "", name.lower())
    named = [j for j in joints if re.sub(r"[^a-z0-9]", "", j.lower()) in flat]
    if named:
        return f"joint:{max(named, key=len)}"
    own = re.split(r"[^A-Za-z0-9_]+", name.strip("]) "))[-1].lower()
    if not joints and re.fullmatch(r"[a-z]\w*_joint", own):
        return f"joint:{own}"
    text = "".join(words)
    if not re.search(
        r"joint|^(j\d|q|dq|qd|qdot|tau|pos|vel|eff|torque|effort|position|velocity|motor|axis|curr|i\d)", text
    ):
        return ""
    number = next((int(m.group(1)) for w in reversed(words) if (m := _JOINT.search(w))), None)
    if number is None or not (joints or re.match(r"(joint|j\d|q|dq|qd|qdot|tau|torque|effort|pos|vel|curr|i\d)", text)):
        return ""
    return f"joint:{joints[number - 1]}" if 0 < number <= len(joints) else f"joint:joint{number}"


def _quantity(words: list[str]) -> str:
    for n, word in enumerate(words):
        if word == "rz" and words[n + 1 : n + 2] in (["d"], ["dd"]):
            return "velocity" if words[n + 1] == "d" else ""
        if re.fullmatch(r"q[mgr]", word):
            return "position"
        if re.fullmatch(r"i\d{1,2}", word):
            return "current"
        bare = word.rstrip("0123456789")
        for quantity, called in QUANTITY.items():
            if word in called or bare in called:
                return quantity
    return ""


def _no_wishes(found: list[Reading]) -> list[Reading]:
    """What was asked for: `q_d` and `dq_d` beside `q` and `dq`, `qd` where there is a `dq` too, `qg` beside `qm`."""
    names = {r.column.lower() for r in found}
    has_dq = any(re.match(r"dq\W*\d", n) for n in names)
    result = []
    for reading in found:
        name = reading.column.lower()
        wished = re.match(r"d{0,2}q_?d_?\W*\d", name) and (("_d" in name) or has_dq) and not name.startswith("dq_0")
        if "qm" in names and re.fullmatch(r"q[gr]", name):
            reading = replace(reading, command=True)
        if wished and not re.match(r"dq\W*\d", name):
            kind = "position" if name[0] == "q" else "velocity"
            reading = replace(reading, quantity=kind, axis="", command=True)
        result.append(reading)
    return result
