# SPDX-License-Identifier: MIT
"""What runs, records and verifies tasks needs of a plan: tiles of receivers x blocks of suns or of observers."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .receivers import Receivers
from .store import Store


class TiledPlan:
    """hash: names the plan; tasks that were done under another plan are done again. results: names of the arrays of
    results. has_sums: each tile has a last task, which adds what its blocks have found."""

    folder: Path
    facts: dict[str, Any]
    hash: str
    store: Store
    receivers: Receivers
    blocks: Sequence[Any]
    results: list[str]
    has_sums: bool

    @property
    def tasks(self) -> list[tuple[int, int]]:
        """All (tile, block)."""
        return [(tile, block) for tile in range(len(self.receivers)) for block in range(len(self.blocks))]

    def receivers_of_tile(self, tile: int) -> int:
        return math.prod(s.stop - s.start for s in self.receivers.slices(tile))

    def size_of_block(self, block: int) -> int:
        """The suns or observers of a block."""
        raise NotImplementedError

    @property
    def device_name(self) -> str:
        raise NotImplementedError

    def own_record(self, unread: list[int]) -> dict[str, Any]:
        """What the record of the study says, beside what it says of all tasks. unread: caster tiles."""
        raise NotImplementedError

    def hash_of_blocks(self, tile: int) -> str:
        """A hash of the values in the tile's blocks: sums with another hash are out of date."""
        done = [self.store.done(tile, block, self.hash) for block in range(len(self.blocks))]
        text = json.dumps([facts and {k: v["data"] for k, v in facts["chunks"].items()} for facts in done])
        return hashlib.sha256(text.encode()).hexdigest()
