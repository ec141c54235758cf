# SPDX-License-Identifier: MIT
"""Makes the pages of the Python package with pdoc; what is public and has no docstring is an error.

usage: api_pages.py FOLDER
"""

import sys
import warnings
from pathlib import Path

import pdoc
import pdoc.doc

MODULES = [
    "gnomon", "gnomon.studies", "gnomon.surfaces", "gnomon.weather", "gnomon.xarray", "gnomon.integrations.ladybug",
]


def undocumented(member):
    """The names of public classes and functions without a docstring, this one and those in it."""
    if isinstance(member, pdoc.doc.Variable) or member.name.startswith("_"):
        return []
    names = [] if member.docstring else [member.fullname]
    return names + [name for inner in getattr(member, "own_members", []) for name in undocumented(inner)]


modules = [pdoc.doc.Module.from_name(name) for name in MODULES]
missing = [name for module in modules for name in undocumented(module)]
if missing:
    sys.exit("without a docstring: " + ", ".join(missing))
warnings.simplefilter("error", UserWarning)  # what pdoc warns of
# pdoc looks for the types of a NamedTuple's constructor in a module that does not import them.
warnings.filterwarnings("ignore", r"Error parsing type annotation ForwardRef\(.*\.__(init|new)__\.")
pdoc.pdoc(*MODULES, output_directory=Path(sys.argv[1]))
