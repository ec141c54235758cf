// SPDX-License-Identifier: MIT
// gnomon.h: world coordinates.
#include "c/c_interface.hpp"

using namespace gnomon;
using namespace gnomon::c;

namespace {

WorldLattice lattice_at(const gnomon_world_lattice* lattice, const char* argument = "lattice") {
    const gnomon_world_lattice& c_world_lattice = at(lattice, argument);
    return {.exponent = c_world_lattice.exponent,
            .origin = values_at<std::int64_t, 3>(c_world_lattice.origin, argument)};
}

void give_lattice(const WorldLattice& lattice, gnomon_world_lattice* lattice_out) {
    gnomon_world_lattice& out = at(lattice_out, "lattice_out");
    std::copy(lattice.origin.begin(), lattice.origin.end(), out.origin);
    out.exponent = lattice.exponent;
}

template <typename Value>
void give_array(const std::vector<Value>& values, Value* out, const char* argument) {
    if (!values.empty()) std::copy(values.begin(), values.end(), &at(out, argument));
}

}  // namespace

gnomon_status gnomon_world_lattice_around(const double* positions, size_t count, int32_t exponent,
                                          gnomon_world_lattice* lattice_out) {
    return guarded(
        [&] { give_lattice(WorldLattice::around(array(positions, count, 3, "positions"), exponent), lattice_out); });
}

gnomon_status gnomon_world_lattice_fit(const double* positions, size_t count, gnomon_world_lattice* lattice_out) {
    return guarded([&] { give_lattice(WorldLattice::fit(array(positions, count, 3, "positions")), lattice_out); });
}

gnomon_status gnomon_world_lattice_snap(const gnomon_world_lattice* lattice, const double* positions, size_t count,
                                        float* snapped_out, double* largest_move_out) {
    return guarded([&] {
        const WorldLattice::Snapped snapped = lattice_at(lattice).snap(array(positions, count, 3, "positions"));
        give_array(snapped.positions, snapped_out, "snapped_out");
        give(largest_move_out, snapped.largest_move);
    });
}

gnomon_status gnomon_world_lattice_lift(const gnomon_world_lattice* lattice, const double* positions,
                                        const double* normals, size_t count, float* lifted_out) {
    return guarded([&] {
        give_array(
            lattice_at(lattice).lift(array(positions, count, 3, "positions"), array(normals, count, 3, "normals")),
            lifted_out, "lifted_out");
    });
}

gnomon_status gnomon_world_lattice_changes(const gnomon_world_lattice* lattice, const double* triangles, size_t count,
                                           double degrees, gnomon_change* changes_out) {
    return guarded([&] {
        std::vector<gnomon_change> values;
        for (const WorldLattice::Change change :
             lattice_at(lattice).changes(array(triangles, count, 9, "triangles"), degrees))
            values.push_back(static_cast<gnomon_change>(change));
        give_array(values, changes_out, "changes_out");
    });
}

gnomon_status gnomon_world_lattice_touched_triangles(const gnomon_world_lattice* lattice, const double* triangles,
                                                     size_t count, uint32_t* touched_out) {
    return guarded([&] {
        give_array(lattice_at(lattice).touched_triangles(array(triangles, count, 9, "triangles")), touched_out,
                   "touched_out");
    });
}

gnomon_status gnomon_world_lattice_world_of(const gnomon_world_lattice* lattice, const float position[3],
                                            double world_out[3]) {
    return guarded([&] {
        const std::array<double, 3> world = lattice_at(lattice).world_of(float3_at(position, "position"));
        std::copy(world.begin(), world.end(), &at(world_out, "world_out"));
    });
}

gnomon_status gnomon_world_lattice_rebase(const gnomon_world_lattice* lattice, const float* positions, size_t count,
                                          const gnomon_world_lattice* other, float* rebased_out) {
    return guarded([&] {
        give_array(lattice_at(lattice).rebased(array(positions, count, 3, "positions"), lattice_at(other, "other")),
                   rebased_out, "rebased_out");
    });
}
