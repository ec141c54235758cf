# SPDX-License-Identifier: MIT
"""One task: a tile of receivers x a block of suns, read, decided and written; and the sums of a tile."""

from __future__ import annotations

import functools
import platform
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .plan import Plan
from .receivers import TileOfReceivers

#: Receivers that are packed at once stay in the cache.
ROWS_AT_ONCE = 4096


def opened(folder: str, plan_hash: str, device: str | None) -> Plan:
    """The plan, once per process and survey."""
    plan = _opened(folder, device, (Path(folder) / "survey.npz").stat().st_mtime_ns, plan_hash)
    if plan.hash != plan_hash:
        raise ValueError(f"{folder}: its plan was made anew while this run was going")
    return plan


@functools.lru_cache(maxsize=2)
def _opened(folder: str, device: str | None, survey_time: int, plan_hash: str) -> Plan:
    return Plan.open(Path(folder), device)


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
    receivers = plan.receivers.tile(tile)
    shape = tuple(s.stop - s.start for s in plan.receivers.slices(tile))
    count = len(receivers.is_valid)
    wants_bits = "bits" in plan.settings.outputs
    packed = {(k, int(w)): np.zeros(count, np.uint32) for k in (0, 1) for w in (words if wants_bits else [])}
    sums = {(k, o): np.zeros(count, np.int64) for k in (0, 1) for o in plan.settings.outputs if o != "bits"}
    per_sun = {"hours": suns.seconds, "weights": suns.weights}
    unread, decisions = set(receivers.unread), 0

    def add(rows: NDArray[np.int64], chosen: NDArray[np.int64], answers: tuple[Any, Any]) -> None:
        for k, answer in enumerate(answers):
            if not answer.any():
                continue
            for w in words if wants_bits else ():
                columns = np.flatnonzero(suns.word[chosen] == w)
                if len(columns):
                    packed[k, int(w)][rows] = _packed(answer, columns, suns.bit[chosen[columns]])
            for output in plan.settings.outputs:
                if output != "bits":
                    sums[k, output][rows] = _weighed(answer, per_sun[output][chosen])

    for part in receivers.parts:
        towards = suns.towards[suns.zone_row(part.zone)]
        chosen = of_block[np.isfinite(towards[of_block, 0])]
        if len(chosen) == 0:
            continue
        chosen = chosen[np.argsort(np.arctan2(towards[chosen, 0], towards[chosen, 1]), kind="stable")]
        answer = plan.decider.decide(part, towards[chosen], suns.centre(part.zone))
        unread |= set(answer.unread)
        decisions += answer.lit.size
        add(part.rows, chosen, (answer.lit, answer.undecided))
    _add_unknown(plan, receivers, of_block, add)
    values: dict[str, tuple[int, NDArray[Any]]] = {}
    for (k, w), words_of_suns in packed.items():
        values[f"results.zarr/{('lit', 'undecided')[k]}@{w}"] = (w, words_of_suns.reshape(shape))
    for (k, output), total in sums.items():
        values[f"partials.zarr/{('lit', 'undecided')[k]}_{output}@{block}"] = (block, total.reshape(shape))
    open_answers = sum(int(np.bitwise_count(array).sum()) for (k, _), array in packed.items() if k == 1)
    open_receivers = sum(int((array != 0).sum()) for (k, _), array in sums.items() if k == 1)
    undecided = open_answers if wants_bits else open_receivers
    return values, {"decisions": decisions, "undecided": undecided, "unread": sorted(unread)}


def _packed(answer: NDArray[np.bool_], columns: NDArray[np.int64], bits: NDArray[np.int64]) -> NDArray[np.uint32]:
    """One word per row, with the columns' answers at these bits."""
    result = np.empty(len(answer), np.uint32)
    for first in range(0, len(answer), ROWS_AT_ONCE):
        rows = answer[first : first + ROWS_AT_ONCE]
        spread = np.zeros((len(rows), 32), np.uint8)
        spread[:, bits] = rows[:, columns]
        result[first : first + len(rows)] = np.packbits(spread, axis=1, bitorder="little").view("<u4")[:, 0]
    return result


def _weighed(answer: NDArray[np.bool_], weights: NDArray[np.int64]) -> NDArray[np.int64]:
    """The exact sum of each row's whole weights."""
    if len(weights) and (weights == weights[0]).all():
        return np.asarray(np.bitwise_count(np.packbits(answer, axis=1)).sum(axis=1, dtype=np.int64) * weights[0])
    result: NDArray[np.int64] = np.zeros(len(answer), np.int64)
    for column in range(answer.shape[1]):
        result += answer[:, column] * weights[column]
    return result


def _add_unknown(plan: Plan, receivers: TileOfReceivers, of_block: NDArray[np.int64], add: Any) -> None:
    """All suns of receivers that could not be read are undecided."""
    rows = np.flatnonzero(receivers.is_unknown)
    for zone in np.unique(receivers.zones[rows], axis=0):
        here = rows[(receivers.zones[rows] == zone).all(axis=1)]
        towards = plan.suns.towards[plan.suns.zone_row((int(zone[0]), int(zone[1])))]
        chosen = of_block[np.isfinite(towards[of_block, 0])]
        if len(chosen):
            yes = np.ones((len(here), len(chosen)), bool)
            add(here, chosen, (~yes, yes))


def sum_tile(folder: str, plan_hash: str, tile: int) -> dict[str, Any]:
    """Adds the partial sums of a tile's blocks, rounds once, and writes its hours and sums of weights."""
    plan = opened(folder, plan_hash, None)
    at, key = plan.receivers.slices(tile), plan.receivers.key(tile)
    receivers = plan.receivers.tile(tile)
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
