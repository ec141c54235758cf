# SPDX-License-Identifier: MIT
"""gnomon-study: run, verify, export and picture from the command line. Exit codes: 0 done, 1 something failed, 2 the
command line is wrong."""

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

    one = commands.add_parser("run", help="run a study, or go on with it")
    one.add_argument("file", type=Path, help="study.toml: settings, and in [run] folder, workers, device")
    one.add_argument(
        "--folder", type=Path, help="of the study; default: [run] folder, else the file's name without .toml"
    )
    one.add_argument(
        "--workers", help="processes of this host, 'gpus', or the address of a dask scheduler; default: none"
    )
    one.add_argument("--device", help="P:D as gnomon devices lists it, or a part of its name")
    one.add_argument("--tiles", help="i:j, these receiver tiles alone, for job arrays: no dask is needed")
    one.add_argument("--restart", action="store_true", help="begin anew, whatever is in the folder")
    one.add_argument("--no-check", action="store_true", help="do not read what is done to find damaged chunks")
    one.add_argument("--strict", action="store_true", help="fail if an answer is undecided")
    one.add_argument("--quiet", action="store_true", help="no progress, no summary")
    one.set_defaults(function=_run)

    two = commands.add_parser("verify", help="recompute a random share and compare bits")
    two.add_argument("folder", type=Path)
    two.add_argument("--share", type=float, default=0.05, help="of the tasks, 0 to 1 (0: only files are checked)")
    two.add_argument("--device", help="another device than before, say")
    two.add_argument("--seed", type=int)
    two.set_defaults(function=_verify)

    for name, text in (("export", "write a result as GeoTIFF (COG) or CSV"), ("picture", "draw a map with a legend")):
        more = commands.add_parser(name, help=text)
        more.add_argument("folder", type=Path)
        more.add_argument("output", type=Path, help="the file; for packed bits a folder")
        more.add_argument("--what", help="sun_hours, sum_of_weights or lit")
        more.set_defaults(function=_write)
    return parser


def _tiles(text: str | None) -> slice | None:
    if text is None:
        return None
    first, colon, last = text.partition(":")
    if not colon or not (first + last).isdigit() and first + last:
        raise ValueError(f"--tiles: {text!r} is not i:j, such as 0:16")
    return slice(int(first) if first else None, int(last) if last else None)


def _run(options: argparse.Namespace) -> int:
    settings, of_run = read_toml(options.file)
    unknown = sorted(set(of_run) - {"folder", "workers", "device"})
    if unknown:
        raise ValueError(f"{options.file}: [run] has no {', '.join(unknown)}: only folder, workers, device")
    base = options.file.absolute().parent
    folder = options.folder or base / of_run.get("folder", options.file.stem)
    workers: Any = options.workers if options.workers is not None else of_run.get("workers")
    if isinstance(workers, str) and workers.isdigit():
        workers = int(workers)
    device = options.device or of_run.get("device")
    how = Execution(
        workers=workers,
        device=device,
        tiles=_tiles(options.tiles),
        restart=options.restart,
        check=not options.no_check,
        progress=not options.quiet,
    )
    result = run(folder, settings, how)
    record = result.record
    if not options.quiet:
        print(json.dumps({k: v for k, v in record.items() if k not in ("chunks", "settings", "versions")}, indent=1))
    if record["unread_casters"]:
        names = ", ".join(record["unread_casters"])
        print(f"gnomon-study: could not read {names}: run again when it is mended", file=sys.stderr)
    if record["undecided"]:
        print(f"gnomon-study: {record['undecided']:,} answers are undecided", file=sys.stderr)
        return 1 if options.strict else 0
    return 0


def _verify(options: argparse.Namespace) -> int:
    found = open_study(options.folder).verify(options.share, options.device, options.seed)
    print(f"{found.tasks} tasks recomputed on {found.device}: {len(found.wrong)} chunks differ")
    for text, chunks in (("damaged", found.damaged), ("differs", found.wrong)):
        for chunk in chunks:
            print(f"{text}: {chunk}")
    if found.missing:
        print(f"{found.missing} tasks are not done")
    return 0 if found.is_good else 1


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
