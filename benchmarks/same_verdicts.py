"""Whether a change of the code changes a verdict: every field of verdict.json but the seconds, before and after.

    python -m benchmarks.same_verdicts --out before                     at the commit before
    python -m benchmarks.same_verdicts --out after --against before     at the one after

Studies: those of the shared recordings (SPACEROBOT_DATA), of examples/studies, and sealed campaigns that are made again
from their published records. Each verdict is kept at once: a run that was stopped goes on. Exit code 1 where any differs.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from spacerobot.proof.campaign import write_study
from spacerobot.proof.conceal import conceal
from spacerobot.proof.orders import KINDS
from spacerobot.proof.published import read_batch
from spacerobot.recordings.dataroot import recordings_folder
from spacerobot.support.files import write_text
from spacerobot.support.progress import Progress
from spacerobot.support.scratch import scratch
from spacerobot.view.proof.prove import orders_of

RECORDS = Path("docs/proof_records.jsonl")
MAY_DIFFER = ("seconds", "spacerobot")
ABSENT = "(absent)"


def studies(sealed: int) -> Iterator[tuple[str, Path | Any]]:
    """(name, folder of a study, or the order of a sealed campaign)."""
    roots = [r for r in (recordings_folder(), Path("examples/studies/real")) if r is not None]
    for root in roots:
        yield from ((f"{root.name}-{p.parent.name}", p.parent) for p in sorted(root.glob("*/study.toml")))
    meta, records = read_batch(RECORDS)
    wrist = [r for r in records if r["family"] != "driven arm" and "failed" not in r]
    orders = {o.name: o for o in orders_of(False, meta, list(KINDS), 1.0)}
    spread = wrist[:: max(1, len(wrist) // max(sealed, 1))][:sealed]
    yield from ((f"sealed-{r['name']}", orders[r["name"]]) for r in spread)


def verdict_of(study: Path | Any) -> dict[str, Any]:
    """What a process of its own says of a study; its error where it says none."""
    with scratch("same") as folder:
        if not isinstance(study, Path):
            made = conceal(study)
            study = folder / "study"
            write_study(study, made.campaign, made.readings)
        command = [sys.executable, "-m", "spacerobot", "diagnose", str(study.resolve()), "--json", "--jobs", "1"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    return json.loads(done.stdout) if done.returncode == 0 else {"exit": done.returncode, "error": done.stderr[-400:]}


def differences(before: Any, after: Any, where: str = "") -> list[str]:
    """What differs between two verdicts, field by field; nothing where only MAY_DIFFER does."""
    if isinstance(before, dict) and isinstance(after, dict):
        keys = [k for k in dict.fromkeys([*before, *after]) if where or k not in MAY_DIFFER]
        return [d for k in keys for d in differences(before.get(k, ABSENT), after.get(k, ABSENT), f"{where}.{k}")]
    if isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        pairs = enumerate(zip(before, after, strict=True))
        return [d for i, (a, b) in pairs for d in differences(a, b, f"{where}[{i}]")]
    return [] if before == after else [f"{where[1:]}: {before!r} -> {after!r}"]


def main() -> int:
    """Take the verdicts, and compare them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="folder for the verdicts")
    parser.add_argument("--against", type=Path, help="folder of an earlier run to compare with")
    parser.add_argument("--sealed", type=int, default=60, help="sealed campaigns; default: 60")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", default="", help="names that contain this")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    chosen = [(n, s) for n, s in studies(args.sealed) if args.only in n]
    missing = [(n, s) for n, s in chosen if not (args.out / f"{n}.json").exists()]
    with ThreadPoolExecutor(args.jobs) as pool, Progress("diagnosing", len(missing), unit="verdict") as bar:
        for (name, _), found in zip(missing, pool.map(verdict_of, [s for _, s in missing]), strict=True):
            write_text(args.out / f"{name}.json", json.dumps(found, indent=1))
            bar.advance(1)
    if args.against is None:
        return 0
    other = 0
    for name, _ in chosen:
        before, after = (json.loads((d / f"{name}.json").read_text("utf-8")) for d in (args.against, args.out))
        changed = differences(before, after)
        other += bool(changed)
        print(f"{name}: {'same' if not changed else f'{len(changed)} fields differ'}")
        print("".join(f"  {line}\n" for line in changed[:5]), end="")
    print(f"{len(chosen) - other} of {len(chosen)} the same")
    return 1 if other else 0


if __name__ == "__main__":
    sys.exit(main())
