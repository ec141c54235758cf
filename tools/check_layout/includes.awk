# SPDX-License-Identifier: MIT
# Follows the includes of all sources. Standard input: the sources' paths. `wings`: their names in the order of the flow.
# Prints each offence after the name of its rule: wings, direction, kernels, system, contracts, references (tools/check_layout.sh).

function normal(path) {  # without "x/../"
    while (match(path, /[^\/.]+\/\.\.\//)) path = substr(path, 1, RSTART - 1) substr(path, RSTART + RLENGTH)
    return path
}
function found(from, included,    folders, i, n, path) {
    n = 4
    if (from ~ /^kernels\//) n = split("kernels/", folders, " ")
    else if (from ~ /^tests\/reference\//) n = split("tests/ tests/reference/", folders, " ")
    else n = split("host/ ./ host/include/ tests/ tools/", folders, " ")
    folders[++n] = from
    sub(/[^\/]*$/, "", folders[n])
    for (i = 1; i <= n; ++i) {
        path = normal((folders[i] == "./" ? "" : folders[i]) included)
        if (path in is_file) return path
    }
    return ""
}
function place(file) {  # in the order of the flow; -1: outside of it; -2: in no wing
    if (file ~ /^host\/include\// || file ~ /^kernels\/[^\/]*$/) return 0
    if (file ~ /^host\/[^\/]*$/) return 1000
    if (file ~ /^host\/(app|measure|python|scene)\//) return -1
    sub(/^[a-z]+\//, "", file)
    sub(/\/[^\/]*$/, "", file)
    return file in order ? order[file] : -2
}
function judge(file, target, where,    from, to) {
    if (file ~ /^kernels\// && target !~ /^kernels\//) print "kernels " where
    if (file ~ /^tests\/reference\// && target !~ /^tests\/reference\//) print "references " where
    if (file !~ /^(kernels|host)\// || target !~ /^(kernels|host)\//) return
    from = place(file)
    to = place(target)
    if (from >= 0 && (to < 0 || to > from)) print "direction " where
}
# only[d]: whether the branch of the conditional at depth d is for C++ alone (1), for OpenCL alone (-1) or for both (0).
function follow_conditionals(text) {
    if (text ~ /^[ \t]*#[ \t]*endif/) --depth
    else if (text ~ /^[ \t]*#[ \t]*else/) only[depth] = -only[depth]
    else if (text ~ /^[ \t]*#[ \t]*elif/) only[depth] = 0
    else if (text ~ /^[ \t]*#[ \t]*if/) {
        only[++depth] = text ~ /__cplusplus/ ? 1 : text ~ /__OPENCL_VERSION__/ ? -1 : 0
        if (text ~ /ifndef|!/) only[depth] = -only[depth]
    }
}
function is_within(kind,    d) {
    for (d = 1; d <= depth; ++d) if (only[d] == kind) return 1
    return 0
}
BEGIN { n = split(wings, names, " "); for (i = 1; i <= n; ++i) order[names[i]] = i }
{ is_file[$0] = 1; files[++file_count] = $0 }
END {
    for (f = 1; f <= file_count; ++f) {
        file = files[f]
        if (file ~ /^(kernels|host)\// && place(file) == -2) print "wings " file
        depth = 0
        for (line = 1; (getline text < file) > 0; ++line) {
            if (text ~ /^[ \t]*#/) follow_conditionals(text)
            if (file ~ /^kernels\// && text ~ /^[ \t]*#[ \t]*include[ \t]*</ && !is_within(1))
                print "system " file ":" line ":" text
            if (text !~ /^[ \t]*#[ \t]*include[ \t]*"/) continue
            included = text
            sub(/^[^"]*"/, "", included)
            sub(/".*/, "", included)
            target = found(file, included)
            judge(file, target, file ":" line ":" text)
            if (target ~ /^kernels\// && !is_within(-1)) reads[file, ++read_count[file]] = target
        }
        close(file)
        if (file !~ /^kernels\//) pending[++pending_count] = file
    }
    for (p = 1; p <= pending_count; ++p)  # C++, then the contracts that it reads
        for (i = 1; i <= read_count[pending[p]]; ++i) {
            target = reads[pending[p], i]
            if (target !~ /\.h$/) print "contracts " pending[p] " reads " target
            else if (!(target in is_read)) { is_read[target] = 1; pending[++pending_count] = target }
        }
    for (f = 1; f <= file_count; ++f)
        if (files[f] ~ /^kernels\/.*\.h$/ && !(files[f] in is_read)) print "contracts " files[f] " (no C++ reads it)"
}
