// SPDX-License-Identifier: MIT
// Shade: albedo times (ambient + the lights' visibility * Lambert), times the exposure, through the tone curve, to
// 8-bit sRGB through a table that the host computes, so that no device's pow() can change a pixel. The ambient light
// comes mostly from above and a little from one side, so that shapes stay visible in shadow. Pixels are taken in blocks
// (simd/point_blocks.clh), 16 at once on a CPU.
#include "shading/shade.h"
#include "simd/triangle_blocks.clh"

#define AMBIENT 0.25f

// Normals that are farther apart than this sine (30 degrees) are meant to show edges.
#define MAX_SHIFT 0.5f

// The light of the whole sky, compared with the 1 - AMBIENT of a light that shines from above; and the part of the
// ambient light that is added to the light of the sky.
#define SKY_LIGHT 0.45f
#define REFLECTED_AMBIENT 0.5f

// ---- Light of a point light or a direction --------------------------------------------------------------------------

// Unit vectors, up to the last bits (pictures only, never a decision); 0 of a zero.
static PointBlock unit_of(PointBlock d) {
    LaneFloat largest = largest_of(d);
    LaneInt has_size = LANE_COMPARE(largest, >, (LaneFloat)(0.0f));
    d = (PointBlock){d.x / largest, d.y / largest, d.z / largest};
    LaneFloat length_of_d = sqrt(block_dot(d, d));
    d = (PointBlock){d.x / length_of_d, d.y / length_of_d, d.z / length_of_d};
    return selected(same_point(0.0f, 0.0f, 0.0f), d, has_size);
}

// Adds one light's part to `lambert`; at pixels that show the sky it may be anything.
//
// Visibility is decided for the triangle: it ends where the light lies in the triangle's plane. A shading normal would
// still get light there, up to the sine of its angle to the triangle's normal (`spreads`), so that the edges of
// triangles would show. So the cosine is shifted: it is 0 from that sine on, and 1 where it is 1, as in appleseed (F.
// Beaune 2019) and Blender's Cycles ("Shading Offset"); here the triangle determines the shift.
__kernel void shade_light(ShadeParams params, __global const float* positions, __global const float* normals,
                          __global const float* spreads, __global const float* visibility, __global float* lambert) {
    PointsLayout layout = params.layout;
    bool is_directional = params.light[3] == 0.0f;
    PointBlock light = same_point(params.light[0], params.light[1], params.light[2]), l = unit_of(light);
    GN_FOR_EACH(block, block_count(layout)) {
        if (!is_directional) l = unit_of(difference(light, load_block(positions, layout, block)));
        LaneFloat cosine = block_dot(load_block(normals, packed_layout(layout), block), l);
        if (params.has_spreads != 0u) {
            LaneFloat shift = load_lanes(spreads, layout, block), most = (LaneFloat)(MAX_SHIFT);
            shift = LANES_MIN(shift, most);
            cosine = (cosine - shift) / ((LaneFloat)(1.0f) - shift);
        }
        LaneFloat none = 0.0f, before = params.is_first != 0u ? none : load_lanes(lambert, layout, block);
        cosine = LANES_MAX(cosine, none);
        store_lanes(before + load_lanes(visibility, layout, block) * cosine, lambert, layout, block);
    }
}

// ---- Picture --------------------------------------------------------------------------------------------------------

// What the kernels of a picture read.
typedef struct PictureInputs {
    __global const uint* visible;
    __global const float* normals;
    __global const float* lambert;
    __global const uint* triangle_material;
    __global const float* base_colors;
    __global const float* albedos;
    __global const float* sky_shares;
} PictureInputs;

// The base colours of the triangles' materials, of which neighbours mostly have one.
static PointBlock base_colors_of(const PictureInputs* from, LaneInt ids) {
    __global const int* colors = (__global const int*)from->base_colors;
    int id = LANE_OF_INT(ids, 0), first = (int)from->triangle_material[id];
    LaneInt materials = (LaneInt)(first);
    if (LANES_ANY(LANE_COMPARE(ids, !=, (LaneInt)(id))))
        materials = LANES_GATHER((__global const int*)from->triangle_material, ids);
    if (LANES_ANY(LANE_COMPARE(materials, !=, (LaneInt)(first)))) {
        LaneInt at = 3 * materials;
        return (PointBlock){LANES_AS_FLOAT(LANES_GATHER(colors, at)), LANES_AS_FLOAT(LANES_GATHER(colors + 1, at)),
                            LANES_AS_FLOAT(LANES_GATHER(colors + 2, at))};
    }
    float3 color = vload3((size_t)first, from->base_colors);
    return same_point(color.x, color.y, color.z);
}

// The linear light that the lanes `seen`, at least one, show. With shares of the sky, the light of the sky replaces
// most of the ambient light; a little stays for what surfaces reflect.
static PointBlock light_of_surfaces(PictureParams params, const PictureInputs* from, size_t block, LaneInt ids,
                                    LaneInt seen) {
    PointsLayout layout = params.layout, packed = packed_layout(layout);
    PointBlock base, n = load_block(from->normals, packed, block);
    if (params.has_albedos != 0u)
        base = load_block(from->albedos, packed, block);
    else
        base = base_colors_of(from, LANES_SELECT((LaneInt)(LANE_OF_INT(ids, first_lane(seen))), ids, seen));
    LaneFloat ambient = AMBIENT * (1.0f + 0.35f * n.y + 0.15f * n.x);
    LaneFloat sun = (1.0f - AMBIENT) * load_lanes(from->lambert, layout, block), exposure = params.exposure;
    if (params.has_sky_shares == 0u) return scaled(scaled(base, ambient + sun), exposure);
    LaneFloat sky = SKY_LIGHT * load_lanes(from->sky_shares, layout, block), rest = REFLECTED_AMBIENT * ambient + sun;
    return scaled(
        (PointBlock){base.x * (0.80f * sky + rest), base.y * (0.97f * sky + rest), base.z * (1.26f * sky + rest)},
        exposure);
}

// The light that a block's pixels show; `seen`: not the sky.
static PointBlock light_of_block(PictureParams params, const PictureInputs* from, size_t block, LaneInt* seen) {
    LaneInt ids = load_lane_ids(from->visible, params.layout, block);
    *seen = valid_lanes(params.layout, block) & LANE_COMPARE(ids, !=, (LaneInt)((int)GN_NO_ID));
    float exposure = params.exposure;
    PointBlock sky = same_point(0.46f * exposure, 0.62f * exposure, 0.86f * exposure);
    if (!LANES_ANY(*seen)) return sky;
    return selected(sky, light_of_surfaces(params, from, block, ids, *seen), *seen);
}

static LaneFloat brightest_of(PointBlock light) { return LANES_MAX(LANES_MAX(light.x, light.y), light.z); }

// Light above 1 in the range of the picture: the curve of Khronos' PBR Neutral tone mapper (2024) without its first
// step, which is for materials that reflect 4 % at their surface. Colours up to .8 stay as they are; brighter ones keep
// their hue and slowly lose their saturation.
static PointBlock tone_mapped(PointBlock light) {
    const float start = 0.8f, rest = 1.0f - start;
    LaneFloat peak = brightest_of(light);
    LaneInt bright = LANE_COMPARE(peak, >, (LaneFloat)(start));
    if (!LANES_ANY(bright)) return light;
    LaneFloat mapped = 1.0f - rest * rest / (peak + rest - start);
    LaneFloat saturated = 1.0f / (0.15f * (peak - mapped) + 1.0f);
    PointBlock curved = scaled(scaled(light, mapped / peak), saturated);
    LaneFloat white = mapped * (1.0f - saturated);
    return selected(light, (PointBlock){curved.x + white, curved.y + white, curved.z + white}, bright);
}

static LaneInt to_srgb(LaneFloat linear, __global const uchar* table) {
    LaneFloat none = 0.0f, all = 1.0f;
    linear = LANES_MAX(linear, none);
    linear = LANES_MIN(linear, all);
    LaneInt at = LANES_TO_INT(linear * (float)(SRGB_TABLE_SIZE - 1) + 0.5f);
    return LANES_GATHER(table, at);
}

// 8-bit sRGB of light from 0 to 1; what lies beyond is taken for its end.
static LaneInt rgba_of(PointBlock light, __global const uchar* table) {
    return to_srgb(light.x, table) | to_srgb(light.y, table) << 8 | to_srgb(light.z, table) << 16 | (int)0xFF000000u;
}

__kernel void shade(PictureParams params, __global const uint* visible, __global const float* normals,
                    __global const float* lambert, __global const uint* triangle_material,
                    __global const float* base_colors, __global const float* albedos, __global const float* sky_shares,
                    __global const uchar* srgb_table, __global uint* picture) {
    PictureInputs from = {visible, normals, lambert, triangle_material, base_colors, albedos, sky_shares};
    GN_FOR_EACH(block, block_count(params.layout)) {
        LaneInt seen;
        PointBlock light = tone_mapped(light_of_block(params, &from, block, &seen));
        store_lane_ids(rgba_of(light, srgb_table), picture, params.layout, block);
    }
}

// Adds a picture's light to the sums of the pictures before: three planes, a float for each pixel.
__kernel void shade_add(PictureParams params, __global const uint* visible, __global const float* normals,
                        __global const float* lambert, __global const uint* triangle_material,
                        __global const float* base_colors, __global const float* albedos,
                        __global const float* sky_shares, __global float* sums) {
    PictureInputs from = {visible, normals, lambert, triangle_material, base_colors, albedos, sky_shares};
    PointsLayout layout = params.layout, planes = planes_layout(layout);
    GN_FOR_EACH(block, block_count(layout)) {
        LaneInt seen;
        PointBlock light = tone_mapped(light_of_block(params, &from, block, &seen));
        if (params.is_first == 0u) {
            PointBlock before = load_block(sums, planes, block);
            light = (PointBlock){light.x + before.x, light.y + before.y, light.z + before.z};
        }
        store_lanes(light.x, sums, layout, block);
        store_lanes(light.y, sums + layout.count, layout, block);
        store_lanes(light.z, sums + 2u * (size_t)layout.count, layout, block);
    }
}

// The mean of all pictures: params.exposure is 1 / their number.
__kernel void shade_mean(PictureParams params, __global const float* sums, __global const uchar* srgb_table,
                         __global uint* picture) {
    PointsLayout planes = planes_layout(params.layout);
    GN_FOR_EACH(block, block_count(params.layout)) {
        PointBlock light = scaled(load_block(sums, planes, block), (LaneFloat)(params.exposure));
        store_lane_ids(rgba_of(light, srgb_table), picture, params.layout, block);
    }
}

// The brightest channel of each pixel, for a metered exposure. Sky: -1.
__kernel void brightest_channels(PictureParams params, __global const uint* visible, __global const float* normals,
                                 __global const float* lambert, __global const uint* triangle_material,
                                 __global const float* base_colors, __global const float* albedos,
                                 __global const float* sky_shares, __global float* brightest) {
    PictureInputs from = {visible, normals, lambert, triangle_material, base_colors, albedos, sky_shares};
    GN_FOR_EACH(block, block_count(params.layout)) {
        LaneInt seen;
        PointBlock light = light_of_block(params, &from, block, &seen);
        store_lanes(LANES_SELECT((LaneFloat)(-1.0f), brightest_of(light), seen), brightest, params.layout, block);
    }
}
