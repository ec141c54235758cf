// SPDX-License-Identifier: MIT
// Albedo and shading normal of each pixel, GN_LANES pixels at a time. Contract: surface.h.
#include "shading/shade.h"
#include "shading/surface.h"
#include "shading/texture.clh"
#include "simd/triangle_blocks.clh"

static PointBlock surface_vector(const float* v) { return same_point(v[0], v[1], v[2]); }

GN_INLINE_ON_CPU PointBlock surface_cross(PointBlock v, PointBlock w) {
    return (PointBlock){v.y * w.z - v.z * w.y, v.z * w.x - v.x * w.z, v.x * w.y - v.y * w.x};
}
GN_INLINE_ON_CPU LaneFloat surface_sum(PointBlock v) { return v.x + v.y + v.z; }

// The places of a block's pixels in the picture.
GN_INLINE_ON_CPU LanePair pixels_of_block(SurfaceParams params, size_t block) {
    LanePair pixel;
    if (GN_LANES > 1 && params.layout.picture_width != 0u) {
        uint blocks_x = params.layout.picture_width / 4u;
        pixel.x = LANES_TO_FLOAT((LaneInt)((int)(4u * ((uint)block % blocks_x))) + (LANE_INDEX & 3));
        pixel.y = LANES_TO_FLOAT((LaneInt)((int)(4u * ((uint)block / blocks_x))) + (LANE_INDEX >> 2));
        return pixel;
    }
    for (int lane = 0; lane < GN_LANES; ++lane) {
        uint i = (uint)block * GN_LANES + (uint)lane;
        LANE_OF_FLOAT(pixel.x, lane) = (float)(i % params.width);
        LANE_OF_FLOAT(pixel.y, lane) = (float)(i / params.width);
    }
    return pixel;
}

// Barycentric coordinates of pixels' centres, x of corner a and so on, and their derivatives.
typedef struct Barycentric {
    PointBlock at, across, down;
} Barycentric;

// The derivatives where the direction changes by `step`; of_a, of_b, of_c: as in barycentric_of().
GN_INLINE_ON_CPU PointBlock derivatives(PointBlock of_a, PointBlock of_b, PointBlock of_c, PointBlock step,
                                        PointBlock at, LaneFloat inverse) {
    PointBlock w = {block_dot(of_a, step), block_dot(of_b, step), block_dot(of_c, step)};
    LaneFloat sum = surface_sum(w);
    return (PointBlock){(w.x - at.x * sum) * inverse, (w.y - at.y * sum) * inverse, (w.z - at.z * sum) * inverse};
}

GN_INLINE_ON_CPU Barycentric barycentric_of(const TriangleBlock* t, SurfaceParams params, LanePair pixel) {
    PointBlock eye = surface_vector(params.eye), corner = surface_vector(params.corner);
    PointBlock across = surface_vector(params.across), down = surface_vector(params.down);
    PointBlock d = {corner.x + across.x * pixel.x + down.x * pixel.y, corner.y + across.y * pixel.x + down.y * pixel.y,
                    corner.z + across.z * pixel.x + down.z * pixel.y};
    PointBlock a = difference(t->a, eye), b = difference(t->b, eye), c = difference(t->c, eye);
    // An edge as second row: the rounding grows with distance x edge, not with distance squared.
    PointBlock of_a = surface_cross(b, difference(t->c, t->b)), of_b = surface_cross(c, difference(t->a, t->c)),
               of_c = surface_cross(a, difference(t->b, t->a));
    PointBlock w = {block_dot(of_a, d), block_dot(of_b, d), block_dot(of_c, d)};
    LaneFloat inverse = (LaneFloat)(1.0f) / surface_sum(w);
    PointBlock at = scaled(w, inverse);
    LaneInt known = finite_lanes(inverse) & finite_lanes(surface_sum(at));
    // Textures are filtered over the square that the sample stands for.
    LaneFloat share = (LaneFloat)(params.pixel_share);
    PointBlock none = same_point(0.0f, 0.0f, 0.0f), third = same_point(1.0f / 3.0f, 1.0f / 3.0f, 1.0f / 3.0f);
    Barycentric found;
    found.across = selected(none, derivatives(of_a, of_b, of_c, scaled(across, share), at, inverse), known);
    found.down = selected(none, derivatives(of_a, of_b, of_c, scaled(down, share), at, inverse), known);
    // The ray meets the triangle: what is outside is rounding.
    const LaneFloat zero = (LaneFloat)(0.0f), one = (LaneFloat)(1.0f);
    at = (PointBlock){LANES_MAX(LANES_MIN(at.x, one), zero), LANES_MAX(LANES_MIN(at.y, one), zero),
                      LANES_MAX(LANES_MIN(at.z, one), zero)};
    LaneFloat sum = surface_sum(at);
    found.at = selected(third, (PointBlock){at.x / sum, at.y / sum, at.z / sum}, known);
    return found;
}

// What triangles have, by slot (surface.h).
typedef struct SurfaceArrays {
    __global const uint* materials;
    __global const float* coordinates;
    __global const float* colors;
    __global const uint* normals;
} SurfaceArrays;

GN_INLINE_ON_CPU LaneFloat blended_corners(__global const float* of_a, int stride, LaneInt at, PointBlock of) {
    __global const int* values = (__global const int*)of_a;
    return LANES_AS_FLOAT(LANES_GATHER(values, at)) * of.x + LANES_AS_FLOAT(LANES_GATHER(values + stride, at)) * of.y +
           LANES_AS_FLOAT(LANES_GATHER(values + 2 * stride, at)) * of.z;
}

// Corners' normals from the octahedral map; 0 if there is none.
GN_INLINE_ON_CPU PointBlock unpacked_normals(LaneInt bits) {
    LaneFloat x = LANES_TO_FLOAT(bits & 0xFFFF) * (2.0f / 65534.0f) - (65536.0f / 65534.0f);
    LaneFloat y = LANES_TO_FLOAT(bits >> 16 & 0xFFFF) * (2.0f / 65534.0f) - (65536.0f / 65534.0f);
    LaneFloat z = 1.0f - fabs(x) - fabs(y), zero = (LaneFloat)(0.0f), fold = LANES_MAX(-z, zero);
    x += LANES_SELECT(fold, -fold, LANE_COMPARE(x, >=, zero));
    y += LANES_SELECT(fold, -fold, LANE_COMPARE(y, >=, zero));
    LaneFloat size = sqrt(x * x + y * y + z * z);
    return selected(same_point(0.0f, 0.0f, 0.0f), (PointBlock){x / size, y / size, z / size},
                    LANE_COMPARE(bits, !=, (LaneInt)(0)));
}

// Interpolated normals, on the eye's side of the triangles; the geometric normals where corners have none. *spread: the
// sine of the largest angle between a triangle's normal and a corner's; 0 where corners have none.
GN_INLINE_ON_CPU PointBlock shading_normals(__global const uint* normals, LaneInt slots, PointBlock at,
                                            PointBlock geometric, LaneFloat* spread) {
    const LaneFloat zero = (LaneFloat)(0.0f), one = (LaneFloat)(1.0f), least_size = (LaneFloat)(1e-3f);
    LaneInt known = (LaneInt)(-1);
    PointBlock corners[3];
    LaneFloat least = one;
    for (int i = 0; i < 3; ++i) {
        LaneInt bits = LANES_GATHER((__global const int*)normals + i, 3 * slots);
        known &= LANE_COMPARE(bits, !=, (LaneInt)(0));
        corners[i] = unpacked_normals(bits);
        LaneFloat cosine = fabs(block_dot(corners[i], geometric));
        least = LANES_MIN(cosine, least);
    }
    LaneFloat sine = one - least * least;
    *spread = LANES_SELECT(zero, sqrt(LANES_MAX(sine, zero)), known);
    PointBlock n = {corners[0].x * at.x + corners[1].x * at.y + corners[2].x * at.z,
                    corners[0].y * at.x + corners[1].y * at.y + corners[2].y * at.z,
                    corners[0].z * at.x + corners[1].z * at.y + corners[2].z * at.z};
    LaneFloat size = sqrt(block_dot(n, n));
    known &= LANE_COMPARE(size, >, least_size);
    n = (PointBlock){n.x / size, n.y / size, n.z / size};
    LaneFloat side = block_dot(n, geometric);
    known &= LANE_COMPARE(fabs(side), >, least_size);
    PointBlock turned = {-n.x, -n.y, -n.z};
    return selected(geometric, selected(n, turned, LANE_COMPARE(side, <, zero)), known);
}

// The filtered texels of these lanes, which have this material.
GN_NOINLINE_ON_CPU void texture_of(const SurfaceArrays* of, const SurfaceMaterial* material, LaneInt slots,
                                   const Barycentric* at, __global const uint* texels, __global const float* decoded,
                                   LaneInt lanes, PointBlock* albedo) {
    Texels texture = {
        texels + material->first_texel, decoded, material->width, material->height, material->wrap_u, material->wrap_v};
    __global const float* u = of->coordinates;
    __global const float* v = u + 1;
    LaneInt first = 6 * slots;
    TextureArea area = {{blended_corners(u, 2, first, at->at), blended_corners(v, 2, first, at->at)},
                        {blended_corners(u, 2, first, at->across), blended_corners(v, 2, first, at->across)},
                        {blended_corners(u, 2, first, at->down), blended_corners(v, 2, first, at->down)}};
    PointBlock color = filtered(&texture, &area, material->is_nearest != 0u, material->minification, lanes);
    *albedo = selected(*albedo, (PointBlock){albedo->x * color.x, albedo->y * color.y, albedo->z * color.z}, lanes);
}

// The albedos of these lanes, material by material: a block's pixels have few.
GN_INLINE_ON_CPU PointBlock albedos_of(const SurfaceArrays* of, LaneInt slots, const Barycentric* at, bool has_colors,
                                       __global const SurfaceMaterial* materials, __global const uint* texels,
                                       __global const float* decoded, LaneInt lanes) {
    const LaneFloat zero = (LaneFloat)(0.0f), one = (LaneFloat)(1.0f);
    PointBlock albedo = same_point(0.0f, 0.0f, 0.0f), tint = same_point(1.0f, 1.0f, 1.0f);
    if (has_colors) {
        LaneInt first = 9 * slots;
        LaneFloat red = blended_corners(of->colors, 3, first, at->at);
        LaneFloat green = blended_corners(of->colors + 1, 3, first, at->at);
        LaneFloat blue = blended_corners(of->colors + 2, 3, first, at->at);
        tint = (PointBlock){LANES_MAX(LANES_MIN(red, one), zero), LANES_MAX(LANES_MIN(green, one), zero),
                            LANES_MAX(LANES_MIN(blue, one), zero)};
    }
    LaneInt ids = LANES_GATHER((__global const int*)of->materials, slots);
    while (LANES_ANY(lanes)) {
        int id = LANE_OF_INT(ids, first_lane(lanes));
        LaneInt same = lanes & LANE_COMPARE(ids, ==, (LaneInt)(id));
        lanes &= ~same;
        SurfaceMaterial material = materials[id];
        PointBlock base = surface_vector(material.base_color);
        albedo = selected(albedo, (PointBlock){base.x * tint.x, base.y * tint.y, base.z * tint.z}, same);
        if (material.width != 0u) texture_of(of, &material, slots, at, texels, decoded, same, &albedo);
    }
    return albedo;
}

static void store_vectors(PointBlock v, __global float* values, PointsLayout layout, size_t block) {
    LaneInt lanes = valid_lanes(layout, block);
    for (int lane = 0; lane < GN_LANES; ++lane)
        if (LANE_OF_INT(lanes, lane)) vstore3(lane_point(v, lane), point_of_lane(layout, block, lane), values);
}

// `slots`: of each pixel, or GN_NO_ID. `normals`: the geometric ones, in whose place the shading normals are written.
// Sky: 0.
__kernel void surfaces(SurfaceParams params, __global const float* vertices, __global const uint* visible,
                       __global const uint* slots, __global const uint* triangle_material,
                       __global const float* coordinates, __global const float* corner_colors,
                       __global const uint* corner_normals, __global const SurfaceMaterial* materials,
                       __global const uint* texels, __global const float* decoded, __global float* albedos,
                       __global float* normals, __global float* spreads GN_SHARES) {
    SurfaceArrays of = {triangle_material, coordinates, corner_colors, corner_normals};
    PointsLayout layout = params.layout, packed = packed_layout(layout);
    vertices += params.triangles.first_float;
    GN_FOR_EACH_OF(block, GN_SHARED_RANGE(block_count(layout))) {
        PointBlock albedo = same_point(0.0f, 0.0f, 0.0f);
        LaneFloat spread = (LaneFloat)(0.0f);
        LaneInt of_pixels = load_lane_ids(slots, layout, block);
        LaneInt shown = valid_lanes(layout, block) & LANE_COMPARE(of_pixels, !=, (LaneInt)((int)GN_NO_ID));
        if (LANES_ANY(shown)) {
            repeat_active(&of_pixels, shown);
            TriangleBlock t = load_triangles_of(vertices, load_lane_ids(visible, layout, block), shown);
            Barycentric at = barycentric_of(&t, params, pixels_of_block(params, block));
            albedo = albedos_of(&of, of_pixels, &at, params.has_colors != 0u, materials, texels, decoded, shown);
            if (params.has_normals != 0u) {
                PointBlock geometric = load_block(normals, packed, block);
                PointBlock smooth = shading_normals(corner_normals, of_pixels, at.at, geometric, &spread);
                store_vectors(selected(geometric, smooth, shown), normals, layout, block);
                spread = LANES_SELECT((LaneFloat)(0.0f), spread, shown);
            }
        }
        store_vectors(albedo, albedos, layout, block);
        if (params.has_normals != 0u) store_lanes(spread, spreads, layout, block);
    }
    GN_END_SHARES;
}
