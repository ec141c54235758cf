# SPDX-License-Identifier: MIT
"""Parses and renders a recipe of conda-forge's (recipe.yaml) as rattler-build does: one package, with its name, version
and tests. usage: check_recipe.py RECIPE VERSION"""

import sys

from rattler_build import Stage0Recipe, VariantConfig

recipe, version = sys.argv[1:]
variants = VariantConfig.from_yaml("""
python: [3.12.* *_cpython]
cxx_compiler: [gxx]
c_stdlib: [sysroot]
c_stdlib_version: ["2.28"]
""")
rendered = Stage0Recipe.from_file(recipe).render(variants)
if len(rendered) != 1:
    sys.exit(f"{recipe}: {len(rendered)} variants, must be 1")
package = rendered[0].recipe.package
if (package.name, str(package.version)) != ("gnomon", version):
    sys.exit(f"{recipe}: is {package.name} {package.version}, must be gnomon {version}")
print(f"{recipe}: {package.name} {package.version}")
