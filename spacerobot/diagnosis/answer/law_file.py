"""A learned law in closed form as a file with an effect of its own: a draft to name, to explain and to hand on."""

from __future__ import annotations

import re
from collections.abc import Mapping

from spacerobot.effects.effect import Parameter
from spacerobot.effects.formula import OF_UNIT, WORDS, FormulaLaw

_FILE = '''"""A draft, written by `spacerobot diagnose` from a law that it learned; `--effects {file}` takes it.

Say what it is: give it a name, a title and a source, and its parameters names that end in their units.
"""

from __future__ import annotations

{imports}

from spacerobot.effects.effect import Effect, Parameter
{kernel}from spacerobot.effects.mechanism import Mechanism
{primitives}

{law}


class MyLaw(Effect):
    """Known from {low:.6g} to {high:.6g} {of_unit}, where recordings have shown it; beyond, it is a guess."""

    name = "my_law"
    title = "my law"
    formula = r"{formula}"
    source = "learned from recordings"
    parameters = (
{parameters}
    )

    def places(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Where it was learned."""
        return {places}

    def edit(self, mechanism: Mechanism, where: str, values: Mapping[str, float]) -> Mechanism:
        """The law at its place."""
        p = tuple(values[one.name] for one in self.parameters)
{edit}
'''

_FORCE = '''def force(d: float, v: float, aux: float, p: tuple[float, ...]) -> float:
    """Along the port [N]."""
    return -({sum})'''

_LEVEL = '''def level(v: float, normal: float, d: float, p: tuple[float, ...]) -> float:
    """The largest friction [N]."""
    return max({sum}, 0.0)'''

_CONTACT = '''def contact_force(d: float, v: float, aux: float, p: tuple[float, ...]) -> float:
    """Spring, dashpot and the law [N], negative in compression; p begins with the stiffness and the damping."""
    return -(p[0] * d + p[1] * v + {sum})'''

_MEMORY = '''Numbers = tuple[float, ...]


def rate(z: float, dz: float, d: float, v: float, way: float, normal: float, p: Numbers) -> float:
    """How fast what is remembered changes [N/s]."""
    return ({sum}) * v - p[{fading}] * z


def remembered(z: float, dz: float, d: float, v: float, way: float, normal: float, p: Numbers) -> float:
    """The force [N]."""
    return -z'''


def law_file(law: FormulaLaw, values: Mapping[str, float], where: str, file: str = "my_law.py") -> str:
    """The text of a Python file that defines the law as an effect, the learned values as its first starts.

    Args:
        law: in closed form.
        values: of its parameters, SI.
        where: the port at which it was learned.
        file: what it will be called.
    """
    form = law.shape
    contact = where == "contact"
    total = _sum(law, first=2 if contact else 0)
    template, kernel, primitives, edit = (
        _FORCE,
        "Kernel",
        "Force",
        _line("force", "Force(self.name, where, Kernel(force), p)"),
    )
    if form.kind == "memory":
        size = f"{max(abs(form.low), abs(form.high)):.6g}"
        template, kernel, primitives = _MEMORY, "", "State"
        edit = _line("state", f"State(self.name, where, Memory(rate, remembered), p, {size})")
    elif form.kind == "friction":
        pressed = ', normal="contact"' if form.of == "N" else ""
        template, kernel, primitives = _LEVEL, "", "Friction"
        edit = _line("friction", f"Friction(self.name, where, level, p{pressed})")
    elif contact:
        template, primitives = _CONTACT, ""
        edit = (
            "        return mechanism.with_contact(\n"
            "            lambda c: replace(c, kernel=Kernel(contact_force), p=(c.p[0], c.p[1], *p))\n        )"
        )
    memory = "from spacerobot.effects.memory import Memory\n" if form.kind == "memory" else ""
    return _FILE.format(
        file=file,
        imports="\n".join(
            (["import math"] if "math." in total else [])
            + ["from collections.abc import Mapping"]
            + (["from dataclasses import replace"] if contact else [])
        ),
        kernel=f"from spacerobot.effects.kernel import {kernel}\n" if kernel else "",
        primitives=f"{memory}from spacerobot.effects.primitives import {primitives}\n" if primitives else "",
        law=template.format(sum=total, fading=len(law.parameters) - 1),
        low=form.low,
        high=form.high,
        of_unit=OF_UNIT[form.of],
        formula=law.formula + r", \quad " + form.written(values),
        parameters="\n".join(_parameter(p, values[p.name]) for p in law.parameters),
        places='("contact",) if mechanism.contact is not None and mechanism.contact.p[2:] == (1.0, 0.0) else ()'
        if contact
        else f'("{where}",) if "{where}" in mechanism.ports else ()',
        edit=edit,
    )


def _line(what: str, made: str) -> str:
    return f"        return mechanism.with_{what}({made})"


def _sum(law: FormulaLaw, first: int) -> str:
    """The words of a law with its parameters as p[...], from the index `first` on."""
    names = [p.name for p in law.parameters]
    variable = {"d": "d", "v": "v", "N": "normal", "z": "(way * z)"}[law.shape.of]
    parts = []
    for k, (word, _) in enumerate(law.shape.words, 1):
        at = {n: f"p[{first + names.index(f'a_{k}_{n}')}]" for n in WORDS[word].further}
        own, text = f"p[{first + names.index(f'a_{k}')}]", WORDS[word].python.format(x=variable, **at)
        parts.append(own if text == "1.0" else f"{own} * {text}")
    return " + ".join(parts)


def _parameter(p: Parameter, value: float) -> str:
    further = ", log=True" if p.log else ""
    further += ", shape=True" if p.shape else ""
    unit = re.sub(r"[^A-Za-z0-9]+", "_", p.unit.replace(" ", "").replace("^", "").replace("1/", "per_")).strip("_")
    name = p.name if p.unit == "1" or p.name.endswith(f"_{unit}") or p.name == "rate_1_s" else f"{p.name}_{unit}"
    numbers = ", ".join(f"{x:.6g}" for x in (p.null, p.scale, p.lower, p.upper))
    return f'        Parameter("{name}", "{p.unit}", {numbers}, ({value:.6g},){further}),'
