# SPDX-License-Identifier: MIT
"""Files as callers hold them: names, and binary file objects."""

from __future__ import annotations

import contextlib
import os
import tempfile
import uuid
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple


class FileOnDisk(NamedTuple):
    """path: where it is read. name: what messages call it. folder: of a copy that goes away, or ""."""

    path: Path
    name: str
    folder: str = ""

    def named(self, text: str) -> str:
        """A message of who read the path, with the file's own name. A copy has no files beside it."""
        if not self.folder or self.folder not in text:
            return text
        said = text.replace(str(self.path), self.name).replace(self.folder + os.sep, "")
        alone = " (a file object has no files beside it: give the file's name)"
        return said + alone if "does not exist" in said else said


def write_whole(path: Path, text: str) -> None:
    """Writes a file that appears whole or not at all."""
    partial = path.with_name(f".{path.name}.{uuid.uuid4().hex}.partial")
    try:
        with partial.open("w") as file:
            file.write(text)
        os.replace(partial, path)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise


def require_other(path: Path, inputs: Iterable[str]) -> None:
    """Raises ValueError if what is to be written is a folder, or a file that is read."""
    if path.is_dir():
        raise ValueError(f"cannot write {path}: it is a folder: give a file's name")
    if path.exists() and any(Path(name).exists() and path.samefile(name) for name in inputs):
        raise ValueError(f"cannot write {path}: it is a file that this run reads")


def require_writable(path: Path) -> None:
    """Makes the folder of a file that is to be written after long work. Raises ValueError if it cannot be."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise ValueError(f"cannot write {path}: {error.strerror}") from None


@contextlib.contextmanager
def on_disk(given: Any, argument: str) -> Iterator[FileOnDisk]:
    """A file that is given by its name, or as an object whose read() or read_bytes() gives bytes: as a copy then, while
    the context lasts. A ValueError on the way gets the object's name.

    Raises FileNotFoundError for a name without a file, TypeError for what is neither, and ValueError for an object that
    cannot be read.
    """
    if isinstance(given, str | os.PathLike):
        path = Path(given)
        if not path.exists():
            is_url = "://" in os.fspath(given)
            raise FileNotFoundError(f"{os.fspath(given)}: does not exist" + " here: download it first" * is_url)
        yield FileOnDisk(path, str(path))
        return
    data, name = _bytes_of(given, argument), _name_of(given)
    with tempfile.TemporaryDirectory(prefix="gnomon-") as folder:
        file = FileOnDisk(Path(folder) / "file", name, folder)
        file.path.write_bytes(data)
        try:
            yield file
        except ValueError as error:
            raise ValueError(file.named(str(error))) from None


def _name_of(given: Any) -> str:
    """An object's own name, or its type's: that of an open descriptor is a number."""
    name = getattr(given, "name", None)
    return name if isinstance(name, str) and name else f"<{type(given).__name__}>"


def _bytes_of(given: Any, argument: str) -> bytes:
    if isinstance(given, bytes | bytearray | memoryview):
        raise TypeError(f"{argument}: must be a file's name or a binary file, not bytes: io.BytesIO(data) is one")
    read = getattr(given, "read_bytes", None) or getattr(given, "read", None)
    if not callable(read):
        raise TypeError(
            f"{argument}: must be a file's name or a binary file, not {type(given).__name__}: open(name, 'rb') is one"
        )
    try:
        data = read()
    except TypeError:
        raise TypeError(f"{argument}: {type(given).__name__} gives no bytes by itself: open a member of it") from None
    except (OSError, ValueError) as error:
        raise ValueError(f"{argument}: {_name_of(given)} cannot be read: {error}") from None
    if not isinstance(data, bytes | bytearray):
        raise TypeError(f"{argument}: {_name_of(given)} gives {type(data).__name__}, not bytes: open it with mode 'rb'")
    if not data:
        raise ValueError(f"{argument}: {_name_of(given)} gives no bytes: it is empty, or read to its end (seek(0))")
    return bytes(data)
