# SPDX-License-Identifier: MIT
"""`gnomon view` as a process of its own, and the scenes that it shows. GNOMON_BINARY names the command."""

import base64
import json
import os
import re
import signal
import struct
import subprocess
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    import browser

ROOT = Path(__file__).resolve().parents[2]
BINARY = os.environ.get("GNOMON_BINARY", str(ROOT / "build" / "gnomon"))
SCENES = ROOT / "scenes"

# A shell lets what it starts in the background ignore Ctrl-C, and so would each server.
signal.signal(signal.SIGINT, signal.default_int_handler)


class Answer:
    """The status, headers and body of an answer."""

    def __init__(self, status: int, headers: dict[str, str], body: bytes) -> None:
        self.status, self.headers, self.body = status, headers, body

    @property
    def text(self) -> str:
        return self.body.decode()

    @property
    def json(self) -> dict:
        return json.loads(self.body)

    @property
    def facts(self) -> dict:
        return json.loads(self.headers["X-Gnomon"])


class Server:
    """A running `gnomon view`."""

    def __init__(self, *arguments: str) -> None:
        self.process = subprocess.Popen(
            [BINARY, "view", *arguments, "--no-open"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        assert self.process.stdout
        self.address = self.process.stdout.readline().strip()
        found = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/\?token=([0-9a-f]{32})", self.address)
        assert found, self.address or self.process.communicate()[1]
        self.port, self.token = int(found[1]), found[2]

    def get(self, path: str, headers: dict[str, str] | None = None, method: str = "GET", **parameters: str) -> Answer:
        """Asks with the token, unless `headers` has another one."""
        query = urllib.parse.urlencode({name.replace("_", "-"): value for name, value in parameters.items()})
        request = urllib.request.Request(
            f"http://127.0.0.1:{self.port}/{path}?{query}",
            headers={"X-Gnomon-Token": self.token} | (headers or {}),
            method=method,
        )
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return Answer(answer.status, dict(answer.headers), answer.read())
        except urllib.error.HTTPError as error:
            return Answer(error.code, dict(error.headers), error.read())

    def stop(self) -> int:
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(timeout=5)


@pytest.fixture(scope="session")
def sundial() -> Iterator[Server]:
    server = Server()
    yield server
    server.stop()


@pytest.fixture(scope="session")
def quick() -> Iterator[Server]:
    """The same, whose pictures stay sharp."""
    server = Server("--samples", "1")
    yield server
    server.stop()


@pytest.fixture(scope="session")
def driver(tmp_path_factory: pytest.TempPathFactory) -> Iterator["browser.Driver"]:
    import browser

    driver = browser.start(tmp_path_factory.mktemp("downloads"))
    yield driver
    driver.quit()


@pytest.fixture(scope="session")
def moving_scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A floor, and a triangle above it that moves by two metres within two seconds."""
    positions = struct.pack("<18f", -5, 0, 5, 5, 0, 5, 0, 0, -5, -1, 1, 1, 1, 1, 1, 0, 1, -1)
    keyframes = struct.pack("<2f", 0, 2) + struct.pack("<6f", 0, 0, 0, 2, 0, 0)
    data = base64.b64encode(positions + keyframes).decode()
    scene = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0}, {"mesh": 1}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": i}}]} for i in (0, 1)],
        "animations": [
            {
                "name": "Slide",
                "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}],
                "samplers": [{"input": 2, "output": 3}],
            }
        ],
        "buffers": [{"byteLength": 104, "uri": "data:application/octet-stream;base64," + data}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": offset, "byteLength": size}
            for offset, size in ((0, 36), (36, 36), (72, 8), (80, 24))
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-5, 0, -5], "max": [5, 0, 5]},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, 1, -1], "max": [1, 1, 1]},
            {"bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [2]},
            {"bufferView": 3, "componentType": 5126, "count": 2, "type": "VEC3"},
        ],
    }
    file = tmp_path_factory.mktemp("scenes") / "moving.gltf"
    file.write_text(json.dumps(scene))
    return file


@pytest.fixture(scope="session")
def moving(moving_scene: Path) -> Iterator[Server]:
    server = Server(str(moving_scene))
    yield server
    server.stop()
