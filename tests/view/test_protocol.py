# SPDX-License-Identifier: MIT
"""What the server of `gnomon view` answers, to whom, and with which bits."""

import http.client
import io
import math
import shlex
import socket
import struct
import subprocess
import threading
import time
from pathlib import Path

import pytest
from conftest import BINARY, SCENES, Server

VIEW = {"size": "160x90", "eye": "2,2.2,-3.4", "target": "0,0.9,0", "fovy": "50"}


def run(command: str, folder: Path) -> subprocess.CompletedProcess:
    """Runs a line that the page copies, in this folder."""
    words = shlex.split(command)
    assert words[0] == "gnomon"
    return subprocess.run([BINARY, *words[1:]], cwd=folder, capture_output=True, text=True, check=False)


def same_as_render(server: Server, folder: Path, path: str = "frame.png", **parameters: str) -> bytes:
    """The frame, which has the bytes of the file that its command writes."""
    answer = server.get(path, **parameters)
    assert answer.status == 200, answer.text
    done = run(answer.facts["command"], folder)
    assert done.returncode == 0, done.stderr
    assert answer.body == (folder / "view.png").read_bytes()
    return answer.body


# ---- Bits ----


@pytest.mark.parametrize(
    "more",
    [
        {},
        {"light-direction": "0.75,-0.62,-0.23"},
        {"light-position": "1,3,1"},
        {"samples": "4"},
        {"sun-angle": "2", "sun-samples": "16"},
        {"sun-angle": "2", "sun-samples": "16", "samples": "4"},
        {"ambient": "sky"},
        {"exposure": "auto"},
        {"technique": "shadow-map", "set": "size=64"},
    ],
    ids=lambda more: "-".join(more) or "plain",
)
def test_frames_are_those_of_render(sundial: Server, tmp_path: Path, more: dict[str, str]) -> None:
    same_as_render(sundial, tmp_path, **VIEW, **more)


@pytest.mark.parametrize("server", ["sundial", "moving"])  # with a camera, and without
def test_the_scenes_own_view_is_that_of_render(server: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    started = request.getfixturevalue(server)
    for size in ("160x90", "90x160", "160x90"):
        same_as_render(started, tmp_path, size=size)
    same_as_render(started, tmp_path, size="160x90", fovy="20")


def test_frames_with_a_prepared_light_are_those_of_render(sundial: Server, tmp_path: Path) -> None:
    for x in ("2", "1", "0", "-1"):  # the light stands still while the camera moves
        same_as_render(sundial, tmp_path, **(VIEW | {"eye": f"{x},2.2,-3.4"}))


def test_poses_are_those_of_render(moving: Server, tmp_path: Path) -> None:
    assert moving.get("frame.jpg", size="16x16").status == 200
    assert moving.get("state").json["animations"] == [{"name": "Slide", "end_s": 2.0}]
    pictures = [same_as_render(moving, tmp_path, size="96x64", **{"time": t}) for t in ("0", "1.5", "0.25", "0")]
    assert len(set(pictures)) == 3 and pictures[0] == pictures[3]
    named = same_as_render(moving, tmp_path, size="96x64", time="1.5", animation="Slide")
    assert named == pictures[1]


def test_textured_scenes_are_those_of_render(tmp_path: Path) -> None:
    server = Server(str(SCENES / "leaves.glb"))
    same_as_render(server, tmp_path, size="160x90")
    same_as_render(server, tmp_path, size="160x90", samples="4")
    server.stop()


def test_a_comparison_shows_both_and_counts_what_is_wrong(sundial: Server, tmp_path: Path) -> None:
    answer = sundial.get("compare.png", **VIEW, technique="shadow-map", set="size=64")
    assert answer.status == 200, answer.text
    pillow = pytest.importorskip("PIL.Image")
    stack = pillow.open(io.BytesIO(answer.body))
    assert stack.size == (160, 270)
    exact = sundial.get("frame.png", **VIEW)
    rival = sundial.get("frame.png", **VIEW, technique="shadow-map", set="size=64")
    assert stack.crop((0, 0, 160, 90)).tobytes() == pillow.open(io.BytesIO(exact.body)).tobytes()
    assert stack.crop((0, 90, 160, 180)).tobytes() == pillow.open(io.BytesIO(rival.body)).tobytes()
    masks = []
    for technique in (["--technique", "shadow-map", "--set", "size=64"], []):
        view = [word for name in VIEW for word in (f"--{name}", VIEW[name])]
        subprocess.run([BINARY, "render", *view, *technique, "--mask", "m.png", "--quiet"], cwd=tmp_path, check=True)
        masks.append(pillow.open(tmp_path / "m.png").tobytes())
    rounded = [(a >= 128, b >= 128) for a, b in zip(*masks, strict=True)]
    assert answer.facts["points"] == 160 * 90
    assert answer.facts["wrongly_lit"] == rounded.count((True, False)) > 0
    assert answer.facts["wrongly_shadowed"] == rounded.count((False, True))


def test_a_comparison_may_come_first(sundial: Server) -> None:
    server = Server()
    settings = {"technique": "shadow-map", "set": "size=64"}
    first = server.get("compare.png", **VIEW, **settings)
    assert first.status == 200 and first.body == sundial.get("compare.png", **VIEW, **settings).body
    server.stop()


def test_explanations_are_those_of_explain(sundial: Server, tmp_path: Path) -> None:
    answers = set()
    for pixel in ("80,45", "148,15", "0,0", "60,60", "100,70"):
        explained = sundial.get("explain", **VIEW, pixel=pixel).json
        done = run(explained["command"], tmp_path)
        assert done.returncode == 0 and done.stdout == explained["text"]
        result = [line for line in done.stdout.splitlines() if line.startswith("result")]
        assert result == [f"result    {'lit' if explained['is_lit'] else 'in shadow'}: {explained['reason']}"]
        answers.add(explained["is_lit"])
    assert answers == {True, False}


def test_a_near_miss_says_by_how_much(moving: Server, tmp_path: Path) -> None:
    view = {"size": "160x90", "eye": "0,6,6", "target": "0,0,0"}
    point = moving.get("explain", **view, pixel="80,45").json["position"]
    misses = []
    for beyond in (2.0**-24, 2.0**-23, 2.0**-22):  # towards the edge from (-1,1,1) to (1,1,1), and past it
        towards = [math.ldexp(round(math.ldexp(c, 20)), -20) for c in (-point[0], 1 - point[1], 1 - point[2])]
        travel = ",".join(f"{-c:.9g}" for c in (towards[0], towards[1], towards[2] + beyond))
        explained = moving.get("explain", **view, pixel="80,45", **{"light-direction": travel}).json
        # The distance of two lines: the ray, and the edge along x.
        _, y, z = struct.unpack("3f", struct.pack("3f", *(-float(c) for c in travel.split(","))))
        distance = abs(y * (1 - point[2]) - z * (1 - point[1])) / math.hypot(y, z)
        assert explained["is_lit"] and explained["arithmetic"] in ("float", "double", "integers")
        assert [near["triangle"] for near in explained["near_misses"]] == [1]
        assert explained["near_misses"][0]["missed_by"] == pytest.approx(distance, rel=1e-6)
        assert f"missed by {distance:.3g}, rounded" in explained["text"]
        assert run(explained["command"], tmp_path).stdout == explained["text"]
        misses.append(distance)
    assert misses[0] < misses[1] < misses[2] < 2e-6


def test_suns_are_those_of_hours(sundial: Server, tmp_path: Path) -> None:
    suns = sundial.get("suns", place="48.2,16.4", day="2026-06-21")
    options = ["--place", "48.2,16.4", "--day", "2026-06-21", "--size", "8x8", "-o", "h.png", "--quiet"]
    done = subprocess.run([BINARY, "hours", *options], cwd=tmp_path, capture_output=True, text=True, check=False)
    if suns.status == 500:
        assert "ERFA" in suns.text and "ERFA" in done.stderr
        return
    rows = [line.split(",") for line in (tmp_path / "h.suns.csv").read_text().splitlines() if not line.startswith("#")]
    columns = [rows[0].index(name) for name in ("x", "y", "z")]
    assert [sun["direction"] for sun in suns.json] == [",".join(row[c] for c in columns) for row in rows[1:]]


DAY = {"place": "48.2,16.4", "day": "2026-06-21"}


@pytest.mark.parametrize("more", [{}, {"step": "60", "most": "16"}, {"north": "30.5"}], ids=lambda more: "-".join(more))
def test_hours_are_those_of_hours(sundial: Server, tmp_path: Path, more: dict[str, str]) -> None:
    view = VIEW | {"size": "480x270"}  # room for the legend
    answer = sundial.get("hours.png", **view, **DAY, **more)
    if answer.status == 500:
        assert "ERFA" in answer.text
        return
    assert answer.status == 200, answer.text
    done = run(answer.facts["command"], tmp_path)
    assert done.returncode == 0, done.stderr
    assert answer.body == (tmp_path / "hours.png").read_bytes()
    assert f"{answer.facts['suns']} suns" in done.stdout
    if "most" in more:
        assert answer.facts["legend"]["most"] == 16


def test_the_colour_of_a_pixel_is_its_points_hours(sundial: Server, tmp_path: Path) -> None:
    pillow = pytest.importorskip("PIL.Image")
    pixels = [(80, 70), (30, 60), (95, 52), (140, 80)]
    points = [sundial.get("explain", **VIEW, pixel=f"{x},{y}").json["position"] for x, y in pixels]
    (tmp_path / "points.csv").write_text("x,y,z\n" + "".join(f"{x},{y},{z}\n" for x, y, z in points))
    options = [word for name in DAY for word in (f"--{name}", DAY[name])]
    words = [BINARY, "hours", *options, "--points", "points.csv", "-o", "values.csv", "--quiet"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        assert "ERFA" in done.stderr
        return
    values = [float(row.split(",")[3]) for row in (tmp_path / "values.csv").read_text().splitlines()[1:]]
    assert len(set(values)) > 2
    for (x, y), value in zip(pixels, values, strict=True):
        for part in (16, 8, 4):  # the value's place on a scale that ends at 16 / part of it
            answer = sundial.get("hours.png", **VIEW, **DAY, most=repr(value * 16 / part))
            color = pillow.open(io.BytesIO(answer.body)).convert("RGB").getpixel((x, y))
            assert "#{:02x}{:02x}{:02x}".format(*color) == answer.facts["legend"]["colors"][part], (x, y, value)


# ---- Who is answered ----


@pytest.mark.parametrize(
    "headers",
    [
        {"X-Gnomon-Token": "0" * 32},
        {"X-Gnomon-Token": ""},
        {"Host": "evil.example"},
        {"Host": "evil.example:80"},
        {"Host": "127.0.0.1.evil.example"},
        {"Host": "[::1"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Range": "bytes=0-1,0-1"},
    ],
    ids=str,
)
@pytest.mark.parametrize(
    "path", ["", "state", "frame.jpg", "frame.png", "compare.jpg", "hours.png", "explain", "suns", "page.css"]
)
def test_strangers_are_refused(sundial: Server, path: str, headers: dict[str, str]) -> None:
    answer = sundial.get(path, headers)
    assert answer.status == 403
    assert sundial.token not in answer.text


def test_other_methods_are_refused(sundial: Server) -> None:
    for method in ("POST", "PUT", "DELETE", "OPTIONS", "PATCH"):
        assert sundial.get("state", method=method).status in (400, 403)


def test_the_page_and_its_own_requests_are_answered(sundial: Server) -> None:
    own = f"http://localhost:{sundial.port}"
    assert sundial.get("state", {"Host": f"localhost:{sundial.port}", "Origin": own}).status == 200
    assert sundial.get("state", {"Host": "127.0.0.1:9"}).status == 200  # the other end of ssh -L
    page = sundial.get("")
    assert page.status == 200 and "Content-Security-Policy" in page.headers
    assert sundial.get("controls.js").status == 200
    assert sundial.get("../options.hpp").status == 404
    assert sundial.get("%2e%2e/%2e%2e/etc/passwd").status == 404


def test_tokens_differ() -> None:
    first, second = Server(), Server()
    assert first.token != second.token
    assert second.get("state", {"X-Gnomon-Token": first.token}).status == 403
    first.stop()
    second.stop()


# ---- Bounds ----


@pytest.mark.parametrize(
    "parameters",
    [
        {"size": "16385x1"},
        {"size": "8192x8192"},
        {"size": "0x10"},
        {"size": "10x10", "samples": "33"},
        {"size": "10x10", "samples": "1024"},
        {"size": "10x10", "sun-angle": "1", "sun-samples": "65536"},
        {"size": "10x10", "ambient": "sky:16"},
        {"size": "10x10", "eye": "nan,0,0", "target": "0,0,0"},
        {"size": "10x10", "eye": "1e99,0,0", "target": "0,0,0"},
        {"size": "10x10", "eye": "0,0,0"},
        {"size": "10x10", "eye": "0,0,0", "target": "0,0,0"},
        {"size": "10x10", "light-direction": "0,0,0"},
        {"size": "10x10", "fovy": "180"},
        {"size": "10x10", "camera": "x" * 300},
        {"size": "10x10", "technique": "shadow-map", "set": "size=1000000"},
        {"size": "10x10\0"},
    ],
    ids=str,
)
def test_numbers_and_sizes_are_bounded(sundial: Server, parameters: dict[str, str]) -> None:
    answer = sundial.get("frame.jpg", **parameters)
    assert answer.status == 400 and answer.text, answer.text


@pytest.mark.parametrize(
    "parameters",
    [
        {"size": "8192x8192"},
        {"size": "10x10", "step": "7"},
        {"size": "10x10", "step": "0"},
        {"size": "10x10", "most": "-1"},
        {"size": "10x10", "north": "inf"},
        {"size": "10x10", "place": "91,0"},
        {"size": "10x10", "day": "2026-02-30"},
        {"size": "10x10", "day": ""},
    ],
    ids=str,
)
def test_hours_are_bounded(sundial: Server, parameters: dict[str, str]) -> None:
    answer = sundial.get("hours.jpg", **(DAY | parameters))
    assert answer.status == 400 and answer.text, answer.text
    assert sundial.get("hours.jpg", size="10x10", year="2026", place="1,2").status == 400  # a year is too long


def test_the_page_names_no_file(sundial: Server, tmp_path: Path) -> None:
    target = tmp_path / "written"
    names = ("scene", "SCENE", "output", "o", "mask", "aov", "dump-triangles", "stats", "points", "triangles", "device")
    plain = sundial.get("frame.png", **VIEW)
    for name in names:
        answer = sundial.get("frame.png", **VIEW, **{name: str(target)})
        assert answer.status == 200 and answer.body == plain.body and "written" not in answer.facts["command"]
    assert sundial.get("frame.png", size="10x10", camera=f"0 --output={target}").status in (400, 500)
    assert sundial.get("explain", **VIEW, pixel=f"1,1 --triangles={target}").status == 400
    assert not target.exists()


def test_a_copied_command_is_one_command(moving_scene: Path, tmp_path: Path) -> None:
    scene = tmp_path / "it's $(touch owned) ;.gltf"
    scene.write_bytes(moving_scene.read_bytes())
    server = Server(str(scene))
    command = server.get("frame.jpg", size="16x16").facts["command"]
    script = f'gnomon() {{ "{BINARY}" "$@"; }}\n{command}'
    subprocess.run(["bash", "-c", script], cwd=tmp_path, check=True, capture_output=True)
    assert (tmp_path / "view.png").exists() and not (tmp_path / "owned").exists()
    server.stop()


# ---- Many requests ----


def test_the_newest_request_wins(sundial: Server) -> None:
    long = {"size": "320x180", "samples": "32", "sun-angle": "5", "sun-samples": "256"}
    statuses: dict[int, int] = {}

    def ask(i: int, parameters: dict[str, str]) -> None:
        statuses[i] = sundial.get("frame.jpg", {"X-Gnomon-Client": "me"}, **parameters).status

    sundial.get("frame.jpg", size="320x180", samples="4", **{"sun-angle": "5"})  # compiles
    threads = []
    for i, parameters in enumerate([long, long, long, {"size": "32x18"}]):
        threads.append(threading.Thread(target=ask, args=(i, parameters)))
        threads[-1].start()
        time.sleep(0.3)
    began = time.monotonic()
    threads[-1].join()
    assert statuses[3] == 200
    for thread in threads:
        thread.join()
    assert [statuses[i] for i in range(3)] == [409, 409, 409]
    assert time.monotonic() - began < 30


def test_another_client_is_not_superseded(sundial: Server) -> None:
    statuses = []

    def ask(name: str) -> None:
        statuses.append(sundial.get("frame.jpg", {"X-Gnomon-Client": name}, size="320x180", samples="4").status)

    threads = [threading.Thread(target=ask, args=(name,)) for name in "abcd"]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert statuses == [200] * 4


def test_a_slow_client_holds_nothing(sundial: Server) -> None:
    slow = []
    for _ in range(12):
        client = socket.create_connection(("127.0.0.1", sundial.port))
        client.sendall(f"GET /frame.jpg?token={sundial.token}&size=1920x1080 HTTP/1.1\r\nHost: localhost\r\n".encode())
        slow.append(client)
    for client in slow[:6]:
        client.sendall(b"X-Gnomon-Client: slow\r\n\r\n")  # asks, and does not read
    for client in slow[6:9]:
        client.close()
    began = time.monotonic()
    assert sundial.get("state").status == 200
    assert time.monotonic() - began < 2
    assert sundial.get("frame.jpg", size="32x18").status == 200
    for client in slow:
        client.close()


# ---- Begin and end ----


def test_an_interrupt_ends_it_at_once() -> None:
    server = Server()
    server.get("frame.jpg", size="32x18")
    idle = socket.create_connection(("127.0.0.1", server.port))

    def ask() -> None:
        with pytest.raises((OSError, http.client.HTTPException)):
            server.get("frame.jpg", size="640x360", samples="32")

    asking = threading.Thread(target=ask)
    asking.start()
    time.sleep(0.3)
    began = time.monotonic()
    assert server.stop() == -2
    assert time.monotonic() - began < 2
    asking.join()
    idle.close()


def test_a_scene_that_cannot_be_read_is_said(tmp_path: Path) -> None:
    absent = [BINARY, "view", "missing.glb", "--no-open"]
    missing = subprocess.run(absent, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert missing.returncode == 1 and "missing.glb" in missing.stderr
    broken = tmp_path / "broken.gltf"
    broken.write_text("{}")
    server = Server(str(broken))
    for _ in range(100):
        state = server.get("state").json
        if "failure" in state:
            break
        time.sleep(0.1)
    assert "broken.gltf" in state["failure"]
    assert server.get("frame.jpg", size="8x8").status == 500
    server.stop()


def test_wrong_command_lines_are_refused(tmp_path: Path) -> None:
    for words, said in (
        (["--port", "0"], "--port"),
        (["--port", "70000"], "--port"),
        (["--samples", "3"], "--samples"),
        (["--eye", "1,2,3"], "--target"),
        (["--output", "x.png"], "unexpected"),
    ):
        done = subprocess.run([BINARY, "view", *words], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 2 and said in done.stderr, done.stderr
    other = Server()
    again = [BINARY, "view", "--no-open", "--port", str(other.port)]
    taken = subprocess.run(again, capture_output=True, text=True, timeout=60, check=False)
    assert taken.returncode == 1 and str(other.port) in taken.stderr
    other.stop()
