#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Tables, charts and a page of what the tool `bench` wrote with --json.

    pip install pandas matplotlib tabulate markdown
    python tools/report.py bench.json [more.json ...] [--html page.html] [--markdown tables.md] [--charts PREFIX]

--html: a page that loads nothing and has no script. --markdown: the machine, and the tables. --charts: run time against
error of each scene of the experiment techniques, as PREFIX_SCENE.svg. The figures of others, which stand beside ours,
are those of bench/published.json.
"""

from __future__ import annotations

import argparse
import base64
import html
import io
import json
import re
import sys
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import markdown
import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.image import imsave
from matplotlib.ticker import LogLocator, SymmetricalLogLocator
from report_tables import PARTS, Row, Rows, digits, good, is_aside, pareto_front, size_of, spaced, tables_of, views_of

COLOURS = [matplotlib.colormaps["tab20"](i) for i in [*range(0, 20, 2), *range(1, 20, 2)]]
SKY, TOO_BRIGHT, TOO_DARK = np.array([[214, 228, 245], [255, 140, 0], [26, 115, 255]]) / 255
CHART_STYLE = {
    "svg.fonttype": "none", "svg.hashsalt": "gnomon", "font.size": 9, "axes.titlesize": 9,
    "axes.titlelocation": "left", "axes.grid": True, "axes.axisbelow": True, "grid.color": "0.87",
    "axes.spines.top": False, "axes.spines.right": False,
}  # fmt: skip

# ---- Reading ---------------------------------------------------------------------------------------------------------


class Report(NamedTuple):
    machine: dict[str, Any]
    experiments: list[dict[str, str]]  # name, title, idea
    families: dict[str, list[str]]  # techniques
    rows: Rows


def read_report(file: Path) -> Report:
    """Raises ValueError, with a sentence, if the file is not what bench writes."""
    try:
        data = json.loads(file.read_text())
        experiments = [{key: str(e[key]) for key in ("name", "title", "idea")} for e in data["experiments"]]
        experiments.insert(0, {"name": "times", "title": "Times", "idea": "The scenes of the command line."})
        return Report(dict(data["machine"]), experiments, dict(data["families"]), rows_of(data["rows"]))
    except OSError as error:
        raise ValueError(f"cannot read {file}: {error.strerror}") from error
    except (ValueError, LookupError, TypeError, AttributeError) as error:
        raise ValueError(f"{file} is not what bench writes with --json") from error


def rows_of(data: list[dict[str, Any]]) -> Rows:
    """Flat rows, each with what tables call it: `name`, `size`, `seen` and `title`, which says what may be compared."""
    rows, device = [], ""
    for figures in data:
        row = Row(flat(figures))
        mode = "" if row["mode"] == "animated" else f"({row['mode']})"
        if row["technique"] != "embree" or not device:  # which has no OpenCL device: it belongs to the rows before it
            device = row["device"]
        settings = row.get("asked", row["settings"])  # as it was before it was put on equal terms
        row["name"] = " ".join([row["technique"], *settings.split(), mode]).strip()
        row["size"] = f"{row['width']}x{row['height']}"
        row["seen"] = f"{row['scene']} {row['view']}.{row['light']}"
        row["title"] = f"{row['seen']}, {row['size']}, {device}"
        rows.append(row)
    return rows


def flat(figures: dict[str, Any], above: str = "") -> dict[str, Any]:
    """{"a": {"b": 1}} as {"a/b": 1}. What bench could not measure, null, is left out."""
    found: dict[str, Any] = {}
    for key, value in figures.items():
        found |= flat(value, f"{above}{key}/") if isinstance(value, dict) else {above + key: value}
    return {key: value for key, value in found.items() if value is not None}


# ---- Charts ----------------------------------------------------------------------------------------------------------


def new_chart(height: float) -> tuple[Figure, Axes]:
    figure = Figure(figsize=(7.6, height), layout="constrained")
    return figure, figure.subplots()


def label_log(axis: Axis, text: Callable[[float], str]) -> None:
    """Labels at 1, 2, 5, 10, ..."""
    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(lambda value, _: text(value))
    axis.set_minor_formatter(lambda *_: "")


def ms_text(ms: float) -> str:
    return f"{ms:g} ms"


def svg_of(figure: Figure) -> str:
    """The picture as SVG text. An artist with the group id "tip:TEXT" gets this tooltip."""
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    svg = text.getvalue()[text.getvalue().index("<svg") :]
    return re.sub(r'<g id="tip:([^"]*)">', r"<g><title>\1</title>", svg)


def said(row: Row) -> str:
    return f"{row['name']}: {digits(row['ms/median'])} ms, {spaced(row['errors/wrong'])} wrong"


def place(row: Row) -> tuple[float, float]:
    return row["errors/wrong_share"], row["ms/median"]


def scatter(title: str, view: Rows, families: dict[str, list[str]]) -> Figure:
    """Run time against error, a colour for each family. Marks of the front are numbered, and named below."""
    marks, front = good(view, "errors/wrong"), pareto_front(view)
    figure, axes = new_chart(4.6 + 0.16 * len(front))
    axes.set_yscale("log")
    label_log(axes.yaxis, ms_text)
    shares = [row["errors/wrong_share"] for row in marks if row["errors/wrong_share"] > 0] or [0.01]
    subs = (1, 2, 5) if max(shares) < 300 * min(shares) else (1,)
    axes.set_xscale("symlog", linthresh=min(shares))  # 0 has its own place on the left
    axes.xaxis.set_major_locator(SymmetricalLogLocator(base=10, linthresh=min(shares), subs=subs))
    axes.xaxis.set_major_formatter(lambda share, _: f"{100 * share:g} %" if share == 0 or share >= min(shares) else "")
    for colour, (family, techniques) in zip(COLOURS, families.items(), strict=False):
        for k, row in enumerate(row for row in marks if row["technique"] in techniques):
            fill = "none" if is_aside(row) else colour
            mark = axes.scatter(*place(row), s=30, facecolor=fill, edgecolor=colour, label="" if k else family)
            mark.set_gid("tip:" + said(row))
    axes.plot(*zip(*map(place, front), strict=True), "--", color="0.5", zorder=0)
    below = ["share of wrong points", "", "On the front, from the fastest to the least wrong:"]
    for k, row in enumerate(front, 1):
        axes.annotate(str(k), place(row), (4, 4), textcoords="offset points", weight="bold")
        below.append(f"{k}  {said(row)}")
    axes.set_xlabel("\n".join(below), loc="left")
    axes.set_title(textwrap.fill(title, 110))
    figure.legend(loc="outside upper left", ncols=4, frameon=False)
    return figure


def bars(ms: dict[str, dict[str, float]]) -> Figure:
    """Milliseconds of parts by what they are parts of: stacked bars, all to one scale."""
    table = pd.DataFrame.from_dict(ms, orient="index").fillna(0)
    table = table.loc[:, table.any()]
    figure, axes = new_chart(1 + 0.62 * len(table))
    table.plot.barh(stacked=True, ax=axes, color=COLOURS[: len(table.columns)], legend=False, width=0.32)
    for name, of_part in zip(table.columns, axes.containers, strict=True):
        for bar in of_part:
            bar.set_gid(f"tip:{name}: {digits(bar.get_width())} ms")
    for y, (label, total) in enumerate(table.sum(axis=1).items()):
        axes.annotate(f"{digits(total)} ms", (total, y), (4, -3), textcoords="offset points")
        axes.annotate(str(label), (0, y), (0, 9), textcoords="offset points", fontsize=8).set_in_layout(False)
    axes.set_yticks([])
    axes.set_ylim(len(table) - 0.7, -0.9)
    axes.margins(x=0.12)
    axes.set_xlabel("ms")
    figure.legend(loc="outside upper left", ncols=6, frameon=False)
    return figure


def growth(rows: Rows) -> Figure:
    """Time against triangles or points, a line for each scene."""
    lines: dict[str, list[tuple[float, float]]] = {}
    for row in good(rows):
        unit, size = size_of(row)
        scene = row["scene"].rpartition("_")[0] if unit == "triangles" else row["scene"]  # RECIPE_TRIANGLES
        lines.setdefault(f"{scene} {row['view']}.{row['light']}, {row['device']}", []).append((size, row["ms/median"]))
    figure, axes = new_chart(4)
    axes.set_yscale("log")
    axes.set_xscale("log")
    axes.set_xlabel(unit)
    label_log(axes.yaxis, ms_text)
    label_log(axes.xaxis, spaced)
    for label, points in lines.items():
        axes.plot(*zip(*points, strict=True), "o-", label=label)
    figure.legend(loc="outside upper left", frameon=False)
    return figure


def charts_of(experiment: str, rows: Rows, families: dict[str, list[str]]) -> list[str]:
    """What the page shows of an experiment above its tables, as HTML."""
    if experiment.startswith("growth"):
        return [div(growth(rows))] if good(rows) else []
    parts = []
    for title, view in views_of(rows).items():
        if good(view, "errors/wrong"):
            parts += [div(scatter(title, view, families)), *gallery(title, view)]
    label = "{0[title]}\n{0[name]}".format
    frames = {label(row): {part: row.ms(part).median() for part in PARTS} for row in good(rows, "frame_ms/median")}
    profiled = {label(row): row.below("stages_ms") for row in good(rows) if row.below("stages_ms")}
    return parts + [div(bars(ms)) for ms in (frames, profiled) if ms]


def div(figure: Figure) -> str:
    return f'<div class="chart">{svg_of(figure)}</div>'


# ---- Pictures --------------------------------------------------------------------------------------------------------


def unpacked(row: Row, name: str) -> np.ndarray:
    """A picture that bench packed by its runs of equal pixels: "255*1200 -1 254*3"."""
    values, _, lengths = zip(*(run.partition("*") for run in row[f"picture/{name}"].split()), strict=True)
    pixels = np.repeat([int(value) for value in values], [int(length or 1) for length in lengths])
    return pixels.reshape(int(row["picture/height"]), int(row["picture/width"]), 1)


def images(row: Row) -> list[np.ndarray]:
    """The mask; if it has errors, also itself in dim grey, with too bright pixels in orange, too dark ones in blue."""
    mask, error = unpacked(row, "mask"), unpacked(row, "error") / 255
    seen = np.where(mask < 0, SKY, mask / 255)
    share = np.sqrt(np.abs(error))  # the root, so that small errors can still be seen
    dim = 0.12 + 0.23 * np.where(mask < 0, 1, mask / 255)
    return [seen, dim + share * (np.where(error > 0, TOO_BRIGHT, TOO_DARK) - dim)][: 1 + bool(error.any())]


def gallery(title: str, view: Rows) -> list[str]:
    """Each mask of a view once, beside its errors."""
    figures, shown = [], set()
    for row in good(view, "picture/width"):
        if row["mask_hash"] in shown:
            continue
        shown.add(row["mask_hash"])
        caption = row["name"]
        if row["errors/mean_absolute"] > 0:
            lit, dark = spaced(row["errors/wrongly_lit"]), spaced(row["errors/wrongly_shadowed"])
            caption += f": {lit} wrongly lit (orange), {dark} wrongly shadowed (blue)"
        pictures = "".join(map(img, images(row)))
        figures.append(f"<figure>{pictures}<figcaption>{html.escape(caption)}</figcaption></figure>")
    summary = f"<details open><summary>Masks and errors: {html.escape(title)}</summary><div class='gallery'>"
    return [f"{summary}{''.join(figures)}</div></details>"] if figures else []


def img(pixels: np.ndarray) -> str:
    png = io.BytesIO()
    imsave(png, np.clip(np.broadcast_to(pixels, (*pixels.shape[:2], 3)), 0, 1), format="png")
    return f'<img alt="" src="data:image/png;base64,{base64.b64encode(png.getvalue()).decode()}"/>'


# ---- Documents -------------------------------------------------------------------------------------------------------

STYLE = """:root { color-scheme: light dark; } body { margin: 0 auto; max-width: 1240px; padding: 24px 16px;
font: 15px/1.5 system-ui, sans-serif; } h2 { border-top: 1px solid #8888; padding-top: 12px; margin-top: 40px; }
p { max-width: 75ch; } table { border-collapse: collapse; font-size: 13px; display: block; overflow-x: auto; }
th, td { padding: 3px 10px 3px 0; border-bottom: 1px solid #8884; white-space: nowrap; } th { white-space: normal;
text-align: left; vertical-align: bottom; } td { font-variant-numeric: tabular-nums; } .chart svg { background: white;
width: 100%; height: auto; max-width: 900px; } .gallery { display: grid; gap: 12px;
grid-template-columns: repeat(auto-fill, minmax(min(100%, 480px), 1fr)); } figure { margin: 0; }
figure img { width: 49%; margin-right: 1%; } figcaption, summary { font-size: 13px; }"""
PAGE = """<!DOCTYPE html>
<html lang="en"><head><title>gnomon: benchmark</title><meta charset="utf-8"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/><style>{style}</style></head><body>
{body}
</body></html>
"""
INTRODUCTION = """# gnomon: run time against error

Times are medians of wall-clock runs after warm-up, from resident triangles and points to the resident mask; of frames,
from resident triangles to a picture. A wrong point is one whose visibility is on the other side of one half. Modes:
animated keeps nothing but the raw triangles between runs; moving keeps clusters of triangles; static keeps all that
depends on scene and light.
"""


def document(report: Report, has_charts: bool) -> str:
    """Markdown of a run: its machine, then each experiment's charts, as HTML, and tables."""
    machine = {key: value if isinstance(value, str) else json.dumps(value) for key, value in report.machine.items()}
    blocks = [pd.Series(machine).to_markdown(headers=["machine and versions", ""], tablefmt="github")]
    for experiment in report.experiments:
        rows = [row for row in report.rows if row["experiment"] == experiment["name"]]
        if not rows:
            continue
        blocks += ["## " + experiment["title"], experiment["idea"]]
        blocks += charts_of(experiment["name"], rows, report.families) if has_charts else []
        for title, note, lines in tables_of(experiment["name"], rows):
            table = pd.DataFrame(lines).fillna("").to_markdown(index=False, tablefmt="github", disable_numparse=True)
            blocks += [block for block in (title and f"**{title}**", table, note) if block]
    return "\n\n".join(blocks) + "\n"


def page(reports: list[Report]) -> str:
    text = "\n\n".join([INTRODUCTION, *(document(report, True) for report in reports)])
    return PAGE.format(style=STYLE, body=markdown.markdown(text, extensions=["tables"]))


def chart_files(reports: list[Report]) -> dict[str, str]:
    """SVG of the experiment techniques by scene; of a scene's later views by scene and light."""
    files: dict[str, str] = {}
    for report in reports:
        rows = [row for row in report.rows if row["experiment"] == "techniques"]
        for title, view in views_of(good(rows, "errors/wrong")).items():
            names = [view[0]["scene"], f"{view[0]['scene']}_{view[0]['light']}"]
            free = [name for name in names if name not in files]
            if not free:
                raise ValueError(f"two charts would be {names[-1]}: name the files of one device at a time")
            files[free[0]] = "<!-- SPDX-License-Identifier: MIT -->\n" + svg_of(scatter(title, view, report.families))
    return files


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser("report.py", description="Tables, charts and a page of what bench measured.")
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE.json", help="what bench wrote with --json")
    parser.add_argument("--html", type=Path, help="a page with all charts, pictures and tables")
    parser.add_argument("--markdown", type=Path, help="the machine, and all tables")
    parser.add_argument("--charts", metavar="PREFIX", help="write each scene of techniques as PREFIX_SCENE.svg")
    options = parser.parse_args(arguments)
    if not (options.html or options.markdown or options.charts):
        parser.error("name --html, --markdown or --charts")
    try:
        reports = [read_report(file) for file in options.files]
        if options.markdown:
            options.markdown.write_text("\n".join(document(report, False) for report in reports))
        with matplotlib.rc_context(CHART_STYLE):  # whoever imports this module keeps their own style
            if options.html:
                options.html.write_text(page(reports))
            for name, svg in chart_files(reports).items() if options.charts else ():
                Path(f"{options.charts}_{name}.svg").write_text(svg)
    except (ValueError, OSError) as error:
        sys.exit(f"report.py: error: {error}")


if __name__ == "__main__":
    main()
