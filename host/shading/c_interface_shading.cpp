// SPDX-License-Identifier: MIT
// The functions of gnomon.h that draw pictures.
#include "c/c_interface.hpp"

using namespace gnomon;
using namespace gnomon::c;

gnomon_status gnomon_view_shade(const gnomon_view* view, const gnomon_triangles* triangles,
                                const gnomon_light_visibility* lights, size_t light_count,
                                const gnomon_materials* materials, uint8_t* rgba_out) {
    return guarded([&] {
        const gnomon_view& c_view = at(view, "view");
        const gnomon_materials& c_materials = sized_at(materials, "materials");
        const auto ids =
            array(c_materials.triangle_material, c_materials.triangle_count, 1, "materials.triangle_material");
        const auto colors = array(c_materials.base_color, c_materials.material_count, 3, "materials.base_color");
        Materials copied{{ids.begin(), ids.end()}, std::vector<Float3>(c_materials.material_count)};
        for (std::size_t i = 0; i < colors.size(); ++i) copied.base_color[i / 3][i % 3] = colors[i];
        const LightVisibilities pairs(lights, light_count);
        const std::vector<std::uint8_t> picture = shade(c_view.device, at(triangles, "triangles").triangles,
                                                        c_view.view, pairs.visibilities, copied, pairs.lights);
        std::copy(picture.begin(), picture.end(), &at(rgba_out, "rgba_out"));
    });
}
