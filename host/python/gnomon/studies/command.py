# SPDX-License-Identifier: MIT
"""The command gnomon-study: run, verify, export, picture and viewshed. Exit codes: 0 done, 1 it failed, 2 the command
line is wrong."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .. import DeviceNotFoundError, OpenCLError
from .._earth import EARTH_RADIUS
from .._viewshed import REFRACTION
from . import Execution, StudyStoppedError, open_study, read_toml, run, verify
from .settings import files_of
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
    return parser


def _add_viewshed(commands: Any) -> None:
    parser = commands.add_parser("viewshed", help="write which cells of a raster observers see (docs/viewshed.md)")
    parser.add_argument("raster", help="a GeoTIFF of heights, or a pattern such as 'tiles/*.tif', on one grid")
    parser.add_argument(
        "observers", help="x,y on the map (after -- if x is below 0), or a .csv file: columns x, y, perhaps height"
    )
    parser.add_argument("output", type=Path, help="the GeoTIFF that is written")
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


def _refraction(text: str) -> float | None:
    try:
        return None if text == "plane" else float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is neither a number nor 'plane'") from None


def _viewshed(options: argparse.Namespace) -> int:
    observers = observers_of(options.observers, options.height)
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


def _write(options: argparse.Namespace) -> int:
    study = open_study(options.folder)
    (study.export if options.command == "export" else study.picture)(options.output, options.what)
    return 0


def main(arguments: Sequence[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    try:
        return int(options.function(options))
    except (ValueError, OSError, StudyStoppedError, MemoryError, DeviceNotFoundError, OpenCLError) as error:
        print(f"gnomon-study: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("gnomon-study: stopped; the same command goes on from here", file=sys.stderr)
        return 130
