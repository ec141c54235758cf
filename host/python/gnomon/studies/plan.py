# SPDX-License-Identifier: MIT
"""The plan of a study: it is made once, kept in the study's folder, and opened by every process that works on it."""

from __future__ import annotations

import hashlib
import json
import math
import threading
import warnings
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .casters import LARGEST_SPAN, Casters, Survey, far_from_all, largest_tile
from .decide import Decider
from .energy import ENERGIES
from .rasters import open_mosaic
from .receivers import Receivers, TileOfReceivers, receivers_of, write_points
from .settings import Settings
from .store import Store, create_arrays_of_suns, sha256_of_array, write_whole
from .suns import Suns, suns_of
from .tiled import TiledPlan

#: The finest step that a study chooses by itself is 2^-10 m.
FINEST_EXPONENT = -10
#: In metres: beyond the deepest sea and the highest mountain with a tower, a note asks for the unit.
LOWEST_GROUND, HIGHEST_GROUND = -12_000.0, 12_000.0
#: A coarser step, of 1.6 cm, is warned of.
COARSE_EXPONENT = -6
#: Surveys caster tiles: the study's folder and the tiles -> each tile and what Casters.surveyed() finds of it.
SurveyRun = Callable[[str, Iterable[int]], Iterable[tuple[int, tuple[list[float], float, float, int, str]]]]


def facts_in(folder: Path) -> dict[str, Any]:
    """study.json of a study's folder. Raises ValueError if the folder holds no study."""
    try:
        facts: dict[str, Any] = json.loads((folder / "study.json").read_text())
    except (FileNotFoundError, NotADirectoryError):
        raise ValueError(f"{folder}: holds no study (no study.json): gnomon-study run makes a study") from None
    except json.JSONDecodeError as error:
        raise ValueError(f"{folder}/study.json: {error}: run the study again with restart") from None
    return facts


class Plan(TiledPlan):
    """The settings, casters, survey, suns, receivers and blocks of a study. The lattice's step is 2^exponent."""

    def __init__(self, folder: Path, settings: Settings, facts: dict[str, Any], device: str | None = None) -> None:
        self.folder = folder
        self.settings = settings
        self.facts = facts
        self.exponent = int(facts["exponent"])
        self.hash = str(facts["hash"])
        mosaic = open_mosaic(settings.raster, settings.height_unit) if settings.raster else None
        self.casters = Casters(settings, mosaic)
        self.survey = Survey.load(folder / "survey.npz")
        self.suns = Suns.load(folder / "suns.npz")
        self.receivers: Receivers = receivers_of(settings, self.casters, folder)
        self.blocks = self.suns.blocks(settings.block)
        self.store = Store(folder)
        self.decider = Decider(settings, self.casters, self.survey, self.exponent, device)
        names = {"bits": ["lit", "undecided"], "hours": ["sun_hours", "undecided_hours"],
                 "weights": ["sum_of_weights", "undecided_weights"],
                 **{name: [name, f"undecided_{name}"] for name in ENERGIES}}  # fmt: skip
        self.results = [name for output in settings.outputs for name in names[output]]
        self.has_sums = settings.outputs != ("bits",)
        self._tile: tuple[int, TileOfReceivers] | None = None  # the last tile, which several blocks of suns need
        self._tile_lock = threading.Lock()

    @classmethod
    def open(cls, folder: Path, device: str | None = None) -> Plan:
        """The plan in a study's folder. Raises ValueError if the folder holds no study."""
        facts = facts_in(folder)
        if facts.get("kind") == "viewshed":
            raise ValueError(f"{folder}: holds a viewshed: choose another folder")
        return cls(folder, Settings.from_json(facts["settings"]), facts, device)

    def tile(self, tile: int) -> TileOfReceivers:
        """The receivers of a tile, the same object for the tasks that follow one another."""
        with self._tile_lock:
            if self._tile is not None and self._tile[0] == tile:
                return self._tile[1]
            receivers = self.receivers.tile(tile)
            self._tile = (tile, receivers) if not receivers.unread else None
            return receivers

    def size_of_block(self, block: int) -> int:
        is_up = np.isfinite(self.suns.towards[:, :, 0]).any(axis=0)
        return int((np.isin(self.suns.word, self.blocks[block]) & is_up).sum())

    @property
    def device_name(self) -> str:
        return repr(self.decider.device)

    def own_record(self, unread: list[int]) -> dict[str, Any]:
        s = self.settings
        return {
            "lattice": f"2^{self.exponent} m",
            "reach_metres": self.facts["reach"],
            "diagonal_of_cells": "from south-west to north-east",
            "beyond_the_casters": "nothing stands" if s.outside is None else f"at most {s.outside} m",
            "curvature": f"on, k = {s.refraction_of_ground}" if s.curvature else "off",
            "unread_casters": [self.casters.name(tile) for tile in unread],
            "suns": self.suns.notes,
            "zones": len(self.suns.zones),
        }


def _stamps(settings: Settings) -> dict[str, list[int]]:
    """Size and time of the files that a study reads."""
    result = {}
    for name in (*settings.raster, *settings.meshes, *([settings.weather] if settings.weather else [])):
        path = Path(name)
        if path.exists():
            stat = path.stat()
            result[name] = [stat.st_size, stat.st_mtime_ns]
    return result


def load_or_make_plan(folder: Path, settings: Settings, run_survey: SurveyRun, restart: bool = False) -> Plan:
    """The plan of these settings in the folder, which is made if the folder has none. Caster tiles that could not be
    read are surveyed again. Raises ValueError if the folder holds another study, or a file has changed since."""
    known = folder / "study.json"
    if known.exists() and not restart:
        plan = Plan.open(folder)
        if plan.settings.hash_of_answers() != settings.hash_of_answers():
            raise ValueError(f"{folder}: holds a study with other settings: choose another folder, or give restart")
        changed = [name for name, stamp in _stamps(settings).items() if plan.facts["stamps"].get(name) != stamp]
        unread = np.flatnonzero(plan.survey.unread)
        if changed and not len(unread) and not _has_unread_tasks(plan):
            raise ValueError(f"{changed[0]}: has changed since the study began: choose another folder, or give restart")
        if settings.memory_limit != plan.settings.memory_limit or changed:
            plan.facts["settings"]["memory_limit"] = settings.memory_limit
            plan.facts["stamps"] = _stamps(settings)
            write_whole(known, json.dumps(plan.facts))
        if not len(unread):
            return Plan.open(folder)
        survey = _run_survey(folder, plan.casters, run_survey, plan.survey, unread.tolist())
        if _exponent(settings, plan.casters, survey) == plan.exponent:
            survey.save(folder / "survey.npz")
            return Plan.open(folder)
    return _make_plan(folder, settings, run_survey)


def _has_unread_tasks(plan: Plan) -> bool:
    return any(facts["unread"] for task in plan.tasks if (facts := plan.store.done(*task, plan.hash)))


def _make_plan(folder: Path, settings: Settings, run_survey: SurveyRun) -> Plan:
    mosaic = open_mosaic(settings.raster, settings.height_unit) if settings.raster else None
    for note in () if mosaic is None else mosaic.notes:
        warnings.warn(note, stacklevel=2)
    casters = Casters(settings, mosaic)
    (folder / "tasks").mkdir(parents=True, exist_ok=True)
    for old in (folder / "tasks").iterdir():
        old.unlink()
    (folder / "study.json").unlink(missing_ok=True)
    if settings.receivers != "raster":
        write_points(settings, folder / "points.npy")
    receivers = receivers_of(settings, casters, folder)
    crs = mosaic.crs if mosaic is not None else None
    suns = suns_of(settings, crs, receivers.box)
    if negative := int((suns.weights < 0).sum()):
        warnings.warn(f"weights: {negative} of {suns.weights.size} are below 0, and lower sums", stacklevel=2)
    suns.save(folder / "suns.npz")
    write_whole(folder / "survey.json", json.dumps({"settings": json.loads(settings.as_json())}))
    survey = _run_survey(folder, casters, run_survey, None, list(range(len(casters))))
    survey.save(folder / "survey.npz")
    if heights := _note_of_heights(survey):
        warnings.warn(heights, stacklevel=2)
    for note in far_from_all(casters, survey, receivers.box, folder / "points.npy"):
        warnings.warn(note, stacklevel=2)
    exponent = _exponent(settings, casters, survey)
    digest = hashlib.sha256(
        " ".join(
            [settings.hash_of_answers(), sha256_of_array(suns.towards), sha256_of_array(suns.weights), str(exponent)]
        ).encode()
    ).hexdigest()
    facts = {"settings": json.loads(settings.as_json()), "exponent": exponent, "hash": digest,
             "reach": _reach(settings, survey), "stamps": _stamps(settings)}  # fmt: skip
    blocks = suns.blocks(settings.block)
    create_arrays_of_suns(folder, settings, suns, receivers, len(blocks), crs)
    write_whole(folder / "study.json", json.dumps(facts))
    return Plan.open(folder)


def casters_to_survey(folder: str) -> Casters:
    settings = Settings.from_json(json.loads((Path(folder) / "survey.json").read_text())["settings"])
    return Casters(settings, open_mosaic(settings.raster, settings.height_unit) if settings.raster else None)


def _run_survey(folder: Path, casters: Casters, run_survey: SurveyRun, old: Survey | None, tiles: list[int]) -> Survey:
    """Surveys these tiles and enters them into the old survey, or into a new one."""
    count = len(casters)
    survey = old or Survey(np.zeros((count, 4)), np.zeros(count), np.zeros(count), np.zeros(count, np.int64))
    for tile, (box, top, bottom, triangles, note) in run_survey(str(folder), tiles):
        survey.boxes[tile], survey.tops[tile], survey.bottoms[tile] = box, top, bottom
        survey.triangles[tile] = triangles
        if survey.unread[tile]:
            note += ": answers that it can shadow are undecided until it can be read"
        if note:
            warnings.warn(note, stacklevel=2)
    return survey


def _reach(settings: Settings, survey: Survey) -> float:
    """The greatest distance in metres from a caster to a receiver that it can shadow, by heights and the lowest sun;
    the extent's diagonal if that is less."""
    extent = survey.extent
    diagonal = math.hypot(extent[2] - extent[0], extent[3] - extent[1])
    if not len(_finite(survey.tops)):
        return diagonal
    lowest = settings.min_elevation if settings.start is not None else 6.0 / max(settings.sky, 1)
    if settings.directions is not None or settings.weather is not None:
        return diagonal
    reach = min(_rise(survey) / math.tan(math.radians(lowest)) * 1.01 + 1, diagonal)
    return reach if settings.halo_limit is None else min(reach, settings.halo_limit)


def _finite(heights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Those of caster tiles that hold ground, of known heights."""
    return heights[np.isfinite(heights)]


def _rise(survey: Survey) -> float:
    """From the lowest height to the highest."""
    bottoms, tops = _finite(survey.bottoms), _finite(survey.tops)
    return float(tops.max() - bottoms.min()) if len(tops) and len(bottoms) else 0.0


def _note_of_heights(survey: Survey) -> str | None:
    """A sentence about heights that no ground on Earth has in metres."""
    bottoms, tops = _finite(survey.bottoms), _finite(survey.tops)
    extremes = [n for n in (tops.max(initial=0), bottoms.min(initial=0)) if not LOWEST_GROUND < n < HIGHEST_GROUND]
    if not extremes:
        return None
    return (
        f"heights: reach {extremes[0]:.6g} m: if they are no metres, height_unit= says their unit, as "
        'height_unit="millimetre"'
    )


def _exponent(settings: Settings, casters: Casters, survey: Survey) -> int:
    """The exponent of the lattice's step: the finest from 2^-10 on for which a receiver tile and the casters that can
    shadow it fit on a lattice. It does not depend on the size of a tile."""
    cell = 0.0 if casters.mosaic is None else max(casters.mosaic.dx, casters.mosaic.dy)
    if settings.lattice is not None:
        return math.frexp(settings.lattice)[1] - 1
    exponent = FINEST_EXPONENT
    span = max(2 * largest_tile(settings, cell) + _reach(settings, survey), _rise(survey))
    while span > LARGEST_SPAN * 2.0**exponent:
        exponent += 1
    if cell and cell < 8 * 2.0**exponent:
        raise ValueError(
            f"lattice: the study reaches {_reach(settings, survey):.0f} m, which needs steps of 2^{exponent} m, too "
            f"coarse for cells of {cell:g} m: raise min_elevation, or set halo_limit or a finer lattice=, with which "
            "answers beyond their reach are undecided"
        )
    if exponent > COARSE_EXPONENT:
        warnings.warn(
            f"lattice: casters and receivers are rounded to steps of 2^{exponent} m, since the study reaches "
            f"{_reach(settings, survey):.0f} m ({_farthest(casters, survey)}): leave out what lies far away, or set "
            "halo_limit or lattice=",
            stacklevel=2,
        )
    return exponent


def _farthest(casters: Casters, survey: Survey) -> str:
    """The caster tile whose middle lies farthest from the median of all, or the widest of few."""
    if not len(survey.boxes):
        return "no casters"
    middles = (survey.boxes[:, :2] + survey.boxes[:, 2:]) / 2
    away = np.abs(middles - np.median(middles, axis=0)).max(axis=1) + np.ptp(survey.boxes[:, [0, 2]], axis=1)
    return casters.name(int(np.where(survey.unread, -1, away).argmax()))
