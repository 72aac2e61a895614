"""Numba's decorator as the house uses it, with a disk cache that a changed source cannot leave stale.

Numba looks only at the file of the compiled function, not at those whose functions it calls or whose constants it
holds; so the cache folder carries a hash of every source that compiled code can see. Laws, which loops call by their
addresses, have a folder of their own: who changes an effect waits for its laws only. Both lie in the user's cache
folder, which also serves read-only installations.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import sys
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from types import FunctionType
from typing import Any

from spacerobot.support import parts
from spacerobot.support.progress import compiling

_PACKAGE = Path(__file__).resolve().parent.parent
_ALL = ("support/jit.py", "support/parts.py", "effects/kernel.py")
"""How everything is compiled, and how a law is called."""

_LAYERS = ("dynamics", "simulation")
"""Where loops are looked for."""

_MARK = b"from spacerobot.support.jit import"
"""What a file of loops says."""

_LOOPS = (
    "recordings/readers/decimals.py",
    "diagnosis/machines/measured.py",
    "diagnosis/machines/hidden_motion.py",
    "effects/laws.py",
    "simulation/reduced/arrays.py",
    "simulation/multibody/dop853.py",
    "simulation/multibody/radau.py",
)
"""Loops elsewhere, and what loops read: the constants that they hold, and a law that stands in them."""

_LAWS = ("effects", "simulation/multibody/ports.py")
"""Where laws are defined."""


def sources() -> list[Path]:
    """Every file that compiled loops can depend on; a test holds that none is forgotten."""
    layers = [path for layer in _LAYERS for path in sorted((_PACKAGE / layer).rglob("*.py"))]
    return [*(_PACKAGE / name for name in _ALL + _LOOPS), *(p for p in layers if _MARK in p.read_bytes())]


def sources_of_laws() -> list[Path]:
    """Every file that a compiled law can depend on."""
    found = [_PACKAGE / name for name in _ALL + _LAWS]
    return [file for path in found for file in (sorted(path.rglob("*.py")) if path.is_dir() else [path])]


def cache_folder(files: list[Path]) -> Path:
    """Where compiled code of these very sources is kept; SPACEROBOT_CACHE moves it."""
    digest = hashlib.sha256()
    for path in files:
        digest.update(f"\0{path.relative_to(_PACKAGE)}\0".encode())
        digest.update(path.read_bytes())
    root = os.environ.get("SPACEROBOT_CACHE") or os.environ.get("XDG_CACHE_HOME") or "~/.cache"
    folder = Path(root).expanduser() / "spacerobot" / f"numba-{digest.hexdigest()[:16]}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        folder = Path(tempfile.gettempdir()) / f"spacerobot-numba-{os.getuid()}-{digest.hexdigest()[:16]}"
        folder.mkdir(mode=0o700, exist_ok=True)
    return folder


def nothing_kept() -> bool:
    """Whether nothing is compiled yet."""
    return next(Path(numba().config.CACHE_DIR).rglob("*.nbi"), None) is None


@functools.cache
def numba() -> Any:
    """The numba module, its cache pointed at the folder of loops."""
    if "numba" not in sys.modules:  # of thousands of messages that it writes while it tries what fits, nobody sees any
        os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")
    import numba as module

    setattr(module.config, "CACHE_DIR", str(cache_folder(sources())))  # noqa: B010 - numba's own stubs do not know it
    _tell_of_compiling()
    return module


_turn = threading.RLock()
"""Of who makes a compiled function: Numba reads the folder from its settings then, which are everybody's."""


@contextlib.contextmanager
def kept_with_laws() -> Iterator[None]:
    """What is made within is kept in the folder of laws."""
    config = numba().config
    with _turn:
        loops = config.CACHE_DIR
        config.CACHE_DIR = str(_folder_of_laws())
        try:
            yield
        finally:
            config.CACHE_DIR = loops


@functools.cache
def _folder_of_laws() -> Path:
    return cache_folder(sources_of_laws())


def _njit(function: Any, **options: Any) -> Any:
    module = numba()
    with _turn:
        return module.njit(function, cache=True, **{"nogil": True, "error_model": "numpy", **options})


def _part(function: Any, **options: Any) -> Any:
    """What is left open here is as in the first caller to be compiled: `forceinline` too."""
    numba()
    kind, options = parts.part(), {"nogil": True, "error_model": "numpy", "forceinline": False, **options}
    return _njit(function, **options) if kind is None else kind(function, _njit, **options)


def _tell_of_compiling() -> None:
    """Have progress say while something compiles: minutes, the first time, which nobody would guess."""
    from numba.core import event

    class Told(event.Listener):  # type: ignore[misc]
        def on_start(self, event: object) -> None:
            compiling(1)

        def on_end(self, event: object) -> None:
            compiling(-1)

    event.register("numba:compile", Told())


def inlined(function: Any) -> Any:
    """As `lean`, but merged into every compiled caller, which keeps a hot loop whole."""
    return _part(function, _nrt=False, forceinline=True)


def part(function: Any) -> Any:
    """As `jit`, for functions that compiled ones call: none is optimised but within what Python calls, see `parts`."""
    return _part(function, _nrt=True)


def lean(function: Any) -> Any:
    """As `part`, for functions of a hot loop that make no arrays: no reference is counted for their arguments.

    The counts are atomic; for a function of eight arrays they cost 0.1 us a call, which is what its work costs.
    """
    return _part(function, _nrt=False)


def lean_sum(function: Any) -> Any:
    """As `lean`, for sums along rows in whatever order is quickest: in the written one each term waits for the last.

    All else is IEEE arithmetic: nothing is taken to be finite.
    """
    return _part(function, _nrt=False, fastmath={"reassoc"})


def lean_twin(compiled: Any) -> Any:
    """The `lean` form of what `jit` compiled, for compiled callers: what it returns must not reach Python.

    Of a name of its own: Numba's disk cache does not look at options, so a process would be handed whichever form
    another had left there first, and the lean one's views come back to Python as the whole array.
    """
    f = compiled.py_func
    twin = FunctionType(f.__code__, f.__globals__, f.__name__, f.__defaults__, f.__closure__)
    twin.__module__, twin.__qualname__ = f.__module__, f"{f.__qualname__}.lean"
    return lean(twin)


def jit(function: Any) -> Any:
    """Compile on first call, keep on disk, release the GIL, IEEE arithmetic: no fast-math, and a division by zero is
    an infinity, which integrators refuse, as in the laws that they call.
    """
    return _njit(function)


@functools.cache
def call_law() -> Any:
    """An intrinsic `(address, d, v, aux, array, first) -> float` that calls a C law on the array from `first` on.

    A typed list of functions, or a view of the array, would count references at every call: five times the cost.
    """
    from llvmlite import ir
    from numba.core import cgutils, types
    from numba.extending import intrinsic

    numba()

    @intrinsic
    def call(typingctx: Any, address: Any, d: Any, v: Any, aux: Any, array: Any, first: Any) -> Any:
        def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            double = ir.DoubleType()
            law = builder.inttoptr(args[0], ir.FunctionType(double, [double] * 3 + [double.as_pointer()]).as_pointer())
            data = context.make_array(signature.args[4])(context, builder, args[4]).data
            return builder.call(law, [*args[1:4], cgutils.gep_inbounds(builder, data, args[5])])

        real = types.float64
        return real(types.int64, real, real, real, array, types.int64), codegen

    return call


@functools.cache
def call_memory() -> Any:
    """As `call_law`, of a law that reads more numbers: `(address, tuple of them, array, first) -> float`."""
    from llvmlite import ir
    from numba.core import cgutils, types
    from numba.extending import intrinsic

    numba()

    @intrinsic
    def call(typingctx: Any, address: Any, numbers: Any, array: Any, first: Any) -> Any:
        def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            double, read = ir.DoubleType(), cgutils.unpack_tuple(builder, args[1])
            kind = ir.FunctionType(double, [double] * len(read) + [double.as_pointer()])
            data = context.make_array(signature.args[2])(context, builder, args[2]).data
            law = builder.inttoptr(args[0], kind.as_pointer())
            return builder.call(law, [*read, cgutils.gep_inbounds(builder, data, args[3])])

        return types.float64(types.int64, numbers, array, types.int64), codegen

    return call


@functools.cache
def by_address() -> tuple[Any, Any, Any]:
    """What keeps a large compiled function out of its callers, where LLVM would copy it to every call.

    Returns:
        outlined: decorator, `(int64, float, pointer, pointer, pointer) -> float` in plain Python to a C function.
        pointer: intrinsic, an address to what `numba.carray` takes.
        call: intrinsic `(function, here, t, a, b, c) -> float`, both addresses, that calls such a function on arrays.
    """
    from llvmlite import ir
    from numba.core import cgutils, types
    from numba.extending import intrinsic

    module, real, address = numba(), types.float64, types.int64
    numbers = types.CPointer(real)
    outlined = module.cfunc(real(address, real, numbers, numbers, numbers), cache=True, error_model="numpy")

    @intrinsic
    def pointer(typingctx: Any, at: Any) -> Any:
        def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            return builder.inttoptr(args[0], cgutils.voidptr_t)

        return types.voidptr(address), codegen

    @intrinsic
    def call(typingctx: Any, function: Any, here: Any, t: Any, a: Any, b: Any, c: Any) -> Any:
        def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            double, data = ir.DoubleType(), ir.DoubleType().as_pointer()
            kind = ir.FunctionType(double, [ir.IntType(64), double, data, data, data])
            arrays = [context.make_array(k)(context, builder, x).data for k, x in zip(signature.args[3:], args[3:])]
            return builder.call(builder.inttoptr(args[0], kind.as_pointer()), [args[1], args[2], *arrays])

        return real(address, address, real, a, b, c), codegen

    return outlined, pointer, call
