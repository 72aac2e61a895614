"""The targets by name: readers in Python, which a coverage-guided fuzzer drives from inside."""

from __future__ import annotations

from fuzz.target import Target
from fuzz.targets import csv, mesh, motive, nexus, npz, results, scene, study, trajectory, urdf

TARGETS: dict[str, Target] = {
    target.name: target
    for target in (
        study.TARGET,
        scene.TARGET,
        csv.TARGET,
        motive.TARGET,
        nexus.TARGET,
        npz.TARGET,
        trajectory.TARGET,
        results.TARGET,
        urdf.TARGET,
        mesh.TARGET,
    )
}
