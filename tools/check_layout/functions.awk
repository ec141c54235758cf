# SPDX-License-Identifier: MIT
# Prints the functions and macros of the given files that have more than `most` lines, heads included. A function ends
# where the brace of its body closes. Relies on clang-format: a space precedes the brace of a body, none that of an
# initialiser.

# The line without comments, strings and characters.
function bare(text,    raw) {
    if (in_raw) {
        if (!(raw = index(text, raw_end))) return ""
        text = substr(text, raw + length(raw_end))
        in_raw = 0
    }
    gsub(/\\./, "", text)
    if (match(text, /R"[A-Za-z_]*\(/)) {
        raw_end = ")" substr(text, RSTART + 2, RLENGTH - 3) "\""
        raw = substr(text, RSTART + RLENGTH)
        text = substr(text, 1, RSTART - 1)
        if (!index(raw, raw_end)) in_raw = 1
        else text = text substr(raw, index(raw, raw_end) + length(raw_end))
    }
    gsub(/"[^"]*"/, "0", text)
    gsub(/\047[^\047]\047/, "0", text)
    sub(/\/\/.*/, "", text)
    gsub(/\/\*[^*]*\*\//, "", text)
    return text
}
function finish(first, what) {
    if (FNR - first + 1 <= most) return
    sub(/^[ \t]+/, "", what)
    print FILENAME ":" first ": " FNR - first + 1 " lines: " substr(what, 1, 60)
}
function open_brace(before,    outside) {
    ++depth
    if (function_depth) return
    kind[depth] = "initialiser"
    if (before !~ /(^|[ \t])$/) return
    outside = head  # of brackets
    while (gsub(/\([^()]*\)|<[^<>]*>/, "", outside)) continue
    if (outside ~ /\(/ || (outside ~ /(^|[^=!<>])=([^=]|$)/ && outside !~ /operator/)) return
    kind[depth] = "scope"
    if (head ~ /\)/ && head !~ /^[ \t]*(template[^>]*>[ \t]*)?(namespace|class|struct|enum|union|extern)[ \t]/) {
        kind[depth] = "function"
        function_depth = depth
        function_first = head_first
        function_head = head
    } else head = ""
}
function close_brace() {
    if (depth == function_depth) { finish(function_first, function_head); function_depth = 0; head = "" }
    else if (!function_depth && kind[depth] == "scope") head = ""
    if (depth > 0) --depth
}
FNR == 1 { depth = function_depth = conditionals = in_raw = in_macro = 0; head = "" }
in_macro || (!in_raw && /^[ \t]*#/) {
    if (!in_macro) {
        macro_first = FNR
        macro = $0
        # After #else stands another text for the same place.
        if (/^[ \t]*#[ \t]*if/) {
            saved[++conditionals] = depth " " function_depth " " function_first
            saved_head[conditionals] = head
        }
        if (/^[ \t]*#[ \t]*el/ && conditionals) {
            split(saved[conditionals], state, " ")
            depth = state[1]; function_depth = state[2]; function_first = state[3]
            head = saved_head[conditionals]
        }
        if (/^[ \t]*#[ \t]*endif/ && conditionals) --conditionals
    }
    in_macro = /\\$/
    if (!in_macro) finish(macro_first, macro)
    next
}
{
    text = bare($0)
    while (match(text, /[{};]/)) {
        mark = substr(text, RSTART, 1)
        before = substr(text, 1, RSTART - 1)
        text = substr(text, RSTART + 1)
        if (!function_depth) {
            if (head !~ /[^ \t]/) { head = ""; head_first = FNR }
            head = head " " before
        }
        if (mark == "{") open_brace(before)
        else if (mark == "}") close_brace()
        else if (!function_depth) head = ""
    }
    if (!function_depth && text ~ /[^ \t]/) {
        if (head !~ /[^ \t]/) { head = ""; head_first = FNR }
        head = head " " text
    }
}
