"""The proof's pages again from their records, without a campaign played: `make proof-pages`."""

from __future__ import annotations

from pathlib import Path

from spacerobot import __version__
from spacerobot.proof.orders import KINDS
from spacerobot.proof.published import read_batch
from spacerobot.view.proof.prove import in_words, orders_of, publish, seeds_in_words

DOCS = Path(__file__).resolve().parent


def main() -> None:
    """Write the page of every file of records beside this one."""
    for path in sorted(DOCS.glob("*_records.jsonl")):
        batch, records = read_batch(path)
        about = {
            "seeds": seeds_in_words(batch),
            "version": __version__,
            "code": in_words(batch["codes"]),
            "command": "spacerobot prove",
            "planned": len(orders_of(False, batch, list(KINDS), 1.0)),
        }
        publish(DOCS, path.stem.removesuffix("_records"), batch, records, about)


if __name__ == "__main__":
    main()
