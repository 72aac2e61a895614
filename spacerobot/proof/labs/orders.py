"""What the share of other labs' rigs in a batch consists of."""

from __future__ import annotations

FAMILY = "another lab"

FULL = {
    "nothing_missing": 40,
    "wrong_value": 40,
    "unlabelled": 60,
    "masked": 20,
    "rare": 10,
    "imitated": 10,
    "two": 30,
    "outsider": 40,
}
"""Kind -> campaigns."""

QUICK: dict[str, int] = {}
"""The same of a quick batch."""
