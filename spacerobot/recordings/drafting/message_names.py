"""Arrays of a message whose elements are named in columns of text beside them, as tables of ROS's JointState have them.

Their order is the logger's, often that of the alphabet, and no machine's.
"""

from __future__ import annotations

import re
from dataclasses import replace

from spacerobot.recordings.drafting.files import Found
from spacerobot.recordings.readers.layout import find_layout, split
from spacerobot.recordings.readers.text import read_lines

_ELEMENT = re.compile(r"(?P<stem>(?:.*\W|.*_)?(?P<field>[A-Za-z]+))[\[_]?(?P<place>\d{1,2})\]?")


def with_message_names(file: Found) -> Found:
    """The file with its arrays' elements called by their names, "position[elbow_joint]"; itself where none are told."""
    columns = file.table.columns
    if file.format not in ("csv", "text") or file.labels:
        return file
    elements = {j: m for j, c in enumerate(columns) if c.names and (m := _ELEMENT.fullmatch(c.names[0]))}
    told = {j: m for j, m in elements.items() if m["field"].lower() in ("name", "names") and j not in file.usable}
    if len(told) < 2:
        return file
    lines = read_lines(file.table.path)
    layout = find_layout(lines, None, None, None)
    first = split(lines[layout.rows[0]], layout.separator)
    names = {int(m["place"]): first[j] for j, m in told.items() if j < len(first)}
    if len({n for n in names.values() if re.fullmatch(r"[A-Za-z]\w*", n)}) < len(told):
        return file
    owner = next(iter(told.values()))["stem"].removesuffix("s").removesuffix("name")
    labels = [""] * len(columns)
    for j, m in elements.items():
        if m["stem"].startswith(owner) and int(m["place"]) in names and j in file.usable:
            labels[j] = f"{m['stem']}[{names[int(m['place'])]}]"
    return replace(file, labels=tuple(labels), labelled_by="the names beside it")
