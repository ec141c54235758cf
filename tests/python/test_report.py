# SPDX-License-Identifier: MIT
"""tools/report.py, on small made files: its tables have the figures, its charts are written, and what bench did not
write gets one sentence."""

import json
import sys
import xml.etree.ElementTree as ElementTree
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

for package in ("pandas", "matplotlib", "tabulate", "markdown"):
    pytest.importorskip(package)
import matplotlib  # noqa: E402

STYLE_OF_OTHERS = {name: value for name, value in matplotlib.rcParams.items() if name != "backend"}
sys.path.insert(0, str(Path(__file__).parents[2] / "tools"))
import report  # noqa: E402
from report_tables import PUBLISHED, TABLES, digits, pareto_front, published, spaced, tables_of  # noqa: E402

FAMILIES = {"exact": ["frustum-traced", "izb"], "filtered maps": ["vsm", "esm"], "Embree": ["embree"]}


def made(experiment, technique="frustum-traced", ms=2.0, **figures):
    """A row as bench writes it. Without `ms` the run failed."""
    row = {"experiment": experiment, "scene": "city", "view": "v0", "light": "sun", "width": 100, "height": 10,
           "triangles": 500, "technique": technique, "settings": "", "exact": technique == "frustum-traced",
           "mode": "animated", "device": "CPU" if technique == "embree" else "cpu", "mask_hash": "1"}  # fmt: skip
    return row | ({"ms": of(ms), "device_memory_bytes": 22_000} if ms else {}) | figures


def of(ms, spread=0.0, runs=3):
    return {"median": ms, "least": ms, "most": ms, "spread": spread, "runs": runs}


def wrong(lit, dark=0, points=1000):
    return {"points": points, "wrong": lit + dark, "wrong_share": (lit + dark) / points, "wrongly_lit": lit,
            "wrongly_shadowed": dark, "mean_absolute": (lit + dark) / points, "ssim": 0.5, "worst_tile": 0.25,
            "penumbra_points": 10, "penumbra_mean_absolute": 0.125}  # fmt: skip


def lines_of(rows, which=0):
    """The lines of a table of some rows of one experiment."""
    return tables_of(rows[0]["experiment"], report.rows_of(rows))[which].lines


def cells_of(rows, which=0):
    return [list(line.values()) for line in lines_of(rows, which)]


# ---- Tables ----------------------------------------------------------------------------------------------------------


def test_numbers_keep_three_digits():
    numbers = {
        0: "0",
        0.012345: "0.0123",
        1.2345: "1.23",
        1234.5: "1234",
        0.000001234: "1.23e-06",
        np.nan: "",
        np.inf: "inf",
    }
    assert [digits(number) for number in numbers] == list(numbers.values())
    assert [spaced(12_800_000), spaced(100)] == ["12\u00a0800\u00a0000", "100"]


def test_errors_and_failures_stand_side_by_side():
    rows = [
        made("errors", ms=2.5, errors=wrong(7, 2, 100), oracle={"points": 50, "wrong": 0}) | {"ms": of(2.5, 0.5)},
        made("errors", "vsm", None, failed="it broke"),
        made("errors", "esm", settings="size=512", mode="static") | {"ms": of(3, 0, 1)},
    ]
    first, second, third = lines_of(rows)
    assert list(first.values()) == ["frustum-traced", "2.50 ± 0.250", "9", "9.00 %", "7", "2", "0.0900", "0.50000",
                                    "0.250", "0.0220", "50, 0"]  # fmt: skip
    assert (second["technique"], second["ms"], second["wrong"]) == ("vsm", "it broke", "")
    assert (third["technique"], third["ms"]) == ("esm size=512 (static)", "3.00 (1 run)")


def test_the_front_holds_what_nothing_beats():
    named = [("slower", 0.1, 5), ("fastest", 0.1, 4), ("between", 0.01, 6), ("beaten", 0.02, 7), ("exact", 0, 20),
             ("exact, slower", 0, 30)]  # fmt: skip
    rows = [made("errors", name, ms, errors=wrong(1000 * share)) for name, share, ms in named]
    rows.append(made("errors", "embree", 1, mode="static", errors=wrong(0)))  # no build: stands aside
    assert [row["name"] for row in pareto_front(report.rows_of(rows))] == ["fastest", "between", "exact"]


def test_techniques_are_compared_scene_by_scene():
    assert cells_of(techniques()) == [
        ["frustum-traced", "**5.00 ms, 0**", "**5.00 ms, 0**"],
        ["vsm size=512", "9.00 ms, 2.00 %", "**4.00 ms, 2.00 %**"],
        ["esm", "it broke", "**3.00 ms, 3.00 %**"],
    ]


def techniques():
    """Two scenes; a technique fails in one."""
    row, vsm = "techniques", {"settings": "size=512", "errors": wrong(20)}
    return [
        made(row, ms=5, errors=wrong(0)), made(row, "vsm", 9, **vsm), made(row, "esm", None, failed="it broke"),
        made(row, ms=5, scene="yard", errors=wrong(0)), made(row, "vsm", 4, scene="yard", **vsm),
        made(row, "esm", 3, scene="yard", errors=wrong(30)),
    ]  # fmt: skip


def test_equal_terms_name_a_row_by_what_was_asked():
    terms = {"settings": "size=256 fit=receivers", "asked": "size=512", "terms": "4 x 256², receivers"}
    assert lines_of([made("techniques", "pssm", errors=wrong(20), **terms)]) == [
        {
            "technique": "pssm size=512",
            "terms": "4 x 256², receivers",
            "city v0.sun, 100x10, cpu": "**2.00 ms, 2.00 %**",
        }
    ]


def test_alternatives_stand_beside_the_first():
    def way(settings, ms, mask="1", **counts):
        runs = {"shadow": {"wall_ms": ms, "processor_ms": ms}}
        return made("alternatives", "pssm", ms[0], settings=settings, runs=runs, mask_hash=mask, errors=wrong(3),
                    counts=counts)  # fmt: skip

    rows = [way("a=1", [4, 8, 6], pixels_written=1200), way("a=2", [2, 2, 3]), way("a=3", [4, 8, 6], mask="2")]
    assert [cells[2:] for cells in cells_of(rows)] == [
        ["4.00 ± 0", "1.00 ± 0", "yes", "3", "1\N{NO-BREAK SPACE}200"],
        ["2.00 ± 0", "0.500 ± 0.0625", "yes", "3", ""],
        ["4.00 ± 0", "1.00 ± 0", "no", "3", ""],
    ]


def test_bias_tells_acne_from_peter_panning():
    assert cells_of([made("bias", errors=wrong(7, 30))]) == [
        ["frustum-traced", "2.00 ± 0", "30", "3.00 %", "7", "0.700 %"]
    ]


def test_soft_shows_penumbrae():
    assert cells_of([made("soft", errors=wrong(7))])[0][2:] == ["0.125", "0.00700", "0.700 %", "1.00 %"]


def test_memory_is_a_share_of_points_and_triangles():
    assert cells_of([made("memory")])[0][-2:] == ["22.0", "25.0 %"]  # of 64 * 1000 + 48 * 500


def test_skips_are_shares_of_what_there_is():
    counts = {"points": 1000, "points_absent": 250, "triangles": 500, "triangles_outside": 100, "tests": 80,
              "uncertain_pairs": 8}  # fmt: skip
    empty = {"counts": {"points": 1000, "points_absent": 1000}, "skipped": {"trace": "no point", "clusters": "none"}}
    full, sky = lines_of([made("skips", ms=4, counts=counts), made("skips", ms=0.1, view="sky", **empty)])
    wanted = {"of the first": "100 %", "sky": "25.0 %", "triangles outside": "20.0 %", "looked at exactly": "10.0 %"}
    assert wanted.items() <= full.items() and full["stages that did not run"] == ""
    assert (sky["of the first"], sky["sky"]) == ("2.50 %", "100 %")
    assert sky["stages that did not run"] == "trace: no point"


def test_growth_is_scaled_to_a_doubling():
    """Four times the triangles in 2.25 of the time are 1.5 for twice as many."""
    rows = [made("growth_in_triangles", scene=f"city_{n}", triangles=n, ms=ms) for n, ms in ((100, 4), (400, 9))]
    assert [line["growth for twice as many"] for line in lines_of(rows)] == ["", "1.50"]
    rows = [made("growth_in_points", width=n, ms=ms) for n, ms in ((100, 4), (200, 8))]
    assert cells_of(rows)[1] == ["city v0", "2\u00a0000", "8.00 ± 0", "2.00"]


def test_stages_have_a_column_each():
    rows = [made("table1", stages_ms={"bins": 1, "trace": 2}), made("table1", "izb", stages_ms={"izb": 3, "trace": 4})]
    rows[0]["counts"] = {"points": 1000, "points_absent": 200, "points_decided_by_map": 400}
    assert [cells[-4:] for cells in cells_of(rows)] == [["1.00", "2.00", "0", "50.0 %"], ["0", "4.00", "3.00", "0"]]


def of_runs(build=None, **parts):
    """Runs in which the processor works twice as long on a build as the clock says."""
    runs = {name: {"wall_ms": ms, "processor_ms": ms} for name, ms in parts.items()}
    return runs | ({"build": {"wall_ms": build, "processor_ms": [2 * ms for ms in build]}} if build else {})


def test_rivals_are_compared_round_by_round():
    """With the fastest of their trees; one that is built in each run counts. The second round is twice as slow."""

    def row(technique, tree, mode, build, *parts):
        runs = {name: [ms, 2 * ms, ms] for name, ms in zip(("camera", "shadow", "shade"), parts, strict=True)}
        runs = of_runs([build, 2 * build, build] if build else None, **runs)
        return made("rivals", technique, settings=tree, mode=mode, runs=runs, frame_ms=of(1))

    rows = [
        row("frustum-traced", "", "animated", 0, 6, 3, 1),
        row("frustum-traced", "", "static", 0, 4, 1, 1),
        row("embree", "build=low rays=fast", "animated", 2, 6, 4, 2),
        row("embree", "build=medium", "static", 0, 5, 4, 2),
        row("embree", "build=high", "static", 0, 8, 2, 2),
    ]
    assert [cells[1:] for cells in cells_of(rows)] == [
        ["animated", "6.00", "8.00", "0.750 ± 0", "0.600 ± 0", "3.00", "6.00", "0.500 ± 0", "0.375 ± 0", "10.0", "14.0",
         "0.714 ± 0", "0.625 ± 0", "low, low, low"],
        ["static", "4.00", "5.00", "0.800 ± 0", "0.800 ± 0", "1.00", "2.00", "0.500 ± 0", "0.500 ± 0", "6.00", "11.0",
         "0.545 ± 0", "0.545 ± 0", "medium, high, medium"],
    ]  # fmt: skip
    assert len(lines_of(rows, 1)) == 3  # one for each of the rival's settings


def test_the_automatic_map_is_compared_with_the_better_one():
    ms = {"on": [2.0, 4.0, 2.0], "off": [4.0, 8.0, 4.0], "auto": [2.2, 4.4, 2.2]}
    rows = [made("auto", settings=f"conservative-map={mode}", runs=of_runs(shadow=runs)) for mode, runs in ms.items()]
    assert cells_of(rows)[0][4:] == ["0.500", "0.500", "1.10", "1.10", "the same"]
    rows[1]["mask_hash"] = "2"
    assert cells_of(rows)[0][-1] == "DIFFER"


def test_clusters_show_what_is_dropped():
    kept = {"clusters": 40, "clusters_outside": 10, "clusters_too_far": 10, "triangles": 500, "triangles_outside": 50}
    stages = {"clusters": 1, "triangle_setup": 2}
    rows = [
        made("clusters", camera_ms=of(7), stages_ms={"triangle_setup": 4}),
        made("clusters", mode="moving", camera_ms=of(6), build_ms=of(5), counts=kept, stages_ms=stages),
    ]
    assert cells_of(rows)[0][3:] == ["4.00", "3.00", "7.00", "6.00", "50.0 %", "10.0 %", "5.00"]


def test_samples_are_compared_with_one_and_with_embree():
    parts = {"": 1.0, "samples=4": 2.0, "samples=32": 8.0}
    rows = [
        made(
            "samples", settings=text, runs=of_runs(camera=[1, 1], shadow=[ms, ms]), frame_ms=of(1 + ms), camera_ms=of(1)
        )
        for text, ms in parts.items()
    ]
    rays = of_runs(camera=[2, 2], shadow=[16, 16])
    rows.append(
        made("samples", "embree", settings="build=low", mode="static", runs=rays, frame_ms=of(18), camera_ms=of(2))
    )
    (line,) = lines_of(rows)
    assert (line["32 over 1"], line["frame, 32 over 1"]) == ("8.00 ± 0", "4.50 ± 0")
    assert (line["gnomon's 32 over its shadow rays"], line["frame over its frame"]) == ("0.500 ± 0", "0.500 ± 0")


def test_many_lights_are_compared_with_the_first_way():
    pairs = {"points": 10, "lights": 4, "facing": 20e6, "lit": 5e6, "differing": 3, "facing_per_second": 1e10,
             "ms_per_light": 0.5}  # fmt: skip
    rows = [made("many_lights", runs=of_runs(shadow=[2, 4]), pairs=pairs)]
    rows.append(made("many_lights", "embree", runs=of_runs(shadow=[6, 12]), pairs=pairs))
    first, second = cells_of(rows)
    assert first[2:] == ["10", "sun (4)", "20.0", "25.0 %", "frustum-traced", "10000", "0.500", "", "", "3"]
    assert second[-3:] == ["3.00", "3.00", "3"]


def test_published_tables_are_whole():
    """The totals of table 1 are the sum of its stages, but for the roundings: a slip of a digit would show."""
    for table in json.loads(PUBLISHED.read_text()):
        assert table["source"] and table["machine"] and table["experiment"] in {*TABLES, "table1", "table2"}
        assert all(len(row) == len(table["columns"]) for row in table["rows"])
    (table,) = (table for table in json.loads(PUBLISHED.read_text()) if table["experiment"] == "table1")
    assert len(table["rows"]) == 24
    for row in table["rows"]:
        assert abs(row[8] - sum(ms or 0 for ms in row[4:8])) < 0.021, row
    assert published("table1")[0].lines[0]["conservative map"] == "–"


# ---- The program -----------------------------------------------------------------------------------------------------


@pytest.fixture
def write(tmp_path):
    """Writes rows as bench does, and says where."""

    def written(rows, name="bench.json"):
        names = dict.fromkeys([*(row["experiment"] for row in rows), "memory"])
        experiments = [{"name": n, "title": f"Title of {n}", "idea": f"Idea of {n}."} for n in names if n != "times"]
        whole = {
            "machine": {"date": "today", "threads": 2},
            "experiments": experiments,
            "families": FAMILIES,
            "rows": rows,
        }
        (tmp_path / name).write_text(json.dumps(whole))
        return str(tmp_path / name)

    return written


def test_charts_are_written_and_say_what_is_where(write, tmp_path):
    rows = [*techniques(), made("techniques", ms=5, light="lamp", errors=wrong(0))]
    report.main([write(rows), "--charts", str(tmp_path / "chart")])
    assert sorted(path.name for path in tmp_path.glob("*.svg")) == [
        "chart_city.svg", "chart_city_lamp.svg", "chart_yard.svg"]  # fmt: skip
    svg = ElementTree.parse(tmp_path / "chart_yard.svg")
    texts = [node.text for node in svg.iter("{http://www.w3.org/2000/svg}text")]
    front = ["esm: 3.00 ms, 30 wrong", "vsm size=512: 4.00 ms, 20 wrong", "frustum-traced: 5.00 ms, 0 wrong"]
    assert [node.text for node in svg.iter("{http://www.w3.org/2000/svg}title")] == [front[2], front[1], front[0]]
    assert {"exact", "filtered maps", "yard v0.sun, 100x10, cpu"} <= set(texts) and "Embree" not in texts
    drawn = "".join(svg.getroot().itertext())
    assert all(f"{k}  {text}" in drawn for k, text in enumerate(front, 1))
    assert {name: matplotlib.rcParams[name] for name in STYLE_OF_OTHERS} == STYLE_OF_OTHERS


class Elements(HTMLParser):
    """Counts the elements of a page, and keeps what they load."""

    def __init__(self):
        super().__init__()
        self.counts, self.loads = {}, []

    def handle_starttag(self, tag, attributes):
        self.counts[tag] = self.counts.get(tag, 0) + 1
        self.loads += [value for name, value in attributes if name in ("src", "href") and tag != "use"]


def test_the_page_has_everything_and_loads_nothing(write, tmp_path):
    picture = {"width": 3, "height": 2, "mask": "255*2 -1 0*3", "error": "0*4 -1 7"}
    rows = [
        made("times", errors=wrong(0), runs=of_runs(shadow=[2], shade=[1]), frame_ms=of(3), stages_ms={"trace": 1}),
        made("errors", "vsm", errors=wrong(3), picture=picture),
        made("errors", "esm", errors=wrong(3), picture=picture),  # the same mask again
        *(made("growth_in_triangles", scene=f"city_{n}", triangles=n) for n in (100, 200)),
    ]
    report.main([write(rows), "--html", str(tmp_path / "page.html"), "--markdown", str(tmp_path / "tables.md")])
    page, tables = (tmp_path / "page.html").read_text(), (tmp_path / "tables.md").read_text()
    elements = Elements()
    elements.feed(page)
    assert (elements.counts["svg"], elements.counts["img"]) == (5, 2)  # two of errors, frames, stages, growth
    assert elements.counts["table"] == 4  # machine, times, errors, growth
    assert "script" not in elements.counts and all(load.startswith("data:image/png;") for load in elements.loads)
    assert "@import" not in page and "url(http" not in page
    for text in ("Title of errors", "Idea of errors.", "The scenes of the command line."):
        assert text in page and text in tables
    assert "| date" in tables and "## Title of memory" not in tables and "<svg" not in tables


def test_pictures_show_sky_and_errors():
    picture = {"width": 3, "height": 2, "mask": "255*2 -1 0*3", "error": "0*4 -255 64"}
    (row,) = report.rows_of([made("errors", errors=wrong(1), picture=picture)])
    mask, errors = report.images(row)
    assert mask.shape == (2, 3, 3) and np.all(mask[0, 2] == report.SKY)
    assert np.all(mask[0, :2] == 1) and np.all(mask[1] == 0)
    assert np.all(errors[1, 1] == report.TOO_DARK)
    assert np.allclose(errors[1, 2], 0.12 + np.sqrt(64 / 255) * (report.TOO_BRIGHT - 0.12))
    assert np.all(errors[1, 0] == 0.12) and np.all(errors[0] == 0.35)


def test_several_files_stand_one_after_the_other(write, tmp_path):
    files = [write([made("memory", scene=scene)], f"{scene}.json") for scene in ("one", "two")]
    report.main([*files, "--markdown", str(tmp_path / "tables.md")])
    text = (tmp_path / "tables.md").read_text()
    assert text.count("| date") == 2 and text.index("one v0.sun") < text.index("two v0.sun")
    same = [write(techniques(), name) for name in ("a.json", "b.json", "c.json")]
    with pytest.raises(SystemExit, match="two charts would be city_sun"):
        report.main([*same, "--charts", str(tmp_path / "chart")])


BROKEN = {
    "not JSON": "machine: here",
    "a list": "[]",
    "no rows": '{"machine": {}, "experiments": [], "families": {}}',
    "no families": '{"machine": {}, "experiments": [], "rows": []}',
    "rows of something else": '{"machine": {}, "experiments": [], "families": {}, "rows": [{"scene": "city"}]}',
    "bytes": b"\xff\xfe\x00",
}


@pytest.mark.parametrize("text", BROKEN.values(), ids=BROKEN)
def test_what_bench_did_not_write_gets_a_sentence(text, tmp_path):
    file = tmp_path / "broken.json"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(SystemExit) as stop:
        report.main([str(file), "--markdown", str(tmp_path / "tables.md")])
    assert stop.value.code == f"report.py: error: {file} is not what bench writes with --json"
    assert not (tmp_path / "tables.md").exists()


def test_a_missing_file_gets_a_sentence(tmp_path):
    with pytest.raises(SystemExit, match="report.py: error: cannot read .*gone.json: No such file or directory"):
        report.main([str(tmp_path / "gone.json"), "--html", str(tmp_path / "page.html")])


def test_an_output_must_be_named(write, capsys):
    with pytest.raises(SystemExit):
        report.main([write([made("memory")])])
    assert "name --html, --markdown or --charts" in capsys.readouterr().err
