// SPDX-License-Identifier: MIT
// Decides the lights of fans by the horizon of a height field (horizons.h). Every bound is taken on the safe side; what
// lies between them stays open.
//
// Lit. A ray whose slope is above the greatest slope at which its strip meets any triangle meets none. A triangle with
// a corner at the point, and the point's receiver, do not block and are left out.
//
// Dark. Over the rectangle in which the field has one height at each place (height_field.cl), a ray that is above the
// field at one place and below it at a farther one meets it in between; so does one that is first below and then above.
// The triangle that it meets blocks it: the ray comes from one side of its plane, so it is not in the plane. Where a
// ray is first known to be above or below is the end of its first triangle, the one under the point. This is the
// receiver itself, or it has, as the receiver has, a corner at the point; so the ray cannot meet the receiver farther
// on. Where neither holds, no light is found to be dark.
#include "shafts/strip_walk.clh"

// Slopes of the pyramid round three times.
#define SLOPE_ABOVE (1.0f + 0x1p-18f)
#define SLOPE_BELOW (1.0f - 0x1p-18f)
#define SLOPE_WELL_BELOW (1.0f - 0x1p-16f)

static FieldBlock load_field_block(const HorizonParams* params, size_t block, __global const float* positions,
                                   __global const uint* receivers) {
    FieldBlock made;
    const HeightField* field = &params->field;
    PointBlock points = load_block(positions, params->points, block);
    made.at = lanes_over_ground(field->axis, points);
    made.x = (made.at.x - field->corner[0]) * field->halves;
    made.y = (made.at.y - field->corner[1]) * field->halves;
    made.height = (made.at.z - field->lowest) * field->units;
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

// Within the rectangle with one height at each place.
static LaneInt lanes_inside(const FieldBlock* block, const HeightField* field) {
    const float* sides = field->inside;
    return LANE_COMPARE(block->at.x, >=, (LaneFloat)(sides[0])) & LANE_COMPARE(block->at.y, >=, (LaneFloat)(sides[1])) &
           LANE_COMPARE(block->at.x, <=, (LaneFloat)(sides[2])) & LANE_COMPARE(block->at.y, <=, (LaneFloat)(sides[3]));
}

// ---- Strips ---------------------------------------------------------------------------------------------------------

// Lower bounds, of one part of each group.
static void meet_first_parts(Horizon* horizon, const FieldBlock* block, uint group_count, const FieldScene* scene) {
    for (uint g = 0; g < group_count; ++g) {
        __global const HorizonStep* part = &scene->steps[g * (1u + STEPS_OF_GROUP) + 1u];
        LaneInt lanes = lanes_left(horizon, part, block);
        if (!LANES_ANY(lanes)) return;
        StepSlopes slopes = slopes_over(part, block, scene->pyramid);
        LaneInt inside = lanes & LANE_COMPARE((LaneFloat)(part->q), <=, block->reach_inside);
        horizon->low = LANES_SELECT(horizon->low, LANES_MAX(slopes.low, horizon->low), inside);
        horizon->above = LANES_SELECT(horizon->above, LANES_MIN(slopes.high, horizon->above), inside);
    }
}

// The lanes for which some light's slope lies above `low` and not above `high`, so that better bounds may decide it.
static LaneInt have_lights_between(__global const HorizonFan* fan, LaneFloat low, LaneFloat high) {
    LaneInt found = (LaneInt)(0);
    for (uint l = 0; l < fan->light_count; ++l) {
        LaneFloat slope = (LaneFloat)(fan->slopes[l]);
        found |= LANE_COMPARE(slope, >, low) & LANE_COMPARE(slope, <=, high);
    }
    return found;
}

// Both bounds, of all steps of a group; where lights depend on it, triangle by triangle if the group is near.
static void meet_group(Horizon* horizon, uint g, const FieldBlock* block, __global const HorizonFan* fan,
                       const FieldScene* scene, LaneInt lanes) {
    __global const HorizonStep* group = &scene->steps[g * (1u + STEPS_OF_GROUP)];
    LaneFloat high = horizon->high;
    for (uint k = 1; k <= STEPS_OF_GROUP; ++k) {
        StepSlopes slopes = slopes_over(&group[k], block, scene->pyramid);
        LaneInt inside = lanes & LANE_COMPARE((LaneFloat)(group[k].q), <=, block->reach_inside);
        high = LANES_MAX(slopes.high, high);
        horizon->low = LANES_SELECT(horizon->low, LANES_MAX(slopes.low, horizon->low), inside);
    }
    LaneInt closer = (LaneInt)(0);
    LaneFloat known = LANES_MAX(horizon->high, horizon->low);
    if (g < fan->near_groups) closer = lanes & have_lights_between(fan, known, high);
    horizon->high = LANES_SELECT(horizon->high, high, lanes & ~closer);
    if (!LANES_ANY(closer)) return;
    meet_triangles(horizon, group->q * fan->least_major, group->end * fan->most_major, block, fan, scene, closer);
}

// Both bounds, of the groups that could raise the horizon.
static void meet_groups(Horizon* horizon, const FieldBlock* block, __global const HorizonFan* fan,
                        const FieldScene* scene) {
    for (uint g = 0; g < fan->group_count; ++g) {
        __global const HorizonStep* group = &scene->steps[g * (1u + STEPS_OF_GROUP)];
        LaneInt lanes = lanes_left(horizon, group, block);
        if (!LANES_ANY(lanes)) return;
        StepSlopes slopes = slopes_over(group, block, scene->pyramid);
        lanes &= LANE_COMPARE(slopes.high, >, horizon->low * SLOPE_WELL_BELOW);
        if (!LANES_ANY(lanes)) continue;
        LaneFloat q = (LaneFloat)(group->q), begin = LANES_MIN(q, horizon->begin);
        horizon->begin = LANES_SELECT(horizon->begin, begin, lanes);
        meet_group(horizon, g, block, fan, scene, lanes);
    }
}

static Horizon horizon_of(const FieldBlock* block, __global const HorizonFan* fan, const FieldScene* scene) {
    Horizon horizon = no_horizon();
    meet_triangles(&horizon, 0.0f, (float)NEAR_CELLS, block, fan, scene, block->usable);
    LaneFloat near_high = horizon.high;
    meet_first_parts(&horizon, block, fan->group_count, scene);
    meet_groups(&horizon, block, fan, scene);
    LaneInt is_near = LANE_COMPARE(near_high, >, horizon.low * SLOPE_WELL_BELOW);
    horizon.begin = LANES_SELECT(horizon.begin, (LaneFloat)(0.0f), is_near);
    return horizon;
}

// ---- Lights ---------------------------------------------------------------------------------------------------------

// Of a block's points, the lights that reach them for certain, and those that do not. low: lanes in which some other
// light may be below the horizon's lower bound.
typedef struct FanLights {
    LaneInt lit, dark, low;
} FanLights;

static FanLights lights_by(const Horizon* horizon, const FieldBlock* block, __global const HorizonFan* fan,
                           const HeightField* field) {
    LaneInt certain = horizon->has_first & LANE_COMPARE(block->reach_inside, >, (LaneFloat)(fan->near_reach)) &
                      LANE_COMPARE(horizon->first_high, >, (LaneFloat)(-INFINITY)) & lanes_inside(block, field);
    FanLights lights = {(LaneInt)(0), (LaneInt)(0), (LaneInt)(0)};
    for (uint l = 0; l < fan->light_count; ++l) {
        LaneFloat less = (LaneFloat)(fan->slopes[l] * SLOPE_BELOW), more = (LaneFloat)(fan->slopes[l] * SLOPE_ABOVE);
        LaneInt bit = (LaneInt)((int)(1u << l));
        LaneInt is_above = certain & LANE_COMPARE(less, >, horizon->first_high);
        LaneInt into = LANE_COMPARE(more, <, horizon->low) & is_above;
        LaneInt out_of = LANE_COMPARE(more, <, horizon->first_low) & LANE_COMPARE(less, >, horizon->above);
        LaneInt lit = LANE_COMPARE(less, >, horizon->high), dark = certain & (into | out_of);
        lights.lit |= lit & bit;
        lights.dark |= dark & bit;
        lights.low |= ~(lit | dark | is_above);
    }
    return lights;
}

// ---- Fans -----------------------------------------------------------------------------------------------------------

GN_NOINLINE_ON_CPU void decide_horizons(ItemRange items, const HorizonParams params, __global const HorizonFan* fans,
                                        __global const HorizonStep* steps, __global const uint* starts,
                                        __global const uint* list, __global const uint* pyramid,
                                        __global const float* vertices, __global const float* positions,
                                        __global const uint* receivers, __global uint* masks, __global uint* lit,
                                        __global float* begins) {
    uint blocks = block_count(params.points);
    GN_FOR_EACH_OF(task, items) {
        size_t number = task % blocks, bundle = task / blocks, first = bundle * params.mask_stride;
        __global const HorizonFan* fan = &fans[bundle];
        __global float* open = (__global float*)(masks + first);
        LaneInt mask = LANES_AS_INT(load_lanes(open, params.points, number)), reached = (LaneInt)(0);
        LaneFloat zero = (LaneFloat)(0.0f), begin = zero;
        FieldBlock block = load_field_block(&params, number, positions, receivers);
        block.usable &= LANE_COMPARE(mask, !=, (LaneInt)(0));
        if (fan->group_count != 0u && LANES_ANY(block.usable)) {
            FieldScene scene = {&params, steps + fan->first_step, starts, list, pyramid, vertices};
            set_reach(&block, fan, &params.field);
            Horizon horizon = horizon_of(&block, fan, &scene);
            FanLights lights = lights_by(&horizon, &block, fan, &params.field);
            reached = mask & lights.lit & block.usable;
            begin = LANES_SELECT(horizon.begin - 2.0f, zero, lights.low | ~block.usable);
            begin = LANES_MAX(begin, zero) / params.field.halves;
            mask &= ~(block.usable & (lights.lit | lights.dark));
        }
        store_lanes(LANES_AS_FLOAT(mask), open, params.points, number);
        store_lanes(begin, begins + first, params.points, number);
        store_lanes(LANES_AS_FLOAT(reached), (__global float*)(lit + first), params.points, number);
    }
}

// masks: the lights that points face; then those that are still open. lit: those that reach them. begins: how far along
// the ground the open lights' rays meet nothing.
__kernel void horizons(const HorizonParams params, __global const HorizonFan* fans, __global const HorizonStep* steps,
                       __global const uint* starts, __global const uint* list, __global const uint* pyramid,
                       __global const float* vertices, __global const float* positions, __global const uint* receivers,
                       __global uint* masks, __global uint* lit, __global float* begins) {
    decide_horizons(item_range(block_count(params.points) * (size_t)params.bundle_count), params, fans, steps, starts,
                    list, pyramid, vertices, positions, receivers, masks, lit, begins);
}

// Adds the lights that reach points to those that did after they were traced.
__kernel void horizons_join(const HorizonParams params, __global uint* masks, __global const uint* lit) {
    GN_FOR_EACH(i, params.points.count * (size_t)params.bundle_count) {
        size_t at = i / params.points.count * params.mask_stride + i % params.points.count;
        masks[at] |= lit[at];
    }
}
