// SPDX-License-Identifier: MIT
#include "area_light.hpp"

namespace gnomon::app {

glm::dvec3 AreaLight::area_vector() const { return cross(loaded(edge_a), loaded(edge_b)); }

Float3 AreaLight::centre() const { return array_of(loaded(corner) + 0.5 * (loaded(edge_a) + loaded(edge_b))); }

void AreaLight::require_area() const {
    const glm::dvec3 area = area_vector();
    if (!(dot(area, area) > 0)) throw Error("the area light has no area: its two edges must not be parallel");
}

}  // namespace gnomon::app
