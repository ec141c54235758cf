// SPDX-License-Identifier: MIT
// The trace of packets on a CPU: the shadow rays of a block of 16 points to one light. Where triangles are small beside
// the points' distance, or lights are few, a packet meets fewer of them than a shaft. Along the light's own axes
// (light_bundle.h) all rays are parallel: a ray is a point in two axes, a packet a rectangle. Lanes are a node's
// children, then the rays, for each child that meets the rectangle; then a leaf's triangles, then the rays again. A
// block's packets to the lights of a bundle follow one another, since they meet the same nodes and leaves.
//
// Filter of a triangle and a packet's rays. In the leaf's coordinates u, v, w, from its origin O, a corner of a
// triangle, e_c(P) = (A - P) x (B - P) along w is linear in P: x P_u + y P_v + z. All three are turned such that their
// sum, twice the area, is positive. Where all are positive the ray's line meets the triangle, and h = e_a (A_w - P_w) +
// e_b (B_w - P_w) + e_c (C_w - P_w), linear too, is positive if it does so beyond P. Where one is negative it misses.
//
// Bound, in units of 2^-24. S is the largest |X - O|_1 of a corner of the leaf, R = |P - O|_1, q = |P_u| + |P_v|. A
// corner's coordinate rounds four times (a difference, three of the sum): it is wrong by 4 S, P's by 4 R. So x and y
// are wrong by 9 S, z by 20 S^2, and with two roundings of the sum e by S (8 R + 11 q + 24 S), and by
// 1.75 (S + R) (S + q) since u and v are not quite at right angles to D: by less than (S + q) (36 S + 10 R). The area
// is wrong by 40 S^2. If its sign is wrong and the line meets the triangle, no e exceeds that. So with m = (S + q) (76
// S + 10 R) an e below -m proves a miss, and three above m a meeting, whichever way they are turned. h's coefficients
// of u and v (three products of x or y and a height) are wrong by 54 S^2, that of w by 100 S^2, the last one by 144
// S^3; with P's errors and three roundings h is wrong by S^2 (63 q + 162 S + 106 |P_w| + 32 R), and by 3 m (S + |P_w|)
// through the errors of the e: 8 m (S + |P_w|) bounds both.
//
// Boxes. With the largest coordinate L a box's side rounds by less than 5.4e-7 L, a ray's coordinate by 4.2e-7 L, a
// leaf's corner from the scene's origin by 1.3e-6 L, and u . D moves X by 1.8e-7 L: `rounding` is 4e-6 L.
#include "shafts/shaft_walk.clh"

#if GN_LANES > 1

#define PACKET_BOUND_OF_LEAF 4.6e-6f
#define PACKET_BOUND_OF_POINT 6.2e-7f
#define PACKET_BOUND_OF_HEIGHT 8.0f

typedef struct Packet {
    PointBlock points;
    LaneInt receivers;
    size_t block;
    uint bundle_index, light;
    __global const LightBundle* bundle;
    LightAxes axes;
    uint open;                                  // bit i: ray i is not blocked yet
    PointBlock low, high;                       // u, v and w of the rays, less and plus the bound of rounding errors
    float low_u, high_u, low_v, high_v, low_w;  // the rectangle around the open rays, and the least height
} Packet;

static float least_of_open(LaneFloat v, LaneInt open) {
    return LANES_LEAST(LANES_SELECT((LaneFloat)(INFINITY), v, open));
}

static LaneInt lanes_of_bits(uint bits) { return LANE_COMPARE((LaneInt)((int)bits) << (31 - LANE_INDEX), <, 0); }

static void set_rectangle(Packet* packet) {
    LaneInt open = lanes_of_bits(packet->open);
    packet->low_u = least_of_open(packet->low.x, open);
    packet->low_v = least_of_open(packet->low.y, open);
    packet->low_w = least_of_open(packet->low.z, open);
    packet->high_u = -least_of_open(-packet->high.x, open);
    packet->high_v = -least_of_open(-packet->high.y, open);
}

// ---- Nodes ----------------------------------------------------------------------------------------------------------

// Nodes and leaves that wait, each with the rays that meet its box.
typedef struct PacketStack {
    uint codes[MOST_SHAFT_ENTRIES], rays[MOST_SHAFT_ENTRIES];
    uint top;
} PacketStack;

// The extents of a node's children along the light's axes.
typedef struct TurnedBoxes {
    float low_u[GN_LANES], high_u[GN_LANES], low_v[GN_LANES], high_v[GN_LANES], high_w[GN_LANES];
} TurnedBoxes;

// The greatest value along n of each child's box; along -n, the least one with its sign changed.
static LaneFloat farthest_along(__global const float* node, float3 n) {
    PointBlock side = {farthest_side(node, 0u, n.x), farthest_side(node, 1u, n.y), farthest_side(node, 2u, n.z)};
    return lanes_along(n, side);
}

static uint rays_in_box(const Packet* packet, const TurnedBoxes* boxes, uint k) {
    return packet->open & lane_bits(LANE_COMPARE(packet->high.x, >=, (LaneFloat)(boxes->low_u[k])) &
                                    LANE_COMPARE(packet->low.x, <=, (LaneFloat)(boxes->high_u[k])) &
                                    LANE_COMPARE(packet->high.y, >=, (LaneFloat)(boxes->low_v[k])) &
                                    LANE_COMPARE(packet->low.y, <=, (LaneFloat)(boxes->high_v[k])) &
                                    LANE_COMPARE(packet->low.z, <=, (LaneFloat)(boxes->high_w[k])));
}

static void push_packet(PacketStack* stack, uint code, uint rays, const ShaftScene* scene) {
    stack->codes[stack->top] = code;
    stack->rays[stack->top++] = rays;
    if ((code & SHAFT_LEAF) == 0u) {
        __global const float* node = scene->nodes + (size_t)code * (SHAFT_NODE_ROWS * SHAFT_WIDTH);
        for (uint row = 0; row < SHAFT_NODE_ROWS; ++row) GN_PREFETCH(node + row * SHAFT_WIDTH);
    } else {
        size_t leaf = code & ~SHAFT_LEAF;
        __global const float* corners = scene->leaves + leaf * (SHAFT_LEAF_ROWS * SHAFT_WIDTH);
        for (uint row = 0; row < SHAFT_LEAF_ROWS; ++row) GN_PREFETCH(corners + row * SHAFT_WIDTH);
        GN_PREFETCH(scene->ids + leaf * SHAFT_WIDTH);
    }
}

// Pushes the children of a node whose boxes meet the rectangle, and then one of the rays.
GN_INLINE_ON_CPU void push_children_of_packet(PacketStack* stack, uint index, const Packet* packet,
                                              const ShaftScene* scene) {
    __global const float* node = scene->nodes + (size_t)index * (SHAFT_NODE_ROWS * SHAFT_WIDTH);
    float3 u = vload3(0, packet->axes.u), v = vload3(0, packet->axes.v);
    LaneFloat low_u = -farthest_along(node, -u), high_u = farthest_along(node, u);
    LaneFloat low_v = -farthest_along(node, -v), high_v = farthest_along(node, v);
    LaneFloat high_w = farthest_along(node, vload3(0, packet->axes.w));
    uint bits = lane_bits(
        LANE_COMPARE(low_u, <=, (LaneFloat)(packet->high_u)) & LANE_COMPARE(high_u, >=, (LaneFloat)(packet->low_u)) &
        LANE_COMPARE(low_v, <=, (LaneFloat)(packet->high_v)) & LANE_COMPARE(high_v, >=, (LaneFloat)(packet->low_v)) &
        LANE_COMPARE(high_w, >=, (LaneFloat)(packet->low_w)));
    if (bits == 0u) return;
    TurnedBoxes boxes;
    vstore16(low_u, 0, boxes.low_u);
    vstore16(high_u, 0, boxes.high_u);
    vstore16(low_v, 0, boxes.low_v);
    vstore16(high_v, 0, boxes.high_v);
    vstore16(high_w, 0, boxes.high_w);
    __global const uint* codes = (__global const uint*)node + SHAFT_CODES;
    while (bits != 0u) {
        uint k = take_lowest_bit(&bits), rays = rays_in_box(packet, &boxes, k);
        if (rays != 0u) push_packet(stack, codes[k], rays, scene);
    }
}

// ---- Leaves ---------------------------------------------------------------------------------------------------------

// Rows of a leaf's triangles as a packet tests them: x, y, z of the three e, then x, y, w, z of h, then the greatest
// height.
#define PACKET_ROWS 14u
#define ROW_OF_HEIGHT 9u
#define ROW_OF_GREATEST 13u

// A leaf's triangles, and the packet's points in its coordinates.
typedef struct PacketLeaf {
    float rows[PACKET_ROWS * GN_LANES];
    LaneFloat u, v, w;
    LaneFloat bound, height_bound;  // m, 8 m (S + |P_w|)
    LaneFloat rounding;             // of a corner's height above P
} PacketLeaf;

// The corners of a leaf's triangles along the light's axes, from the leaf's origin.
typedef struct TurnedCorners {
    PointBlock a, b, c;
    float3 origin;
    LaneFloat sizes;  // of each triangle the largest |X - O|_1 of a corner
} TurnedCorners;

static PointBlock turned(PointBlock p, const LightAxes* axes) {
    return (PointBlock){lanes_along(vload3(0, axes->u), p), lanes_along(vload3(0, axes->v), p),
                        lanes_along(vload3(0, axes->w), p)};
}

// False if the leaf has no triangles.
GN_INLINE_ON_CPU bool turn_corners(TurnedCorners* t, __global const float* leaf, const LightAxes* axes) {
    PointBlock a = load_corner(leaf, 0u), b = load_corner(leaf, 1u), c = load_corner(leaf, 2u);
    uint present = lane_bits(LANE_COMPARE(a.x, ==, a.x));
    if (present == 0u) return false;
    uint i = lowest_bit(present);
    t->origin = (float3)(leaf[i], leaf[SHAFT_WIDTH + i], leaf[2u * SHAFT_WIDTH + i]);
    PointBlock from = same_in_lanes(t->origin);
    a = lanes_difference(a, from), b = lanes_difference(b, from), c = lanes_difference(c, from);
    LaneFloat size_a = lanes_size(a), size_b = lanes_size(b), size_c = lanes_size(c);
    LaneFloat larger = LANES_MAX(size_a, size_b);
    t->sizes = LANES_MAX(larger, size_c);
    t->a = turned(a, axes), t->b = turned(b, axes), t->c = turned(c, axes);
    return true;
}

// The triangles whose boxes along the axes meet the rectangle.
static uint triangles_in_rectangle(const TurnedCorners* t, const Packet* packet) {
    const LightAxes* axes = &packet->axes;
    float o_u = along_axis(axes->u, t->origin), o_v = along_axis(axes->v, t->origin);
    float o_w = along_axis(axes->w, t->origin);
    LaneFloat low_u = LANES_MIN(t->a.x, t->b.x), low_v = LANES_MIN(t->a.y, t->b.y);
    LaneFloat high_u = LANES_MAX(t->a.x, t->b.x), high_v = LANES_MAX(t->a.y, t->b.y);
    LaneFloat high_w = LANES_MAX(t->a.z, t->b.z);
    low_u = LANES_MIN(low_u, t->c.x), low_v = LANES_MIN(low_v, t->c.y);
    high_u = LANES_MAX(high_u, t->c.x), high_v = LANES_MAX(high_v, t->c.y), high_w = LANES_MAX(high_w, t->c.z);
    return lane_bits(LANE_COMPARE(low_u, <=, (LaneFloat)(packet->high_u - o_u)) &
                     LANE_COMPARE(high_u, >=, (LaneFloat)(packet->low_u - o_u)) &
                     LANE_COMPARE(low_v, <=, (LaneFloat)(packet->high_v - o_v)) &
                     LANE_COMPARE(high_v, >=, (LaneFloat)(packet->low_v - o_v)) &
                     LANE_COMPARE(high_w, >=, (LaneFloat)(packet->low_w - o_w)));
}

static void set_points(PacketLeaf* of, const TurnedCorners* t, const Packet* packet, float size) {
    PointBlock from = lanes_difference(packet->points, same_in_lanes(t->origin)), at = turned(from, &packet->axes);
    of->u = at.x, of->v = at.y, of->w = at.z;
    LaneFloat distance = lanes_size(from), off = fabs(at.x) + fabs(at.y) + size;
    of->rounding = 6.5e-7f * (distance + size) + SHAFT_UNDERFLOW;
    of->bound = off * (PACKET_BOUND_OF_LEAF * size + PACKET_BOUND_OF_POINT * distance) + SHAFT_UNDERFLOW;
    of->height_bound = PACKET_BOUND_OF_HEIGHT * of->bound * (fabs(at.z) + size) + SHAFT_UNDERFLOW;
}

// Of the triangles `bits`, those that some of a few rays may meet. Lanes are triangles.
static uint triangles_of_rays(const PacketLeaf* of, const LaneFloat* x, const LaneFloat* y, const LaneFloat* z,
                              uint rays) {
    uint met = 0u;
    while (rays != 0u) {
        int lane = take_lane(&rays);
        LaneFloat u = (LaneFloat)(LANE_OF_FLOAT(of->u, lane)), v = (LaneFloat)(LANE_OF_FLOAT(of->v, lane));
        LaneFloat e_a = fma(x[0], u, fma(y[0], v, z[0])), e_b = fma(x[1], u, fma(y[1], v, z[1]));
        LaneFloat e_c = fma(x[2], u, fma(y[2], v, z[2])), least = LANES_MIN(e_a, e_b);
        least = LANES_MIN(least, e_c);
        met |= lane_bits(LANE_COMPARE(least, >=, (LaneFloat)(-LANE_OF_FLOAT(of->bound, lane))));
    }
    return met;
}

// Makes the rows of a leaf; returns those of the triangles `bits` that the rays may meet.
GN_INLINE_ON_CPU uint set_leaf(PacketLeaf* of, const TurnedCorners* t, const Packet* packet, uint bits, uint rays) {
    float size = -LANES_LEAST(LANES_SELECT((LaneFloat)(0.0f), -t->sizes, LANE_COMPARE(t->sizes, ==, t->sizes)));
    set_points(of, t, packet, size);
    LaneFloat x[3] = {t->b.y - t->c.y, t->c.y - t->a.y, t->a.y - t->b.y};
    LaneFloat y[3] = {t->c.x - t->b.x, t->a.x - t->c.x, t->b.x - t->a.x};
    LaneFloat z[3] = {fma(t->b.x, t->c.y, -(t->b.y * t->c.x)), fma(t->c.x, t->a.y, -(t->c.y * t->a.x)),
                      fma(t->a.x, t->b.y, -(t->a.y * t->b.x))};
    LaneFloat area = fma(y[2], x[1], -(y[1] * x[2]));
    LaneInt sign = LANES_AS_INT(area) & (int)0x80000000;
    for (int k = 0; k < 3; ++k) {
        x[k] = LANES_AS_FLOAT(LANES_AS_INT(x[k]) ^ sign);
        y[k] = LANES_AS_FLOAT(LANES_AS_INT(y[k]) ^ sign);
        z[k] = LANES_AS_FLOAT(LANES_AS_INT(z[k]) ^ sign);
    }
    if (popcount(rays) < popcount(bits)) bits &= triangles_of_rays(of, x, y, z, rays);
    if (bits == 0u) return 0u;
    for (int k = 0; k < 3; ++k) {
        vstore16(x[k], 3 * k, of->rows);
        vstore16(y[k], 3 * k + 1, of->rows);
        vstore16(z[k], 3 * k + 2, of->rows);
    }
    vstore16(fma(x[0], t->a.z, fma(x[1], t->b.z, x[2] * t->c.z)), ROW_OF_HEIGHT, of->rows);
    vstore16(fma(y[0], t->a.z, fma(y[1], t->b.z, y[2] * t->c.z)), ROW_OF_HEIGHT + 1, of->rows);
    vstore16(-fabs(area), ROW_OF_HEIGHT + 2, of->rows);
    vstore16(fma(z[0], t->a.z, fma(z[1], t->b.z, z[2] * t->c.z)), ROW_OF_HEIGHT + 3, of->rows);
    LaneFloat higher = LANES_MAX(t->a.z, t->b.z);
    vstore16(LANES_MAX(higher, t->c.z), ROW_OF_GREATEST, of->rows);
    return bits;
}

// x P_u + y P_v + z of triangle i for each ray; x, y and z are in rows from `row` on.
static LaneFloat linear_of_rays(const PacketLeaf* leaf, uint row, uint i) {
    const float* rows = leaf->rows + row * GN_LANES + i;
    return fma((LaneFloat)(rows[0]), leaf->u, fma((LaneFloat)(rows[GN_LANES]), leaf->v, rows[2 * GN_LANES]));
}

// Of the rays `open`, those that triangle i blocks for certain, and those for which that is not decided.
typedef struct PacketDecision {
    uint blocked, undecided;
} PacketDecision;

GN_INLINE_ON_CPU PacketDecision decide_rays(const PacketLeaf* leaf, uint i, uint open) {
    LaneFloat e_a = linear_of_rays(leaf, 0u, i), e_b = linear_of_rays(leaf, 3u, i), e_c = linear_of_rays(leaf, 6u, i);
    LaneFloat least = LANES_MIN(e_a, e_b);
    least = LANES_MIN(least, e_c);
    PacketDecision decision = {0u, open & ~lane_bits(LANE_COMPARE(least, <, -leaf->bound))};
    if (decision.undecided == 0u) return decision;
    const float* rows = leaf->rows + ROW_OF_HEIGHT * GN_LANES + i;
    LaneFloat height = fma((LaneFloat)(rows[2 * GN_LANES]), leaf->w, (LaneFloat)(rows[3 * GN_LANES]));
    height = fma((LaneFloat)(rows[0]), leaf->u, fma((LaneFloat)(rows[GN_LANES]), leaf->v, height));
    uint inside = lane_bits(LANE_COMPARE(least, >, leaf->bound));
    LaneFloat greatest_height = (LaneFloat)(leaf->rows[ROW_OF_GREATEST * GN_LANES + i]);
    uint behind = lane_bits(LANE_COMPARE(greatest_height, <, leaf->w - leaf->rounding)) |
                  (inside & lane_bits(LANE_COMPARE(height, <, -leaf->height_bound)));
    decision.blocked = decision.undecided & inside & lane_bits(LANE_COMPARE(height, >, leaf->height_bound));
    decision.undecided &= ~(behind | decision.blocked);
    return decision;
}

// The rays that begin at a corner of a triangle: it does not block them (has_corner_at()).
static uint rays_from_corners(const Packet* packet, __global const float* corners) {
    LaneInt at = (LaneInt)(0);
    for (uint row = 0; row < SHAFT_LEAF_ROWS; row += 3u) {
        float3 corner =
            (float3)(corners[row * SHAFT_WIDTH], corners[(row + 1u) * SHAFT_WIDTH], corners[(row + 2u) * SHAFT_WIDTH]);
        at |= lanes_at(same_in_lanes(corner), packet->points);
    }
    return lane_bits(at);
}

// Tests the triangles of a leaf for some of the rays.
GN_INLINE_ON_CPU void test_leaf_of_packet(Packet* packet, uint leaf, uint rays, const ShaftScene* scene,
                                          Reservation* mine) {
    __global const float* corners = scene->leaves + (size_t)leaf * (SHAFT_LEAF_ROWS * SHAFT_WIDTH);
    __global const uint* ids = scene->ids + (size_t)leaf * SHAFT_WIDTH;
    TurnedCorners t;
    if (!turn_corners(&t, corners, &packet->axes)) return;
    uint bits = triangles_in_rectangle(&t, packet);
    if (bits == 0u) return;
    PacketLeaf of;
    bits = set_leaf(&of, &t, packet, bits, rays);
    while (bits != 0u) {
        uint i = take_lowest_bit(&bits);
        PacketDecision decision = decide_rays(&of, i, rays & packet->open);
        if ((decision.blocked | decision.undecided) == 0u) continue;
        uint id = ids[i];
        bool is_masked = false;
#ifdef GN_CUT_OUTS
        is_masked = (id & SHAFT_MASKED) != 0u;
        id &= ~SHAFT_MASKED;
        if (is_masked) decision = (PacketDecision){0u, decision.blocked | decision.undecided};
#endif
        uint others = lane_bits(LANE_COMPARE(packet->receivers, !=, (LaneInt)((int)id)));
        decision.blocked &= others;
        decision.undecided &= others;
        if (decision.undecided != 0u) decision.undecided &= ~rays_from_corners(packet, corners + i);
        for (uint open = decision.undecided; open != 0u;) {
            int lane = take_lane(&open);
            ShaftPairs pair = {(uint)(packet->block * SHAFT_WIDTH) + (uint)lane, packet->bundle_index, id,
                               1u << packet->light};
            if (is_pair_blocked(pair, lane_point(packet->points, lane), corners, i, is_masked, packet->bundle, scene,
                                mine))
                decision.blocked |= 1u << lane;
        }
        packet->open &= ~decision.blocked;
    }
}

// ---- Walk -----------------------------------------------------------------------------------------------------------

GN_INLINE_ON_CPU void trace_packet(Packet* packet, PacketStack* stack, const ShaftScene* scene, uint* blocking,
                                   Reservation* mine) {
    set_rectangle(packet);
    stack->codes[0] = 0u;
    stack->rays[0] = 0xFFFFu;
    stack->top = 1u;
    for (uint k = BLOCKING_LEAVES; k-- != 0u;)
        if (blocking[k] != 0u) push_packet(stack, blocking[k], 0xFFFFu, scene);
    uint open = packet->open;
    while (stack->top != 0u) {
        uint code = stack->codes[--stack->top], rays = stack->rays[stack->top] & packet->open;
        if (rays == 0u) continue;
        if ((code & SHAFT_LEAF) == 0u) {
            push_children_of_packet(stack, code, packet, scene);
            continue;
        }
        test_leaf_of_packet(packet, code & ~SHAFT_LEAF, rays, scene, mine);
        if (packet->open == open) continue;
        note_blocking(blocking, code);
        if (packet->open == 0u) return;
        if (2u * popcount(packet->open) > popcount(open)) continue;
        open = packet->open;
        set_rectangle(packet);
    }
}

static void set_light(Packet* packet, uint light, LaneInt masks, float rounding) {
    packet->light = light;
    packet->axes = packet->bundle->axes[light];
    packet->open = lane_bits(masks << (int)(31u - light));  // the light's bit is the sign
    PointBlock at = turned(packet->points, &packet->axes);
    packet->low = (PointBlock){at.x - rounding, at.y - rounding, at.z - rounding};
    packet->high = (PointBlock){at.x + rounding, at.y + rounding, at.z + rounding};
}

__kernel void ray_packets(const ShaftParams params, __global const LightBundle* bundles, __global const float* nodes,
                          __global const float* leaves, __global const uint* ids, __global const float* positions,
                          __global const uint* receivers, __global const float* surface_normals, __global uint* masks,
                          __global ShaftPairs* queue, __global ShaftCounters* counters, __local uint* shared) {
    ShaftScene scene = {nodes, leaves, ids, queue, params.queue_capacity, params.rounding, counters};
    Reservation mine = no_reservation();
    PacketStack stack;
    uint blocks = (params.points.count + SHAFT_WIDTH - 1u) / SHAFT_WIDTH;
    uint blocking[MOST_BUNDLE_LIGHTS][BLOCKING_LEAVES] = {{0u}};  // by each light of the bundle: of the block before
    GN_FOR_EACH(task, (size_t)blocks * params.bundle_count) {
        Packet packet;
        packet.block = task % blocks;
        packet.bundle_index = (uint)(task / blocks);
        packet.bundle = &bundles[packet.bundle_index];
        size_t first = packet.block * SHAFT_WIDTH;
        __global uint* mask = masks + packet.bundle_index * (size_t)params.mask_stride + first;
        packet.points = load_block(positions, params.points, packet.block);
        LaneInt valid = valid_lanes(params.points, packet.block) & present_lanes(packet.points);
        LaneInt lights = as_int16(vload16(0, mask)) & valid;
        packet.receivers = (LaneInt)((int)GN_NO_ID);
        if (params.points.has_receivers != 0u)
            packet.receivers = as_int16(vload16(0, receivers + params.points.first / 3u + first));
        LaneInt dark = (LaneInt)(0);
        for (uint light = 0; light < packet.bundle->light_count; ++light) {
            set_light(&packet, light, lights, params.rounding);
            uint before = packet.open;
            if (before == 0u) continue;
            trace_packet(&packet, &stack, &scene, blocking[light], &mine);
            dark |= lanes_of_bits(before & ~packet.open) & (int)(1u << light);
        }
        vstore16(vload16(0, mask) & ~as_uint16(dark), 0, mask);
    }
    close_queue(&mine, &scene);
}

#endif
