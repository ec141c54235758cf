#!/bin/bash
# SPDX-License-Identifier: MIT
# Plants faults in copies of the kernels and sees that the proofs notice.
# usage: faults.sh KERNELS [SHARD SHARDS]    SHARD: from 1 to SHARDS; of the faults, each SHARDS-th; default: all
set -euo pipefail
kernels=$1 shard=${2:-1} shards=${3:-1} planted=0 proofs=$(dirname "$(realpath "$0")")
command -v clang-14 >/dev/null || { echo "NOT TESTED: there is no clang-14 here"; exit 77; }
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT

is_mine() { [ $((planted % shards)) -eq $((shard - 1)) ]; }
# noticed FILE SED-EXPRESSION PROOF: the proof's expressions are no longer the kernel's.
noticed() {
    planted=$((planted + 1))
    is_mine || return 0
    rm -rf "$made/kernels"
    cp -r "$kernels" "$made/kernels"
    sed -i "$2" "$made/kernels/$1"
    ! cmp -s "$kernels/$1" "$made/kernels/$1" || { echo "$1 has nothing that '$2' changes"; exit 1; }
    if GNOMON_KERNELS_DIR=$made/kernels "$proofs/expressions.py" "$proofs/$3" >"$made/said" 2>&1; then
        echo "$3 does not notice '$2' in $1"
        exit 1
    fi
    grep -q 'does not prove what the kernels' "$made/said" || { cat "$made/said"; exit 1; }
}
# refused PROOF: Coq must refuse what the proof makes of the kernel that noticed() has just changed.
refused() {
    is_mine && command -v coqc >/dev/null || return 0
    if [ ! -d "$made/proofs" ]; then
        cp -r "$proofs" "$made/proofs"
        (cd "$made/proofs" && rm -f ./*.vo && for name in Roundings Devices Filters; do coqc -q "$name.v"; done)
        printf '%s\n' 'From Coq Require Import Reals QArith.' 'Require Import Roundings Devices Filters.' \
            >"$made/proofs/refusals.v"
    fi
    cp "$proofs/$1.v" "$made/proofs/$1.v"
    (cd "$made/proofs" && GNOMON_KERNELS_DIR=$made/kernels ./expressions.py --write "$1.v" && mv "$1.v" "$1_$planted.v")
    echo "Fail Load \"$1_$planted\"." >>"$made/proofs/refusals.v"
}
# judged: one process of Coq, which reads the libraries once, tries all that refused() wrote. It stops at what it accepts.
judged() {
    [ -d "$made/proofs" ] || return 0
    if ! (cd "$made/proofs" && coqc -q refusals.v) >"$made/said" 2>&1; then
        tail -n 20 "$made/said"
        echo "Coq accepts a proof with a fault, or cannot read one; that line:"
        sed -n "$(sed -nE 's/^File ".*refusals.v", line ([0-9]+).*/\1/p' "$made/said" | tail -n 1)p" "$made/proofs/refusals.v"
        exit 1
    fi
}

# A constant below the least; two additions exchanged; a range that is another.
noticed exact/det3.clh 's/5\.0e-7f$/4.76e-7f/' det3_float.v
refused det3_float
noticed exact/det3.clh 's/w\.x \* cross\.value\.x + w\.y \* cross\.value\.y + w\.z \* cross\.value\.z/w.x * cross.value.x + (w.y * cross.value.y + w.z * cross.value.z)/' det3_float.v
noticed exact/det3.clh 's/0x1p-40f/0x1p-41f/' det3_float.v
# A sum that the size lacks: the value's permanent is no longer below it.
noticed exact/det3_lanes.clh 's/plus_size\.z + minus_size\.z/plus_size.z/' det3_float.v
noticed occluders/triangle_records.clh 's/fma(a->y, d_w, -(a->w \* d_y))/fma(-a->w, d_y, a->y * d_w)/' edge_functions.v
noticed simd/projection.h 's/(10\.0f \* GN_U)/(5.0f * GN_U)/' projection.v
noticed beams/beam_intersect.clh 's/5\.2e-7f/2.6e-7f/' beams.v
# The heights' errors, which no test misses; constants just below the least; what keeps a box's side outside.
noticed occluders/triangle_records.clh 's/safe_n_z + v\[0\].error_z + height_error/safe_n_z/' planes.v
noticed occluders/triangle_records.clh 's/PLANE_NEAR 0x1p-80f/PLANE_NEAR 0x1p-82f/' planes.v
refused planes
noticed occluders/triangle_records.clh 's/(ay1 \* az2 + az1 \* ay2) \* (4\.0f/(ay1 * az2 + az1 * ay2) * (3.0f/' planes.v
refused planes
noticed occluders/triangle_records.clh 's/largest \* (8.0f \* GN_U)/largest * (6.5f * GN_U)/' planes_in_perspective.v
refused planes_in_perspective
noticed occluders/triangle_records.clh 's/side_error_1 \* side_error_2 \* 2.0f/side_error_1 * side_error_2/' planes_in_perspective.v
refused planes_in_perspective
noticed occluders/triangle_records.clh 's/UNDERFLOW 0x1p-90f/UNDERFLOW 0x1p-96f/' planes_in_perspective.v
refused planes_in_perspective
noticed occluders/triangle_records.clh 's/PLANE_NEAR 0x1p-80f/PLANE_NEAR 0x1p-96f/' planes_in_perspective.v
refused planes_in_perspective
noticed occluders/triangle_records.clh 's/ + e_1a \* e_2a) \* 2\.0f/) * 2.0f/' planes_in_perspective.v
noticed packets/parallel_packets.clh 's/PACKET_BOUND_OF_POINT 6.2e-7f/PACKET_BOUND_OF_POINT 5.8e-7f/' packets.v
refused packets
noticed beams/beam_intersect.clh 's/return side - origin + by/return side + by - origin/' boxes.v
# The bounds of a whole frame, of prepared lights and of slopes of the pyramid: constants below what is proved.
noticed receivers/light_frame.cl 's/FRAME_PADDING (32\.0f/FRAME_PADDING (28.0f/' frame_fit.v
refused frame_fit
noticed receivers/light_frame.cl 's/1\.01f \* PROJECTION_ERROR \* fmax/0.6f * PROJECTION_ERROR * fmax/' frame_errors.v
refused frame_errors
noticed prepared/prepared_light.h 's/PREPARED_PADDING (32\.0f/PREPARED_PADDING (8.0f/' prepared_boxes.v
refused prepared_boxes
noticed horizons/horizons.cl 's/SLOPE_BELOW (1\.0f - 0x1\.8p-21f)/SLOPE_BELOW (1.0f - 0x1p-22f)/' pyramid_slopes.v
refused pyramid_slopes
# What keeps bounds above what underflow takes.
noticed horizons/sweeps.h 's/SWEEP_CROSSING_ERROR (14\.0f/SWEEP_CROSSING_ERROR (7.0f/' sweeps.v
refused sweeps
noticed horizons/sweeps.h 's/SWEEP_LOST 0x1p-77f/SWEEP_LOST 0x1p-78f/' sweeps.v
refused sweeps
noticed horizons/sweep_rays.clh 's/(a + share \* (b - a)) - climb/a + (share * (b - a) - climb/; s/climb \* farther;/climb * farther);/' sweeps.v
noticed horizons/sweeps.h 's/ROUNDINGS 128\.0f/ROUNDINGS 90.0f/; s/ROUNDINGS 24\.0f/ROUNDINGS 14.0f/' sweeps.v
refused sweeps
noticed horizons/sweeps.cl 's/ends\[1\] - ends\[0\]/ends[0] - ends[1]/' sweeps.v
noticed horizons/sweeps.cl 's/strips->last\.at\[k\]) + bend/strips->last.at[k])/' sweeps.v
noticed horizons/sweeps.cl 's/LANES_MAX(most\.at\[k\], strips/LANES_MAX(least.at[k], strips/' sweeps.v
noticed horizons/sweeps.cl 's/0\.25f \* share/0.2f * share/' sweeps.v
noticed horizons/sweeps.cl 's/-1\.0f - share/share - 1.0f/' sweeps.v
noticed horizons/height_field.h 's/FIELD_NEAR 0x1p-40f/FIELD_NEAR 0x1p-60f/' horizons.v
refused horizons
noticed horizons/strip_triangle.clh 's/HEIGHT_NEAR 0x1p-16f/HEIGHT_NEAR 0x1p-18f/' slopes.v
refused slopes
noticed horizons/strip_triangle.clh 's/ + HEIGHT_NEAR;/;/' slopes.v
noticed horizons/strip_triangle.clh 's/CROSSING_NEAR 0x1p-43f/CROSSING_NEAR 0x1p-45f/' slopes.v
refused slopes
noticed occluders/eye_records.clh 's/EYE_PLANE_NEAR 0x1p-100f/EYE_PLANE_NEAR 0x1p-108f/' eye_planes.v
refused eye_planes
noticed occluders/eye_records.clh 's/EYE_EDGE_BOUND 7.5e-7f/EYE_EDGE_BOUND 6.9e-7f/' eye_records.v
refused eye_records
noticed receivers/footprint.h 's/FOOTPRINT_NEAR 0x1p-90f/FOOTPRINT_NEAR 0x1p-91f/' footprints.v
refused footprints
noticed samples/footprints.clh 's/1.0e-30f;/1.0e-31f;/' spread.v
refused spread
noticed exact/cut_outs.clh 's/(CutReal)0x1p-50f);/(CutReal)0x1p-60f);/' cut_outs.v
refused cut_outs
noticed exact/cut_outs.clh 's/largest + 4\.0f \* u/largest/' cut_out_lanes.v
noticed lights/light_sides.cl 's/0x1p-98f/0x1p-100f/' light_sides.v
refused light_sides
noticed beams/beam.h 's/BEAM_ROUNDING 4e-6f/BEAM_ROUNDING 3.1e-6f/' leaf_extents.v
refused leaf_extents
noticed packets/parallel_packets.clh 's/PACKET_BOUND_OF_HEIGHT 8\.0f/PACKET_BOUND_OF_HEIGHT 4.4f/' packet_heights.v
refused packet_heights
noticed receivers/footprint.h 's/(64\.0f \* GN_U) \* sizes/(26.0f * GN_U) * sizes/' footprints.v
refused footprints
noticed samples/footprints.clh 's/1.01f \* (rest + error + (50\.0f/1.01f * (rest + error + (34.0f/' spread.v
refused spread
noticed samples/footprints.clh 's/3\.0f \* (reach + eye_size)/2.0f * (reach + eye_size)/' spread.v
refused spread
noticed occluders/hull_bounds.clh 's/BOUND_INFLATION 1\.01f/BOUND_INFLATION 1.009f/' rectangles.v
refused rectangles
noticed receivers/light_frame.cl 's/1\.0e-18f/1.0e-20f/' frame_fit.v
refused frame_fit
noticed prepared/prepared_facing.clh 's/0x1p-120f/0x1p-125f/' prepared_facing.v
refused prepared_facing
# Limits of what a proof assumes of its inputs; least terms of margins.
noticed receivers/light_frame.h 's/LARGEST_EXTENT 1\.0e30f/LARGEST_EXTENT 1.3e30f/' frame_fit.v
refused frame_fit
noticed receivers/light_frame.h 's/SMALLEST_W 1\.0e-15f/SMALLEST_W 4.0e-16f/' frame_errors.v
refused frame_errors
refused prepared_boxes
noticed prepared/prepared_facing.clh 's/PLANE_LEAST 0x1p-60f/PLANE_LEAST 0x1p-61f/' prepared_facing.v
refused prepared_facing
noticed occluders/triangle_records.clh 's/EDGE_NEAR 1\.0e-30f/EDGE_NEAR 4.0e-32f/' edge_functions.v
refused edge_functions
noticed beams/beam.h 's/BEAM_ROUNDING_LEAST 1e-30f/BEAM_ROUNDING_LEAST 9e-31f/' leaf_extents.v
refused leaf_extents
noticed beams/beam.h 's/BEAM_ROUNDING_LEAST 1e-30f/BEAM_ROUNDING_LEAST 7e-34f/' tree.v
refused tree
# A bound that lacks one of its two; a plane's factor; a mean's; terms of the camera's rays and of its intervals.
noticed receivers/backfacing.cl 's/1\.01f \* (bound_a + bound_b)/1.01f * bound_a/' two_determinants.v
refused two_determinants
noticed beams/beam_intersect.clh 's/PLANE_BOUNDS 1\.5f/PLANE_BOUNDS 1.1f/' light_boxes.v
refused light_boxes
noticed exact/cut_outs.clh 's/257\.0f/255.0f/' cut_out_means.v
refused cut_out_means
refused cut_out_means_float
# A single hit in float: of its quotient, which double has with more room; of its last roundings.
noticed exact/cut_outs.clh 's/16 \* CUT_HALF_ULP);/12 * CUT_HALF_ULP);/' cut_out_lanes.v
refused cut_out_lanes
noticed exact/cut_outs.clh 's/(2 \* CUT_HALF_ULP + (CutReal)0x1p-50f)/(CUT_HALF_ULP + (CutReal)0x1p-50f)/' cut_out_lanes.v
refused cut_out_lanes
noticed exact/cut_outs.clh 's/16\.0f \* u) \* largest/9.0f * u) * largest/' cut_out_lanes.v
refused cut_out_lanes
noticed camera/camera_rays.clh 's/4\.0f \* (fabs(picture\.corner/3.0f * (fabs(picture.corner/' camera_rays.v
refused camera_rays
noticed camera/camera_rays.clh 's/5\.0e-7f/4.0e-7f/' nearness.v
refused nearness
# Operands exchanged, which compute the same in real numbers.
noticed exact/cut_outs.clh 's/upper + g \* (lower - upper)/upper - g * (upper - lower)/' cut_out_means.v
judged
