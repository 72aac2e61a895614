"""What benchmarks/where.py measured, in words."""

from __future__ import annotations

from typing import Any

CYCLE = 1.0 / 3e9
"""Of a core [s]; nominal."""

STREAM = 1e10
"""What one core moves to and from memory [B/s]; nominal."""


def page(found: dict[str, Any]) -> str:
    """Markdown."""
    lines = [
        f"**A multibody trial** (tolerance {found['tolerance']:g}): calls counted, times what one call costs.",
        "",
        "| scene | ms | assembly | right-hand sides | guards | rest | right-hand sides, steps, events | as many `pin.aba`, ms |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in found["multibody"]:
        s = row["seconds"]
        spent = {"assembly": s["assembly"], "rates": row["rates"] * s["rate"], "guards": row["guards"] * s["guard"]}
        shares = [*spent.values(), s["trial"] - sum(spent.values())]
        lines.append(
            f"| {row['scene']} | {1e3 * s['trial']:.1f} | "
            + " | ".join(f"{100 * x / s['trial']:.0f} %" for x in shares)
            + f" | {row['rates']:,}, {row['steps']}, {row['events']} | {1e3 * row['rates'] * s['pin.aba']:.1f} |"
        )
    lines += [
        "",
        "A step of order 8 takes 12 right-hand sides, 15 with its interpolant; those of refused steps, and of the steps repeated",
        "to place an event, are counted too. The rest is the loop in Python around compiled pieces: stages, interpolants, the",
        "record. The limit of this way is the last column: forward dynamics alone, called as often.",
        "",
        *_reduced(found["reduced"]),
        "",
        *_pose(found["pose"]),
        "",
        *_hypothesis(found["hypothesis"]),
    ]
    return "\n".join(lines)


def _reduced(row: dict[str, Any]) -> list[str]:
    s = row["seconds"]
    loop = s["trial"] - s["in and out"]
    return [
        f"**A reduced trial** (held arm): {1e3 * s['trial']:.2f} ms, of which {1e3 * s['in and out']:.2f} ms lead from Python into the "
        f"compiled loop and out again, and {1e3 * loop:.2f} ms are {row['steps']} steps and {row['events']} events: "
        f"{1e6 * loop / row['steps']:.1f} us a step. Making the arrays of a mechanism, {1e3 * s['prepare']:.2f} ms, comes once for each set of "
        f"values. The limit is to compute events and nothing between them, which the exact way does in {1e3 * s['exact']:.3f} ms.",
    ]


def _pose(row: dict[str, Any]) -> list[str]:
    work, memory = row["operations"] * CYCLE, row["bytes"] / STREAM
    return [
        f"**An effective-mass pose** ({row['joints']} joints): {1e6 * row['seconds']:.2f} us. Its source has some "
        f"{row['operations']:,} additions and multiplications: {1e6 * work:.2f} us at one a cycle of 3 GHz. The {row['bytes']} bytes that it reads "
        f"and writes take {1e6 * memory:.3f} us, so it is bound by arithmetic, {row['seconds'] / work:.1f} times that of one operation a cycle: "
        "short loops over small matrices, each waiting for the one before, sines and cosines, square roots. Vectors over poses could go "
        f"below, as far as memory: {row['seconds'] / memory:.0f} times faster.",
    ]


def _hypothesis(row: dict[str, Any]) -> list[str]:
    each = row["seconds"] * row["share"] / row["simulations"]
    return [
        f"**A hypothesis** (Coulomb friction, {row['trials']} trials, {row['free']} free values and the trials' own, {row['samples']:,} samples, "
        f"cold start): {row['seconds']:.2f} s in {row['iterations']} iterations. {row['simulations']:,} trials are simulated and read, "
        f"{1e3 * each:.2f} ms each, {100 * row['share']:.0f} % of the time; the rest is mechanisms, residuals, derivatives and normal "
        "equations. The limit of differences is a simulation of every trial for each of its values in a set of derivatives, and one for "
        "every step. Fewer sets are the way below it: they are kept and corrected over some steps, and most hypotheses are screened, not "
        "fitted.",
    ]
