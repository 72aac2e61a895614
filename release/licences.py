"""Licences of everything that an installation brings along: python -m release.licences [--write docs/licences.md]."""

from __future__ import annotations

import argparse
import functools
import importlib.metadata as metadata
import re
import sys
from dataclasses import dataclass
from pathlib import Path

EXTRAS = ("proof", "notebooks", "scale", "bench", "browser", "docs", "fuzz", "test", "release")

# Words of licence texts and identifiers -> what it is. The first that fits counts.
KNOWN = (
    (r"lgpl|lesser general", "LGPL"),
    (r"\bagpl|affero", "AGPL"),
    (r"\bgpl|gnu general", "GPL"),
    (r"mpl-2|mozilla", "MPL-2.0"),
    (r"apache", "Apache-2.0"),
    (r"bsd|0bsd|enthought|redistribution and use in source and binary forms", "BSD"),
    (r"\bisc\b", "ISC"),
    (r"mit-cmu|hpnd", "MIT-CMU"),
    (r"\bmit\b|mit-0", "MIT"),
    (r"psf|python software foundation|matplotlib versions", "PSF"),
    (r"bsl-1|boost", "BSL-1.0"),
    (r"zlib", "Zlib"),
    (r"unlicense|cc0|public domain", "public domain"),
    (r"any-osi", "any that OSI approves"),
    (r"qhull", "Qhull"),
    (r"proprietary|eula|commercial", "proprietary"),
)

PERMISSIVE = {"Apache-2.0", "BSD", "ISC", "MIT-CMU", "MIT", "PSF", "BSL-1.0", "Zlib", "public domain", "Qhull",
              "any that OSI approves"}  # fmt: skip
"""May be used by, and given away with, a BSD-3-Clause program."""

UNCHANGED = {"MPL-2.0", "LGPL"}
"""May be used so as a library of its own that we neither change nor include."""

BY_HAND = {
    "cmeel-qhull": "Qhull",
    "mosek": "proprietary",
    "jrl-cmakemodules": "LGPL",
}
"""Packages whose metadata say nothing, looked up in their source."""

NOTES = {
    "mosek": "comes with drake, in the extra `bench` alone; spacerobot never calls it",
    "jrl-cmakemodules": "build files that come with Pinocchio's wheels; nothing of it runs",
    "cmeel-qhull": "Qhull's own licence: free to use, change and pass on with its notice",
}


@dataclass(frozen=True)
class Licence:
    """One package.

    Attributes:
        package, version: of the installed distribution.
        licence: kind, "unknown" if nothing says.
        extra: extra that needs it, "" where every installation does.
    """

    package: str
    version: str
    licence: str
    extra: str

    @property
    def fine(self) -> bool:
        """Whether a BSD-3-Clause program may depend on it in this place."""
        if self.licence in PERMISSIVE | UNCHANGED:
            return True
        return bool(self.extra) and self.package in NOTES


def needed(root: str = "spacerobot") -> list[Licence]:
    """Every installed distribution that the package or one of its extras needs."""
    found: dict[str, Licence] = {}
    for extra in ("", *EXTRAS):
        waiting = [(root, extra)]
        seen: set[tuple[str, str]] = set()
        while waiting:
            name, wanted = waiting.pop()
            if (name, wanted) in seen:
                continue
            seen.add((name, wanted))
            requires = _requires(name)
            if requires is None:
                continue  # of another platform, or an extra that is not installed here
            if name != root and name not in found:
                distribution = metadata.distribution(name)
                found[name] = Licence(name, distribution.version, kind_of(name, distribution), extra)
            for requirement in requires:
                for package, inner in _wanted(requirement, wanted):
                    waiting.append((package, inner))
    return sorted(found.values(), key=lambda each: (each.extra, each.package))


@functools.cache
def _requires(name: str) -> tuple[str, ...] | None:
    """What a distribution asks for; None where it is not installed. Every extra asks again, and metadata are slow."""
    try:
        return tuple(metadata.distribution(name).requires or [])
    except metadata.PackageNotFoundError:
        return None


def kind_of(name: str, distribution: metadata.Distribution) -> str:
    """The licence that a distribution's metadata state, or its licence file's first lines."""
    if name in BY_HAND:
        return BY_HAND[name]
    said = distribution.metadata
    texts = [said.get("License-Expression") or ""]
    texts += [c for c in said.get_all("Classifier", []) if c.startswith("License ::")]
    texts.append((said.get("License") or "")[:300])
    for file in distribution.files or []:
        if re.search(r"licen[cs]e|copying", file.name, re.IGNORECASE) and file.suffix in ("", ".txt", ".md", ".rst"):
            texts.append(Path(str(distribution.locate_file(file))).read_text(encoding="utf-8", errors="replace")[:600])
            break
    for text in texts:
        for pattern, kind in KNOWN:
            if re.search(pattern, text, re.IGNORECASE):
                return kind
    return "unknown"


def _wanted(requirement: str, extra: str) -> list[tuple[str, str]]:
    """(package, extra) pairs that a requirement means, when `extra` of its owner is asked for."""
    head, _, marker = requirement.partition(";")
    match = re.match(r"\s*([\w.-]+)\s*(?:\[([^\]]*)\])?", head)
    if match is None:
        return []
    asked = re.search(r"extra\s*==\s*['\"]([^'\"]+)['\"]", marker)
    if asked and asked.group(1) != extra:
        return []
    name = re.sub(r"[-_.]+", "-", match.group(1)).lower()
    return [(name, ""), *((name, inner.strip()) for inner in (match.group(2) or "").split(",") if inner.strip())]


def page(licences: list[Licence]) -> str:
    """The list as a page."""
    lines = [
        "# Licences",
        "",
        "spacerobot is BSD-3-Clause and includes no code of others but what the notice in the viewer's files names. It",
        "needs these packages, which come under licences of their own; `python -m release.licences --write",
        "docs/licences.md` writes this page, and `make release-check` fails where one does not go with ours.",
    ]
    for extra in ("", *EXTRAS):
        rows = [each for each in licences if each.extra == extra]
        if rows:
            title = f"Further ones of the extra `{extra}`" if extra else "Every installation"
            lines += ["", f"## {title}", "", "| package | licence | |", "|---|---|---|"]
            lines += [f"| {r.package} | {r.licence} | {NOTES.get(r.package, '')} |" for r in rows]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Print or write the list; 1 where a licence is unknown or does not go with ours."""
    parser = argparse.ArgumentParser(prog="python -m release.licences")
    parser.add_argument("--write", type=Path, metavar="FILE", help="write the page there")
    args = parser.parse_args()
    licences = needed()
    if args.write:
        args.write.write_text(page(licences), encoding="utf-8")
    bad = [each for each in licences if not each.fine]
    for each in bad:
        print(f"{each.package} {each.version} ({each.extra or 'every installation'}): {each.licence}")
    print(f"{len(licences)} packages, {len(bad)} whose licence does not go with BSD-3-Clause")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
