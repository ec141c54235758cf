# SPDX-License-Identifier: MIT
"""A task decides a tile of receivers x a block of suns and writes its chunks; a last task of a tile adds its sums."""

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
from .energy import ENERGIES, energies, kilowatt_hours, true_normals
from .plan import Plan, facts_in
from .planes import Planes
from .receivers import TileOfReceivers
from .viewshed_plan import ViewshedPlan

_lock = threading.Lock()
#: By name, `array@leading index`, with the leading index.
Values = dict[str, tuple[int, NDArray[Any]]]


def plan_in(folder: Path, device: str | None = None) -> Plan | ViewshedPlan:
    """The plan in a study's folder, of suns or of a viewshed. Raises ValueError if the folder holds no study."""
    facts = facts_in(folder)
    return ViewshedPlan(folder, facts, device) if facts.get("kind") == "viewshed" else Plan.open(folder, device)


def open_plan(folder: str, plan_hash: str, device: str | None) -> Plan | ViewshedPlan:
    """The plan in a study's folder, opened once per process and survey."""
    survey = Path(folder) / "survey.npz"
    with _lock:
        plan = _opened_plan(folder, device, survey.stat().st_mtime_ns if survey.exists() else 0, plan_hash)
    if plan.hash != plan_hash:
        raise ValueError(f"{folder}: another run made a new plan while this run was working")
    return plan


@functools.lru_cache(maxsize=2)
def _opened_plan(folder: str, device: str | None, survey_time: int, plan_hash: str) -> Plan | ViewshedPlan:
    return plan_in(Path(folder), device)


def release_plans() -> None:
    """Frees what the last tasks of this process left for the next ones: a scene and its BVH."""
    with _lock:
        _opened_plan.cache_clear()


def run_task(folder: str, plan_hash: str, tile: int, block: int, device: str | None = None) -> dict[str, Any]:
    """Computes and writes a task, then its file. Returns the facts in it."""
    start = time.perf_counter()
    plan = open_plan(folder, plan_hash, device)
    values, facts = computed(plan, tile, block)
    chunks = {}
    for name, (leading, array) in values.items():
        indices = (leading, *plan.receivers.slices(tile))
        chunk = (leading, *plan.receivers.key(tile))
        key = f"{name.split('@')[0]}/c/{'/'.join(map(str, chunk))}"
        chunks[key] = plan.store.write(name.split("@")[0], indices, array, chunk)
    facts |= {"plan": plan.hash, "chunks": chunks, "seconds": round(time.perf_counter() - start, 3)}
    facts |= {"device": plan.device_name, "host": platform.node()}
    plan.store.mark_done(tile, block, facts)
    return facts


def computed(plan: Plan | ViewshedPlan, tile: int, block: int) -> tuple[Values, dict[str, Any]]:
    """The values that a task writes, by name (`array@leading index`), with the leading index; and facts for its
    file."""
    return plan.compute(tile, block) if isinstance(plan, ViewshedPlan) else compute_task(plan, tile, block)


def compute_task(plan: Plan, tile: int, block: int) -> tuple[Values, dict[str, Any]]:
    """computed() for suns."""
    suns, words = plan.suns, plan.blocks[block]
    suns_of_block = np.flatnonzero(np.isin(suns.word, words))
    receivers = plan.tile(tile)
    shape = tuple(s.stop - s.start for s in plan.receivers.slices(tile))
    count = len(receivers.is_valid)
    wants_bits = "bits" in plan.settings.outputs
    packed = np.zeros((2, len(words) if wants_bits else 0, count), np.uint32)
    sums = {(k, o): np.zeros(count, np.int64) for k in (0, 1) for o in plan.settings.outputs if o != "bits"}
    per_sun = {"hours": suns.seconds, "weights": suns.weights}
    row_of_word = np.zeros(suns.word_count, np.int64)
    row_of_word[words] = np.arange(len(words))
    bits = 32 * row_of_word[suns.word] + suns.bit
    unread, decisions = set(receivers.unread), 0

    def add(
        rows: NDArray[np.int64],
        chosen: NDArray[np.int64],
        answers: tuple[Planes | None, Planes | None],
        normals: NDArray[np.float64] | None = None,
    ) -> None:
        columns = slice(None) if len(rows) == count else rows
        for k, answer in enumerate(answers):
            if answer is None:
                continue
            if wants_bits:
                packed[k][:, columns] = planes.moved(answer, bits[chosen], len(words))
            found = energies(answer, normals, suns, chosen) if plan.settings.weather else {}
            for output in plan.settings.outputs:
                if output != "bits":
                    of_suns = found[output] if found else planes.weighed(answer, per_sun[output][chosen])
                    sums[k, output][columns] = of_suns

    for part in receivers.parts:
        towards = suns.towards[suns.zone_row(part.zone)]
        chosen = suns_of_block[np.isfinite(towards[suns_of_block, 0])]
        if len(chosen) == 0:
            continue
        chosen = chosen[np.argsort(bits[chosen], kind="stable")]  # in the order of the words that are written
        answer = plan.decider.decide(part, towards[chosen], suns.centre(part.zone))
        normals = true_normals(part, suns.to_map[suns.zone_row(part.zone)]) if plan.settings.weather else None
        unread |= set(answer.unread)
        decisions += len(part.rows) * len(chosen)
        add(part.rows, chosen, (answer.lit, answer.undecided), normals)
    _add_unknown(plan, receivers, suns_of_block[np.argsort(bits[suns_of_block], kind="stable")], add)
    values: Values = {}
    for k, name in enumerate(("lit", "undecided")):
        for w, plane in zip(words if wants_bits else (), packed[k], strict=True):
            values[f"results.zarr/{name}@{w}"] = (int(w), plane.reshape(shape))
    for (k, output), total in sums.items():
        values[f"partials.zarr/{('lit', 'undecided')[k]}_{output}@{block}"] = (block, total.reshape(shape))
    open_answers = int(np.bitwise_count(packed[1]).sum())
    open_receivers = sum(int((array != 0).sum()) for (k, _), array in sums.items() if k == 1)
    undecided = open_answers if wants_bits else open_receivers
    return values, {"decisions": decisions, "undecided": undecided, "unread": sorted(unread)}


def _add_unknown(plan: Plan, receivers: TileOfReceivers, suns_of_block: NDArray[np.int64], add: Any) -> None:
    """Adds that every sun is undecided for receivers that could not be read."""
    rows = np.flatnonzero(receivers.is_unknown)
    for zone in np.unique(receivers.zones[rows], axis=0):
        rows_of_zone = rows[(receivers.zones[rows] == zone).all(axis=1)]
        towards = plan.suns.towards[plan.suns.zone_row((int(zone[0]), int(zone[1])))]
        chosen = suns_of_block[np.isfinite(towards[suns_of_block, 0])]
        if len(chosen):
            add(rows_of_zone, chosen, (None, planes.ones(len(chosen), len(rows_of_zone))))


def sum_tile(folder: str, plan_hash: str, tile: int) -> dict[str, Any]:
    """Adds the partial sums of a tile's blocks, and writes them."""
    plan = open_plan(folder, plan_hash, None)
    slices, key = plan.receivers.slices(tile), plan.receivers.key(tile)
    sums, unread = (plan.sums(tile), []) if isinstance(plan, ViewshedPlan) else _sums_of_suns(plan, tile)
    chunks = {}
    for name, values in sums.items():
        array = f"results.zarr/{name}"
        chunks[f"{array}/c/{'/'.join(map(str, key))}"] = plan.store.write(array, slices, values, key)
    facts = {"plan": plan.hash, "chunks": chunks, "of": plan.hash_of_blocks(tile), "unread": unread}
    plan.store.mark_done(tile, None, facts)
    return facts


def _sums_of_suns(plan: Plan, tile: int) -> tuple[dict[str, NDArray[Any]], list[int]]:
    """Hours, sums of weights and energies of a tile, each rounded once; and the caster tiles that it lacked."""
    slices = plan.receivers.slices(tile)
    receivers = plan.tile(tile)
    is_valid = receivers.is_valid.reshape(tuple(s.stop - s.start for s in slices))
    sums = {}
    for output in plan.settings.outputs:
        if output == "bits":
            continue
        for part, name in (("lit", {"hours": "sun_hours", "weights": "sum_of_weights"}.get(output, output)),
                           ("undecided", f"undecided_{output}")):  # fmt: skip
            partial = plan.store.array(f"partials.zarr/{part}_{output}")
            total = np.zeros(is_valid.shape, np.int64)
            for block in range(len(plan.blocks)):
                total += partial[(block, *slices)]
            values: NDArray[Any]
            if output == "hours":
                values = (total / (3600.0 * plan.suns.samples)).astype(np.float32)
            elif output in ENERGIES:
                values = kilowatt_hours(total)
            else:
                values = np.ldexp(total.astype(np.float64), plan.suns.exponent)
            values[~is_valid] = np.nan
            sums[name] = values
    return sums, sorted(receivers.unread)
