# SPDX-License-Identifier: MIT
"""gnomon.study() and the command gnomon-study, which import gnomon.studies and its packages at their first use."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .studies import Study

NEEDS = "gnomon.study needs {}, which is not installed: pip install 'gnomon[study]'"


def study(folder: Any, **arguments: Any) -> Study:
    """Runs a sun study over tiles, or goes on with the one in the folder: gnomon.studies.study() has the arguments.
    Raises ImportError with the remedy where pip install 'gnomon[study]' was not done."""
    try:
        from . import studies

        return studies.study(folder, **arguments)
    except ModuleNotFoundError as error:
        raise ImportError(NEEDS.format(error.name)) from None


def main() -> int:
    """The command gnomon-study."""
    try:
        from .studies.command import main as command

        return command()
    except ModuleNotFoundError as error:
        print(f"gnomon-study: {NEEDS.format(error.name)}", file=sys.stderr)
        return 1
