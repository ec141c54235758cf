# SPDX-License-Identifier: MIT
"""The tables of tools/report.py, experiment by experiment: what stands in their cells, and the note below each."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

PUBLISHED = Path(__file__).parent / "bench" / "published.json"
PARTS = ("build", "camera", "shadow", "shade")
# What a time is the sum of. Each needs the tree, so a rival's build, where each run makes it, counts in each.
SUMS = {"camera": ("build", "camera"), "shadow": ("build", "shadow"), "frame": PARTS}


class Row(dict[str, Any]):
    """A row of the JSON, flat, as in row["errors/wrong"]. What a row lacks is not a number (NaN)."""

    def __missing__(self, key: str) -> float:
        return math.nan

    def below(self, name: str) -> dict[str, Any]:
        """What is below a key: of "stages_ms" {"trace": 12.3, ...}."""
        return {key[len(name) + 1 :]: value for key, value in self.items() if key.startswith(name + "/")}

    def count(self, name: str) -> float:
        """A count of the run's statistics; 0 if it has none of that name."""
        return self.get(f"counts/{name}", 0)

    def share(self, of: str, *names: str) -> str:
        """The sum of some counts, of another one."""
        return percent(sum(map(self.count, names)) / max(self.count(of), 1))

    def ms(self, *parts: str, clock: str = "wall_ms") -> pd.Series:
        """Milliseconds of the sum of these parts, run by run."""
        runs = {part: self[f"runs/{part}/{clock}"] for part in parts if f"runs/{part}/{clock}" in self}
        return pd.DataFrame(runs, dtype=float).sum(axis=1)


Rows = list[Row]
Line = dict[str, str]  # of a table: its cells by their headings; **bold** as in Markdown


def views_of(rows: Iterable[Row]) -> dict[str, Rows]:
    """The rows of each view at one size on one device, which may be compared, by their title."""
    views: dict[str, Rows] = {}
    for row in rows:
        views.setdefault(row["title"], []).append(row)
    return views


def good(rows: Iterable[Row], key: str = "ms/median") -> Rows:
    """The rows that did not fail and have such a figure."""
    return [row for row in rows if "ms/median" in row and key in row]


# ---- Cells -----------------------------------------------------------------------------------------------------------


def digits(value: float) -> str:
    """Three significant digits, and all before the point: 0.0123, 12.3, 1234."""
    if pd.isna(value):
        return ""
    if value == 0 or math.isinf(value):
        return f"{value:g}"
    before_point = math.floor(math.log10(abs(value))) + 1
    return f"{value:.2e}" if before_point < -4 else f"{value:.{max(0, 3 - before_point)}f}"


def spaced(count: float) -> str:
    """12 800 000"""
    return "" if pd.isna(count) else f"{int(count):,}".replace(",", "\N{NO-BREAK SPACE}")


def percent(share: float) -> str:
    return digits(100 * share) + ("" if pd.isna(share) or share == 0 else " %")


def spread(median: float, distance: float, runs: float) -> str:
    """The median of some runs, and half the distance of their quartiles."""
    return digits(median) + ("" if pd.isna(median) else " (1 run)" if runs == 1 else f" ± {digits(distance / 2)}")


def times(row: Row, key: str = "ms") -> str:
    return spread(row[f"{key}/median"], row[f"{key}/spread"], row[f"{key}/runs"])


def rounds(row: Row, other: Row, part: str, clock: str = "wall_ms") -> pd.Series:
    """The time of a part over the other row's in each round; empty if the two did not take turns."""
    return (row.ms(*SUMS[part], clock=clock) / other.ms(*SUMS[part], clock=clock)).dropna()


def ratio(row: Row, other: Row, part: str, clock: str = "wall_ms") -> str:
    each = rounds(row, other, part, clock)
    return spread(float(each.median()), float(each.quantile(0.75) - each.quantile(0.25)), len(each))


# ---- Tables: lines of some rows. A docstring is the note below the table. --------------------------------------------
# fmt: off


def errors(rows: Rows) -> list[Line]:
    """Oracle: points that were put to the independent oracle, and how many of the answers it found wrong."""
    return [{
        "technique": row["name"], "ms": times(row) or row["failed"], "wrong": spaced(row["errors/wrong"]),
        "share": percent(row["errors/wrong_share"]), "wrongly lit": spaced(row["errors/wrongly_lit"]),
        "wrongly shadowed": spaced(row["errors/wrongly_shadowed"]),
        "mean absolute": digits(row["errors/mean_absolute"]),
        "SSIM": f"{row['errors/ssim']:.5f}" if "errors/ssim" in row else "",
        "worst tile": digits(row["errors/worst_tile"]), "memory, MB": digits(row["device_memory_bytes"] / 1e6),
        "oracle": f"{spaced(row['oracle/points'])}, {spaced(row['oracle/wrong'])}" if "oracle/points" in row else "",
    } for row in rows]


def soft(rows: Rows) -> list[Line]:
    """Mean absolute errors of the visibility, and points that are wrong by half or more."""
    return [{
        "technique": row["name"], "ms": times(row), "error in penumbrae": digits(row["errors/penumbra_mean_absolute"]),
        "error everywhere": digits(row["errors/mean_absolute"]), "wrong": percent(row["errors/wrong_share"]),
        "share of points in penumbrae": percent(row["errors/penumbra_points"] / row["errors/points"]),
    } for row in good(rows, "errors/points")]


def bias(rows: Rows) -> list[Line]:
    """Acne: points that are lit and called dark. Peter-panning: points in shadow that are called lit. Both hold what
    the texels' size gets wrong along edges, whatever the bias."""
    return [{
        "technique": row["name"], "ms": times(row), "acne (wrongly shadowed)": spaced(row["errors/wrongly_shadowed"]),
        "share of acne": percent(row["errors/wrongly_shadowed"] / row["errors/points"]),
        "peter-panning (wrongly lit)": spaced(row["errors/wrongly_lit"]),
        "share of peter-panning": percent(row["errors/wrongly_lit"] / row["errors/points"]),
    } for row in good(rows, "errors/points")]


def view_of(row: Row) -> Line:
    return {"view": row["seen"], "size": row["size"], "triangles": spaced(row["triangles"])}


def stages(rows: Rows) -> list[Line]:
    """Total: median and half the quartile distance of wall-clock runs. Stages: device time by events, in separate
    profiled runs. Milliseconds."""
    profiled = [row for row in good(rows) if row.below("stages_ms")]
    names = dict.fromkeys(name for row in profiled for name in row.below("stages_ms"))
    lines = []
    for row in profiled:
        decided, points = row.count("points_decided_by_map"), row.count("points") - row.count("points_absent")
        lines.append(view_of(row) | {"technique": row["name"], "total": times(row)}
                     | {name: digits(row.get(f"stages_ms/{name}", 0)) for name in names}
                     | {"points decided by the map": percent(decided / max(points, 1))})
    return lines


def best_rival(view: Rows, mode: str, part: str) -> Row:
    """The rival's row of that mode with the fastest tree for a part of a frame; an empty one without rivals."""
    rows = [row for row in good(view, "frame_ms/median") if row["technique"] == "embree" and row["mode"] == mode]
    return min(rows, key=lambda row: row.ms(*SUMS[part]).median(), default=Row())


def rivals(rows: Rows) -> list[Line]:
    """Milliseconds, medians. A frame is camera, shadow and shade. Ratios: gnomon's time over Embree's in each round,
    median and half the quartile distance; below 1 gnomon is ahead. Animated: Embree's tree of low quality is built in
    each run, and its build counts in each column. Moving and static: the build does not count, and the tree is the
    fastest of its qualities for the part. By processor time: of all threads, which other programs on the machine change
    least."""
    lines = []
    for title, view in views_of(rows).items():
        for row in good(view, "frame_ms/median"):
            mode = "animated" if row["mode"] == "animated" else "static"
            if not row["exact"] or row["settings"].startswith("samples") or not best_rival(view, mode, "frame"):
                continue
            line, trees = {"view": title, "mode": row["mode"]}, []
            for part, sum_of in SUMS.items():
                rival = best_rival(view, mode, part)
                line |= {part: digits(row.ms(*sum_of).median()), f"Embree's {part}": digits(rival.ms(*sum_of).median()),
                         f"ratio, {part}": ratio(row, rival, part),
                         f"{part} by processor time": ratio(row, rival, part, "processor_ms")}
                trees.append(rival["settings"].split()[0].partition("=")[2])
            lines.append(line | {"Embree's trees": ", ".join(trees)})
    return lines


def settings_of_rivals(rows: Rows) -> list[Line]:
    """Rays of gnomon's own points. Wrong: against the exact mask. Other triangles: pixels whose primary ray meets
    another triangle than gnomon's camera."""
    return [{
        "view": row["title"], "settings": row["settings"], "mode": row["mode"], "build": times(row, "build_ms"),
        "camera": times(row, "camera_ms"), "shadow": times(row), "wrong points": spaced(row["errors/wrong"]),
        "other triangles": spaced(row["counts/points_on_other_triangles"]),
    } for view in views_of(rows).values() for row in good(view) if row["technique"] == "embree"]


def size_of(row: Row) -> tuple[str, float]:
    """What grows in the experiment of a row."""
    in_points = row["experiment"] == "growth_in_points"
    return ("points", row["width"] * row["height"]) if in_points else ("triangles", row["triangles"])


def growth(rows: Rows) -> list[Line]:
    """Growth: this time over the one before it, scaled to a doubling."""
    lines, before = [], ("", 0.0, 0.0)
    for row in good(rows):
        (unit, size), ms, scene = size_of(row), row["ms/median"], row["scene"].rpartition("_")[0] + row["view"]
        is_larger = scene == before[0] and size > before[1]
        grown = digits((ms / before[2]) ** (1 / math.log2(size / before[1]))) if is_larger else ""
        lines.append({"scene": f"{row['scene']} {row['view']}", unit: spaced(size), "ms": times(row),
                      "growth for twice as many": grown})
        before = (scene, size, ms)
    return lines


def memory(rows: Rows) -> list[Line]:
    """Share: of the aim, 64 bytes per point (pixel) and 48 bytes per triangle."""
    lines = []
    for row in good(rows):
        used, points = row["device_memory_bytes"], row["width"] * row["height"]
        share = percent(used / (64 * points + 48 * row["triangles"]))
        lines.append(view_of(row) | {"MB": digits(used / 1e6), "bytes per point": digits(used / points),
                                     "share of 64 per point + 48 per triangle": share})
    return lines


def skips(rows: Rows) -> list[Line]:
    """Milliseconds, medians. Of the first: this time over that of the scene's first view in the same mode. Points:
    shares of all. Triangles: outside the light's frame and, of the others, behind every point below them, shares of
    all; with clusters those that are dropped unread count as outside. Looked at exactly: pairs of a point and a
    triangle that the filter left open, of all its tests."""
    first: dict[tuple[str, str], float] = {}
    return [{
        "view": row["seen"], "mode": row["mode"], "ms": times(row),
        "of the first": percent(row["ms/median"] / first.setdefault((row["scene"], row["mode"]), row["ms/median"])),
        "sky": row.share("points", "points_absent"), "facing away": row.share("points", "points_facing_away"),
        "decided by the map": row.share("points", "points_decided_by_map"),
        "triangles outside": row.share("triangles", "triangles_outside"),
        "behind all points": row.share("triangles", "triangles_hidden"),
        "clusters dropped": row.share("clusters", "clusters_outside", "clusters_too_far"),
        "looked at exactly": row.share("tests", "uncertain_pairs"),
        "stages that did not run": "; ".join(f"{stage}: {why}" for stage, why in row.below("skipped").items()
                                             if stage != "clusters"),  # of which the mode says so
    } for row in good(rows)]


def found(view: Rows, settings: str, mode: str = "animated") -> Row:
    """The exact technique's row of a view with such settings; an empty one if it is not there."""
    return next((row for row in good(view) if row["technique"] == "frustum-traced" and row["mode"] == mode
                 and row["settings"].startswith(settings)), Row())


def maps(rows: Rows) -> list[Line]:
    """Milliseconds, medians; the three take turns. Ratios: the median of the turns' ratios, by wall clock and by
    processor time of all threads. The better one is the faster of on and off by that measure; at most 1.03 is the
    aim."""
    lines = []
    for title, view in views_of(rows).items():
        on, off, auto = (found(view, f"conservative-map={mode}") for mode in ("on", "off", "auto"))
        if not (on and off and auto):
            continue
        by_wall, by_processor = (rounds(on, off, "shadow", clock).median() for clock in ("wall_ms", "processor_ms"))
        over_better = rounds(auto, on if by_wall <= 1 else off, "shadow").median()
        processor_over_better = rounds(auto, on if by_processor <= 1 else off, "shadow", "processor_ms").median()
        line = {"view": title, "on": times(on), "off": times(off), "auto": times(auto), "on over off": digits(by_wall),
                "the same, processor time": digits(by_processor), "auto over the better": digits(over_better),
                "auto over the better, processor time": digits(processor_over_better)}
        is_same = on["mask_hash"] == off["mask_hash"] == auto["mask_hash"]
        lines.append(line | {"masks": "the same" if is_same else "DIFFER"})
    return lines


def clusters(rows: Rows) -> list[Line]:
    """Milliseconds, medians; the two take turns. Setup: the stages clusters and triangle_setup, with profiling.
    Dropped: of all clusters, and of all triangles by whichever test. Keeping: once for a mesh."""
    lines = []
    for title, view in views_of(rows).items():
        animated, moving = found(view, ""), found(view, "", "moving")
        if not (animated and moving):
            continue
        both = {"animated": animated, "moving": moving}
        line = {"view": title} | {mode: times(row) for mode, row in both.items()}
        for mode, row in both.items():
            setup = row.get("stages_ms/clusters", 0) + row.get("stages_ms/triangle_setup", 0)
            line[f"setup, {mode}"] = digits(setup)
        line |= {f"camera, {mode}": digits(row["camera_ms/median"]) for mode, row in both.items()}
        line |= {"clusters dropped": moving.share("clusters", "clusters_outside", "clusters_too_far"),
                 "triangles dropped": moving.share("triangles", "triangles_outside"),
                 "keeping them": digits(moving["build_ms/median"])}
        lines.append(line)
    return lines


def lights(rows: Rows) -> list[Line]:
    """Million front-facing pairs per second, by the wall clock; medians. Ratio: the time over that of gnomon's first
    way, the median of the rounds, by wall clock and by processor time."""
    lines = []
    for view in views_of(rows).values():
        for row in good(view, "pairs/facing"):
            wall, processor = ("" if row is view[0] else digits(rounds(row, view[0], "shadow", clock).median())
                               for clock in ("wall_ms", "processor_ms"))
            lines.append({
                "scene": f"{row['scene']}, {row['view']}", "triangles": spaced(row["triangles"]),
                "points": spaced(row["pairs/points"]), "lights": f"{row['light']} ({spaced(row['pairs/lights'])})",
                "facing, M": digits(row["pairs/facing"] / 1e6),
                "lit": percent(row["pairs/lit"] / max(row["pairs/facing"], 1)), "way": row["name"],
                "M pairs/s": digits(row["pairs/facing_per_second"] / 1e6),
                "ms a light": digits(row["pairs/ms_per_light"]), "ratio": wall, "by processor time": processor,
                "differing bits": spaced(row["pairs/differing"]),
            })
    return lines


def samples(rows: Rows) -> list[Line]:
    """Milliseconds, medians; all take turns, and ratios are medians of the rounds. Several samples: their time holds
    finding their receivers. A frame is camera, samples and shade. Embree: 32 camera rays and as many shadow rays per
    pixel, of its fastest tree; its error is the mean absolute one against gnomon's."""
    lines = []
    for title, view in views_of(rows).items():
        one, four, many = (found(view, settings) for settings in ("", "samples=4", "samples=32"))
        if not (one and four and many and "frame_ms/median" in one and "frame_ms/median" in many):
            continue
        line = {"view": title, "camera": times(one, "camera_ms"), "1 sample": times(one), "4": times(four),
                "32": times(many), "32 over 1": ratio(many, one, "shadow"), "frame, 1": times(one, "frame_ms"),
                "frame, 32": times(many, "frame_ms"), "frame, 32 over 1": ratio(many, one, "frame")}
        if rays := best_rival(view, "static", "frame"):
            line |= {"Embree's 32 camera rays": times(rays, "camera_ms"), "shadow rays": times(rays),
                     "gnomon's 32 over its shadow rays": ratio(many, rays, "shadow"),
                     "frame over its frame": ratio(many, rays, "frame"),
                     "by processor time": ratio(many, rays, "frame", "processor_ms"),
                     "Embree's error": digits(rays["errors/mean_absolute"])}
        lines.append(line)
    return lines


def is_aside(row: Row) -> bool:
    """Rays alone, without the build that goes before them: a time that no other may be compared with."""
    return row["technique"] == "embree" and row["mode"] == "static"


def pareto_front(view: Rows) -> Rows:
    """The rows that no other one beats in both run time and error, from the fastest to the least wrong."""
    front: Rows = []
    for row in sorted(good(view, "errors/wrong"), key=lambda row: (row["ms/median"], row["errors/wrong_share"])):
        if not is_aside(row) and (not front or row["errors/wrong_share"] < front[-1]["errors/wrong_share"]):
            front.append(row)
    return front


def alternatives(rows: Rows) -> list[Line]:
    """Milliseconds of the shadows, medians; ratios to the technique's first row are medians of the rounds. Pixels:
    of the sides of volumes."""
    lines = []
    for title, view in views_of(good(rows)).items():
        firsts: dict[str, Row] = {}
        for row in view:
            first = firsts.setdefault(row["technique"], row)
            lines.append({
                "view": title, "technique": row["name"], "ms": times(row), "of the first": ratio(row, first, "shadow"),
                "same mask": "yes" if row["mask_hash"] == first["mask_hash"] else "no",
                "wrong": spaced(row["errors/wrong"]), "pixels": spaced(row["counts/pixels_written"]),
            })
    return lines


def techniques(rows: Rows) -> list[Line]:
    """Milliseconds (median) and share of wrong points. Bold: on the view's front, where no other is both faster and
    less wrong. Terms: texels of all maps in the first view, and what they fit; a size in a name is that of one map with
    as many texels."""
    lines: dict[str, Line] = {row["name"]: {"technique": row["name"]} for row in rows}
    for row in rows:
        if "terms" in row:
            lines[row["name"]].setdefault("terms", row["terms"])
    for title, view in views_of(rows).items():
        on_front = {row["name"] for row in pareto_front(view)}
        for row in view:
            cell = f"{digits(row['ms/median'])} ms, {percent(row['errors/wrong_share'])}"
            cell = f"**{cell}**" if row["name"] in on_front else cell
            lines[row["name"]][title] = cell if good([row], "errors/wrong") else row["failed"]
    return list(lines.values())


# fmt: on

# ---- Tables by experiment --------------------------------------------------------------------------------------------


class Table(NamedTuple):
    title: str
    note: str
    lines: list[Line]


Maker = Callable[[Rows], list[Line]]
EACH_VIEW = "each view"  # a table for each, with its name as its title
BESIDE_EMBREE: tuple[str, Maker] = ("gnomon beside Embree", rivals)
TABLES: dict[str, list[tuple[str, Maker]]] = {
    "times": [(EACH_VIEW, errors), BESIDE_EMBREE], "errors": [(EACH_VIEW, errors), BESIDE_EMBREE],
    "techniques": [("", techniques)], "alternatives": [("", alternatives)], "bias": [(EACH_VIEW, bias)],
    "soft": [(EACH_VIEW, soft)],
    "rivals": [BESIDE_EMBREE, ("Embree's settings", settings_of_rivals), ("", stages)],
    "growth_in_triangles": [("", growth)], "growth_in_points": [("", growth)], "memory": [("", memory)],
    "skips": [("", skips)], "figure5": [("", stages), ("", maps)], "auto": [("", maps)], "clusters": [("", clusters)],
    "samples": [("", samples)], "many_lights": [("", lights)],
}  # fmt: skip


def tables_of(experiment: str, rows: Rows) -> list[Table]:
    """Ours, without those that have no line, then those of others."""
    tables = []
    for title, make in TABLES.get(experiment, [("", stages)]):
        parts = views_of(rows) if title == EACH_VIEW else {title: rows}
        tables += [Table(of, " ".join(str(make.__doc__).split()), make(part)) for of, part in parts.items()]
    return [table for table in tables if table.lines] + published(experiment)


def published(experiment: str) -> list[Table]:
    """The figures of others that stand beside an experiment."""
    tables = []
    for table in json.loads(PUBLISHED.read_text()):
        note = f"Published by others: {table['source']}. Machine: {table['machine']}."
        cells = [["–" if cell is None else str(cell) for cell in row] for row in table["rows"]]
        lines = [dict(zip(table["columns"], row, strict=True)) for row in cells]
        tables += [Table(table["title"], note, lines)] if table["experiment"] == experiment else []
    return tables
