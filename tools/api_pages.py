# SPDX-License-Identifier: MIT
"""Makes the pages of the Python package with pdoc; what is public and has no docstring is an error.

usage: api_pages.py FOLDER
"""

import sys
from pathlib import Path

import pdoc
import pdoc.doc

MODULES = ["gnomon", "gnomon.studies"]


def undocumented(member):
    """The names of public classes and functions without a docstring, this one and those in it."""
    if isinstance(member, pdoc.doc.Variable) or member.name.startswith("_"):
        return []
    names = [] if member.docstring else [member.fullname]
    return names + [name for inner in getattr(member, "own_members", []) for name in undocumented(inner)]


modules = [pdoc.doc.Module.from_name(name) for name in MODULES]
missing = [name for module in modules for name in undocumented(module)]
for name in missing:
    print(f"{name} has no docstring", file=sys.stderr)
pdoc.pdoc(*MODULES, output_directory=Path(sys.argv[1]))
sys.exit(1 if missing else 0)
