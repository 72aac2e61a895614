"""What the arm's share of a batch consists of."""

from __future__ import annotations

FAMILY = "driven arm"

FULL = {"nothing_missing": 18, "wrong_value": 18, "unlabelled": 32, "two": 12, "outsider": 20}
"""Kind -> campaigns."""

QUICK = {"unlabelled": 1}
"""The same of a quick batch."""
