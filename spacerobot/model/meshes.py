"""Where a URDF's meshes may lie: inside given folders and nowhere else. Loading a model needs none."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path, PurePosixPath
from urllib.parse import unquote

from lxml import etree

from spacerobot.model.reading import at
from spacerobot.support.errors import InputError


def check_meshes(root: etree._Element, mesh_dirs: Sequence[Path], where: str) -> None:
    """Refuse mesh paths that leave the folders; whether the files exist is not asked.

    Raises:
        InputError: names link, line and path.
    """
    for link in root.findall("link"):
        for mesh in link.iter("mesh"):
            name = mesh.get("filename") or ""
            fault = _fault(name, mesh_dirs)
            if fault:
                raise InputError(
                    f"mesh of link {link.get('name')!r} {fault}",
                    given=name,
                    valid="package:// or relative paths inside the package folders",
                    where=at(where, mesh),
                )


def mesh_path(filename: str, mesh_dirs: Sequence[Path]) -> Path | None:
    """The file behind a mesh name, or None if it is not there.

    Args:
        filename: as in the URDF: `package://name/...`, `file://...`, or a path relative to a mesh folder.
        mesh_dirs: folders to look in, in order.

    Raises:
        InputError: the file lies outside of all folders once links are resolved.
    """
    fault = _fault(filename, mesh_dirs)
    if fault:
        raise InputError(f"mesh {fault}", given=filename)
    scheme, relative = _split(filename)
    for folder in mesh_dirs:
        path = Path(relative) if scheme == "file" or relative.startswith("/") else folder / relative
        if path.is_file():
            if not path.resolve().is_relative_to(folder.resolve()):
                raise InputError("mesh leaves its folder through a link", given=filename, valid=str(folder))
            return path
    return None


def _split(filename: str) -> tuple[str, str]:
    scheme, separator, rest = filename.partition("://")
    if not separator:
        return "", filename
    return scheme.lower(), unquote(rest).lstrip("/") if scheme.lower() in ("package", "model") else unquote(rest)


def _fault(filename: str, mesh_dirs: Sequence[Path]) -> str | None:
    scheme, path = _split(filename)
    if scheme not in ("", "package", "model", "file"):
        return f"has the scheme {scheme}://"
    if "\\" in path or any(not c.isprintable() for c in path):
        return "has a path with strange characters"
    if path.startswith("/"):
        target = Path(path).resolve()
        if not any(target.is_relative_to(folder.resolve()) for folder in mesh_dirs):
            return "is an absolute path outside the package folders"
        return None
    if scheme == "file":
        return "is a file:// path that is not absolute"
    depth = 0
    for part in PurePosixPath(path).parts:
        depth += -1 if part == ".." else 1
        if depth < 0 or (scheme and depth < 1):
            return "leaves its folder through '..'"
    return None
