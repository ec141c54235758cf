#!/bin/bash
# SPDX-License-Identifier: MIT
# Builds the site into FOLDER/site: what people read in the repository, the pages of tools/packaging/site, and the API
# pages (tools/api_pages.sh). A link that leads nowhere and a picture without a description are errors. GNOMON is the
# command, which is asked for the page of a check; PYTHON has mkdocs-material, linkchecker, cffconvert, pdoc and
# gnomon[study]. usage: site.sh FOLDER GNOMON PYTHON
set -euo pipefail
mkdir -p "$1"
folder=$(realpath "$1") gnomon=$(realpath "$2") python=$(realpath -s "$3")
here=$(realpath "$(dirname "$0")")
cd "$here/../.."
pages=$folder/pages
tool() { nice "$python" -m "$@"; }

# Links between pages lead to where they lead in the repository, since pages lie there as they do here.
rm -rf "$pages" "$folder/site"
mkdir -p "$pages"
git ls-files -z --cached --others --exclude-standard -- '*.md' docs CITATION.cff LICENSE ':!third_party' ':!tests' ':!tools' |
    xargs -0 cp --parents -t "$pages"
cp "$here"/site/*.md "$pages"
cp "$here/site/mkdocs.yml" "$folder"
"$here/fill_in.sh" -- "$folder/mkdocs.yml" "$pages/CITATION.cff"

tools/api_pages.sh "$python" >"$folder/api_pages.log"
mkdir "$pages/api"
cp -r build/api/cpp build/api/python "$pages/api"

# fill WORD FILE COMMAND...: the command's output in place of the word.
fill() {
    "${@:3}" >"$folder/filled"
    sed -i -e "/$1/{r $folder/filled" -e 'd}' "$2"
}
fill @CHECK@ "$pages/which_device.md" "$gnomon" devices --check
fill @CITATION@ "$pages/citing.md" "$(dirname "$python")/cffconvert" -f bibtex -i "$pages/CITATION.cff"
"$here/fill_in.sh" -- "$pages"/{which_device,citing}.md
sed -n '/^## Tried by us/,$p' docs/drivers.md >>"$pages/which_device.md"

NO_MKDOCS_2_WARNING=1 tool mkdocs build --strict --config-file "$folder/mkdocs.yml" >"$folder/mkdocs.log" 2>&1 ||
    { grep -vE '^INFO' "$folder/mkdocs.log" >&2; exit 1; }
without_text=$(grep -rlE '<img [^>]*>' "$folder/site" --include='*.html' --exclude-dir=api |
    xargs grep -noE '<img [^>]*>' | grep -vE 'alt="[^"]+' || true)
if [ -n "$without_text" ]; then echo "pictures without a description: $without_text" >&2; exit 1; fi
grep -q '"docs"' "$folder/site/search/search_index.json"
nice "$(dirname "$python")/linkchecker" --quiet --no-status --ignore-url='^(https?|mailto):' --ignore-url=/api/cpp/ \
    "$folder/site/index.html" || { echo "the site has links that lead nowhere" >&2; exit 1; }
echo "$folder/site/index.html: $(find "$folder/site" -name '*.html' | wc -l) pages"
