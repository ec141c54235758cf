// SPDX-License-Identifier: MIT
// Contract of the samples: how the samples of many pixels are decided together.
//
// A pixel fragment is the part of a pixel's samples that lies on one receiver: pixel, receiver and a mask of samples.
// Slot i of a batch of pixels has the fragment on pixel i's own receiver, the receiver in the view. The fragments on
// further receivers follow in the extra slots. A pixel is whole if all its samples lie on its own receiver; the corners
// of the samples' box prove this. The other pixels are edge pixels: for each of their samples the kernels find the
// receiver exactly. Every fragment has a footprint (receivers/footprint.h). If a fragment's footprint is classified as
// lit or in shadow, the result is that of all its samples. Every sample of a mixed fragment becomes a point.
#pragma once

#include "camera/camera.h"

#define MAX_SAMPLES 32

// Slots that a GPU's work-group reserves at a time for the fragments that it finds: enough for any pixel.
#define SLOTS_OF_GROUP 32u

// The number of a GPU's work-items that make the points of one fragment. (H200: .23, .21, .23, .32 ms with 4, 8, 16,
// 32.)
#define PARTS_OF_FRAGMENT 8u
#define SAMPLES_OF_PART (0xFFFFFFFFu >> (32u - MAX_SAMPLES / PARTS_OF_FRAGMENT))

GN_STRUCT_BEGIN(SamplePattern)
    uint count;
    uint all;                       // the mask of all samples
    float low[2], high[2];          // the box around all samples, in pixels from the pixel's upper left corner
    float position_x[MAX_SAMPLES];  // of each sample, from the same corner
    float position_y[MAX_SAMPLES];
GN_STRUCT_END(SamplePattern, 280)

// The pixels of a batch, numbered tile by tile, on a CPU square by square of 4 x 4 pixels, on a GPU row by row. A batch
// has whole bands; a band is a row of camera tiles. Pixels of a tile that lie outside the picture have numbers, too.
GN_STRUCT_BEGIN(PixelBatch)
    uint first_tile, count;
    uint width, height;  // of the picture
    uint tiles_x;        // camera tiles per band
    uint bands;
    uint slots;       // of fragments: one for each pixel, then the extra slots
    uint edge_slots;  // of the list of edge pixels; on a GPU the lists of left and of unproven pixels follow, of the
                      // same size
GN_STRUCT_END(PixelBatch, 32)

// A bit of an extra slot's pixel: the fragment has the samples of all pixels of the square that begins with this pixel.
#define IS_SQUARE 0x80000000u
#define SQUARE_PIXELS 16u

// Room for the open pairs of samples_filter.cl, and for the pixels that have them.
#define MIN_OPEN_ROOM 64u
GN_STRUCT_BEGIN(OpenCapacities)
    uint pixels, pairs;
GN_STRUCT_END(OpenCapacities, 8)

// Each kernel takes the elements [first, first + count) of its list.
GN_STRUCT_BEGIN(SamplesParams)
    TrianglesLayout triangles;
    PictureRays picture;
    PixelBatch batch;
    float eye[3];
    uint first, count;
    uint extra_count;   // samples_bound: fragments in the extra slots; samples_resolve: mixed squares, or 0
    uint point_stride;  // samples_points: points that the buffers have room for
    ushort samples;     // per pixel
    ushort squares;     // samples_whole: 1 if squares may become fragments
    OpenCapacities open;
GN_STRUCT_END(SamplesParams, 136)

// Means of visibility that a technique has written sample by sample, `pixels` values each.
GN_STRUCT_BEGIN(MeanParams)
    uint pixels, samples;
    uint is_first;  // 1: the first batch of samples, which starts the sum
    float scale;    // 1, or for the last batch 1 / the number of all samples
GN_STRUCT_END(MeanParams, 16)

// Zeroed before each batch of pixels. Unused slots of a list are GN_NO_ID.
GN_STRUCT_BEGIN(SampleCounters)
    uint edges;          // slots in the list of edge pixels
    uint left;           // edge pixels that samples_masks_gpu leaves to samples_filter
    uint unproven;       // slots in the list of unproven pixels
    uint whole;          // whole pixels
    uint extra;          // extra slots needed (may exceed the capacity)
    uint squares;        // squares of pixels that are mixed fragments
    uint mixed;          // slots in the list of mixed fragments
    uint mixed_samples;  // samples in mixed fragments
    uint fragments;      // fragments with a sample
    uint mixed_fragments;
    uint in_shadow;    // samples decided by their footprint
    uint lit;          // samples decided by their footprint, including samples of the sky
    uint open_pixels;  // samples_filter: pixels with open pairs (may exceed the capacity)
    uint open_pairs;   // samples_filter: open pairs of these pixels (may exceed the capacity)
    uint points;       // written for a part of the mixed fragments; zeroed for each part
GN_STRUCT_END(SampleCounters, 60)
