// SPDX-License-Identifier: MIT
// Adds the classic techniques, and their kernels, to what the core library knows.
#include "rivals/rivals.hpp"

#include <mutex>

#include "c/c_interface.hpp"
#include "cl/embedded_files.hpp"

namespace gnomon {

void add_rivals() {
    static std::once_flag once;
    std::call_once(once, [] {
        add_embedded_kernels(embedded_kernels_of_rivals());
        std::vector<Registered> all{izb_technique(),
                                    shadow_map_technique(),
                                    virtual_shadow_map_technique(),
                                    shadow_volumes_technique(),
                                    sub_pixel_technique(),
                                    conservative_map_technique()};
        for (Registered& preset : shadow_map_presets()) all.push_back(std::move(preset));
        register_techniques(std::move(all));
    });
}

}  // namespace gnomon

gnomon_status gnomon_rivals_add(void) {
    return gnomon::c::guarded([] { gnomon::add_rivals(); });
}
