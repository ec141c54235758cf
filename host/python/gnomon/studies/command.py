# SPDX-License-Identifier: MIT
"""The command gnomon-study: run, verify, export, picture, viewshed and shares. Exit codes: 0 done, 1 it failed, 2 the
command line is wrong."""

from __future__ import annotations

import argparse
import dataclasses
import json
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .. import DeviceNotFoundError, OpenCLError
from .._earth import EARTH_RADIUS
from .._files import require_other
from .._viewshed import REFRACTION
from . import Execution, StudyStoppedError, open_study, read_toml, run, verify
from .mesh_viewshed import MeshSettings, write_seen_targets
from .meshes import SUFFIXES as SUFFIXES_OF_MESHES
from .settings import files_of
from .shares import WHAT as WHAT_OF_SHARES
from .shares import ShareSettings, write_shares
from .viewshed import WHAT, observers_of, write_viewshed
from .viewshed_plan import ViewshedSettings

WORKERS = "processes of this host, 'gpus', or the address of a dask scheduler; default: none"


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="gnomon-study", description="Sun studies over tiles (docs/studies.md).")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    run_parser = commands.add_parser("run", help="run a study, or go on with it")
    run_parser.add_argument("file", type=Path, help="study.toml: settings, and in [run] folder, workers, device")
    run_parser.add_argument(
        "--folder", type=Path, help="the study's; default: [run] folder, else the file's name without .toml"
    )
    run_parser.add_argument("--workers", help=WORKERS)
    run_parser.add_argument(
        "--epw", type=Path, metavar="FILE", help="a weather file, EPW or TMY3: irradiation in kWh/m2 (setting weather)"
    )
    run_parser.add_argument("--device", help="P:D as gnomon devices lists it, or a part of its name")
    run_parser.add_argument("--tiles", help="i:j, these receiver tiles alone, for job arrays: no dask is needed")
    run_parser.add_argument(
        "--restart", action="store_true", help="begin again, and drop the study that is in the folder"
    )
    run_parser.add_argument(
        "--no-check", action="store_true", help="do not read the chunks of done tasks to find damaged ones"
    )
    run_parser.add_argument("--strict", action="store_true", help="fail if an answer is undecided")
    run_parser.add_argument("--quiet", action="store_true", help="no progress, no summary")
    run_parser.set_defaults(function=_run)

    verify_parser = commands.add_parser("verify", help="recompute a random share and compare bits")
    verify_parser.add_argument("folder", type=Path)
    verify_parser.add_argument(
        "--share", type=float, default=0.05, help="the part of the tasks, 0 to 1 (0: only files are checked)"
    )
    verify_parser.add_argument("--device", help="the device that recomputes, P:D or a part of its name")
    verify_parser.add_argument("--seed", type=int)
    verify_parser.add_argument(
        "--lines", type=int, default=20, help="of a viewshed: lines of sight that rational arithmetic follows"
    )
    verify_parser.set_defaults(function=_verify)

    for name, text in (("export", "write a result as GeoTIFF (COG) or CSV"), ("picture", "draw a map with a legend")):
        write_parser = commands.add_parser(name, help=text)
        write_parser.add_argument("folder", type=Path)
        write_parser.add_argument("output", type=Path, help="the file; for packed bits a folder")
        write_parser.add_argument("--what", help="a result's name, such as sun_hours, lit or seen; or suns")
        write_parser.set_defaults(function=_write)
    _add_viewshed(commands)
    _add_shares(commands)
    for command in commands.choices.values():
        command._negative_number_matcher = re.compile(r"-\.?\d")  # -33.9,18.4 is a place, and no option
    return parser


def _add_viewshed(commands: Any) -> None:
    parser = commands.add_parser("viewshed", help="write which cells of a raster observers see (docs/viewshed.md)")
    parser.add_argument(
        "raster", help="a GeoTIFF of heights, or a pattern such as 'tiles/*.tif', on one grid; with --targets a mesh"
    )
    parser.add_argument(
        "observers", help="x,y on the map, or a .csv file: columns x, y, perhaps height; of a mesh x, y, z"
    )
    parser.add_argument("output", type=Path, help="the GeoTIFF that is written; with --targets a .csv file")
    parser.add_argument(
        "--targets", metavar="FILE", help="no raster: which of these points (x, y, z, perhaps nx, ny, nz) are seen"
    )
    parser.add_argument("--what", choices=WHAT, help="default: seen for one observer, else counts")
    parser.add_argument("--height", type=float, default=2.0, help="of eyes above the ground, m; default: %(default)g")
    parser.add_argument("--target-height", type=float, default=0.0, help="of targets above the ground, m")
    parser.add_argument("--distance", type=float, help="cells farther away are not seen, m")
    parser.add_argument(
        "--refraction", type=_refraction, default=REFRACTION, help="k, or 'plane': no curvature; default: 1/7"
    )
    parser.add_argument("--radius", type=float, default=EARTH_RADIUS, help="the Earth's, m; default: %(default).0f")
    parser.add_argument("--outside", type=float, help="what stands where there is no data is at most this high, m")
    parser.add_argument("--height-unit", help="of the raster's heights; default: what it declares, or metres")
    parser.add_argument(
        "--mesh", metavar="FILE", action="append", default=[], help="what stands on the raster, in its CRS"
    )
    parser.add_argument("--mesh-up", choices=("y", "z"), help="default: y of glTF, else z")
    parser.add_argument(
        "--mesh-offset",
        type=_offset,
        default=(0.0, 0.0, 0.0),
        metavar="X,Y,Z",
        help="is added to the meshes' coordinates",
    )
    parser.add_argument(
        "--folder", type=Path, help="the study's, which is kept for verify and export; default: a passing one"
    )
    parser.add_argument("--bits", action="store_true", help="keep each answer as packed bits in the folder")
    parser.add_argument("--tile", type=int, metavar="ROWS", help="of a tile; default: as many as have 2^24 cells")
    parser.add_argument("--block", type=int, default=128, help="observers of a task; default: %(default)d")
    parser.add_argument("--restart", action="store_true", help="begin again, and drop what is in the folder")
    parser.add_argument("--workers", help=WORKERS)
    parser.add_argument("--device", help="P:D as gnomon devices lists it, or a part of its name")
    parser.add_argument("--quiet", action="store_true", help="no progress, no summary")
    parser.set_defaults(function=_viewshed)


def _add_shares(commands: Any) -> None:
    parser = commands.add_parser(
        "shares", help="write the lit share of each planar polygon of a model (docs/shares.md)"
    )
    parser.add_argument("model", help="CityJSON, honeybee's HBJSON, OBJ, OFF, PLY, STL, glTF; of meshes each face")
    parser.add_argument("output", type=Path, help="the .csv file that is written")
    files = "default: %(default)s; shaded: pvlib's shaded fraction; energyplus: like its external shading results"
    parser.add_argument("--what", choices=WHAT_OF_SHARES, default="intervals", help=files)
    parser.add_argument(
        "--faces", metavar="PATTERN", help="names of polygons with * and ?: the others only cast shadows"
    )
    parser.add_argument(
        "--occluders", metavar="FILE", action="append", default=[], help="one more model that only casts shadows"
    )
    suns = parser.add_argument_group("suns: one of these")
    suns.add_argument("--directions", metavar="FILE", help="a table of suns (docs/studies.md)")
    suns.add_argument("--epw", metavar="FILE", help="a weather file: the suns of its hours")
    suns.add_argument(
        "--place", type=_place, metavar="LAT,LON", help="degrees, north and east positive, with a day or year"
    )
    suns.add_argument("--day", metavar="YYYY-MM-DD", help="the suns of a day")
    suns.add_argument("--year", type=int, metavar="YYYY", help="the suns of a year")
    suns.add_argument("--step", type=float, metavar="MINUTES", help="one sun in its middle; default: 10, of a year 60")
    suns.add_argument("--utc", type=float, metavar="HOURS", help="ahead of universal time; default: longitude / 15")
    parser.add_argument("--up", choices=("y", "z"), help="default: y of glTF, else z")
    parser.add_argument("--north", type=float, default=0.0, metavar="DEGREES", help="clockwise from y (y up: from -z)")
    parser.add_argument("--within", type=float, default=0.01, help="the width of an interval; default: %(default)g")
    work = "shadows that are subtracted from a triangle under a sun, at most; default: %(default)d"
    parser.add_argument("--limit", type=int, default=10_000, help=work)
    parser.add_argument("--centroids", action="store_true", help="of what is lit: x, y, z, in the model's coordinates")
    parser.add_argument("--strict", action="store_true", help="fail if an interval is wider than --within")
    parser.add_argument("--quiet", action="store_true", help="no progress, no summary")
    parser.set_defaults(function=_shares)


def _offset(text: str) -> tuple[float, float, float]:
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not X,Y,Z, such as 691000,5334000,0") from None
    return x, y, z


def _place(text: str) -> tuple[float, float]:
    try:
        latitude, longitude = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not LAT,LON, such as 48.2,16.4") from None
    return latitude, longitude


def _shares(options: argparse.Namespace) -> int:
    given = {field.name: getattr(options, field.name) for field in dataclasses.fields(ShareSettings)}
    record = write_shares(options.output, ShareSettings(**given | {"occluders": tuple(options.occluders)}),
                          progress=not options.quiet)  # fmt: skip
    if not options.quiet:
        print(json.dumps(record, indent=1))
    for key, text in (("left_out", "left out"), ("not_planar", "not planar, taken as their triangles")):
        if record[key]:
            more = f" and {len(record[key]) - 3:,} more" if len(record[key]) > 3 else ""
            print(f"gnomon-study: {text}: {'; '.join(record[key][:3])}{more}", file=sys.stderr)
    if record["wider_than_within"]:
        print(f"gnomon-study: {record['wider_than_within']:,} intervals are wider than {options.within:g}: give a "
              "greater --limit", file=sys.stderr)  # fmt: skip
        return 1 if options.strict else 0
    return 0


def _refraction(text: str) -> float | None:
    try:
        return None if text == "plane" else float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is neither a number nor 'plane'") from None


#: Options of rasters alone, and their defaults.
OF_RASTERS = {"what": None, "refraction": REFRACTION, "radius": EARTH_RADIUS, "outside": None, "height_unit": None,
              "folder": None, "bits": False, "tile": None, "block": 128, "restart": False, "workers": None}  # fmt: skip


def _seen_targets(options: argparse.Namespace) -> int:
    for name, default in OF_RASTERS.items():
        if getattr(options, name) != default and (name, getattr(options, name)) != ("refraction", None):
            raise ValueError(f"--{name.replace('_', '-')}: is of rasters: leave it out with --targets")
    record = write_seen_targets(
        options.output,
        MeshSettings(
            meshes=(*files_of(options.raster), *(files_of(options.mesh) if options.mesh else ())),
            **{name: getattr(options, name) for name in MeshSettings._fields[1:]},
        ),
    )
    if not options.quiet:
        print(json.dumps(record, indent=1))
    return 0


def _viewshed(options: argparse.Namespace) -> int:
    if options.targets is not None:
        return _seen_targets(options)
    if (suffix := Path(options.raster).suffix.lower()) in (*SUFFIXES_OF_MESHES, ".cityjson"):
        raise ValueError(f"{options.raster}: is a mesh ({suffix}): give --targets too, a table of what is looked at")
    observers = observers_of(options.observers, options.height)
    require_other(options.output, [options.observers])
    what = options.what or ("seen" if len(observers) == 1 else "counts")
    if what != "counts" and len(observers) != 1:
        raise ValueError(f"what: {what!r} is for one observer, and there are {len(observers)}")
    settings = ViewshedSettings(
        raster=files_of(options.raster),
        observers=observers,
        target_height=options.target_height,
        distance=options.distance,
        refraction=options.refraction,
        radius=options.radius,
        outside=options.outside,
        height_unit=options.height_unit,
        outputs=tuple(dict.fromkeys((WHAT[what], *(("bits",) if options.bits else ())))),
        tile=options.tile,
        block=options.block,
        meshes=files_of(options.mesh) if options.mesh else (),
        mesh_up=options.mesh_up,
        mesh_offset=options.mesh_offset,
    )
    execution = Execution(
        workers=_workers(options.workers), device=options.device, restart=options.restart, progress=not options.quiet
    )
    record = write_viewshed(options.output, settings, options.folder, execution)
    if not options.quiet:
        print(json.dumps(record, indent=1))
    return 0


def _workers(given: Any) -> Any:
    return int(given) if isinstance(given, str) and given.isdigit() else given


def _tiles(text: str | None) -> slice | None:
    if text is None:
        return None
    first, colon, last = text.partition(":")
    if not colon or not (first + last).isdigit() and first + last:
        raise ValueError(f"--tiles: {text!r} is not i:j, such as 0:16")
    return slice(int(first) if first else None, int(last) if last else None)


def _run(options: argparse.Namespace) -> int:
    settings, run_keys = read_toml(options.file, **({"weather": str(options.epw.absolute())} if options.epw else {}))
    unknown = sorted(set(run_keys) - {"folder", "workers", "device"})
    if unknown:
        raise ValueError(f"{options.file}: [run] has no key {', '.join(unknown)}: its keys are folder, workers, device")
    base = options.file.absolute().parent
    folder = options.folder or base / run_keys.get("folder", options.file.stem)
    workers = _workers(options.workers if options.workers is not None else run_keys.get("workers"))
    device = options.device or run_keys.get("device")
    execution = Execution(
        workers=workers,
        device=device,
        tiles=_tiles(options.tiles),
        restart=options.restart,
        check=not options.no_check,
        progress=not options.quiet,
    )
    record = run(folder, settings, execution).record
    if not options.quiet:
        print(json.dumps({k: v for k, v in record.items() if k not in ("chunks", "settings", "versions")}, indent=1))
    if record["unread_casters"]:
        names = ", ".join(record["unread_casters"])
        print(f"gnomon-study: could not read {names}: run again when they can be read", file=sys.stderr)
    if record["undecided"]:
        print(f"gnomon-study: {record['undecided']:,} answers are undecided", file=sys.stderr)
        return 1 if options.strict else 0
    return 0


def _verify(options: argparse.Namespace) -> int:
    verified = verify(options.folder.absolute(), options.share, options.device, options.seed, options.lines)
    print(f"{verified.tasks} tasks recomputed on {verified.device}: {len(verified.wrong)} chunks differ")
    if verified.lines:
        print(f"{verified.lines} lines of sight in rational arithmetic: {len(verified.wrong_lines)} differ")
    for text, chunks in (("damaged", verified.damaged), ("differs", [*verified.wrong, *verified.wrong_lines])):
        for chunk in chunks:
            print(f"{text}: {chunk}")
    if verified.missing:
        print(f"{verified.missing} tasks are not done")
    return 0 if verified.is_good else 1


def files_read_by(settings: Any) -> list[str]:
    single = (getattr(settings, name, None) for name in ("points", "directions", "weather", "weights"))
    return [*settings.raster, *settings.meshes, *(name for name in single if name)]


def _write(options: argparse.Namespace) -> int:
    study = open_study(options.folder)
    if not options.output.is_dir():  # packed bits are written into a folder
        require_other(options.output, files_read_by(study.plan.settings))
    (study.export if options.command == "export" else study.picture)(options.output, options.what)
    return 0


def main(arguments: Sequence[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    try:
        return int(options.function(options))
    except (ValueError, OSError, StudyStoppedError, MemoryError, DeviceNotFoundError, OpenCLError) as error:
        text = str(error)
        if isinstance(error, OSError) and error.filename and error.strerror:
            text = f"{error.filename}: {error.strerror}"
        print(f"gnomon-study: {text}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        is_kept = options.command in ("run", "viewshed")
        print(f"gnomon-study: stopped{'; the same command goes on from here' * is_kept}", file=sys.stderr)
        return 130
