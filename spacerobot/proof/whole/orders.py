"""What the whole machines' share of a batch consists of."""

from __future__ import annotations

FAMILY = "whole machine"

FULL = {"nothing_missing": 20, "wrong_value": 10, "unlabelled": 50, "two": 20}
"""Kind -> campaigns; friction is hidden in a joint or in the wrist, or in both."""

QUICK: dict[str, int] = {}
"""The same of a quick batch."""
