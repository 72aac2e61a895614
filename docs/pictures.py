"""The README's pictures, from the package: `make picture`. Needs chromium and the extra `browser` for the scene."""

from __future__ import annotations

import shutil
import sys
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from spacerobot import Scene, Target, Wrist, diagnose, load_study, simulate
from spacerobot.effects.registry import all_effects
from spacerobot.view.plotting import png
from spacerobot.view.report.evidence import read_evidence
from spacerobot.view.report.plots import figures
from spacerobot.view.scene3d.page import page
from spacerobot.view.scene3d.trajectory_film import trajectory_film

IMAGES = Path(__file__).resolve().parent / "images"
LISTED = {"coulomb_friction", "cubic_stiffness", "table_tilt", "hertz_contact", "viscous_drag"}
GRAPHICS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars"]


def capture(path: Path) -> None:
    """A chaser meets a target, at the moment of the touch."""
    from playwright.sync_api import sync_playwright

    scene = Scene(
        "chaser_pa10_wrist",
        base="free",
        joints="free",
        approach=(-1.0, 0.0, 0.0),
        wrist=Wrist(stiffness=530.0, damping=4.0),
        target=Target(mass=40.0, speed=0.12, gap=0.03, contact_point=(0.15, 0.02, 0.0)),
        duration=1.5,
    )
    film = trajectory_film(simulate(scene, tolerance=1e-6), scene)
    peak = film.time[abs(film.arrow.force).argmax()] if film.arrow is not None else 0.3
    with TemporaryDirectory() as folder, sync_playwright() as driver:
        file = Path(folder) / "capture.html"
        file.write_text(page(film), encoding="utf-8")
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=GRAPHICS)
        tab = browser.new_page(viewport={"width": 1200, "height": 640})
        tab.set_default_timeout(120_000)
        tab.goto(f"{file.as_uri()}#t={peak:.4f}&light=full")
        tab.wait_for_timeout(3000)
        tab.screenshot(path=path)
        browser.close()


def found(path: Path) -> None:
    """Four trials of the bundled study before and after its missing friction was found."""
    study = load_study("guide-friction")
    study = replace(study, trials=tuple(study.trial(name) for name in ("01", "03", "04", "06")))
    result = diagnose(study, jobs=1, without=[name for name in all_effects() if name not in LISTED])
    if [e["effect"] for e in result.verdict["effects"]] != ["coulomb_friction"]:
        sys.exit("the friction was not found: no picture")
    plots = figures(dict(result.verdict), read_evidence(dict(result.evidence)))
    path.write_bytes(png(plots["held_out_target_x"]))


if __name__ == "__main__":
    capture(IMAGES / "capture.png")
    found(IMAGES / "found.png")
