// SPDX-License-Identifier: MIT
// Stage light_tree: a shafts' tree with its boxes along the axes of one light after the other
// (kernels/shafts/light_tree.h).
#pragma once

#include "kernels/shafts/light_tree.h"
#include "shafts/shaft_tree.hpp"

namespace gnomon {

class LightTree {
public:
    /// Keeps references to both. Takes 28 bytes for each child of a node and 40 for each slot of a leaf.
    LightTree(cl::Session& session, const BuiltShaftTree& tree);

    void turn_to(const LightAxes& axes);
    const cl::Buffer& nodes() const { return nodes_; }
    const cl::Buffer& leaves() const { return leaves_; }

private:
    cl::Session& session_;
    const BuiltShaftTree& tree_;
    cl::Buffer nodes_, leaves_;
};

}  // namespace gnomon
