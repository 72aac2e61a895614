"""A command that runs beside others: what it prints, how it fails, and that nobody leaves it behind."""

from __future__ import annotations

import json

import pytest

from spacerobot.cli.beside import beside
from spacerobot.support.errors import SpacerobotError


def test_its_answer_is_what_the_command_prints() -> None:
    with beside(["study", "schema"]) as begun:
        assert json.loads(begun.answer())


def test_its_failure_is_told_in_its_own_words() -> None:
    with beside(["study", "check", "no-such-study"]) as begun, pytest.raises(SpacerobotError, match="no-such-study"):
        begun.answer()


def test_answers_come_in_turn_and_none_after_a_failure() -> None:
    with beside(["study", "schema"], ["study", "check", "no-such-study"], ["study", "schema"]) as begun:
        assert json.loads(begun.answer(0))
        for number in (1, 2):
            with pytest.raises(SpacerobotError, match="no-such-study"):
                begun.answer(number)


def test_who_leaves_early_takes_it_along() -> None:
    with pytest.raises(KeyboardInterrupt), beside(["diagnose", "guide-friction", "--json"]) as begun:
        raise KeyboardInterrupt
    assert begun.process.poll() is not None
