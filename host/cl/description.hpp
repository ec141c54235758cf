// SPDX-License-Identifier: MIT
// The description of a device, and the features that gnomon requires but the device lacks.
#pragma once

#include <gnomon.hpp>

namespace gnomon::cl {

DeviceDescription describe(cl_device_id device);

/// The device that a selector names (see Device). Throws DeviceNotFound with the list of all devices.
DeviceDescription select_device(std::string_view selector);

}  // namespace gnomon::cl
