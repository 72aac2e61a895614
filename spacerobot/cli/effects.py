"""`spacerobot effects`: the catalogue of physics that a model may lack."""

from __future__ import annotations

import argparse
from typing import Any

_EPILOG = """\
examples:
  spacerobot effects                        every effect in a line: name, places, parameters
  spacerobot effects coulomb_friction       one of them: formula, units, bounds, source
  spacerobot effects --json
  spacerobot effects --effects my_effect.py
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.epilog = _EPILOG
    parser.add_argument("effect", nargs="?", metavar="EFFECT", help="one effect; all if absent")
    parser.add_argument(
        "--effects", action="append", default=[], metavar="FILE.py", help="run FILE.py, which adds effects"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(args: argparse.Namespace) -> int:
    """List the catalogue, or show one effect."""
    from spacerobot.cli.effect_files import run_effect_files
    from spacerobot.effects.registry import all_effects, effect
    from spacerobot.support.jsonio import dumps
    from spacerobot.view.docs.effects import entry

    run_effect_files(args.effects)
    chosen = [*all_effects().values()] if args.effect is None else [effect(args.effect)]
    found = [entry(one) for one in chosen]
    if args.json:
        print(dumps({"effects": found} if args.effect is None else {"effect": found[0]}))
    else:
        print(_table(found) if args.effect is None else _card(found[0]))
    return 0


def _table(found: list[dict[str, Any]]) -> str:
    lines = [f"{'effect':22} {'parameters':44} where"]
    for kind in dict.fromkeys(e["kind"] for e in found):
        lines.append(f"\n{kind}:")
        for e in (e for e in found if e["kind"] == kind):
            names = ", ".join(e["parameters"])
            lines.append(f"  {e['effect']:20} {names:44} {', '.join(e['where']) or 'where a study has the port'}")
    return "\n".join(lines)


def _card(e: dict[str, Any]) -> str:
    lines = [
        f"{e['effect']}: {e['title']}",
        f"  where    {', '.join(e['where']) or 'where a study has the port'}",
        f"  formula  {e['formula']}",
        f"  source   {e['source']}",
        f"  proved   {', '.join(e['proved']) or 'not yet'}",
        f"  {'parameter':28} {'unit':14} {'nothing at':>12} {'from':>12} {'to':>12}",
    ]
    for name, p in e["parameters"].items():
        numbers = "".join(f" {p[key]:>12.6g}" for key in ("null", "lower", "upper"))
        lines.append(f"  {name:28} {p['unit']:14}{numbers}")
    if e["forms"]:
        lines.append(f"  forms    {', '.join(e['forms'])} (in a scene: order and kind)")
    return "\n".join(lines)
