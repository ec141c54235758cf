// SPDX-License-Identifier: MIT
// Lines of sight over a grid of heights on a device (kernels/sight/sight_lines.h has the rules, and the ranges of all
// numbers).
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "cl/session.hpp"
#include "kernels/sight/sight_sweep.h"

namespace gnomon {

/// An eye above the ground: its place in sub-cells, its height in steps; and what it looks at.
struct Eye {
    std::int32_t x = 0, y = 0, height = 0;
    std::int32_t target_height = 0;  ///< steps above the ground
};

/// The first target column of each row of a band, and the one after the last.
using Spans = std::span<const std::int32_t>;

class HeightGrid {
public:
    /// Rows of the grid, the end exclusive. Answers are those of a band alone; the ground is all of the grid.
    struct Band {
        std::int32_t first_row, last_row;
    };

    /// The heights of rows x columns cells, in steps; NO_HEIGHT for none. They must stay where and as they are: a
    /// device that shares the host's memory has no copy. Throws InvalidArgument.
    HeightGrid(const Device& device, std::span<const std::int32_t> heights, std::uint32_t columns);

    /// What the eye sees of each cell: SIGHT_SEEN or SIGHT_HIDDEN, also for cells outside the spans or without height.
    /// `sweeps`: most cells are decided by the sweep (the same answers).
    std::vector<std::uint8_t> look(const Eye& eye, const Band& band, Spans spans, bool sweeps = true);
    /// The least height above the ground, from the targets' on, at which each cell is seen, in steps; NO_HEIGHT for
    /// cells without a height or outside the spans, INT_MAX for those that no height serves.
    std::vector<std::int32_t> least_heights(const Eye& eye, const Band& band, Spans spans);

    /// What several eyes see: per cell the number of eyes that see it, and, if asked for, a word for each 32 eyes, one
    /// plane after the other.
    struct Seen {
        std::vector<std::uint32_t> counts, words;
    };
    /// `spans` has those of one eye after the other. `progress` is called after each eye; if it returns false,
    /// Cancelled is thrown.
    Seen look_from(std::span<const Eye> eyes, const Band& band, Spans spans, bool wants_words,
                   const std::function<bool(double)>& progress = {});

private:
    void share(std::span<const std::int32_t> heights);
    Band checked(const Band& band, Spans spans, std::size_t eyes) const;
    void set_box(SightGrid& grid, Spans spans) const;
    SightGrid grid_of(const Eye& eye, const Band& band, Spans spans);
    void open(const SightGrid& grid, const Band& band);
    void sweep(const SightGrid& grid, const Band& band);
    void decide(const SightGrid& grid, const Band& band, const SightSum& sum, const cl::Buffer& counts,
                const cl::Buffer& words);
    void turn();
    SweepQuadrant quadrant(const SightGrid& grid, bool is_along_y, int direction) const;
    static void set_wedges(SweepQuadrant& of);
    std::size_t cells_of(const Band& band) const {
        return std::size_t(band.last_row - band.first_row) * std::size_t(grid_.columns);
    }

    Device device_;
    SightGrid grid_{};
    struct Release {
        void operator()(cl_mem memory) const;
    };
    std::unique_ptr<std::remove_pointer_t<cl_mem>, Release> heights_;
    bool has_absent_ = false, has_swept_ = false, has_columns_ = false;
    cl::Buffer copy_;        ///< of the heights, on devices with own memory
    cl::Buffer by_columns_;  ///< the heights, one column after the other
    cl::Buffer targets_, patch_tops_, spans_, answers_;
    std::size_t hidden_ = 0;  ///< so many answers are SIGHT_HIDDEN
};

}  // namespace gnomon
