// SPDX-License-Identifier: MIT
#include "map_views.hpp"

namespace gnomon {

void fill_centres(cl::Session& session, const MapViews& map_views) {
    session.launch("shadow_map/map_view.cl", "map_view_centres", cl::Range::items(4096), map_views.set, map_views.views,
                   map_views.tables);
}

}  // namespace gnomon
