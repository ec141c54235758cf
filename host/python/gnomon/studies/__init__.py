# SPDX-License-Identifier: MIT
"""Studies: many suns over receivers and casters of any extent, by tiles, with a certificate for what is lit.

    result = gnomon.study("town", raster="dsm.tif", start="2026-06-21", end="2026-06-22", step="10min")
    result.picture("town.png")
    result.export("sun_hours.tif")

docs/studies.md has a tutorial, the layout of the results, and what a certificate is. Needs pip install 'gnomon[study]'.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .export import export, picture
from .plan import Plan
from .record import digests, record_of
from .runner import StudyStoppedError, run_study, workers_of
from .settings import Settings, read_toml, settings_of
from .verify import Verified, verify

__all__ = [
    "Execution",
    "Settings",
    "Study",
    "StudyStoppedError",
    "Verified",
    "open_study",
    "read_toml",
    "run",
    "study",
    "verify",
]


class Study:
    """A study in its folder: what study() and open_study() return."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan

    @property
    def folder(self) -> Path:
        return self.plan.folder

    @property
    def record(self) -> dict[str, Any]:
        """What was computed, by what, and the hash of every chunk: record.json, as it is now."""
        return record_of(self.plan)

    def dataset(self) -> Any:
        """The results as an xarray.Dataset, read when they are used: xarray.open_zarr(folder / "results.zarr")."""
        import xarray

        return xarray.open_zarr(self.folder / "results.zarr", consolidated=False)

    def digests(self) -> dict[str, str]:
        """sha256 of each result, decoded: the same for any tiles, workers and devices."""
        return digests(self.plan)

    def export(self, path: str | os.PathLike[str], what: str | None = None) -> list[Path]:
        """Writes a result as GeoTIFF (COG), or as CSV for points: export.export()."""
        return export(self.plan, Path(path), what)

    def picture(self, path: str | os.PathLike[str], what: str | None = None) -> Path:
        """Draws a map of a result with a legend."""
        return picture(self.plan, Path(path), what)

    def verify(self, share: float = 0.05, device: str | None = None, seed: int | None = None) -> Verified:
        """Recomputes a random share and compares bits."""
        return verify(self.folder, share, device, seed)

    def __repr__(self) -> str:
        found = self.record
        return (
            f"<gnomon.Study in {self.folder}: {found['tasks_done']:,} of {found['tasks']:,} tasks, "
            f"{found['decisions']:,} decisions, {found['undecided']:,} undecided>"
        )


@dataclass(frozen=True)
class Execution:
    """How a study is computed: study() has the meaning of each. It changes no answer."""

    workers: int | str | Sequence[str] | None = None
    client: Any = None
    device: str | None = None
    tiles: slice | None = None
    restart: bool = False
    check: bool = True
    progress: bool = False


def study(
    folder: str | os.PathLike[str],
    *,
    workers: int | str | Sequence[str] | None = None,
    client: Any = None,
    device: str | None = None,
    tiles: slice | None = None,
    restart: bool = False,
    check: bool = True,
    progress: bool = False,
    **settings: Any,
) -> Study:
    """Runs a study, or goes on with the one in the folder, and returns it.

    folder: of the study; it is made if it is not there.
    settings: those of gnomon.studies.Settings, by name: raster=, start=, end=, step= and so on.
    workers: None: this process. N: N processes of this host. "gpus", or names of devices as in gnomon.use(): a process
        for each. "tcp://...": a dask scheduler.
    client: a distributed.Client that you have.
    device: for all workers: a name as in gnomon.use().
    tiles: only these receiver tiles, for job arrays. Jobs may share a folder once one has made the plan.
    restart: begin anew, whatever is there.
    check: read what is done already, and compute damaged chunks again.
    progress: show a bar.

    Raises ValueError with the setting's name, StudyStoppedError where the study cannot go on (a full disk, say): the
    same call then goes on from there.
    """
    how = Execution(workers, client, device, tiles, restart, check, progress)
    return run(Path(folder), settings_of(settings), how)


def run(folder: Path, settings: Settings, how: Execution) -> Study:
    """study() with settings that are checked already."""
    with workers_of(how.workers, how.client, how.device) as executor:
        plan = run_study(folder.absolute(), settings, executor, how.tiles, how.restart, how.check, how.progress)
    return Study(plan)


def open_study(folder: str | os.PathLike[str]) -> Study:
    """The study in a folder. Raises ValueError if there is none."""
    return Study(Plan.open(Path(folder).absolute()))
