"""Functions that other compiled functions are made of: optimised once, in whichever function Python calls.

Numba finishes every function by itself, from the innermost out, and links the finished code of each into its callers,
which optimise all of it again: what lies ten calls deep is optimised ten times over, and each time turned into machine
code that nobody runs. A part goes no further than LLVM's language; the function that Python calls has all its parts
linked in, and optimises the whole of it.
"""

from __future__ import annotations

import functools
from typing import Any

REPLACED = ("_optimize_final_module", "_finalize_final_module", "_finalize_dynamic_globals")
"""What Numba does at the end of every function."""


@functools.cache
def part() -> Any:
    """The class of such functions, `(function, finish, **options of njit) -> part`; `finish` compiles it for Python.

    None where a Numba to come has not what this rests on: every function is finished by itself then, which takes
    longer and gives the same.
    """
    from numba import types
    from numba.core.codegen import JITCodeLibrary
    from numba.core.compiler import Compiler
    from numba.core.registry import CPUDispatcher

    if not all(hasattr(JITCodeLibrary, name) for name in REPLACED) or not hasattr(Compiler, "_compile_core"):
        return None
    remember_operators()

    class Unfinished(JITCodeLibrary):  # type: ignore[misc]
        """Code for callers to link."""

        def _optimize_final_module(self) -> None:
            pass

        def _finalize_final_module(self) -> None:
            self._finalize_dynamic_globals()
            self._finalized = True

    class Lowered(Compiler):  # type: ignore[misc]
        """Numba's own way, which ends before there is an address: callers know a part by an object of its own."""

        def define_pipelines(self) -> Any:
            state = self.state
            state.library = Unfinished(state.targetctx.codegen(), state.func_id.func_qualname)
            state.flags.no_compile = True
            return super().define_pipelines()

        def _compile_core(self) -> Any:
            made = super()._compile_core()._replace(entry_point=object())
            self.state.targetctx.insert_user_function(made.entry_point, made.fndesc, [made.library])
            return made

    class Part(CPUDispatcher):  # type: ignore[misc]
        def __init__(self, function: Any, finish: Any, **options: Any) -> None:
            self.finish = functools.partial(finish, function, **options)
            inner = {**options, "nopython": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
            super().__init__(function, targetoptions=inner, pipeline_class=Lowered)

        def get_call_template(self, args: Any, kws: Any) -> Any:
            """One form for all numbers of a type: Numba would make another for every constant that is handed over."""
            return super().get_call_template([types.unliteral(a) for a in args], kws)

        def add_overload(self, cres: Any) -> None:
            self.overloads[tuple(cres.signature.args)] = cres

        @functools.cached_property
        def whole(self) -> Any:
            """For callers in Python."""
            return self.finish()

        def __call__(self, *args: Any) -> Any:
            return self.whole(*args)

    return Part


@functools.cache
def remember_operators() -> None:
    """Have Numba ask once what `+` of two floats is: it tries some sixty ways at every `+` that it meets."""
    import operator

    from numba.core.types.functions import BaseFunction

    ask = BaseFunction.get_call_type
    found: dict[Any, Any] = {}
    known = {f for f in vars(operator).values() if callable(f)}

    def get_call_type(self: Any, context: Any, args: Any, kws: Any) -> Any:
        if kws or self.typing_key not in known:
            return ask(self, context, args, kws)
        key = self, context, tuple(args)
        if key not in found:
            told = ask(self, context, args, kws)
            if told is None or self._impl_keys.get(told.args) is not self.typing_key:  # compiled for these flags alone
                return told
            found[key] = told
        return found[key]

    setattr(BaseFunction, "get_call_type", get_call_type)  # noqa: B010 - mypy lets no method be assigned
