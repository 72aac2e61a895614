"""Stated detection limits against what happens: effects at 0.5, 1 and 2 of their limits, and how often they are named.

    python -m benchmarks.limits --out limits --campaigns 40 --page docs/limits.md

A campaign: four trials of the wrist rig with the effect in it and fresh noise, from our own simulator (the statement is
about the decision, not about the physics), diagnosed with the whole catalogue. The limits are those that the diagnosis
of the same rig with nothing missing states. Every campaign is kept at once: a run that was stopped goes on.
"""

from __future__ import annotations

import argparse
import json
import math
import multiprocessing
import time
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from pathlib import Path
from typing import Any

import numpy as np

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import Study, load_study
from spacerobot.recordings.synthetic import CAMERA, FORCE_NOISE, POSITION_NOISE, SAMPLER, study_head
from spacerobot.simulation.reduced.run import simulate
from spacerobot.simulation.rig import rig
from spacerobot.simulation.sensors import read_channels
from spacerobot.support.files import write_text
from spacerobot.support.jsonio import dumps
from spacerobot.support.progress import Progress
from spacerobot.support.scratch import scratch

EFFECTS = (
    ("coulomb_friction", "wrist"),
    ("coulomb_friction", "target"),
    ("viscous_drag", "target"),
    ("backlash", "wrist"),
    ("time_offset", "force_sensor"),
)
"""Set-valued and smooth, in the mechanism and in a sensor; of one parameter each, so that a size says all."""

FACTORS = (0.5, 1.0, 2.0)
MASSES, SPEEDS = (9.0, 23.2), (0.06, 0.11)
SIGMA = {"target.x": POSITION_NOISE, "wrist.x": POSITION_NOISE, "contact.force": FORCE_NOISE}
RATES = {"mocap": (("target.x", "wrist.x"), CAMERA), "force": (("contact.force",), SAMPLER)}
COLUMNS = {"target.x": "x_target_m", "wrist.x": "x_wrist_m", "contact.force": "f_contact_N"}
RIG = {
    "wrist.mass": 0.7,
    "wrist.stiffness": 1020.0,
    "wrist.damping": 2.1,
    "wrist.equivalent_damping": 5.0,
    "contact.stiffness": 68000.0,
    "contact.damping": 60.0,
}

Label = tuple[str, str]


def write_campaign(folder: Path, planted: tuple[Label, float] | None, seed: int) -> Study:
    """A study of the rig with an effect of this size in it, or with none, and noise of its own."""
    believed = {n: v for n, v in RIG.items() if n != "contact.damping"}
    random, text = np.random.default_rng(seed), study_head(believed, "limits")
    for number, (mass, speed) in enumerate((m, s) for m in MASSES for s in SPEEDS):
        mechanism = rig({**RIG, "target.mass": mass})
        if planted is not None:
            (name, where), size = planted
            (parameter,) = effect(name).parameters
            mechanism = effect(name).apply(mechanism, where, {parameter.name: size})
        end = 0.02 / speed + 1.4
        run = simulate(mechanism, position={"target": -0.02}, velocity={"target": speed}, end=end)
        text += f'[[trials]]\nid = "{number}"\ntarget.mass = {mass}\n'
        for stream, (channels, rate) in RATES.items():
            at = np.arange(0.0, end, 1.0 / rate)
            seen = read_channels(run, mechanism, channels, at)
            columns = [at, *(seen[c] + SIGMA[c] * random.standard_normal(at.size) for c in channels)]
            header = ",".join(["time_s", *(COLUMNS[c] for c in channels)])
            np.savetxt(
                folder / f"{number}_{stream}.csv", np.transpose(columns), "%.7f", ",", header=header, comments=""
            )
            text += f'{stream} = "{number}_{stream}.csv"\n'
    write_text(folder / "study.toml", text)
    return load_study(folder)


def stated(seed: int) -> dict[Label, float]:
    """The limits that a diagnosis of the rig with nothing missing states."""
    with scratch("limits") as folder:
        verdict = diagnose(write_campaign(folder, None, seed), jobs=1).verdict
    found = {(d["effect"], d["where"]): d["smallest"] for d in verdict["detectable"]}
    return {label: float(found[label]) for label in EFFECTS}


def play(label: Label, size: float, seed: int) -> dict[str, Any]:
    """One campaign: what was said, and whether it is the truth."""
    began = time.perf_counter()
    with scratch("limits") as folder:
        verdict = diagnose(write_campaign(folder, (label, size), seed), jobs=1).verdict
    named = [(e["effect"], e["where"]) for e in verdict["effects"]]
    (parameter,) = effect(label[0]).parameters
    own = [e["parameters"][parameter.name] for e in verdict["effects"] if (e["effect"], e["where"]) == label]
    return {
        "said": verdict["verdict"],
        "confidence": verdict["confidence"],
        "effects": named,
        "named": verdict["verdict"] == "named" and named == [label],
        "size": size,
        "interval": own[0].get("ci95") if own and verdict["verdict"] == "named" else None,
        "seconds": time.perf_counter() - began,
    }


def run(
    out: Path, campaigns: int, seed: int, minutes: float, jobs: int
) -> tuple[dict[Label, float], list[dict[str, Any]]]:
    """Play what is not kept in `out` yet; a smaller number of campaigns is part of a larger one."""
    out.mkdir(parents=True, exist_ok=True)
    path = out / f"limits-{seed}.jsonl"
    rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []
    if not rows:
        rows = [{"stated": [[*label, size] for label, size in stated(seed).items()]}]
        write_text(path, dumps(rows[0], indent=None) + "\n")
    sizes = {(e, w): s for e, w, s in rows[0]["stated"]}
    done = {tuple(r["key"]) for r in rows[1:]}
    orders = [o for o in _orders(campaigns) if o not in done]
    until = time.monotonic() + 60.0 * minutes
    with Progress("limits", len(orders), unit="campaign") as progress, _pool(jobs) as pool:
        waiting: set[Future[dict[str, Any]]] = set()
        while orders or waiting:
            while orders and len(waiting) < jobs and time.monotonic() < until:
                waiting.add(pool.submit(_row, orders[0], sizes, seed))
                del orders[0]
            if not waiting:
                break
            finished, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            for row in (f.result() for f in finished):
                rows.append(row)
                with path.open("a", encoding="utf-8") as file:
                    file.write(dumps(row, indent=None) + "\n")
                name, _, factor, _ = row["key"]
                progress.advance(note=f"{name} at {factor:g}: {row['said']}")
    return sizes, rows[1:]


def _pool(jobs: int) -> ProcessPoolExecutor:
    return ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("spawn"))


def _row(order: tuple[str, str, float, int], sizes: dict[Label, float], seed: int) -> dict[str, Any]:
    name, where, factor, number = order
    words = [seed, EFFECTS.index((name, where)), round(10 * factor), number]
    one = int(np.random.SeedSequence(words).generate_state(1)[0])
    return {"key": list(order), **play((name, where), factor * sizes[name, where], one)}


def _orders(campaigns: int) -> Iterator[tuple[str, str, float, int]]:
    for number in range(campaigns):
        for factor in sorted(FACTORS, key=lambda f: abs(math.log(f))):  # at the limit first
            for name, where in EFFECTS:
                yield name, where, factor, number


def page(sizes: dict[Label, float], rows: list[dict[str, Any]]) -> str:
    """The table, in Markdown."""
    lines = [
        "# Detection limits, stated and met",
        "",
        "The verdict of a study in which nothing is missing states the smallest size of every effect that it would have",
        "named (`detectable`). Here effects are put into the same rig at 0.5, 1 and 2 of these limits, with fresh noise,",
        "and diagnosed with the whole catalogue: in how many campaigns the effect, and nothing else, was `named`. Made by",
        "`make limits`.",
        "",
        "| effect | where | stated limit | at 0.5 | at 1 | at 2 |",
        "|---|---|---|---|---|---|",
    ]
    for label, size in sizes.items():
        (parameter,) = effect(label[0]).parameters
        shares = [_share([r for r in rows if r["key"][:3] == [*label, f]]) for f in FACTORS]
        lines.append(f"| {label[0]} | {label[1]} | {size:.3g} {parameter.unit} | {' | '.join(shares)} |")
    together = [_share([r for r in rows if r["key"][2] == f]) for f in FACTORS]
    stated = [r for r in rows if r["interval"]]
    held = sum(r["interval"][0] <= r["size"] <= r["interval"][1] for r in stated)
    lines += [f"| all | | | {' | '.join(together)} |", ""]
    lines.append(
        f"Of the {len(stated)} intervals (95 %) that were stated of named sizes, {held} hold the size that was put in."
    )
    return "\n".join(lines) + "\n"


def _share(rows: list[dict[str, Any]]) -> str:
    return f"{sum(r['named'] for r in rows)} of {len(rows)}" if rows else "-"


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="folder of the records")
    parser.add_argument("--campaigns", type=int, default=40, help="of each effect and size; default: 40")
    parser.add_argument("--seed", type=int, default=1, help="of the noise; default: 1")
    parser.add_argument("--jobs", type=int, default=2, help="processes; default: 2")
    parser.add_argument("--minutes", type=float, default=math.inf, help="begin no campaign after so long")
    parser.add_argument("--page", type=Path, help="write the table there too")
    args = parser.parse_args()
    text = page(*run(args.out, args.campaigns, args.seed, args.minutes, args.jobs))
    if args.page is not None:
        write_text(args.page, text)
    print(text)


if __name__ == "__main__":
    main()
