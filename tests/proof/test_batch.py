"""Batches: what is in them, resuming, the command."""

from __future__ import annotations

import json
import pickle
import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from spacerobot.cli.main import main
from spacerobot.effects.registry import all_effects
from spacerobot.proof import batch
from spacerobot.proof.engine.outsiders import OUTSIDERS
from spacerobot.proof.orders import CURVES, FULL, KINDS, MOVING, QUICK, Order, schedule
from spacerobot.proof.sizes import DRAWS
from spacerobot.support.executors.base import Here
from spacerobot.support.runs import RunFolder
from spacerobot.view.proof.page import page
from spacerobot.view.proof.prove import orders_of

PLAYED: list[str] = []


def fake_play(order: Order, folder: Path, *, rivals: bool = False, command: Sequence[str] = ()) -> dict[str, Any]:
    """A record as `play` makes it, without playing."""
    PLAYED.append(order.name)
    nothing = order.kind == "nothing_missing"
    outside = order.kind in ("outsider", "withheld")
    hidden = [] if nothing else [list(order.effect or ("coulomb_friction", "wrist"))]
    expected = "nothing_missing" if nothing else "unknown" if outside else "named"
    said = expected
    opinion = {
        "held_out": {"target.x": 2e-4, "wrist.x": 1e-4},
        "says": "no value moved",
        "flagged": False,
        "seconds": 1.0,
    }
    return {
        "name": order.name,
        "kind": order.kind,
        "family": order.family,
        "expected": expected,
        "hidden": hidden,
        "strength": None if nothing else order.limits or 6.0,
        "top": True,
        "in_set": True,
        "abstained": outside,
        "confidently_wrong": False,
        "said": said,
        "favourite": hidden if expected == "named" else [],
        "confidence": 0.9,
        "parameters": [],
        "same": False,
        "equal": False,
        "seconds": 2.0,
        "seed": order.seed,
        "channels": {"target.x": 2e-4, "wrist.x": 1e-4},
        **({"rivals": {"baseline refit": opinion, "PySINDy": {"failed": "no", "seconds": 0.1}}} if rivals else {}),
    }


@pytest.fixture(autouse=True)
def _played(monkeypatch: pytest.MonkeyPatch) -> None:
    PLAYED.clear()
    monkeypatch.setattr(batch, "play", fake_play)
    monkeypatch.setattr(batch, "play_arm", fake_play)


def test_the_full_batch_is_what_was_asked_for() -> None:
    orders = schedule(FULL, 5)
    names = [o.name for o in orders]
    assert len(set(names)) == len(names)
    sealed = [o for o in orders if o.kind != "power"]
    counts = Counter(o.kind for o in sealed)
    assert set(counts) | {"power"} == set(KINDS)
    assert len(sealed) >= 300
    assert sum(o.family in MOVING for o in sealed) >= len(sealed) / 3
    filled = Counter(batch.rate_of(o) for o in sealed)
    assert set(filled) == {"nothing", "value", "outside", "named", "spoiled", "learned"}
    assert filled.pop("learned") == 120
    assert filled.pop("spoiled") == 160  # 15 ways on four rigs, with and without friction, and 40 relatives
    assert min(filled.values()) >= 200
    assert len(OUTSIDERS) >= 4
    rig_effects = {name for name, _ in DRAWS} - set(OUTSIDERS)
    assert rig_effects <= set(all_effects())
    assert {o.effect[0] for o in orders if o.kind == "withheld" and o.effect} == rig_effects
    power = [o for o in orders if o.kind == "power"]
    strengths: dict[tuple[str, str], set[float]] = {}
    for o in power:
        assert o.effect is not None
        assert o.limits is not None
        strengths.setdefault(o.effect, set()).add(o.limits)
    assert {e for e, _ in strengths} == rig_effects
    assert len(CURVES) == 8
    assert all(len(s) == (8 if e in CURVES else 3) for e, s in strengths.items())


def test_seeds_differ_and_depend_on_the_batch_alone() -> None:
    first, again, other = schedule(FULL, 5), schedule(FULL, 5), schedule(FULL, 6)
    assert first == again
    assert len({o.seed for o in first}) == len(first)
    assert not {o.seed for o in first} & {o.seed for o in other}
    small = {o.name: o.seed for o in schedule(QUICK, 5)}
    assert all(seed == {o.name: o.seed for o in first}[name] for name, seed in small.items())


def test_rates_fill_alike_then_the_power_curves() -> None:
    orders = schedule(FULL, 4)
    turns = batch.in_turn(orders)
    assert sorted(o.name for o in turns) == sorted(o.name for o in orders)
    first = Counter(batch.rate_of(o) for o in turns[: 100 * len(batch.FIRST)])
    assert set(first.values()) == {100}
    every = Counter(batch.rate_of(o) for o in orders)
    begin = next(i for i, o in enumerate(turns) if o.kind == "power")
    before = Counter(batch.rate_of(o) for o in turns[:begin])
    assert before == {rate: min(count, every[rate]) for rate, count in batch.FIRST.items()}
    assert all(o.kind == "power" for o in turns[begin : begin + every["power"]])
    for rate in set(batch.RATE.values()):
        seeds = [o.seed for o in turns if batch.RATE.get(o.kind) == rate]
        assert seeds == sorted(seeds)


def test_a_batch_goes_on_where_it_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    orders = schedule(QUICK, 1)
    turns = batch.in_turn(orders)

    def stopping(order: Order, folder: Path, **options: Any) -> dict[str, Any]:
        if order == turns[2]:
            raise KeyboardInterrupt
        return fake_play(order, folder, **options)

    monkeypatch.setattr(batch, "play", stopping)
    with RunFolder(tmp_path / "out", "prove", "hash") as folder, pytest.raises(KeyboardInterrupt):
        batch.run_batch(folder, orders)
    assert [o.name for o in turns[:2]] == PLAYED
    monkeypatch.setattr(batch, "play", fake_play)
    with RunFolder(tmp_path / "out", "prove", "hash") as folder:
        records = batch.run_batch(folder, orders)
    assert [o.name for o in turns] == PLAYED
    assert [r["name"] for r in records] == [o.name for o in orders]


def test_a_batch_that_runs_out_of_time_writes_what_it_has_and_goes_on(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = [0.0]

    def ticking(order: Order, folder: Path, **options: Any) -> dict[str, Any]:
        clock[0] += 50.0
        return fake_play(order, folder, **options)

    monkeypatch.setattr(batch, "play", ticking)
    monkeypatch.setattr(batch, "play_arm", ticking)
    monkeypatch.setattr(batch.time, "monotonic", lambda: clock[0])
    out, docs = tmp_path / "out", tmp_path / "docs"
    asked = ["prove", "--share", "0.01", "--seed", "3", "--out", str(out), "--docs", str(docs), "--minutes", "5"]
    whole = len(orders_of(False, {"seed": 3}, list(KINDS), 0.01))
    assert main(asked) == 0
    assert f"6 of {whole} campaigns" in capsys.readouterr().err
    assert f"6 of {whole} campaigns" in (docs / "proof.md").read_text()
    assert len(PLAYED) == 6
    assert main([*asked[:-2], "--json"]) == 0
    assert len(PLAYED) == len(set(PLAYED)) == whole
    assert json.loads(capsys.readouterr().out)["played"] == whole
    assert "part of the batch" not in (docs / "proof.md").read_text()


@pytest.mark.slow
def test_the_command_writes_page_and_figures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, docs = tmp_path / "out", tmp_path / "docs"
    arguments = ["prove", "--out", str(out), "--share", "0.2", "--seed", "11", "--json", "--docs", str(docs)]
    assert main(arguments) == 0
    printed = capsys.readouterr()
    answer = json.loads(printed.out)
    assert answer["seed"] == 11
    assert "seed 11" in printed.err
    assert answer["targets"]["confidently_wrong"]["met"] is True
    assert answer["targets"]["nothing_missing"]["met"] is None  # all right, but too few to show 95 %
    text = (docs / "proof.md").read_text()
    assert "seed 11" in text
    for name in ("power", "reliability", "confusion"):
        assert f"figures/proof_{name}.png" in text
        assert (docs / "figures" / f"proof_{name}.png").stat().st_size > 1000
    assert "mujoco.sysid" in text
    published = docs / "proof_records.jsonl"
    assert published.read_text() == (out / "records.jsonl").read_text()
    count = len(PLAYED)
    assert main(arguments) == 0  # finished: reused
    assert len(PLAYED) == count
    kept = published.read_text().splitlines(keepends=True)
    published.write_text("".join(kept[:-3]))  # as published when it was not done yet
    elsewhere = ["prove", "--out", str(tmp_path / "elsewhere"), "--share", "0.2", "--resume", str(published)]
    assert main(elsewhere) == 0
    assert len(PLAYED) == count + 3
    assert (tmp_path / "elsewhere" / "records.jsonl").read_text() == "".join(kept)


@pytest.mark.slow
def test_a_second_batch_is_published_beside_the_first(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    docs, asked = tmp_path / "docs", ["prove", "--share", "0.05", "--seed", "5", "--docs", str(tmp_path / "docs")]
    assert main([*asked, "--out", str(tmp_path / "a")]) == 0
    first = {p: p.read_bytes() for p in docs.rglob("*") if p.is_file()}
    assert main([*asked, "--out", str(tmp_path / "b"), "--page", "proof_later"]) == 0
    assert {p: p.read_bytes() for p in first} == first
    text = (docs / "proof_later.md").read_text()
    named = set(re.findall(r"figures/\w+\.png", text))
    assert named
    assert all((docs / n).exists() and n.startswith("figures/proof_later_") for n in named)
    assert "`proof_later_records.jsonl`" in text
    assert (docs / "proof_later_records.jsonl").exists()
    capsys.readouterr()
    assert main([*asked, "--out", str(tmp_path / "c"), "--page", "../x"]) != 0
    assert "--page" in capsys.readouterr().err


def test_the_page_lists_what_went_wrong_and_nothing_else(tmp_path: Path) -> None:
    about = {"seeds": "1, d", "version": "v", "code": "c", "command": "x"}
    fields = {"withheld": None, "wrong_values": [], "moved": []}
    whole = {**fields, "held_out_ratio": 1.0, "strength": 5.0, "hidden": [["preload", "wrist"]]}
    orders = {o.kind: o for o in schedule(FULL, 1)}

    def record(kind: str, **changes: Any) -> dict[str, Any]:
        return {**fake_play(orders[kind], tmp_path), **whole, **changes}

    costs = {"favoured": {"cost": 130.0}, "oracle": {"cost": 100.0}}
    wrong = record("masked", top=False, confidently_wrong=True, favourite=[["backlash", "wrist"]], **costs)
    missed = record("two", top=False, said="unknown", favourite=[], moved=["wrist.mass"])
    faint = record("weak 1.05", top=False, said="nothing_missing", strength=2.0)
    alike = record("withheld", top=False, confidently_wrong=True, same=True)
    right = record("unlabelled")
    text = page([right, faint, missed, wrong, alike], about, {})
    table = text.split("## What went wrong")[1].split("##")[0]
    rows = [line for line in table.splitlines() if line.startswith("|")][2:]
    assert [r.split("|")[1].strip() for r in rows] == [wrong["name"], missed["name"]]
    assert "**named**" in rows[0]
    assert "backlash at wrist" in rows[0]
    assert "+30" in rows[0]
    assert "wrist.mass" in rows[1]
    assert "**" not in rows[1]
    assert "## What went wrong" not in page([right, faint], about, {})


def test_seeds_are_drawn_and_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    seeds = set()
    for name in ("a", "b", "b"):
        assert main(["prove", "--quick", "--out", str(tmp_path / name), "--json"]) == 0
        seeds.add(json.loads(capsys.readouterr().out)["seed"])
    assert len(seeds) == 2


def test_records_do_not_depend_on_where_a_batch_is_played(tmp_path: Path) -> None:
    orders = schedule(QUICK, 5)[:3]
    found = []
    for name, workers in (("here", None), ("backwards", Backwards())):
        with RunFolder(tmp_path / name, "prove", "key") as folder:
            found.append(batch.run_batch(folder, orders, workers=workers))
    assert found[0] == found[1]
    assert [r["name"] for r in found[0]] == [o.name for o in orders]


class Backwards(Here):
    """Workers that finish in another order than they began."""

    def run(self, function: Any, tasks: Any) -> Any:
        for task in reversed(list(tasks)):
            assert pickle.loads(pickle.dumps(task)) == task
            yield task, function(task)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--kinds", "unlabeled"], "unlabelled"),
        (["--quick", "--kinds", "power"], "no campaign"),
        (["--share", "0"], "--share"),
        (["--seed", "-3"], "--seed"),
        (["--minutes", "0"], "--minutes"),
        (["--jobs", "none"], "--jobs"),
        (["--jobs", "2", "--dask", "tcp://127.0.0.1:1"], "--dask or --jobs"),
    ],
)
def test_mistakes_are_told_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], said: str
) -> None:
    assert main(["prove", "--out", str(tmp_path / "x"), *arguments]) == 2
    error = capsys.readouterr().err.strip().splitlines()
    assert said in error[-1]
    assert "Traceback" not in "".join(error)
