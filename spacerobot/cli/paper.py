"""`spacerobot paper`: the paper's table and figures, from theory and simulated trials."""

from __future__ import annotations

import argparse
import csv
import io
import json
from typing import Any

from spacerobot.support.errors import InputError
from spacerobot.support.jsonio import dumps
from spacerobot.support.numbers import parse_numbers
from spacerobot.support.runs import RunFolder, combined_hash

_EPILOG = """\
examples:
  spacerobot paper --out paper-out
  spacerobot paper --out paper-out --seed 7 --equivalent-damping 9.7 --overwrite

Writes paper.html (one file, opens offline), paper.json, table1.csv and a PNG of each figure. Takes some ten seconds."""


LARGEST_DAMPING = 15.0
"""N s/m. Beyond it, the friction that it stands for keeps the lightest target at half the mean speed."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.epilog = _EPILOG
    parser.add_argument("--out", metavar="DIR", required=True, help="folder for page, figures and data")
    parser.add_argument("--json", action="store_true", help="print one JSON object, that of paper.json")
    parser.add_argument("--seed", metavar="N", default="0", help="of the simulated trials; default: 0")
    parser.add_argument(
        "--equivalent-damping",
        metavar="C",
        help="c_eq of the guide, N s/m; default: the one that the paper's 0.97 and 0.74 imply",
    )
    parser.add_argument("--overwrite", action="store_true", help="replace a run that is in DIR")
    parser.add_argument("-v", "--verbose", action="store_true", help="show progress although nobody watches")


def run(args: argparse.Namespace) -> int:
    """Run the command."""
    from spacerobot.theory.table1 import EQUIVALENT_DAMPING

    seed = _seed(args.seed)
    damping = EQUIVALENT_DAMPING
    if args.equivalent_damping is not None:
        damping = parse_numbers([args.equivalent_damping], "--equivalent-damping", count=1)[0]
    if not 0 < damping <= LARGEST_DAMPING:
        raise InputError(
            "the equivalent damping is out of range",
            given=damping,
            valid=f"above 0, up to {LARGEST_DAMPING:g} N s/m",
            where="--equivalent-damping",
        )
    with RunFolder(args.out, "paper", combined_hash("paper", seed, damping), overwrite=args.overwrite) as folder:
        if not folder.finished:
            _write(folder, seed, damping, args.verbose)
        text = (folder.folder / "paper.json").read_text(encoding="utf-8")
        print(text.rstrip("\n") if args.json else _summary(json.loads(text), str(folder.folder)))
    return 0


def _write(folder: RunFolder, seed: int, damping: float, verbose: bool) -> None:
    from spacerobot.view.paper.data import TABLE1_HEADER, as_json, compute, table1_rows
    from spacerobot.view.paper.figures import FIGURES
    from spacerobot.view.paper.page import page
    from spacerobot.view.plotting import png

    data = compute(seed, damping, verbose=verbose)
    figures = {name: draw(data) for name, draw in FIGURES.items()}
    table = io.StringIO()
    csv.writer(table, lineterminator="\n").writerows([TABLE1_HEADER, *table1_rows()])
    folder.write("table1.csv", table.getvalue())
    for name, figure in figures.items():
        folder.write(f"{name}.png", png(figure))
    folder.write("paper.html", page(data, figures))
    folder.write("paper.json", dumps(as_json(data)) + "\n")
    folder.finish()


def _seed(token: str) -> int:
    try:
        seed = int(token)
    except ValueError:
        seed = -1
    if not 0 <= seed < 2**63:
        raise InputError("not a seed", given=token, valid="a whole number from 0 up", where="--seed")
    return seed


def _summary(answer: dict[str, Any], folder: str) -> str:
    eq5, eq14 = answer["equation_5"], answer["equation_14"]
    lines = [
        f"{'k_w [N/m]':>10} {'m_t [kg]':>9} {'e simulated':>15} {'Eq. 18':>7} {'time [s]':>9} {'Eq. 16':>7}",
        *(
            f"{c['stiffness']:>10g} {c['target_mass']:>9g} {c['restitution']:>7.3f} ± {c['restitution_sd']:.3f} "
            f"{c['theory_restitution']:>7.3f} {c['contact_time']:>9.4f} {c['theory_contact_time']:>7.4f}"
            for c in answer["conditions"]
        ),
        "",
        f"Eq. 5 as printed gives {eq5['printed_low_branch_rad_s']:.1f} rad/s where the eigenfrequency of Eqs. 2 to 4 "
        f"is {eq5['exact_low_branch_rad_s']:.2f} and Eqs. 9 and 10 give {eq5['equations_9_and_10_rad_s']:.2f}.",
        f"Before the end of Eq. 14 the force pulls: {100 * eq14['adhesive_share_of_time']:.1f} % of the contact time, "
        f"up to {eq14['adhesive_peak_N']:.2f} N, at {eq14['stiffness_N_m']:g} N/m and {eq14['target_mass_kg']:g} kg.",
        f"page: {folder}/paper.html",
    ]
    return "\n".join(lines)
