# SPDX-License-Identifier: MIT
# tools/Doxyfile reads headers through this: the comment at the head of a header becomes the introduction of its page.
# No line is added, so that warnings name the right one.
1s|.*|/// @file|
2,/^#/{
    # Examples are code, words like "Status." begin paragraphs.
    s|^//   |//     |
    s|^// ([A-Z][a-z]+\.) |// <p><b>\1</b> |
    s|^//|///|
}
# No emphasis.
s|gnomon_\*_[a-z]+(\(\))?|`&`|g
