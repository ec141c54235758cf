# SPDX-License-Identifier: MIT
"""Answers of n receivers and M suns as planes of bits: (ceil(M / 32), n) uint32, bit s % 32 of plane s // 32 is sun s.

A plane is contiguous, and one operation of numpy treats 32 suns of each receiver.
"""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray

from .. import _arrays

Planes = NDArray[np.uint32]

#: As many receivers fit into the cache.
ROWS_AT_ONCE = 8192


@functools.lru_cache(maxsize=64)
def masks(suns: int) -> Planes:
    """(ceil(suns / 32),): words with a bit for each sun."""
    return packed(np.ones((1, suns), bool))[:, 0]


def ones(suns: int, rows: int) -> Planes:
    return np.repeat(masks(suns)[:, None], rows, axis=1)


def packed(answers: NDArray[np.bool_]) -> Planes:
    """The planes of answers (n, M)."""
    rows, suns = answers.shape
    padded = np.zeros((rows, -(-suns // 32) * 32), bool)
    padded[:, :suns] = answers
    return np.ascontiguousarray(np.packbits(padded, axis=1, bitorder="little").view("<u4").astype(np.uint32).T)


def unpacked(planes: Planes, suns: int) -> NDArray[np.bool_]:
    """(n, suns): the answers of planes."""
    return _arrays.unpacked(planes.T, suns)


def of_sun(planes: Planes, sun: int) -> NDArray[np.bool_]:
    """(n,): the answers for a sun."""
    return np.asarray(planes[sun // 32] & np.uint32(1 << sun % 32)) != 0


def clear(planes: Planes, sun: int, rows: NDArray[np.bool_]) -> None:
    """Clears the answers for a sun where rows (n,) are marked."""
    planes[sun // 32] &= ~(rows.astype(np.uint32) << np.uint32(sun % 32))


def transposed(words: Planes) -> Planes:
    """(W, n): the transpose of (n, W), made by parts that fit into the cache."""
    result = np.empty(words.shape[::-1], np.uint32)
    for first in range(0, len(words), ROWS_AT_ONCE):
        result[:, first : first + ROWS_AT_ONCE] = words[first : first + ROWS_AT_ONCE].T
    return result


def moved(planes: Planes, to: NDArray[np.int64], count: int) -> Planes:
    """(count, n) planes in which sun i of `planes` is sun to[i]; `to` ascends. Bits without a sun are 0. Neighbours
    that stay neighbours are moved together."""
    result = np.zeros((count, planes.shape[1]), np.uint32)
    starts = np.flatnonzero(np.concatenate([[True], (np.diff(to) != 1) | (to[1:] % 32 == 0)]))
    for first, last in zip(starts, [*starts[1:], len(to)], strict=True):
        word, shift = divmod(int(first), 32)
        bits = planes[word] >> np.uint32(shift)
        if shift + int(last - first) > 32:
            bits |= planes[word + 1] << np.uint32(32 - shift)
        bits &= np.uint32((1 << int(last - first)) - 1)
        bits <<= np.uint32(to[first] % 32)
        result[to[first] // 32] |= bits
    return result


def weighed(planes: Planes, weights: NDArray[np.int64]) -> NDArray[np.int64]:
    """(n,): the exact sum of the whole weights (M,) of each receiver's suns. For unequal weights a table has the sums
    of all 256 values of a byte."""
    if len(weights) and (weights == weights[0]).all():
        count = np.zeros(planes.shape[1], np.int32)
        for plane in planes:
            count += np.bitwise_count(plane)
        return count * weights[0]
    result = np.zeros(planes.shape[1], np.int64)
    weight_of_bit = np.zeros(32 * len(planes), np.int64)
    weight_of_bit[: len(weights)] = weights
    values = np.unpackbits(np.arange(256, dtype=np.uint8)[:, None], axis=1, bitorder="little").astype(np.int64)
    for i, weights_of_byte in enumerate(weight_of_bit.reshape(-1, 8)):
        result += (values @ weights_of_byte)[planes[i // 4] >> np.uint32(8 * (i % 4)) & np.uint32(255)]
    return result
