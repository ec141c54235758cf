// SPDX-License-Identifier: MIT
// Decides the lights of sectors by the horizon of a height field (horizons.h). Every bound is taken on the safe side;
// lights between the bounds stay open.
//
// Lit. A ray meets no triangle if its slope is above the greatest slope at which its strip meets any triangle. The
// point's receiver, and triangles with a corner at the point, do not block it and are left out.
//
// Dark. Over the rectangle in which the field has one height at each position (height_field.cl), a ray that is above
// the field at one position and below it at a farther one meets the field in between; so does a ray that is first below
// and then above the field. The triangle that it meets blocks it: the ray comes from one side of the triangle's plane,
// so it is not in the plane. The first position at which a ray is known to be above or below the field is the end of
// its first triangle, the triangle under the point. This is the receiver itself, or it has a corner at the point, as
// the receiver has; so the ray cannot meet the receiver farther on. If neither holds, no light is found to be dark.
#include "horizons/strip_walk.clh"

// A light's slope rounds once, those from the pyramid up to five times (tests/proofs/pyramid_slopes.v), also that of
// the highest height, at which lanes_left() stops a walk.
#define SLOPE_ABOVE (1.0f + 0x1.8p-21f)
#define SLOPE_BELOW (1.0f - 0x1.8p-21f)
#define SLOPE_WELL_BELOW (1.0f - 0x1p-16f)

static LaneFloat height_in_units(LaneFloat z, const HeightField* field) { return (z - field->lowest) * field->units; }

static FieldBlock load_field_block(const HorizonParams* params, size_t block, __global const float* positions,
                                   __global const uint* receivers) {
    FieldBlock made;
    const HeightField* field = &params->field;
    PointBlock points = load_block(positions, params->points, block);
    made.at = lanes_over_ground(field->axis, points);
    made.x = (made.at.x - field->corner[0]) * field->halves;
    made.y = (made.at.y - field->corner[1]) * field->halves;
    made.height = height_in_units(made.at.z, field);
    LaneFloat zero = (LaneFloat)(0.0f);
    made.usable = valid_lanes(params->points, block) & present_lanes(points) & LANE_COMPARE(made.x, >=, zero) &
                  LANE_COMPARE(made.y, >=, zero) & LANE_COMPARE(made.x, <, (LaneFloat)(2.0f * field->columns)) &
                  LANE_COMPARE(made.y, <, (LaneFloat)(2.0f * field->rows)) &
                  LANE_COMPARE(fabs(made.height), <, (LaneFloat)(0x1p20f));
    made.receivers = (LaneInt)((int)GN_NO_ID);
    if (params->points.has_receivers != 0u)
        made.receivers = load_lane_ids(receivers + params->points.first / 3u, params->points, block);
    return made;
}

// The lanes whose points are within the rectangle with one height at each position.
static LaneInt lanes_inside(const FieldBlock* block, const HeightField* field) {
    const float* sides = field->inside;
    return LANE_COMPARE(block->at.x, >=, (LaneFloat)(sides[0])) & LANE_COMPARE(block->at.y, >=, (LaneFloat)(sides[1])) &
           LANE_COMPARE(block->at.x, <=, (LaneFloat)(sides[2])) & LANE_COMPARE(block->at.y, <=, (LaneFloat)(sides[3]));
}

// Updates the lower bounds by one part of each stretch.
static void meet_first_parts(Horizon* horizon, const FieldBlock* block, uint stretch_count, const FieldScene* scene) {
    for (uint g = 0; g < stretch_count; ++g) {
        __global const HorizonStep* part = &scene->steps[g * (1u + STEPS_OF_STRETCH) + 1u];
        LaneInt lanes = lanes_left(horizon, part, block);
        if (!LANES_ANY(lanes)) return;
        StepSlopes slopes = slopes_over(part, block, scene->pyramid);
        LaneInt inside = lanes & LANE_COMPARE((LaneFloat)(part->q), <=, block->reach_inside);
        horizon->low = LANES_SELECT(horizon->low, LANES_MAX(slopes.low, horizon->low), inside);
        horizon->above = LANES_SELECT(horizon->above, LANES_MIN(slopes.high, horizon->above), inside);
    }
}

// The lanes for which some light's slope lies above `low` and not above `high`, so that better bounds may decide it.
static LaneInt have_lights_between(__global const HorizonSector* sector, LaneFloat low, LaneFloat high) {
    LaneInt found = (LaneInt)(0);
    for (uint l = 0; l < sector->light_count; ++l) {
        LaneFloat slope = (LaneFloat)(sector->slopes[l]);
        found |= LANE_COMPARE(slope, >, low) & LANE_COMPARE(slope, <=, high);
    }
    return found;
}

// Updates both bounds by all steps of a stretch. If the stretch is near, lanes with lights between the bounds test its
// triangles instead, one by one.
static void meet_stretch(Horizon* horizon, uint g, const FieldBlock* block, __global const HorizonSector* sector,
                         const FieldScene* scene, LaneInt lanes) {
    __global const HorizonStep* stretch = &scene->steps[g * (1u + STEPS_OF_STRETCH)];
    LaneFloat high = horizon->high;
    for (uint k = 1; k <= STEPS_OF_STRETCH; ++k) {
        StepSlopes slopes = slopes_over(&stretch[k], block, scene->pyramid);
        LaneInt inside = lanes & LANE_COMPARE((LaneFloat)(stretch[k].q), <=, block->reach_inside);
        high = LANES_MAX(slopes.high, high);
        horizon->low = LANES_SELECT(horizon->low, LANES_MAX(slopes.low, horizon->low), inside);
    }
    LaneInt closer = (LaneInt)(0);
    LaneFloat known = LANES_MAX(horizon->high, horizon->low);
    if (g < sector->near_stretches) closer = lanes & have_lights_between(sector, known, high);
    horizon->high = LANES_SELECT(horizon->high, high, lanes & ~closer);
    if (!LANES_ANY(closer)) return;
    meet_triangles(horizon, stretch->q * sector->min_major, stretch->end * sector->max_major, block, sector, scene,
                   closer);
}

// Updates both bounds by the stretches that could raise the horizon.
static void meet_stretches(Horizon* horizon, const FieldBlock* block, __global const HorizonSector* sector,
                           const FieldScene* scene) {
    for (uint g = 0; g < sector->stretch_count; ++g) {
        __global const HorizonStep* stretch = &scene->steps[g * (1u + STEPS_OF_STRETCH)];
        LaneInt lanes = lanes_left(horizon, stretch, block);
        if (!LANES_ANY(lanes)) return;
        StepSlopes slopes = slopes_over(stretch, block, scene->pyramid);
        lanes &= LANE_COMPARE(slopes.high, >, horizon->low * SLOPE_WELL_BELOW);
        if (!LANES_ANY(lanes)) continue;
        LaneFloat q = (LaneFloat)(stretch->q), begin = LANES_MIN(q, horizon->begin);
        horizon->begin = LANES_SELECT(horizon->begin, begin, lanes);
        meet_stretch(horizon, g, block, sector, scene, lanes);
    }
}

static Horizon horizon_of(const FieldBlock* block, __global const HorizonSector* sector, const FieldScene* scene) {
    Horizon horizon = no_horizon();
    meet_triangles(&horizon, 0.0f, (float)NEAR_CELLS, block, sector, scene, block->usable);
    LaneFloat near_high = horizon.high;
    meet_first_parts(&horizon, block, sector->stretch_count, scene);
    meet_stretches(&horizon, block, sector, scene);
    LaneInt is_near = LANE_COMPARE(near_high, >, horizon.low * SLOPE_WELL_BELOW);
    horizon.begin = LANES_SELECT(horizon.begin, (LaneFloat)(0.0f), is_near);
    return horizon;
}

// For each point of a block, the lights that certainly reach it, the lights that certainly do not, and, among all
// others, the lights that may be below the horizon's lower bound.
typedef struct SectorLights {
    LaneInt lit, dark, low;
} SectorLights;

static SectorLights lights_by(const Horizon* horizon, const FieldBlock* block, __global const HorizonSector* sector,
                              const HeightField* field) {
    LaneInt certain = horizon->has_first & LANE_COMPARE(block->reach_inside, >, (LaneFloat)(sector->near_reach)) &
                      LANE_COMPARE(horizon->first_high, >, (LaneFloat)(-INFINITY)) & lanes_inside(block, field);
    SectorLights lights = {(LaneInt)(0), (LaneInt)(0), (LaneInt)(0)};
    for (uint l = 0; l < sector->light_count; ++l) {
        LaneFloat less = (LaneFloat)(sector->slopes[l] * SLOPE_BELOW),
                  more = (LaneFloat)(sector->slopes[l] * SLOPE_ABOVE);
        LaneInt bit = (LaneInt)((int)(1u << l));
        LaneInt is_above = certain & LANE_COMPARE(less, >, horizon->first_high);
        LaneInt into = LANE_COMPARE(more, <, horizon->low) & is_above;
        LaneInt out_of = LANE_COMPARE(more, <, horizon->first_low) & LANE_COMPARE(less, >, horizon->above);
        LaneInt lit = LANE_COMPARE(less, >, horizon->high), dark = certain & (into | out_of);
        lights.lit |= lit & bit;
        lights.dark |= dark & bit;
        lights.low |= ~(lit | dark | is_above) & bit;
    }
    return lights;
}

GN_NOINLINE_ON_CPU void decide_horizons(ItemRange items, const HorizonParams params,
                                        __global const HorizonSector* sectors, __global const HorizonStep* steps,
                                        __global const uint* starts, __global const uint* list,
                                        __global const uint* pyramid, __global const float* vertices,
                                        __global const float* positions, __global const uint* receivers,
                                        __global uint* masks, __global uint* lit, __global float* begins) {
    uint blocks = block_count(params.points);
    GN_FOR_EACH_OF(task, items) {
        size_t number = task % blocks, bundle = task / blocks, first = bundle * params.mask_stride;
        __global const HorizonSector* sector = &sectors[bundle];
        __global float* open = (__global float*)(masks + first);
        LaneInt mask = LANES_AS_INT(load_lanes(open, params.points, number)), reached = (LaneInt)(0);
        LaneFloat zero = (LaneFloat)(0.0f), begin = zero;
        FieldBlock block = load_field_block(&params, number, positions, receivers);
        block.usable &= LANE_COMPARE(mask, !=, (LaneInt)(0));
        if (sector->stretch_count != 0u && LANES_ANY(block.usable)) {
            FieldScene scene = {&params, steps + sector->first_step, starts, list, pyramid, vertices};
            set_reach(&block, sector, &params.field);
            Horizon horizon = horizon_of(&block, sector, &scene);
            SectorLights lights = lights_by(&horizon, &block, sector, &params.field);
            reached = mask & lights.lit & block.usable;
            LaneInt is_whole = ~block.usable | LANE_COMPARE(lights.low & mask, !=, (LaneInt)(0));
            begin = LANES_SELECT(horizon.begin - 2.0f, zero, is_whole);
            begin = LANES_MAX(begin, zero) / params.field.halves;
            mask &= ~(block.usable & (lights.lit | lights.dark));
        }
        store_lanes(LANES_AS_FLOAT(mask), open, params.points, number);
        store_lanes(begin, begins + first, params.points, number);
        store_lanes(LANES_AS_FLOAT(reached), (__global float*)(lit + first), params.points, number);
    }
}

// masks: the lights that each point faces; afterwards those that are still open. lit: the lights that reach the point.
// begins: the distance along the ground within which the rays to the open lights meet nothing.
__kernel void horizons(const HorizonParams params, __global const HorizonSector* sectors,
                       __global const HorizonStep* steps, __global const uint* starts, __global const uint* list,
                       __global const uint* pyramid, __global const float* vertices, __global const float* positions,
                       __global const uint* receivers, __global uint* masks, __global uint* lit,
                       __global float* begins) {
    decide_horizons(item_range(block_count(params.points) * (size_t)params.bundle_count), params, sectors, steps,
                    starts, list, pyramid, vertices, positions, receivers, masks, lit, begins);
}
