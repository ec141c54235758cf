# SPDX-License-Identifier: MIT
# Prints "COUNT NAME FILE" for each kernel of the given files: the arguments in its head, local memory included. Where a
# macro stands in the head, its longest definition counts; GN_SHARES, of CPUs alone, does not.

# Commas outside of brackets, those of macros in the text included.
function commas(text, level,    n, rest, name, depth) {
    n = 0
    rest = text
    while (match(rest, /[A-Za-z_][A-Za-z_0-9]*|[(),]/)) {
        name = substr(rest, RSTART, RLENGTH)
        rest = substr(rest, RSTART + RLENGTH)
        if (name == "(") ++depth
        else if (name == ")") --depth
        else if (name == ",") { if (!depth) ++n }
        else if ((name in bodies) && name != "GN_SHARES" && level < 4) n += max_commas(name, level + 1)
    }
    return n
}
function max_commas(name, level,    i, n, most) {
    most = 0
    for (i = 1; i <= bodies[name]; ++i) if ((n = commas(body[name, i], level)) > most) most = n
    return most
}
# The text up to the bracket that closes it.
function bracket(text,    i, n, c) {
    n = 1
    for (i = 1; i <= length(text); ++i) {
        c = substr(text, i, 1)
        if (c == "(") ++n
        else if (c == ")" && !--n) return substr(text, 1, i - 1)
    }
    return text
}
function take_logical_line(text,    name) {
    if (text ~ /^[ \t]*#[ \t]*define[ \t]/ && match(text, /define[ \t]+[A-Za-z_0-9]+/)) {
        name = substr(text, RSTART, RLENGTH)
        sub(/define[ \t]+/, "", name)
        text = substr(text, RSTART + RLENGTH)
        if (text ~ /^\(/) sub(/^\([^)]*\)/, "", text)
        body[name, ++bodies[name]] = text
    } else if (text ~ /^[ \t]*#/) return
    texts[FILENAME] = texts[FILENAME] " " text
}
{
    text = $0
    sub(/\/\/.*/, "", text)
    if (sub(/\\[ \t]*$/, " ", text)) joined = joined text
    else { take_logical_line(joined text); joined = "" }
}
END {
    for (file in texts) {
        rest = texts[file]
        while (match(rest, /__kernel[^;{]*void[ \t]+[A-Za-z_][A-Za-z_0-9#]*\(|GN_KERNEL_OF_ITEMS\(/)) {
            name = substr(rest, RSTART, RLENGTH - 1)
            rest = substr(rest, RSTART + RLENGTH)
            parameters = bracket(rest)
            if (name ~ /^GN/) {  # (name, count, parameters, names)
                split(parameters, parts, /[ \t]*,[ \t]*/)
                name = parts[1]
                parameters = parts[3]
            }
            sub(/.*[ \t]/, "", name)
            print commas(parameters) + (parameters ~ /[^ \t]/), name, file
        }
    }
}
