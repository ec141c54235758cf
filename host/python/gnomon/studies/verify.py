# SPDX-License-Identifier: MIT
"""Recomputes a random share of a study's tasks and compares bits; of a viewshed, follows a sample of lines of sight in
rational arithmetic, too."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from .store import sha256_of_array
from .tasks import computed, plan_in
from .viewshed_plan import ViewshedPlan


class Verified(NamedTuple):
    """tasks: the number of tasks that were recomputed. missing: the number that are not done yet. damaged: chunks whose
    files are not the ones that were written. wrong: chunks for which the recomputed values differ. device: the device
    that recomputed the tasks. lines: the number of lines of sight that rational arithmetic followed. wrong_lines: those
    of them that it decides otherwise."""

    tasks: int
    missing: int
    damaged: list[str]
    wrong: list[str]
    device: str
    lines: int = 0
    wrong_lines: tuple[str, ...] = ()

    @property
    def is_good(self) -> bool:
        return not (self.missing or self.damaged or self.wrong or self.wrong_lines)


def verify(
    folder: Path, share: float = 0.05, device: str | None = None, seed: int | None = None, lines: int = 20
) -> Verified:
    """Checks the files of all chunks, then computes a random share of the tasks, at least one, preferably on another
    device than before; of a viewshed, it follows `lines` lines of sight. It writes nothing. Raises ValueError."""
    if not 0 <= share <= 1:
        raise ValueError(f"share: {share} is not between 0 and 1")
    plan = plan_in(folder, device)
    random = np.random.default_rng(seed)
    done, missing, damaged, wrong = [], 0, [], []
    for tile in range(len(plan.receivers)):
        for block in [*range(len(plan.blocks)), *([None] if plan.has_sums else [])]:
            facts = plan.store.done(tile, block, plan.hash)
            if facts is None:
                missing += 1
                continue
            damaged += plan.store.changed_chunks(facts)
            if block is not None:
                done.append((tile, block, facts))
    count = min(len(done), max(1, round(share * len(done)))) if share else 0
    for i in random.choice(len(done), count, replace=False).tolist() if count else []:
        tile, block, facts = done[i]
        values, _ = computed(plan, tile, block)
        for name, (leading, array) in values.items():
            key = f"{name.split('@')[0]}/c/{'/'.join(map(str, (leading, *plan.receivers.key(tile))))}"
            if facts["chunks"][key]["data"] != sha256_of_array(array):
                wrong.append(key)
    name = plan.device_name if count else "none"
    if not isinstance(plan, ViewshedPlan):
        return Verified(count, missing, damaged, wrong, name)
    tiles = [tile for tile, _, _ in done]
    followed, wrong_lines = plan.wrong_lines(tiles, lines if done else 0, random)
    return Verified(count, missing, damaged, wrong, name, followed, tuple(wrong_lines))
