"""One locator for the files that ship with the package, in a wheel and in an editable install alike."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent.parent
_SOURCES = {
    "urdf": ("_data/urdf", "../urdf"),
    "studies": ("_data/studies", "../examples/studies"),
    "newcomer": ("_data/newcomer", "../examples/newcomer"),
}


def folder(kind: str) -> Path:
    """The folder that holds the bundled `kind` ("urdf", "studies" or "newcomer").

    Raises:
        FileNotFoundError: the installation lacks the folder (a broken wheel).
    """
    for relative in _SOURCES[kind]:
        path = (_PACKAGE / relative).resolve()
        if path.is_dir():
            return path
    raise FileNotFoundError(f"the bundled {kind} are missing from {_PACKAGE}; reinstall spacerobot")
