# SPDX-License-Identifier: MIT
# The core library, static or shared as the triplet says: it needs OpenCL's headers alone (third_party has them), and
# loads the OpenCL library when a program first needs it.
vcpkg_from_git(
    OUT_SOURCE_PATH SOURCE_PATH
    URL "@HOME@"
    REF "@COMMIT@"
)
vcpkg_cmake_configure(
    SOURCE_PATH "${SOURCE_PATH}"
    OPTIONS
        -DGNOMON_COMMAND=OFF
        -DGNOMON_TESTS=OFF
        -DGNOMON_TOOLS=OFF
        -DGNOMON_INSTALL=ON
)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/gnomon)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
file(INSTALL "${CMAKE_CURRENT_LIST_DIR}/usage" DESTINATION "${CURRENT_PACKAGES_DIR}/share/${PORT}")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
