"""A robot with sliders: what they reach, what is drawn, and whom the server answers."""

from __future__ import annotations

import functools
import http.client
import json
import math
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

import spacerobot
from spacerobot.cli.main import main
from spacerobot.dynamics.effective_mass import effective_mass
from spacerobot.model.library import load
from spacerobot.simulation.scene import Scene
from spacerobot.support.errors import InputError
from spacerobot.view.live.live_view import LiveView, live_view
from tests.processes import PATIENCE

VIEWS = ("pa10_wrist", "chaser_pa10_wrist", "kinova")
"""A fixed base with a wrist, a floating one, and a robot with joints that turn without limits."""


@functools.cache
def view_of(name: str) -> LiveView:
    return LiveView(load(name))


def asked(
    url: str, query: str = "", *, host: str | None = None, below: str = "/pose"
) -> tuple[int, str, dict[str, str]]:
    parts = urlsplit(url)
    connection = http.client.HTTPConnection(str(parts.hostname), parts.port, timeout=PATIENCE)
    connection.request("GET", parts.path + below + query, headers={"Host": host or parts.netloc})
    answer = connection.getresponse()
    found = answer.status, answer.read().decode(), dict(answer.headers)
    connection.close()
    return found


@pytest.mark.parametrize("name", VIEWS)
def test_sliders_reach_as_far_as_the_urdf_allows(name: str) -> None:
    """Read from the URDF's text, not from the model that the sliders are made of."""
    sliders = {s.name: s for s in view_of(name).sliders}
    root = etree.fromstring(view_of(name).robot.urdf.encode())
    moving = {
        j.get("name"): j for j in root.findall("joint") if j.get("type") in ("revolute", "prismatic", "continuous")
    }
    assert set(sliders) == set(moving)
    for joint, element in moving.items():
        limit, slider = element.find("limit"), sliders[joint]
        assert slider.turns == (element.get("type") != "prismatic")
        if element.get("type") == "continuous":
            assert (slider.low, slider.high) == (-math.pi, math.pi)
        else:
            assert (slider.low, slider.high) == pytest.approx((float(limit.get("lower")), float(limit.get("upper"))))


@pytest.mark.parametrize("name", VIEWS)
@settings(max_examples=15, deadline=None)
@given(data=st.data())
def test_the_pose_that_is_set_is_the_pose_that_is_drawn(name: str, data: Any) -> None:
    view = view_of(name)
    robot = view.robot
    positions = {s.name: data.draw(st.floats(s.low, s.high)) for s in view.sliders}
    view.pose = positions
    still = view.still()
    np.testing.assert_allclose(still["positions"], list(positions.values()), atol=1e-12)
    q, model, frames = pin.neutral(robot.model), robot.model, robot.model.createData()
    for joint, value in positions.items():
        record = model.joints[model.getJointId(joint)]
        q[record.idx_q : record.idx_q + record.nq] = [value] if record.nq == 1 else [math.cos(value), math.sin(value)]
    pin.framesForwardKinematics(model, frames, q)
    for body, row in zip(view.film.bodies, still["poses"], strict=True):
        joint = body.name.partition("/")[2]
        if joint not in ("base", "spring"):
            drawn, wanted = pin.XYZQUATToSE3(np.array(row)), frames.oMi[model.getJointId(joint)]
            np.testing.assert_allclose(drawn.homogeneous, wanted.homogeneous, atol=1e-12)
    tip = frames.oMf[robot.frame_id(robot.contact or robot.tip)].translation
    np.testing.assert_allclose(still["readouts"][-3:], tip, atol=1e-12)


def test_the_mass_beside_the_sliders_is_the_commands() -> None:
    view = LiveView(load("chaser_pa10_wrist"))
    view.pose = np.radians([20, 30, -10, 80, 5, -40, 0])
    for told, axis in zip(view.still()["readouts"][:3], np.eye(3), strict=True):
        assert told == pytest.approx(effective_mass(view.robot, view.pose, axis).effective_mass_kg, rel=1e-9)


def test_page_and_python_set_one_and_the_same_pose() -> None:
    with live_view("pa10_wrist") as view:
        start = view.pose
        status, text, _ = asked(view.url, "?q=0.1,0.2,0.3,0.4,0.5,0.6,0.7,0.01")
        assert status == 200
        np.testing.assert_allclose(view.pose, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7])
        assert view.positions["wrist_slider"] == pytest.approx(0.01)
        version = json.loads(text)["version"]
        assert asked(view.url, f"?since={version}")[0] == 204
        view.pose = start
        status, text, _ = asked(view.url, f"?since={version}")
        assert status == 200
        np.testing.assert_allclose(json.loads(text)["positions"][:7], start)


def test_a_scene_is_shown_at_its_pose_and_along_its_approach() -> None:
    scene = Scene()
    view = live_view(scene)
    np.testing.assert_allclose(view.pose, scene.pose)
    along = effective_mass(scene.prepared, view.pose, scene.approach).effective_mass_kg
    assert view.still()["readouts"][3] == pytest.approx(along)


def test_only_this_machine_and_this_address_are_answered() -> None:
    with live_view("wrist") as view:
        parts = urlsplit(view.url)
        assert parts.hostname == "127.0.0.1"
        assert view._server is not None
        assert view._server._server.server_address[0] == "127.0.0.1", "bound to loopback, not to every interface"
        before = view.positions
        for below in ("", "/pose"):
            assert asked(view.url, host="evil.example", below=below)[0] == 404
        assert asked(view.url, "?q=0.01", host=f"evil.example:{parts.port}")[0] == 404
        assert view.positions == before
        assert asked(f"http://{parts.netloc}/guessed")[0] == 404
        assert asked(view.url, below="/other")[0] == 404
        status, text, headers = asked(view.url, below="")
        assert status == 200
        assert "connect-src 'self'" in text.replace("&#39;", "'")
        assert "frame-ancestors 'self' http://localhost:*" in headers["Content-Security-Policy"]


@pytest.mark.parametrize("query", ["?q=1,0", "?q=nan", "?q=a,b", "?q=9"])
def test_what_the_page_cannot_mean_is_refused_in_a_line(query: str) -> None:
    with live_view("wrist") as view:
        before = view.positions
        status, text, headers = asked(view.url, query)
        assert (status, view.positions) == (400, before)
        assert headers["Content-Type"].startswith("text/plain")
        assert text.count("\n") == 1


@pytest.mark.parametrize(
    ("what", "options", "says"),
    [
        ("pa10", {"pose": [1.0, 2.0]}, "wrong length"),
        ("pa10", {"pose": {"S2": 9.0}}, "outside"),
        ("pa10", {"pose": {"S9": 0.0}}, "S9"),
        ("pa10", {"pose": "abc"}, "not numbers"),
        ("pa10", {"pose": [math.nan] * 7}, "outside"),
        ("pa10", {"joints": "loose"}, "joints"),
        ("target", {}, "no joint"),
        (3, {}, "int"),
    ],
)
def test_mistakes_are_told(what: Any, options: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says) as error:
        spacerobot.live_view(what, **options)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["pa10", "--live", "--q", "1", "2"], "wrong length"),
        (["pa10", "--live", "--deg", "--q", *["400"] * 7], "outside"),
        (["pa10", "--live", "--joints", "loose"], "joints"),
        (["guide-friction", "--live", "--joints", "locked"], "--joints"),
        (["pa10", "--joints", "locked"], "--joints"),
        (["target", "--live"], "no joint"),
    ],
)
def test_mistakes_on_the_command_line_serve_nothing(
    arguments: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["view", *arguments]) == 2
    told = capsys.readouterr()
    assert says in told.err
    assert "\n" not in told.err.strip()
    assert not told.out


@contextmanager
def heard(number: signal.Signals) -> Iterator[None]:
    """Children hear the signal, though the shell that began the suite in the background ignores it for them."""
    before = signal.signal(number, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(number, before)


def test_an_interrupt_ends_it_without_a_word_of_python() -> None:
    command = [sys.executable, "-m", "spacerobot", "view", "wrist", "--live", "--json"]
    with (
        heard(signal.SIGINT),
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process,
    ):
        try:
            assert process.stdout is not None
            assert process.stderr is not None
            line = ""
            while not line.rstrip().endswith("}"):
                more = process.stdout.readline()
                assert more, process.stderr.read()
                line += more
            assert asked(json.loads(line)["url"], "?q=0.01")[0] == 200
            process.send_signal(signal.SIGINT)
            assert process.wait(timeout=PATIENCE) == 0
            assert process.stderr.read().strip() == "ended"
        finally:
            process.kill()


def test_in_a_notebook_it_is_a_frame_of_the_page() -> None:
    with live_view("wrist") as view:
        assert view._repr_html_().startswith(f'<iframe src="{view.url}"')
