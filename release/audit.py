"""Known vulnerabilities of what is installed: python -m release.audit. Says so where the database cannot be asked."""

from __future__ import annotations

import json
import subprocess
import sys


def audited() -> tuple[list[str], int, int]:
    """Findings in words, how many packages were looked up, and how many could not be."""
    command = [sys.executable, "-m", "pip_audit", "--local", "--format", "json", "--progress-spinner", "off"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=1200)
    try:
        said = json.loads(done.stdout)["dependencies"]
    except (ValueError, KeyError):
        return [f"pip-audit gave no answer: {done.stderr.strip()[-300:]}"], 0, 0
    known = [each for each in said if "skip_reason" not in each]
    skipped = [each for each in said if "skip_reason" in each and each["name"] != "spacerobot"]
    found = [
        f"{each['name']} {each['version']}: {v['id']} (mended in {', '.join(v['fix_versions']) or 'no version yet'})"
        for each in known
        for v in each["vulns"]
    ]
    return found, len(known), len(skipped)


def main() -> int:
    """Print the findings; 1 where there are any. A database that cannot be reached is said, and is no finding."""
    found, known, skipped = audited()
    for line in found:
        print(line)
    if not known:
        print(f"not audited: the index in use has no vulnerability records ({skipped} packages asked for)")
        print("run it again where the vulnerability database can be reached, before the release is given away")
    else:
        print(f"{known} packages audited, {len(found)} findings; {skipped} are unknown to the database")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
