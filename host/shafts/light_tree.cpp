// SPDX-License-Identifier: MIT
#include "shafts/light_tree.hpp"

#include <algorithm>

namespace gnomon {

LightTree::LightTree(cl::Session& session, const BuiltShaftTree& tree) : session_(session), tree_(tree) {
    const std::size_t width = shaft_width(session);
    nodes_.reserve(session, tree.levels().back() * width * LIGHT_NODE_ROWS * sizeof(float));
    leaves_.reserve(session, std::max<std::size_t>(tree.leaf_count(), 1) * width * LIGHT_LEAF_ROWS * sizeof(float));
    // Without triangles the root has no children.
    if (tree.leaf_count() == 0) session.fill(nodes_, 0x7FC00000u, nodes_.bytes());
}

void LightTree::turn_to(const LightAxes& axes) {
    if (tree_.leaf_count() == 0) return;
    LightTreeParams params{.axes = axes, .first = 0, .count = tree_.leaf_count()};
    session_.launch("shafts/light_tree.cl", "light_leaves", shaft_range(session_, params.count), params, tree_.leaves(),
                    leaves_, cl::LocalBytes{sizeof(cl_uint)});
    const std::vector<std::uint32_t>& levels = tree_.levels();
    for (std::size_t level = levels.size() - 1; level-- > 0;) {
        params.first = levels[level];
        params.count = levels[level + 1] - levels[level];
        session_.launch("shafts/light_tree.cl", "light_nodes", shaft_range(session_, params.count), params,
                        tree_.nodes(), leaves_, nodes_);
    }
}

}  // namespace gnomon
