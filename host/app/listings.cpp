// SPDX-License-Identifier: MIT
// The lists of devices and techniques, laid out for a terminal.
#include "options.hpp"

#include <fmt/core.h>
#include <iomanip>
#include <sstream>

#include "setup.hpp"
#include "terminal.hpp"

namespace gnomon::app {
namespace {

std::string settings_text(const TechniqueDescription& technique) {
    std::ostringstream out;
    if (technique.settings.empty()) out << "    no settings\n";
    for (const SettingDescription& setting : technique.settings)
        out << "    --set " << setting.name << "=" << setting.default_value << '\n'
            << "        " << setting.meaning << '\n';
    for (const DiagnosticDescription& diagnostic : technique.diagnostics)
        out << "    --diagnostic " << diagnostic.name << '\n' << "        " << diagnostic.meaning << '\n';
    return out.str();
}

std::string line_of(const TechniqueDescription& technique) {
    return fmt::format("{:<20}{:<10}{}\n", technique.name, technique.exact ? "exact" : "not exact", technique.summary);
}

}  // namespace

std::string device_text(const DeviceDescription& device) {
    const std::string indent(6, ' ');
    std::ostringstream out;
    out << std::left << std::setw(6) << device.selector << device.name << '\n';
    if (device.is_default) out << indent << "the default: " << device.why_default << '\n';
    if (!device.lacks.empty()) out << indent << "cannot be used, it lacks " << device.lacks << '\n';
    out << indent << device.type << " of " << device.vendor << ", " << device.compute_units << " compute units, "
        << bytes_for_people(device.global_memory_bytes) << " of memory (largest buffer "
        << bytes_for_people(device.largest_allocation_bytes) << "), "
        << (device.has_fp64 ? "double precision" : "no double precision (not needed)")
        << (device.shares_host_memory ? ", memory shared with the host" : "") << '\n';
    out << indent << device.platform << ", driver " << device.driver_version << ", " << device.opencl_version << ", "
        << device.opencl_c_version << '\n';
    return out.str();
}

std::string device_list() {
    std::string text;
    load_opencl();
    for (const DeviceDescription& device : devices()) text += device_text(device);
    if (text.empty()) Device();  // throws: its sentence says why there is none
    return text;
}

std::string technique_list(const ListTechniques& options) {
    std::string text;
    for (const TechniqueDescription& technique :
         options.name.empty() ? techniques() : std::vector{describe_technique(options.name)}) {
        text += line_of(technique);
        if (options.verbose || !options.name.empty()) text += settings_text(technique);
    }
    return text;
}

}  // namespace gnomon::app
