// SPDX-License-Identifier: MIT
// Contract of the samples: how the samples of many pixels are settled together.
//
// A piece is what one receiver holds of a pixel's samples: pixel, receiver, and a mask of samples. Piece i of a batch
// of pixels is what pixel i's own receiver (that of the view) holds; further receivers' pieces follow behind them. A
// pixel is whole if its own receiver holds all its samples, proven by the corners of the samples' box; the others are
// edges, whose samples find their receivers one by one, exactly. Every piece has a footprint (footprint.h). Those that
// the technique settles count for all their samples; of the others, the mixed ones, every sample is made into a point.
#ifndef GN_SAMPLES_H
#define GN_SAMPLES_H

#include "prelude.h"

#define MOST_SAMPLES 32

// Places for pieces that a work-group of samples_pieces claims at a time: enough for any pixel.
#define PIECES_CLAIM 64u

// In how many parts a GPU's work-items make the points of a piece. (On an H200 .23, .21, .23, .32 ms with 4, 8,
// 16, 32.)
#define PARTS_OF_PIECES 8u
#define SAMPLES_OF_PART (0xFFFFFFFFu >> (32u - MOST_SAMPLES / PARTS_OF_PIECES))

GN_STRUCT_BEGIN(SamplePattern)
    uint count;
    uint all;                     // the mask of all samples
    float low[2], high[2];        // the box that holds them, in pixels from the pixel's upper left corner
    float place_x[MOST_SAMPLES];  // of each, likewise
    float place_y[MOST_SAMPLES];
GN_STRUCT_END(SamplePattern, 280)

// The pixels that are worked on: `count` of them from `first` on, in rows of `width`: whole bands, which are rows of
// camera tiles.
GN_STRUCT_BEGIN(PixelBatch)
    uint first, count;
    uint width, height;  // of the picture
    uint tiles_x;        // camera tiles per band
    uint bands;
    uint places;  // that there are for pieces, the pixels' own among them
GN_STRUCT_END(PixelBatch, 28)

// Zeroed before each batch of pixels. Claimed lists may hold unused places, GN_NO_ID.
GN_STRUCT_BEGIN(SampleCounters)
    uint edges;          // places in the list of edge pixels
    uint sought;         // places in the list of edge pixels whose receivers are sought
    uint whole;          // pixels
    uint extra;          // places for pieces behind the pixels' own, wanted
    uint mixed;          // places in the list of mixed pieces
    uint mixed_samples;  // in mixed pieces
    uint pieces;         // with a sample
    uint mixed_pieces;
    uint in_shadow;  // samples settled
    uint lit;        // samples settled, those of the sky among them
    uint placed;     // points made of the mixed pieces at hand; zeroed for each part of them
GN_STRUCT_END(SampleCounters, 44)

#endif
