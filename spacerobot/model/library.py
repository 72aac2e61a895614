"""Loading a robot by bundled name, by example-robot-data's name, from a file or from text."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from spacerobot.model import examples
from spacerobot.model.armature import add_rotors
from spacerobot.model.build import build
from spacerobot.model.floating import float_root
from spacerobot.model.reading import MAX_BYTES, parse
from spacerobot.model.robot import Robot
from spacerobot.support import resources
from spacerobot.support.errors import InputError, NotFoundError


def bundled() -> list[str]:
    """Names of the URDFs that ship with the package."""
    return sorted(path.stem for path in resources.folder("urdf").glob("*.urdf"))


def load(
    what: str | Path,
    *,
    tip: str | None = None,
    package_dirs: Sequence[str | Path] = (),
    floating: bool | None = None,
    armature: bool = True,
) -> Robot:
    """Load a robot.

    What `what` means is settled in this order: text that starts with `<` is a URDF; a path (an object, or a
    string with a separator or ending in .urdf or .xml) is a file; otherwise it is a name, of a bundled robot
    first, then of one of example-robot-data.

    Args:
        what: name, path or URDF text.
        tip: frame at the end of the arm, or None to find it.
        package_dirs: folders that hold the packages of `package://` mesh paths; a file's own folder is added.
        floating: True puts the root on a free-flyer, False insists on a fixed base; None keeps what the URDF or
            the example's loader says.
        armature: whether rotor inertia counts.

    Raises:
        NotFoundError: no robot of that name (names the nearest), no such file, or no frame `tip`.
        InputError: the URDF is malformed, or describes a body that cannot exist.
    """
    if isinstance(what, str) and what.lstrip("\ufeff \t\r\n").startswith("<"):
        where, text, folders, rotors, free = "URDF text", what.encode(), [], {}, bool(floating)
        name = None
    elif isinstance(what, Path) or _path_like(what):
        path = Path(what)
        where, text, folders, rotors, free = (
            str(path),
            _read(path),
            [path.resolve().parent],
            {},
            bool(floating),
        )
        name = path.stem
    elif what in bundled():
        path = resources.folder("urdf") / f"{what}.urdf"
        where, text, folders, rotors, free = str(what), path.read_bytes(), [], {}, bool(floating)
        name = what
    elif what in examples.names():
        example = examples.find(what)
        where, text, folders = f"example robot {what!r}", _read(example.urdf), [example.mesh_dir]
        rotors = examples.rotors(example, text.decode("utf-8"))
        free = example.floating if floating is None else floating
        name = what
    else:
        raise NotFoundError("robot", what, [*bundled(), *examples.names()])
    mesh_dirs = tuple([*folders, *(_folder(d) for d in package_dirs)])
    root = parse(text, where)
    robot = None
    if rotors:
        add_rotors(root, rotors)
    if free:
        robot = build(root, name=name, tip=tip, mesh_dirs=mesh_dirs, armature=armature, where=where)
        if not robot.floating:
            float_root(root)
            robot = None
    robot = robot or build(root, name=name, tip=tip, mesh_dirs=mesh_dirs, armature=armature, where=where)
    if floating is False and robot.floating:
        raise InputError("robot's URDF has a floating base", given="floating=False", where=where)
    return robot


def _path_like(text: str) -> bool:
    return "/" in text or "\\" in text or text.lower().endswith((".urdf", ".xml", ".xacro"))


def _read(path: Path) -> bytes:
    if path.suffix.lower() == ".xacro":
        raise InputError(
            "xacro files are programs, not URDFs", given=str(path), valid="the URDF that xacro writes"
        )
    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError(
                "URDF is too large", given=f"{path.stat().st_size} bytes", valid=f"at most {MAX_BYTES}"
            )
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"URDF cannot be read ({error.strerror})", given=str(path)) from None


def _folder(path: str | Path) -> Path:
    folder = Path(path).resolve()
    if not folder.is_dir():
        raise InputError("package folder does not exist", given=str(path))
    return folder
