# SPDX-License-Identifier: MIT
"""Runs the tasks of a study in this process or by dask, until all are done or one fails for good."""

from __future__ import annotations

import ast
import contextlib
import errno
import itertools
import json
import multiprocessing
import os
import subprocess
import sys
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any

from .. import _gnomon
from .plan import Plan, casters_to_survey, load_or_make_plan
from .rasters import UndeclaredNoDataError
from .record import write_record
from .settings import Settings
from .tasks import release_plans, run_task, sum_tile
from .tiled import TiledPlan

#: The calls that a process runs at a time: one prepares and writes while the device works for the other one.
THREADS = 2
#: How often a task that raises, or whose worker dies, is called.
MAX_CALLS = 4
TILES_OF_A_SURVEY = 16
#: The processes that workers="gpus" starts for a GPU where the host has two cores for each: one process keeps a GPU
#: busy for a tenth of its time.
PROCESSES_OF_A_GPU = 4


class StudyStoppedError(RuntimeError):
    """The study could not go on. Tasks that are done are kept: the same call goes on from there."""


#: A key that names the call, a function and its arguments.
Call = tuple[Any, Callable[..., Any], tuple[Any, ...]]


@dataclass(frozen=True)
class Execution:
    """How a study is computed. No answer depends on it.

    workers: None: this process. N: N processes of this host. Names of devices as in gnomon.use(): a process for each
        name, which may come several times. "gpus": up to 4 processes for each GPU of this host, one for two of its
        cores. "tcp://...": the address of a dask scheduler.
    client: a distributed.Client that you have.
    device: for all workers: a name as in gnomon.use().
    tiles: only these receiver tiles, for job arrays. Jobs may share a folder once one has made the plan.
    restart: begin again, and drop the study that is in the folder.
    check: read the chunks of done tasks, and compute damaged ones again.
    progress: show a bar.
    """

    workers: int | str | Sequence[str] | None = None
    client: Any = None
    device: str | None = None
    tiles: slice | None = None
    restart: bool = False
    check: bool = True
    progress: bool = False

    def __post_init__(self) -> None:
        workers = self.workers
        are_names = isinstance(workers, str | list | tuple) and all(isinstance(name, str) for name in workers)
        is_number = isinstance(workers, int) and not isinstance(workers, bool) and workers >= 0
        if not (workers is None or are_names or is_number):
            raise ValueError(f'workers: {workers!r} is no number of processes, nor "gpus", names or an address')
        if not isinstance(self.tiles, slice | None):
            raise ValueError(f"tiles: {self.tiles!r} is no slice: slice(16, 32) are the receiver tiles from 16 to 31")


class LocalExecutor:
    """Runs calls in this process, THREADS at a time. They end in any order."""

    def __init__(self, device: str | None = None) -> None:
        self.device = device

    def run(self, calls: Iterable[Call]) -> Iterator[tuple[Any, Any]]:
        waiting = iter(calls)
        pending: dict[Future[Any], Any] = {}
        pool = ThreadPoolExecutor(THREADS, thread_name_prefix="gnomon-study")
        try:
            while True:
                for call in itertools.islice(waiting, THREADS - len(pending)):
                    pending[pool.submit(call_with_retries, *call)] = call[0]
                if not pending:
                    return
                for future in wait(pending, return_when=FIRST_COMPLETED).done:
                    yield pending.pop(future), future.result()
        finally:
            pool.shutdown(cancel_futures=True)


def call_with_retries(key: Any, function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    failures = 0
    while True:
        try:
            return function(*arguments)
        except UndeclaredNoDataError:
            raise
        except Exception as error:
            failures += 1
            if _is_final(error) or failures >= MAX_CALLS:
                raise _stopped(key, error) from error


class DaskExecutor:
    """Runs calls on a dask cluster, two per thread at a time. A call whose worker dies is given to another worker."""

    def __init__(self, client: Any, device: str | None = None) -> None:
        self.client = client
        self.device = device

    def run(self, calls: Iterable[Call]) -> Iterator[tuple[Any, Any]]:
        from distributed import as_completed

        waiting = iter(calls)
        pending: dict[Any, tuple[Call, int]] = {}
        done = as_completed()

        def submit(call: Call, failures: int = 0) -> None:
            future = self.client.submit(call[1], *call[2], pure=False)
            pending[future] = call, failures
            done.add(future)

        max_pending = 2 * max(sum(self.client.nthreads().values()), 1)
        for call in itertools.islice(waiting, max_pending):
            submit(call)
        try:
            for future in done:
                call, failures = pending.pop(future)
                if future.status == "finished":
                    yield call[0], future.result()
                    for next_call in itertools.islice(waiting, 1):
                        submit(next_call)
                    continue
                error = (
                    future.exception() if future.status == "error" else RuntimeError(f"the call was {future.status}")
                )
                if isinstance(error, UndeclaredNoDataError):
                    raise error
                if failures + 1 >= MAX_CALLS or _is_final(error):
                    raise _stopped(call[0], error) from error
                submit(call, failures + 1)
        finally:
            self.client.cancel(list(pending))


def _is_final(error: BaseException) -> bool:
    """Whether another call can only fail in the same way."""
    return isinstance(error, ValueError | TypeError) or (
        isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EFBIG)
    )


def _stopped(key: Any, error: BaseException) -> StudyStoppedError:
    text = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        text = f"{error.strerror}: {error.filename or 'the study folder'}: make room"
    if isinstance(error, ValueError):  # of the input: the same study would stop at the same place
        return StudyStoppedError(f"{error} (task {key})")
    return StudyStoppedError(
        f"task {key} failed: {text}. Tasks that are done are kept: run the same study again to go on"
    )


@contextlib.contextmanager
def executor_of(execution: Execution) -> Iterator[LocalExecutor | DaskExecutor]:
    """What runs the calls of a study. Clusters that it starts end with the context. Raises StudyStoppedError in a
    thread that outlives the main one: Python then starts no threads, which all of this needs."""
    workers = execution.workers
    is_remote = execution.client is not None or (isinstance(workers, str) and "://" in workers)
    if workers and not is_remote:
        _require_main_guard()
    try:
        with _executor_of(execution) as executor:
            yield executor
    except RuntimeError as error:
        if _takes_threads():
            raise
        raise StudyStoppedError(
            "the program's main thread has ended, and a study in another thread cannot go on without it: wait for that "
            "thread (thread.join()). Tasks that are done are kept: run the same study again to go on"
        ) from error


def _takes_threads() -> bool:
    """False once the main thread has ended."""
    try:
        with ThreadPoolExecutor(1) as pool:
            pool.submit(int)
    except RuntimeError:
        return False
    return True


@contextlib.contextmanager
def _executor_of(execution: Execution) -> Iterator[LocalExecutor | DaskExecutor]:
    workers, device = execution.workers, execution.device
    if execution.client is not None:
        yield DaskExecutor(execution.client, device)
        return
    if workers is None or workers == 0:
        _gnomon.require_unforked()
        yield LocalExecutor(device)
        return
    import dask
    from distributed import Client

    if isinstance(workers, str) and "://" in workers:
        with Client(workers) as remote:
            yield DaskExecutor(remote, device)
        return
    names = _devices_of(workers, device)
    config = {"distributed.scheduler.allowed-failures": 10, "distributed.worker.memory.terminate": False}
    with dask.config.set(config), _cluster(names) as cluster, Client(cluster) as local:
        local.wait_for_workers(len(names))
        yield DaskExecutor(local, None)


def _require_main_guard() -> None:
    """Worker processes import the program that runs, and would start the study again where no guard keeps them out."""
    main = sys.modules["__main__"]
    file = getattr(main, "__file__", None)
    if multiprocessing.current_process().daemon:
        raise RuntimeError(
            "workers=: a process of multiprocessing.Pool or of a dask worker may start none: leave workers= out, or "
            "take concurrent.futures.ProcessPoolExecutor"
        )
    if main.__spec__ is None and file is not None and not os.path.exists(file):
        raise RuntimeError(f"workers=: worker processes import the program, and {file} is no file: write it into one")
    frame: FrameType | None = sys._getframe()
    while frame is not None and not (frame.f_globals is main.__dict__ and frame.f_code.co_name == "<module>"):
        frame = frame.f_back
    is_in_thread = threading.current_thread() is not threading.main_thread()
    if file is None or (frame is None and not is_in_thread) or not os.path.isfile(file):
        return
    for statement in ast.parse(Path(file).read_bytes()).body:
        if isinstance(statement, ast.If) and "__name__" in ast.dump(statement.test):
            return
        if frame is not None and statement.lineno <= frame.f_lineno <= (statement.end_lineno or 0):
            raise RuntimeError(
                f"{file}, line {frame.f_lineno}: the worker processes of workers= import this program and would run "
                'this line again: put it below if __name__ == "__main__":'
            )
    if is_in_thread and main.__spec__ is None:
        raise RuntimeError(
            f"{file}: the worker processes of workers= import this program and would start its thread again: put what "
            'starts it below if __name__ == "__main__":'
        )


def _devices_of(workers: int | str | Sequence[str], device: str | None) -> list[str | None]:
    if isinstance(workers, int):
        return [device] * workers
    if isinstance(workers, str) and workers != "gpus":
        return [workers]
    if workers != "gpus":
        return list(workers)
    from .._devices import devices

    gpus: list[str | None] = [d.selector for d in devices() if d.type == "GPU"]
    if not gpus:
        raise ValueError('workers: "gpus": this host has no GPU with an OpenCL driver (gnomon.devices() lists devices)')
    cores_of_each = (os.cpu_count() or 1) // len(gpus)
    return gpus * min(max(cores_of_each // 2, 1), PROCESSES_OF_A_GPU)


def _forget_what_drivers_set() -> None:
    """Makes the environment that processes inherit the one that Python knows. OpenCL drivers change that of the process
    which loads them (PoCL sets HWLOC_PLUGINS_PATH)."""
    program = [sys.executable, "-S", "-c", "import json, os; print(json.dumps(dict(os.environ)))"]
    inherited = json.loads(subprocess.run(program, stdout=subprocess.PIPE, check=True).stdout)
    for name in inherited.keys() - os.environ.keys():
        os.unsetenv(name)
    for name, value in os.environ.items():
        if inherited.get(name) != value:
            os.putenv(name, value)


def _cluster(names: list[str | None]) -> Any:
    """A process for each device of this host; a process that dies is started again."""
    from distributed import Nanny, Scheduler, SpecCluster

    _forget_what_drivers_set()
    cores = max(1, (os.cpu_count() or 1) // len(names))
    # GDAL's own choice is a twentieth of the machine's memory in each process.
    cache = os.environ.get("GDAL_CACHEMAX", "256")
    options = {}
    for i, name in enumerate(names):
        env = {"POCL_MAX_PTHREAD_COUNT": str(cores), "GDAL_CACHEMAX": cache}
        device_env = {"GNOMON_DEVICE": name} if name else {}
        options[i] = {
            "cls": Nanny,
            "options": {
                "nthreads": THREADS,
                "env": env | device_env,
                "memory_limit": 0,
                "dashboard": False,
                "silence_logs": 40,
            },
        }
    scheduler = {"cls": Scheduler, "options": {"dashboard_address": None, "host": "127.0.0.1", "port": 0}}
    return SpecCluster(workers=options, scheduler=scheduler, silence_logs=40)


def survey_tiles(folder: str, tiles: list[int]) -> list[tuple[int, Any]]:
    casters = casters_to_survey(folder)
    return [(tile, casters.surveyed(tile)) for tile in tiles]


def run_study(folder: Path, settings: Settings, execution: Execution, executor: LocalExecutor | DaskExecutor) -> Plan:
    """Plans, computes missing tasks, and writes the record. Raises ValueError or StudyStoppedError."""

    def run_survey(study_folder: str, tiles: Iterable[int]) -> Iterator[tuple[int, Any]]:
        waiting = list(tiles)
        groups = [waiting[i : i + TILES_OF_A_SURVEY] for i in range(0, len(waiting), TILES_OF_A_SURVEY)]
        for _, surveyed in executor.run((f"survey {g[0]}", survey_tiles, (study_folder, g)) for g in groups):
            yield from surveyed

    folder.mkdir(parents=True, exist_ok=True)
    plan = load_or_make_plan(folder, settings, run_survey, execution.restart)
    run_plan(plan, execution, executor)
    return plan


def run_plan(plan: TiledPlan, execution: Execution, executor: LocalExecutor | DaskExecutor) -> None:
    """Computes missing tasks, and writes the record."""
    tiles = range(len(plan.receivers))[execution.tiles or slice(None)]
    check = execution.check
    try:
        for _ in range(2):  # tasks that lacked a caster tile run once more
            if not _run_blocks(plan, tiles, executor, check, execution.progress):
                break
            check = False
        _run_sums(plan, tiles, executor)
    finally:
        release_plans()
    record = write_record(plan)
    if record["tasks_done"] == record["tasks"] > 0 and record["decisions"] == 0 and not record.get("unread_casters"):
        text = "no place of the study has data, so it has no answers"
        warnings.warn(f"{text}: see what the rasters hold (gdalinfo -stats)", stacklevel=2)


def missing_tasks(plan: TiledPlan, tiles: Iterable[int], check: bool) -> list[tuple[int, int]]:
    """Tasks that are not done, or whose chunks are not the ones that they wrote, or that lacked a caster tile."""
    missing = []
    for tile in tiles:
        for block in range(len(plan.blocks)):
            facts = plan.store.done(tile, block, plan.hash)
            if facts is None or facts["unread"] or (check and plan.store.changed_chunks(facts)):
                missing.append((tile, block))
    return missing


def _run_blocks(
    plan: TiledPlan, tiles: Iterable[int], executor: LocalExecutor | DaskExecutor, check: bool, progress: bool
) -> bool:
    """Runs the missing tasks. Returns whether any of them lacked a caster tile. The bar counts decisions, receivers x
    suns, or x observers."""
    from tqdm import tqdm

    missing = missing_tasks(plan, tiles, check)
    decisions = {f"tile {t}, block {b}": plan.receivers_of_tile(t) * plan.size_of_block(b) for t, b in missing}
    calls = (
        (f"tile {t}, block {b}", run_task, (str(plan.folder), plan.hash, t, b, executor.device)) for t, b in missing
    )
    has_unread = False
    with tqdm(
        total=sum(decisions.values()), unit=" decisions", unit_scale=True, disable=not progress, file=sys.stderr,
        smoothing=0.1,
    ) as bar:  # fmt: skip
        for key, facts in executor.run(calls):
            bar.update(decisions[key])
            has_unread = has_unread or bool(facts["unread"])
    return has_unread


def _run_sums(plan: TiledPlan, tiles: Iterable[int], executor: LocalExecutor | DaskExecutor) -> None:
    if not plan.has_sums:
        return
    calls = []
    for tile in tiles:
        facts = plan.store.done(tile, None, plan.hash)
        if (
            facts is None
            or facts["of"] != plan.hash_of_blocks(tile)
            or facts["unread"]
            or plan.store.changed_chunks(facts)
        ):
            calls.append((f"sums of tile {tile}", sum_tile, (str(plan.folder), plan.hash, tile)))
    for _ in executor.run(calls):
        pass
