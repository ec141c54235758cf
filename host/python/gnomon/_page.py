# SPDX-License-Identifier: MIT
"""gnomon.view(): the page of the command `gnomon view`, and the scenes that are written for it."""

from __future__ import annotations

import html
import json
import os
import shutil
import struct
import subprocess
import sys
import sysconfig
import tempfile
import weakref
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ._scene import Scene

#: Pages that are open: they live until close(), or until the process ends, whoever still holds them.
_open: set[Page] = set()


class Page:
    """A page of `gnomon view` that gnomon.view() opened; with `with`, it is closed at the end. A notebook shows it in a
    frame of its own."""

    def __init__(self, words: Sequence[str], folder: str | None, height: int) -> None:
        self._folder = folder
        self._height = height
        with tempfile.TemporaryFile() as said:
            # A session of its own: Ctrl-C in this process is not the server's.
            self._process = subprocess.Popen(
                words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=said, text=True, start_new_session=True
            )
            assert self._process.stdout is not None
            #: Of the page, with its token.
            self.address = self._process.stdout.readline().strip()
            self._end = weakref.finalize(self, _end, self._process, folder, os.getpid())
            if not self.address:
                self._process.wait()
                said.seek(0)
                self._end()
                raise RuntimeError(said.read().decode(errors="replace").strip() or "gnomon view ended at once")
        _open.add(self)

    def close(self) -> None:
        """Ends the server."""
        _open.discard(self)
        self._end()

    def __enter__(self) -> Page:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __reduce__(self) -> Any:
        raise TypeError("a gnomon.Page is a server of its process and cannot be copied or pickled: pickle its address")

    def __repr__(self) -> str:
        return f"<gnomon.Page at {self.address}>" if self._end.alive else "<gnomon.Page, closed>"

    def _repr_html_(self) -> str:
        if not self._end.alive:
            return "<p>The page is closed.</p>"
        return (
            f'<iframe src="{html.escape(self.address)}" width="100%" height="{self._height}" allow="clipboard-write" '
            'style="border: 0" title="gnomon view"></iframe>'
        )


def _end(process: subprocess.Popen[str], folder: str | None, owner: int) -> None:
    if os.getpid() != owner:
        return  # a child of a fork, whose parent goes on with the server
    process.terminate()
    process.wait()
    if process.stdout is not None:
        process.stdout.close()
    if folder is not None:
        shutil.rmtree(folder, ignore_errors=True)


def view(
    scene: Scene | str | os.PathLike[str],
    *,
    up: Literal["y", "z"] = "y",
    options: Sequence[str] = (),
    browser: bool | None = None,
    height: int = 600,
) -> Page:
    """Shows a scene on the page of `gnomon view`: look, turn, ask why. The server runs until Page.close(), or until
    this process ends.

    scene: a Scene, or the name of a .glb or .gltf file. A Scene of Scene.from_gltf() is shown from its file.
    up: the direction that points up on the page, "z" for most maps and cities: the page then has the coordinates
        (x, z, -y). Only for a Scene that was made of arrays.
    options: more words of the command's line, such as ("--samples", "16", "--light-direction", "1,-2,0").
    browser: whether a browser is opened; None: unless this is a notebook, which shows the page in a frame.
    height: of that frame, in pixels.

    Raises FileNotFoundError if the command `gnomon` is neither on PATH nor beside this package, RuntimeError with what
    it says if it ends.
    """
    if up not in ("y", "z"):
        raise ValueError(f"up: must be 'y' or 'z', not {up!r}")
    command = _command()
    folder = None
    if isinstance(scene, str | os.PathLike):
        words = [os.fspath(scene)]
    elif not hasattr(scene, "_file"):
        raise TypeError(f"scene: must be a gnomon.Scene or a file's name, not {type(scene).__name__}")
    elif scene._file is not None:
        words = list(scene._file)
    else:
        written = _glb(scene, up)
        folder = tempfile.mkdtemp(prefix="gnomon-view-")
        words = [str(Path(folder) / "scene.glb")]
        Path(words[0]).write_bytes(written)
    if folder is None and up != "y":
        raise ValueError("up: the page shows a glTF file as it is, in which y points up")
    if not isinstance(scene, str | os.PathLike) and scene._device_name:
        words.append(f"--device={scene._device_name}")
    if browser is False or (browser is None and _is_notebook()):
        words.append("--no-open")
    return Page([command, "view", *words, *options], folder, height)


def _command() -> str:
    """The command `gnomon`: on PATH, or where the scripts of this Python lie."""
    found = shutil.which("gnomon") or shutil.which("gnomon", path=sysconfig.get_path("scripts"))
    if found is None:
        raise FileNotFoundError(
            "gnomon.view() starts the command gnomon, which is not on PATH: build it (cmake --build build --target "
            "gnomon_command, in a clone) and put its folder there"
        )
    return found


def _is_notebook() -> bool:
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return getattr(shell, "kernel", None) is not None


def _glb(scene: Scene, up: str) -> bytes:
    """A glTF file of the scene's triangles: each coordinate keeps its bits, each triangle its number."""
    triangles = scene.triangles
    if scene._cut_outs is not None:
        raise ValueError("scene: the page reads cut-outs from glTF files alone (alphaMode MASK), not from arrays")
    if len(triangles) == 0:
        raise ValueError("scene: has no triangles to show")
    if up == "z":
        triangles = triangles[..., [0, 2, 1]] * np.array([1, 1, -1], np.float32)
    corners = np.ascontiguousarray(triangles, "<f4").reshape(-1, 3)
    if corners.nbytes > (1 << 32) - 4096:
        raise ValueError(f"scene: a glb file of {len(triangles):,} triangles would be longer than 4 GiB")
    accessor = {
        "bufferView": 0, "componentType": 5126, "count": len(corners), "type": "VEC3",
        "min": corners.min(axis=0).tolist(), "max": corners.max(axis=0).tolist(),
    }  # fmt: skip
    described = {
        "asset": {"version": "2.0", "generator": "gnomon"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "buffers": [{"byteLength": corners.nbytes}],
        "bufferViews": [{"buffer": 0, "byteLength": corners.nbytes}],
        "accessors": [accessor],
    }
    text = json.dumps(described).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", corners.nbytes, 0x004E4942)
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks) + corners.nbytes) + chunks + corners.tobytes()


def png_of(rgba: NDArray[Any]) -> bytes:
    """A PNG file of (H, W, 4) uint8."""
    height, width = rgba.shape[:2]
    rows = np.concatenate([np.zeros((height, 1), np.uint8), rgba.reshape(height, -1)], axis=1)  # 0: no filter

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6))
            + chunk(b"IEND", b""))  # fmt: skip
