"""The release check-list: licences that go with ours, one version, and checks that can fail."""

from __future__ import annotations

from email.message import Message

import pytest

from release import licences
from release.__main__ import STEPS, _found


@pytest.mark.slow
def test_every_licence_goes_with_ours() -> None:
    found = licences.needed()
    assert {"numpy", "pin", "h5py", "rosbags", "lxml"} <= {each.package for each in found if not each.extra}
    assert [f"{each.package}: {each.licence}" for each in found if not each.fine] == []


@pytest.mark.parametrize("licence", ["GPL", "AGPL", "proprietary", "unknown"])
def test_one_that_does_not_is_seen(licence: str) -> None:
    assert not licences.Licence("somebody", "1.0", licence, "").fine
    assert not licences.Licence("somebody", "1.0", licence, "bench").fine


@pytest.mark.parametrize(
    ("key", "said", "kind"),
    [
        ("License-Expression", "GPL-3.0-or-later", "GPL"),
        ("License-Expression", "LGPL-3.0-or-later", "LGPL"),
        ("License-Expression", "BSD-3-Clause AND 0BSD", "BSD"),
        ("Classifier", "License :: OSI Approved :: GNU Affero General Public License v3", "AGPL"),
        ("License", "The MIT License (MIT)", "MIT"),
        ("License", "ask Bob", "unknown"),
    ],
)
def test_kinds(key: str, said: str, kind: str) -> None:
    message = Message()
    message[key] = said

    class Somebody:
        metadata = message
        files = None

    assert licences.kind_of("somebody", Somebody()) == kind  # type: ignore[arg-type]


def test_one_version_is_stated_everywhere() -> None:
    stated = _found(r'^version = "([^"]+)"', "pyproject.toml")
    assert stated == _found(r'^__version__ = "([^"]+)"', "spacerobot/__init__.py")
    assert stated == _found(r"^version: \"?([^\"\n]+)", "CITATION.cff")


def test_every_step_is_there() -> None:
    assert {"licences", "vulnerabilities", "sdist and wheel, twice", "tests"} <= set(STEPS)
