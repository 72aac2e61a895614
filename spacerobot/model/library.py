"""Loading a robot by bundled name, by example-robot-data's name, from a file or from text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from spacerobot.model import examples
from spacerobot.model.armature import add_rotors
from spacerobot.model.build import build
from spacerobot.model.floating import float_root
from spacerobot.model.reading import MAX_BYTES, parse
from spacerobot.model.robot import Robot
from spacerobot.model.tips import Tree
from spacerobot.model.validate import validate
from spacerobot.model.yourdf import read_with_yourdfpy
from spacerobot.support import resources
from spacerobot.support.errors import InputError, NotFoundError


def bundled() -> list[str]:
    """Names of the URDFs that ship with the package."""
    return sorted(path.stem for path in resources.folder("urdf").glob("*.urdf"))


def robots() -> list[str]:
    """Every name that `load` knows: bundled robots first, then those of example-robot-data."""
    return [*bundled(), *examples.names()]


def load(
    what: str | Path,
    *,
    tip: str | None = None,
    package_dirs: Sequence[str | Path] = (),
    floating: bool | None = None,
    armature: bool = True,
    mend: bool = False,
) -> Robot:
    """Load a robot.

    What `what` means is settled in this order: text that starts with `<` is a URDF; a path (an object, or a
    string with a separator or ending in .urdf or .xml) is a file; otherwise it is a name, of a bundled robot
    first, then of one of example-robot-data.

    Args:
        what: name, path or URDF text.
        tip: frame at the end of the arm, or None to find it.
        package_dirs: folders that hold the packages of `package://` mesh paths; a file's own folder is added.
        floating: True puts the root on a free-flyer, False insists on a fixed base; None keeps what the URDF
            or the example's loader says.
        armature: whether rotor inertia counts.
        mend: whether an inertia that no body can have is moved to the nearest possible (`Robot.mended` says so)
            instead of being refused.

    Raises:
        NotFoundError: no robot of that name (names the nearest), no such file, or no frame `tip`.
        InputError: the URDF is malformed, or describes a body that cannot exist.
    """
    source = _source(what)
    root = parse(source.text, source.where)
    validate(root, source.where)
    if source.foreign:
        read_with_yourdfpy(root, source.where)
    if source.rotors:
        add_rotors(root, source.rotors)
    tree = Tree(root)
    floats = any(tree.kind(joint) == "floating" for joint in tree.joints)
    if floating is False and floats:
        raise InputError("robot's URDF has a floating base", given="floating=False", where=source.where)
    if not floats and (source.floating if floating is None else floating):
        float_root(root)
    return build(
        root,
        name=source.name,
        tip=tip,
        mesh_dirs=(*source.mesh_dirs, *(_folder(d) for d in package_dirs)),
        armature=armature,
        where=source.where,
        mends=mend,
    )


@dataclass(frozen=True)
class _Source:
    """URDF text and what is known about it before it is read."""

    text: bytes
    where: str
    name: str | None = None
    mesh_dirs: tuple[Path, ...] = ()
    rotors: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    floating: bool = False
    foreign: bool = False


def _source(what: str | Path) -> _Source:
    if isinstance(what, str) and what.lstrip("\ufeff \t\r\n").startswith("<"):
        return _Source(what.encode("utf-8", "replace"), "URDF text", foreign=True)
    if isinstance(what, Path) or _path_like(what):
        path = Path(what)
        return _Source(_read(path), str(path), path.stem, (path.resolve().parent,), foreign=True)
    if what in bundled():
        return _Source(_read(resources.folder("urdf") / f"{what}.urdf"), what, what)
    if what in examples.names():
        example = examples.find(what)
        text = _read(example.urdf)
        rotors = examples.rotors(example, text.decode("utf-8"))
        return _Source(text, f"example robot {what!r}", what, (example.mesh_dir,), rotors, example.floating)
    raise NotFoundError("robot", what, [*bundled(), *examples.names()])


def _path_like(text: str) -> bool:
    return "/" in text or "\\" in text or text.lower().endswith((".urdf", ".xml", ".xacro"))


def _read(path: Path) -> bytes:
    if path.suffix.lower() == ".xacro":
        raise InputError("xacro files are programs, not URDFs", given=str(path), valid="the URDF that xacro writes")
    try:
        if not path.is_file():
            raise InputError("URDF file does not exist", given=str(path))
        with path.open("rb") as stream:
            return stream.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        raise InputError(f"URDF cannot be read ({error})", given=str(path)) from None


def _folder(path: str | Path) -> Path:
    folder = Path(path).resolve()
    if not folder.is_dir():
        raise InputError("package folder does not exist", given=str(path))
    return folder
