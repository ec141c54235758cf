// SPDX-License-Identifier: MIT
// What a device says of itself, and what it lacks for gnomon.
#pragma once

#include <gnomon.hpp>

namespace gnomon::cl {

DeviceDescription describe(cl_device_id device);

/// The device that a selector names (see Device). Throws DeviceNotFound with the list of what there is.
DeviceDescription select_device(std::string_view selector);

}  // namespace gnomon::cl
