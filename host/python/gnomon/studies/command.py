# SPDX-License-Identifier: MIT
"""The command gnomon-study: run, verify, export and picture. Exit codes: 0 done, 1 a study failed, 2 the command line
is wrong."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .. import DeviceNotFoundError, OpenCLError
from . import Execution, StudyStoppedError, open_study, read_toml, run


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="gnomon-study", description="Sun studies over tiles (docs/studies.md).")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    run_parser = commands.add_parser("run", help="run a study, or go on with it")
    run_parser.add_argument("file", type=Path, help="study.toml: settings, and in [run] folder, workers, device")
    run_parser.add_argument(
        "--folder", type=Path, help="the study's; default: [run] folder, else the file's name without .toml"
    )
    run_parser.add_argument(
        "--workers", help="processes of this host, 'gpus', or the address of a dask scheduler; default: none"
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
    verify_parser.set_defaults(function=_verify)

    for name, text in (("export", "write a result as GeoTIFF (COG) or CSV"), ("picture", "draw a map with a legend")):
        write_parser = commands.add_parser(name, help=text)
        write_parser.add_argument("folder", type=Path)
        write_parser.add_argument("output", type=Path, help="the file; for packed bits a folder")
        write_parser.add_argument("--what", help="sun_hours, sum_of_weights, lit or suns")
        write_parser.set_defaults(function=_write)
    return parser


def _tiles(text: str | None) -> slice | None:
    if text is None:
        return None
    first, colon, last = text.partition(":")
    if not colon or not (first + last).isdigit() and first + last:
        raise ValueError(f"--tiles: {text!r} is not i:j, such as 0:16")
    return slice(int(first) if first else None, int(last) if last else None)


def _run(options: argparse.Namespace) -> int:
    settings, run_keys = read_toml(options.file)
    unknown = sorted(set(run_keys) - {"folder", "workers", "device"})
    if unknown:
        raise ValueError(f"{options.file}: [run] has no key {', '.join(unknown)}: its keys are folder, workers, device")
    base = options.file.absolute().parent
    folder = options.folder or base / run_keys.get("folder", options.file.stem)
    workers: Any = options.workers if options.workers is not None else run_keys.get("workers")
    if isinstance(workers, str) and workers.isdigit():
        workers = int(workers)
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
    verified = open_study(options.folder).verify(options.share, options.device, options.seed)
    print(f"{verified.tasks} tasks recomputed on {verified.device}: {len(verified.wrong)} chunks differ")
    for text, chunks in (("damaged", verified.damaged), ("differs", verified.wrong)):
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
