# SPDX-License-Identifier: MIT
"""Runs the tasks of a study in this process or by dask, until all are done or one cannot be."""

from __future__ import annotations

import contextlib
import errno
import itertools
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from pathlib import Path
from typing import Any

from . import plan as plans
from .plan import Plan
from .record import write_record
from .settings import Settings
from .tasks import forget, run_task, sum_tile

#: Calls of a process at a time: one prepares and writes while the device works for the other one.
THREADS = 2
#: Tries of a task that raises, or whose worker dies.
TRIES = 4
TILES_OF_A_SURVEY = 16


class StudyStoppedError(RuntimeError):
    """The study could not go on. What is done is kept: the same call goes on from there."""


Call = tuple[Any, Callable[..., Any], tuple[Any, ...]]


class Here:
    """Runs calls in this process, two at a time, so that one prepares and writes while the device works for the other
    one. They end in any order."""

    def __init__(self, device: str | None = None) -> None:
        self.device = device

    def run(self, calls: Iterable[Call]) -> Iterator[tuple[Any, Any]]:
        waiting = iter(calls)
        pending: dict[Future[Any], Any] = {}
        pool = ThreadPoolExecutor(THREADS, thread_name_prefix="gnomon-study")
        try:
            while True:
                for call in itertools.islice(waiting, THREADS - len(pending)):
                    pending[pool.submit(_tried, *call)] = call[0]
                if not pending:
                    return
                for future in wait(pending, return_when=FIRST_COMPLETED).done:
                    yield pending.pop(future), future.result()
        finally:
            pool.shutdown(cancel_futures=True)


def _tried(key: Any, function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    failures = 0
    while True:
        try:
            return function(*arguments)
        except Exception as error:
            failures += 1
            if _is_final(error) or failures >= TRIES:
                raise _stopped(key, error) from error


class Dask:
    """Runs calls on a dask cluster, a few per worker at a time. A call whose worker dies is given to another one."""

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

        at_once = 2 * max(sum(self.client.nthreads().values()), 1)
        for call in itertools.islice(waiting, at_once):
            submit(call)
        try:
            for future in done:
                call, failures = pending.pop(future)
                if future.status == "finished":
                    yield call[0], future.result()
                    for following in waiting:
                        submit(following)
                        break
                    continue
                error = (
                    future.exception() if future.status == "error" else RuntimeError(f"the call was {future.status}")
                )
                if failures + 1 >= TRIES or _is_final(error):
                    raise _stopped(call[0], error) from error
                submit(call, failures + 1)
        finally:
            self.client.cancel(list(pending))


def _is_final(error: BaseException) -> bool:
    """Whether another try can only fail the same way."""
    return isinstance(error, ValueError | TypeError) or (
        isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EFBIG)
    )


def _stopped(key: Any, error: BaseException) -> StudyStoppedError:
    text = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        text = f"{error.strerror}: {error.filename or 'the study folder'}: make room"
    return StudyStoppedError(f"task {key} failed: {text}. What is done is kept: run the same study again to go on")


@contextlib.contextmanager
def workers_of(workers: int | str | Sequence[str] | None, client: Any, device: str | None) -> Iterator[Here | Dask]:
    """What runs the calls: a dask client somebody has, its scheduler's address, a number of processes of this host,
    "gpus" or devices by name (one process each), or this process."""
    if client is not None:
        yield Dask(client, device)
        return
    if workers in (None, 0):
        yield Here(device)
        return
    import dask
    from distributed import Client

    if isinstance(workers, str) and "://" in workers:
        with Client(workers) as remote:
            yield Dask(remote, device)
        return
    names = _devices_of(workers, device)
    config = {"distributed.scheduler.allowed-failures": 10, "distributed.worker.memory.terminate": False}
    with dask.config.set(config), _cluster(names) as cluster, Client(cluster) as local:
        local.wait_for_workers(len(names))
        yield Dask(local, None)


def _devices_of(workers: int | str | Sequence[str], device: str | None) -> list[str | None]:
    if isinstance(workers, int):
        return [device] * workers
    if isinstance(workers, str) and workers != "gpus":
        return [workers]
    if workers != "gpus":
        return list(workers)
    from .._devices import devices

    found: list[str | None] = [d.selector for d in devices() if d.type == "GPU"]
    if not found:
        raise ValueError('workers: "gpus": this host has no GPU with an OpenCL driver (gnomon.devices() lists devices)')
    return found


def _cluster(names: list[str | None]) -> Any:
    """A process for each device of this host; one that dies is started again."""
    from distributed import Nanny, Scheduler, SpecCluster

    cores = max(1, (os.cpu_count() or 1) // len(names))
    options = {}
    for i, name in enumerate(names):
        env = {"POCL_MAX_PTHREAD_COUNT": str(cores)}
        of_device = {"GNOMON_DEVICE": name} if name else {}
        options[i] = {
            "cls": Nanny,
            "options": {
                "nthreads": THREADS,
                "env": env | of_device,
                "memory_limit": 0,
                "dashboard": False,
                "silence_logs": 40,
            },
        }
    scheduler = {"cls": Scheduler, "options": {"dashboard_address": None, "host": "127.0.0.1", "port": 0}}
    return SpecCluster(workers=options, scheduler=scheduler, silence_logs=40)


def survey_tiles(folder: str, tiles: list[int]) -> list[tuple[int, Any]]:
    casters = plans.casters_to_survey(folder)
    return [(tile, casters.surveyed(tile)) for tile in tiles]


def run_study(
    folder: Path,
    settings: Settings,
    executor: Here | Dask,
    tiles: slice | None = None,
    restart: bool = False,
    check: bool = True,
    show_progress: bool = False,
) -> Plan:
    """Plans, computes what is missing, and writes the record. Raises ValueError or StudyStoppedError."""

    def run_survey(at: str, wanted: Iterable[int]) -> Iterator[tuple[int, Any]]:
        todo = list(wanted)
        groups = [todo[i : i + TILES_OF_A_SURVEY] for i in range(0, len(todo), TILES_OF_A_SURVEY)]
        for _, found in executor.run((f"survey {g[0]}", survey_tiles, (at, g)) for g in groups):
            yield from found

    folder.mkdir(parents=True, exist_ok=True)
    plan = plans.made(folder, settings, run_survey, restart)
    chosen = range(len(plan.receivers))[tiles or slice(None)]
    try:
        for _ in range(2):  # what could not be read is tried once more
            if not _run_blocks(plan, chosen, executor, check, show_progress):
                break
            check = False
        _run_sums(plan, chosen, executor)
    finally:
        forget()
    write_record(plan)
    return plan


def missing_tasks(plan: Plan, tiles: Iterable[int], check: bool) -> list[tuple[int, int]]:
    """Tasks that are not done, or whose chunks are not those that they wrote, or that lacked a caster tile."""
    missing = []
    for tile in tiles:
        for block in range(len(plan.blocks)):
            facts = plan.store.done(tile, block, plan.hash)
            if facts is None or facts["unread"] or (check and plan.store.changed_chunks(facts)):
                missing.append((tile, block))
    return missing


def _run_blocks(plan: Plan, tiles: Iterable[int], executor: Here | Dask, check: bool, show_progress: bool) -> bool:
    """Runs the missing tasks; whether some of them lacked a caster tile. The bar counts decisions (receivers x suns),
    and has their rate and the time that is left."""
    from tqdm import tqdm

    missing = missing_tasks(plan, tiles, check)
    decisions = {f"tile {t}, block {b}": plan.receivers_of_tile(t) * plan.suns_of_block(b) for t, b in missing}
    calls = (
        (f"tile {t}, block {b}", run_task, (str(plan.folder), plan.hash, t, b, executor.device)) for t, b in missing
    )
    lacks = False
    with tqdm(
        total=sum(decisions.values()), unit=" decisions", unit_scale=True, disable=not show_progress, file=sys.stderr,
        smoothing=0.1,
    ) as bar:  # fmt: skip
        for key, facts in executor.run(calls):
            bar.update(decisions[key])
            lacks = lacks or bool(facts["unread"])
    return lacks


def _run_sums(plan: Plan, tiles: Iterable[int], executor: Here | Dask) -> None:
    if not plan.has_sums:
        return
    todo = []
    for tile in tiles:
        facts = plan.store.done(tile, None, plan.hash)
        if (
            facts is None
            or facts["of"] != plan.hash_of_blocks(tile)
            or facts["unread"]
            or plan.store.changed_chunks(facts)
        ):
            todo.append((f"sums of tile {tile}", sum_tile, (str(plan.folder), plan.hash, tile)))
    for _ in executor.run(todo):
        pass
