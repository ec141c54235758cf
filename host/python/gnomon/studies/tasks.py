# SPDX-License-Identifier: MIT
"""One task: a tile of receivers x a block of suns, read, decided and written; and the sums of a tile."""

from __future__ import annotations

import functools
import platform
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import planes
from .plan import Plan
from .planes import Planes
from .receivers import TileOfReceivers

_lock = threading.Lock()


def opened(folder: str, plan_hash: str, device: str | None) -> Plan:
    """The plan, once per process and survey."""
    with _lock:
        plan = _opened(folder, device, (Path(folder) / "survey.npz").stat().st_mtime_ns, plan_hash)
    if plan.hash != plan_hash:
        raise ValueError(f"{folder}: its plan was made anew while this run was going")
    return plan


@functools.lru_cache(maxsize=2)
def _opened(folder: str, device: str | None, survey_time: int, plan_hash: str) -> Plan:
    return Plan.open(Path(folder), device)


def forget() -> None:
    """Frees what the last tasks of this process left for the next ones: a scene and its tree."""
    with _lock:
        _opened.cache_clear()


def run_task(folder: str, plan_hash: str, tile: int, block: int, device: str | None = None) -> dict[str, Any]:
    """Computes and writes a task, then its file. Returns the facts in it."""
    start = time.perf_counter()
    plan = opened(folder, plan_hash, device)
    values, facts = computed(plan, tile, block)
    chunks = {}
    for name, (leading, array) in values.items():
        at = (leading, *plan.receivers.slices(tile))
        chunk = (leading, *plan.receivers.key(tile))
        key = f"{name.split('@')[0]}/c/{'/'.join(map(str, chunk))}"
        chunks[key] = plan.store.write(name.split("@")[0], at, array, chunk)
    facts |= {"plan": plan.hash, "chunks": chunks, "seconds": round(time.perf_counter() - start, 3)}
    facts |= {"device": repr(plan.decider.device), "host": platform.node()}
    plan.store.mark_done(tile, block, facts)
    return facts


def computed(plan: Plan, tile: int, block: int) -> tuple[dict[str, tuple[int, NDArray[Any]]], dict[str, Any]]:
    """What a task writes: names (`array@leading index`) to leading index and values; and facts for its file."""
    suns, words = plan.suns, plan.blocks[block]
    of_block = np.flatnonzero(np.isin(suns.word, words))
    receivers = plan.tile(tile)
    shape = tuple(s.stop - s.start for s in plan.receivers.slices(tile))
    count = len(receivers.is_valid)
    wants_bits = "bits" in plan.settings.outputs
    packed = np.zeros((2, len(words) if wants_bits else 0, count), np.uint32)
    sums = {(k, o): np.zeros(count, np.int64) for k in (0, 1) for o in plan.settings.outputs if o != "bits"}
    per_sun = {"hours": suns.seconds, "weights": suns.weights}
    place = np.zeros(suns.word_count, np.int64)
    place[words] = np.arange(len(words))
    bits = 32 * place[suns.word] + suns.bit
    unread, decisions = set(receivers.unread), 0

    def add(rows: NDArray[np.int64], chosen: NDArray[np.int64], answers: tuple[Planes | None, Planes | None]) -> None:
        at = slice(None) if len(rows) == count else rows
        for k, answer in enumerate(answers):
            if answer is None:
                continue
            if wants_bits:
                packed[k][:, at] = planes.moved(answer, bits[chosen], len(words))
            for output in plan.settings.outputs:
                if output != "bits":
                    sums[k, output][at] = planes.weighed(answer, per_sun[output][chosen])

    for part in receivers.parts:
        towards = suns.towards[suns.zone_row(part.zone)]
        chosen = of_block[np.isfinite(towards[of_block, 0])]
        if len(chosen) == 0:
            continue
        chosen = chosen[np.argsort(bits[chosen], kind="stable")]  # in the order of the words that are written
        answer = plan.decider.decide(part, towards[chosen], suns.centre(part.zone))
        unread |= set(answer.unread)
        decisions += len(part.rows) * len(chosen)
        add(part.rows, chosen, (answer.lit, answer.undecided))
    _add_unknown(plan, receivers, of_block[np.argsort(bits[of_block], kind="stable")], add)
    values: dict[str, tuple[int, NDArray[Any]]] = {}
    for k, name in enumerate(("lit", "undecided")):
        for w, plane in zip(words if wants_bits else (), packed[k], strict=True):
            values[f"results.zarr/{name}@{w}"] = (int(w), plane.reshape(shape))
    for (k, output), total in sums.items():
        values[f"partials.zarr/{('lit', 'undecided')[k]}_{output}@{block}"] = (block, total.reshape(shape))
    open_answers = int(np.bitwise_count(packed[1]).sum())
    open_receivers = sum(int((array != 0).sum()) for (k, _), array in sums.items() if k == 1)
    undecided = open_answers if wants_bits else open_receivers
    return values, {"decisions": decisions, "undecided": undecided, "unread": sorted(unread)}


def _add_unknown(plan: Plan, receivers: TileOfReceivers, of_block: NDArray[np.int64], add: Any) -> None:
    """All suns of receivers that could not be read are undecided."""
    rows = np.flatnonzero(receivers.is_unknown)
    for zone in np.unique(receivers.zones[rows], axis=0):
        here = rows[(receivers.zones[rows] == zone).all(axis=1)]
        towards = plan.suns.towards[plan.suns.zone_row((int(zone[0]), int(zone[1])))]
        chosen = of_block[np.isfinite(towards[of_block, 0])]
        if len(chosen):
            add(here, chosen, (None, planes.ones(len(chosen), len(here))))


def sum_tile(folder: str, plan_hash: str, tile: int) -> dict[str, Any]:
    """Adds the partial sums of a tile's blocks, rounds once, and writes its hours and sums of weights."""
    plan = opened(folder, plan_hash, None)
    at, key = plan.receivers.slices(tile), plan.receivers.key(tile)
    receivers = plan.tile(tile)
    is_valid = receivers.is_valid.reshape(tuple(s.stop - s.start for s in at))
    chunks = {}
    for output in plan.settings.outputs:
        if output == "bits":
            continue
        for part, name in (("lit", {"hours": "sun_hours", "weights": "sum_of_weights"}[output]),
                           ("undecided", f"undecided_{output}")):  # fmt: skip
            partial = plan.store.array(f"partials.zarr/{part}_{output}")
            total = np.zeros(is_valid.shape, np.int64)
            for block in range(len(plan.blocks)):
                total += partial[(block, *at)]
            values: NDArray[Any]
            if output == "hours":
                values = (total / (3600.0 * plan.suns.samples)).astype(np.float32)
            else:
                values = np.ldexp(total.astype(np.float64), plan.suns.exponent)
            values[~is_valid] = np.nan
            full = f"results.zarr/{name}"
            chunks[f"{full}/c/{'/'.join(map(str, key))}"] = plan.store.write(full, at, values, key)
    facts = {"plan": plan.hash, "chunks": chunks, "of": plan.hash_of_blocks(tile), "unread": sorted(receivers.unread)}
    plan.store.mark_done(tile, None, facts)
    return facts
