// SPDX-License-Identifier: MIT
// `gnomon devices` and `gnomon techniques`, as text.
#pragma once

#include <string>

#include "options.hpp"

namespace gnomon::app {

/// Every OpenCL device: the default with the reason, and what each lacks. Throws DeviceNotFound if there is none.
std::string device_list();

/// A line per technique, with its settings under --verbose. Throws Error with the list for an unknown name.
std::string technique_list(const ListTechniques& options);

}  // namespace gnomon::app
