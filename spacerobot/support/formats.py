"""Numbers of file formats: a file of another one is refused in a line that says which side is the older one."""

from __future__ import annotations

from spacerobot.support.errors import InputError


def require_format(number: object, ours: int, what: str, where: str | None, older: str = "") -> None:
    """Refuse a file whose format is not ours: its keys may mean other things.

    Args:
        number: as the file states it.
        ours: the format that is read and written here.
        what: kind of file, e.g. "scene".
        where: file, line or key.
        older: what to do about an older file.

    Raises:
        InputError: it is another format, or no number.
    """
    if number == ours and not isinstance(number, bool):
        return
    said = f"unknown format of a {what}"
    if isinstance(number, int) and not isinstance(number, bool):
        said += ", written for a newer spacerobot" if number > ours else ", written for an older spacerobot"
        said += f": {older}" if older and number < ours else ""
    raise InputError(said, given=number, valid=str(ours), where=where)
