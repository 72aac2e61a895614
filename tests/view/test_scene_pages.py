"""Films of captures, recordings and robots as pages, and the command that makes them."""

from __future__ import annotations

import base64
import hashlib
import http.client
import json
import re
import socket
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
import pytest
import umsgpack
from helpers_scene import free, held

from spacerobot.cli.main import main
from spacerobot.model.library import load
from spacerobot.recordings.study import load_study
from spacerobot.simulation.scene import Scene
from spacerobot.support.errors import InputError
from spacerobot.view.scene3d.choose import film_of
from spacerobot.view.scene3d.extent import rotation
from spacerobot.view.scene3d.film import Film
from spacerobot.view.scene3d.messages import messages
from spacerobot.view.scene3d.page import page
from spacerobot.view.scene3d.robot_film import robot_film
from spacerobot.view.scene3d.serve import PageServer
from spacerobot.view.scene3d.study_film import study_film
from spacerobot.view.scene3d.trajectory_film import trajectory_film
from tests.processes import PATIENCE


def body(film: Film, name: str):  # type: ignore[no-untyped-def]
    return next(b for b in film.bodies if b.name == name)


def _gap(scene: Scene, film: Film) -> np.ndarray:
    """How far the drawn contact point is beyond the drawn tip, along the approach, shape (T,)."""
    assert film.arrow is not None
    point = scene.attitude.T @ scene.lever
    touching = np.array([rotation(p[3:]) @ point + p[:3] for p in body(film, "target").poses])
    return (touching - film.arrow.point) @ np.array(scene.approach)


def test_the_drawn_target_presses_the_drawn_tip_by_the_penetration() -> None:
    scene, trajectory = held()
    film = trajectory_film(trajectory, scene)
    penetration = np.interp(film.time, trajectory.time, trajectory["contact.penetration"])
    np.testing.assert_allclose(_gap(scene, film), penetration, atol=1e-9)
    assert film.arrow is not None
    assert 0 < np.count_nonzero(film.arrow.force) < len(film.time)


def test_a_free_arm_is_drawn_where_the_simulation_has_it() -> None:
    scene, trajectory = free()
    film = trajectory_film(trajectory, scene)
    assert film.arrow is not None
    tip = np.column_stack([np.interp(film.time, trajectory.time, trajectory[f"tip.position.{a}"]) for a in "xyz"])
    np.testing.assert_allclose(film.arrow.point, tip, atol=1e-9)
    pressed = film.arrow.force > 0.0
    assert np.abs(_gap(scene, film)[pressed]).max() < 1e-3


def test_the_spring_is_as_short_as_the_slider_is_pushed() -> None:
    scene, trajectory = held()
    film = trajectory_film(trajectory, scene)
    stretch = body(film, "robot/spring").stretch
    pushed = np.interp(film.time, trajectory.time, trajectory["wrist.deflection"])
    np.testing.assert_allclose(stretch[0] - stretch, pushed - pushed[0], atol=1e-9)
    assert np.ptp(stretch) > 0.005


def test_a_held_arm_stands_still_and_a_free_one_does_not() -> None:
    arm = body(trajectory_film(*reversed(held())), "robot/S2")
    assert np.ptp(arm.poses, axis=0).max() < 1e-12
    film = trajectory_film(*reversed(free()))
    assert np.ptp(body(film, "robot/E1").poses, axis=0).max() > 1e-3
    assert film.place == "space"
    assert film.ellipsoid is not None
    assert film.centre_of_mass is not None


def test_frames_are_denser_while_there_is_contact() -> None:
    _, trajectory = held()
    film = trajectory_film(trajectory)
    assert film.arrow is not None
    pressed = film.arrow.force != 0.0
    assert np.median(np.diff(film.time)[pressed[1:]]) <= np.median(np.diff(film.time))
    assert len(film.time) <= 500
    assert [m.label for m in film.marks if not m.quiet] == ["touch", "apart"]


def test_a_ghost_is_where_the_recording_says() -> None:
    study = load_study("guide-friction")
    film = study_film(study, "04")
    ghost, target = body(film, "recorded/target"), body(film, "target")
    series = study.recording("04")["target.x"]
    recorded = np.interp(film.time, *series.good())
    moved = ghost.poses[:, 0] - target.poses[:, 0]
    simulated = next(r for r in film.readouts if r.name == "target.x")
    np.testing.assert_allclose(moved, recorded - simulated.values / 1e3, atol=1e-9)
    assert ghost.mismatch is not None
    np.testing.assert_allclose(ghost.mismatch, np.abs(moved) / series.sigma, rtol=1e-4, atol=1e-6)
    assert film.gains[-1] == 1.0


def test_messages_are_meshcats() -> None:
    film = robot_film(load("pa10_wrist"))
    decoded = [umsgpack.unpackb(m) for m in messages(film)]
    assert [m["type"] for m in decoded[:3]] == ["delete"] * 3
    objects = [m for m in decoded if m["type"] == "set_object"]
    assert len({m["path"] for m in objects}) == len(film.bodies)
    for message in objects:
        known = {g["uuid"] for g in message["object"]["geometries"]} | {
            m["uuid"] for m in message["object"]["materials"]
        }
        for child in message["object"]["object"]["children"]:
            assert {child["geometry"], child["material"]} <= known
        for geometry in message["object"]["geometries"]:
            attributes = geometry["data"]["attributes"]
            points = np.frombuffer(attributes["position"]["array"].data, dtype="<f4")
            assert np.all(np.isfinite(points))
            if "index" in geometry["data"]:
                kind = {"Uint16Array": "<u2", "Uint32Array": "<u4"}[geometry["data"]["index"]["type"]]
                assert np.frombuffer(geometry["data"]["index"]["array"].data, dtype=kind).max() < len(points) // 3


HOSTILE = "</script><script>window.hit=1</script><img src=x onerror=window.hit=1>"


def test_page_is_whole_locked_and_inert() -> None:
    film = robot_film(load("pa10_wrist"))
    film = replace(film, title=HOSTILE, subtitle=HOSTILE, notes=(HOSTILE,), description=HOSTILE + '" onload="x')
    film = replace(film, marks=tuple(replace(m, label=HOSTILE) for m in film.marks))
    text = page(film)
    assert len(text) < 3_000_000
    assert "<img" not in text
    assert "window.hit=1</script>" not in text
    scripts = re.findall(r"<script>(.*?)</script>", text, re.S)
    assert len(scripts) == 4
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', text).group(1)  # type: ignore[union-attr]
    policy = policy.replace("&#39;", "'")
    digests = {base64.b64encode(hashlib.sha256(s.encode()).digest()).decode() for s in scripts}
    assert set(re.findall(r"'sha256-([^']+)'", policy)) == digests
    assert "default-src 'none'" in policy
    assert "connect-src" not in policy
    assert "unsafe-eval" not in policy
    own = text.replace(scripts[0], "")
    assert not re.search(r"""(src|href)\s*=\s*["']?(https?:)?//""", own)
    data = json.loads(re.search(r'id="film">(.*?)</script>', text, re.S).group(1))  # type: ignore[union-attr]
    numbers = np.frombuffer(base64.b64decode(data["numbers"]), dtype="<f4")
    for entry in data["bodies"]:
        start, count = entry["poses"]
        assert count % 7 == 0
        assert start + count <= numbers.size


def test_writing_a_page_opens_no_socket_and_loads_no_server(tmp_path: Path) -> None:
    program = (
        "import socket, sys\n"
        "def refuse(*a, **k): raise AssertionError('a socket was bound')\n"
        "socket.socket.bind = socket.socket.listen = socket.socket.connect = refuse\n"
        "from spacerobot.cli.main import main\n"
        f"code = main(['view', 'pa10_wrist', '--html', {str(tmp_path / 'a.html')!r}])\n"
        "bad = {'zmq', 'tornado', 'IPython', 'meshcat.visualizer'} & set(sys.modules)\n"
        "sys.exit(code or (1 if bad else 0))\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "a.html").stat().st_size > 800_000


def test_a_robots_scene_loads_neither_the_simulation_nor_the_diagnosis() -> None:
    program = (
        "import sys\n"
        "from spacerobot.view.scene3d.choose import film_of\n"
        "film_of('pa10_wrist')\n"
        "heavy = ('scipy.stats', 'spacerobot.simulation.multibody', 'spacerobot.diagnosis.diagnose')\n"
        "print([m for m in heavy if m in sys.modules])\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.stdout == "[]\n", done.stderr


@pytest.fixture
def server():  # type: ignore[no-untyped-def]
    server = PageServer(lambda: "<p>here</p>")
    server.start()
    yield server
    server.close()


def ask(url: str, host: str | None = None, path: str | None = None, method: str = "GET") -> int:
    parts = urlsplit(url)
    connection = http.client.HTTPConnection(str(parts.hostname), parts.port, timeout=PATIENCE)
    connection.request(method, path or parts.path, headers={"Host": host or parts.netloc})
    status = connection.getresponse().status
    connection.close()
    return status


def test_live_page_is_for_this_machine_and_this_address_alone(server: PageServer) -> None:
    assert ask(server.url) == 200
    assert ask(server.url, path="/") == 404
    assert ask(server.url, path="/../etc/passwd") == 404
    assert ask(server.url, host="evil.example") == 404
    assert ask(server.url, method="POST") == 501
    parts = urlsplit(server.url)
    assert parts.hostname == "127.0.0.1"
    others = {i[4][0] for i in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)} - {"127.0.0.1"}
    for address in others:
        if not address.startswith("127."):
            with pytest.raises(OSError), socket.create_connection((address, int(parts.port or 0)), timeout=1):
                pass


def test_a_page_that_can_no_longer_be_made_is_told_in_words(capfd: pytest.CaptureFixture[str]) -> None:
    def broken() -> str:
        raise InputError("no such <scene>", where="scene.toml")

    server = PageServer(broken)
    server.start()
    parts = urlsplit(server.url)
    connection = http.client.HTTPConnection(str(parts.hostname), parts.port, timeout=PATIENCE)
    connection.request("GET", parts.path)
    answer = connection.getresponse()
    assert answer.status == 500
    assert answer.headers["Content-Type"].startswith("text/plain"), "so that nothing in it is taken for markup"
    assert b"no such <scene>" in answer.read()
    connection.close()
    server.close()
    assert "Traceback" not in capfd.readouterr().err


def test_ports_are_not_known_beforehand() -> None:
    servers = [PageServer(lambda: "") for _ in range(5)]
    try:
        assert len({urlsplit(s.url).port for s in servers}) == 5
        assert len({urlsplit(s.url).path for s in servers}) == 5
    finally:
        for server in servers:
            server._server.server_close()


def test_command_writes_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "arm.html"
    assert main(["view", "pa10_wrist", "--q", "0,45,0,90,0,-45,0", "--deg", "--html", str(target), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer == {"page": str(target.resolve()), "bytes": target.stat().st_size}
    assert main(["view", "pa10_wrist", "--html", str(target)]) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert main(["view", "pa10_wrist", "--html", str(target), "--overwrite"]) == 0


def test_a_trajectory_file_and_its_folder_show_the_same(tmp_path: Path) -> None:
    scene, trajectory = held()
    trajectory.save(tmp_path / "trajectory.npz")
    films = [film_of(str(tmp_path)), film_of(str(tmp_path / "trajectory.npz")), trajectory_film(trajectory, scene)]
    assert page(films[0]) == page(films[1])
    np.testing.assert_allclose(films[0].time, films[2].time)


def test_a_scene_is_simulated(tmp_path: Path) -> None:
    scene, trajectory = held()
    film = film_of(str(_written(tmp_path / "scene.toml", scene.to_toml())))
    assert film.arrow is not None
    assert film.arrow.force.max() == pytest.approx(trajectory["contact.force"].max(), rel=0.05)


def _written(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["nobody"], "unknown robot"),
        (["pa10_wrst"], "pa10_wrist"),
        (["pa10", "--q", "1", "2"], "wrong length"),
        (["pa10", "--q", "x"], "not a number"),
        (["pa10", "--deg"], "--deg"),
        (["pa10", "--trial", "1"], "--trial"),
        (["guide-friction", "--trial", "99"], "unknown trial"),
        (["guide-friction", "--q", "1"], "--q"),
        (["missing.toml"], "no such scene"),
        (["missing.npz"], "not a trajectory"),
        (["pa10", "--live", "--html", "x.html"], "--live"),
    ],
)
def test_mistakes_are_answered_in_one_line(
    arguments: list[str], says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["view", *arguments]) == 2
    error = capsys.readouterr().err.strip()
    assert says in error
    assert "\n" not in error
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["ur5", "kinova", "double_pendulum"])
def test_other_robots_stay_light(name: str) -> None:
    assert len(page(robot_film(load(name)))) < 5_000_000
