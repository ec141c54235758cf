# SPDX-License-Identifier: MIT
"""Devices: the OpenCL library that is loaded, the default device, and the thread that works for each device."""

from __future__ import annotations

import collections
import contextlib
import ctypes
import functools
import importlib.util
import os
import shutil
import threading
import warnings
import weakref
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, TypeVar

from . import _gnomon

Result = TypeVar("Result")

_lock = threading.RLock()
_is_loaded = False


def _unlock() -> None:
    """In a child after a fork: the thread that held the lock does not exist there."""
    global _lock
    _lock = threading.RLock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_unlock)


def _bundled_loader() -> str:
    """The OpenCL loader in pyopencl's wheel: it alone finds the drivers of PyPI's wheels, which lie in the folder .libs
    beside it. Two steps of pyopencl's import, which takes long, are done here: PYOPENCL_HOME is set (without it the
    loader crashes), and the drivers are loaded, since no search path has their folder.
    """
    spec = importlib.util.find_spec("pyopencl")
    for folder in (spec.submodule_search_locations or []) if spec is not None else []:
        libraries = Path(folder) / ".libs"
        for loader in sorted(libraries.glob("libOpenCL*")):
            os.environ.setdefault("PYOPENCL_HOME", folder)
            if list(libraries.glob("libpocl*")) and not (shutil.which("cc") or shutil.which("gcc")):
                warnings.warn(
                    "PyPI's PoCL links kernels as a C compiler does, and ends the process where there is none: "
                    "install one (Debian and Ubuntu: gcc libc6-dev), or another OpenCL driver",
                    stacklevel=4,
                )
            for driver in libraries.glob("*.icd"):
                with contextlib.suppress(OSError):  # a driver that cannot be loaded is not listed
                    ctypes.CDLL(str(libraries / driver.read_text().strip()))
            return str(loader)
    return ""


def load_opencl() -> None:
    """Loads OpenCL if it is not loaded: the file in GNOMON_OPENCL_LIBRARY, else the loader in pyopencl's wheel, else
    the system's libOpenCL.so.1. Raises DeviceNotFoundError, which says how to install one."""
    global _is_loaded
    _gnomon.require_unforked()
    with _lock:
        if not _is_loaded:
            _gnomon.load_opencl("" if os.environ.get("GNOMON_OPENCL_LIBRARY") else _bundled_loader())
            _is_loaded = True


def devices() -> list[_gnomon.DeviceDescription]:
    """All OpenCL devices of this machine. Raises DeviceNotFoundError if there is no OpenCL library."""
    load_opencl()
    return _gnomon.devices()


class Device:
    """One OpenCL device. gnomon.use() and Scene(device=...) open it.

    Each device has a thread that runs its calls one after the other. A call may therefore come from any thread, and
    Ctrl-C is answered at once: the device finishes the interrupted work in the background, and its result is dropped.
    """

    def __init__(self, native: _gnomon.Device) -> None:
        self.native = native
        self._worker = ThreadPoolExecutor(max_workers=1, thread_name_prefix="gnomon")
        self._is_working = threading.Lock()

    @property
    def description(self) -> _gnomon.DeviceDescription:
        """Name, platform, memory and abilities."""
        return self.native.description

    @property
    def memory_bytes(self) -> int:
        """Bytes of device memory that gnomon's own buffers occupy now."""
        return self.native.memory_bytes

    def call(self, function: Callable[..., Result], *arguments: Any) -> Result:
        """Runs the function in the device's thread and returns its result."""
        _gnomon.require_unforked()
        try:
            future = self._worker.submit(self._alone, function, arguments)
        except RuntimeError:  # the interpreter ends, and takes no more work for threads: at exit, in a last thread
            return self._alone(function, arguments)
        return future.result()

    def call_reporting(
        self, function: Callable[..., Result], progress: Callable[[float], object] | None, *arguments: Any
    ) -> Result:
        """The same of a function whose last argument it calls with the part that is done, and that ends where this
        returns False. An exception here, Ctrl-C's too, ends it at its next report."""
        is_over = threading.Event()

        def report(done: float) -> bool:
            return not is_over.is_set() and (progress is None or progress(done) is not False)

        try:
            return self.call(function, *arguments, report)
        except BaseException:
            is_over.set()
            raise

    def _alone(self, function: Callable[..., Result], arguments: tuple[Any, ...]) -> Result:
        with self._is_working:
            return function(*arguments)

    def __deepcopy__(self, _: object) -> Device:
        return self

    __copy__ = functools.partialmethod(__deepcopy__, None)

    def __reduce__(self) -> Any:
        raise TypeError(
            "a gnomon.Device belongs to its process and cannot be pickled: pickle the name that gnomon.use() takes, "
            "and call gnomon.use() in the other process"
        )

    def __repr__(self) -> str:
        d = self.description
        return f"<gnomon.Device {d.name!r} ({d.type}, {d.platform})>"


_default: Device | None = None
#: A device of a queue lives as long as something that was made on it, and while it is among the last ones.
_devices_of_queues: weakref.WeakValueDictionary[tuple[int, int], Device] = weakref.WeakValueDictionary()
_last_of_queues: collections.deque[Device] = collections.deque(maxlen=4)


def open_device(selector: str = "", memory_limit_bytes: int = 0) -> Device:
    load_opencl()
    return Device(_gnomon.Device(selector, memory_limit_bytes))


def use(device: str | Device = "", *, memory_limit_bytes: int = 0) -> Device:
    """Makes a device the default of scenes that are made from now on, and returns it.

    device: "P:D" as devices() lists it, or a part of the device's or platform's name in any case; empty: the
        environment variable GNOMON_DEVICE, else the first usable GPU, else the first usable CPU.
    memory_limit_bytes: gnomon refuses to allocate more than this on the device; 0: no limit.
    Raises DeviceNotFoundError with the list of devices if none fits.
    """
    global _default
    _gnomon.require_unforked()
    opened = open_device(device, memory_limit_bytes) if isinstance(device, str) else device_of(device)
    with _lock:
        _default = opened
    return opened


def default_device() -> Device:
    """The device of the last use(); the first call opens it."""
    _gnomon.require_unforked()
    with _lock:
        return _default if _default is not None else use()


def device_of(named: str | Device | None) -> Device:
    """A device, by itself or by its name; None: that of the last use()."""
    if named is None:
        return default_device()
    if not isinstance(named, str | Device):
        raise TypeError(f"device: must be a gnomon.Device or a name, as of gnomon.devices(), not {named!r}")
    return named if isinstance(named, Device) else open_device(named)


def device_of_queue(queue: Any) -> Device:
    """The device of a pyopencl.CommandQueue, which must be in-order. Works on that queue."""
    load_opencl()
    key = (queue.context.int_ptr, queue.int_ptr)
    with _lock:
        device = _devices_of_queues.get(key)
        if device is None:  # a device retains its queue, so the integers are its own while it lives
            device = _devices_of_queues[key] = Device(_gnomon.Device.of_queue(*key))
            _last_of_queues.append(device)
        return device
