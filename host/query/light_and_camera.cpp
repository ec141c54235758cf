// SPDX-License-Identifier: MIT
// Lights and cameras: plain values, checked where they are made.
#include <cmath>

#include <gnomon.hpp>
#include "query/vectors.hpp"

namespace gnomon {

Light Light::directional(const Float3& direction) {
    if (!is_finite(direction)) throw InvalidArgument("the light's direction must be finite numbers");
    if (direction == Float3{0, 0, 0}) throw InvalidArgument("the light's direction must not be 0,0,0");
    return {{-direction[0], -direction[1], -direction[2], 0.0f}};
}

Light Light::point(const Float3& position) {
    if (!is_finite(position)) throw InvalidArgument("the light's position must be finite numbers");
    return {{position[0], position[1], position[2], 1.0f}};
}

Camera Camera::look_at(const Float3& eye, const Float3& target, const Float3& up, double fov_y_degrees) {
    if (!is_finite(eye) || !is_finite(target) || !is_finite(up))
        throw InvalidArgument("the camera's eye, target and up must be finite numbers");
    if (!(fov_y_degrees > 0 && fov_y_degrees < 180))
        throw InvalidArgument("the camera's vertical field of view must lie between 0 and 180 degrees");
    Camera camera;
    camera.eye = eye;
    camera.fov_y_radians = fov_y_degrees * (3.14159265358979323846 / 180.0);
    glm::dvec3 forward = loaded(target) - loaded(eye), up_hint = loaded(up);
    if (!make_unit(forward)) throw InvalidArgument("the camera's eye and target coincide");
    if (!make_unit(up_hint)) throw InvalidArgument("the camera's up must not be 0,0,0");
    glm::dvec3 right = cross(forward, up_hint);
    if (std::hypot(right.x, right.y, right.z) < 1e-12 || !make_unit(right))
        throw InvalidArgument("the camera's up is parallel to its view: choose another up");
    glm::dvec3 upwards = cross(right, forward);
    make_unit(upwards);
    camera.right = array_of<double>(right), camera.up = array_of<double>(upwards);
    camera.forward = array_of<double>(forward);
    return camera;
}

}  // namespace gnomon
