# SPDX-License-Identifier: MIT
# Install and export rules: afterwards find_package(gnomon) gives gnomon::gnomon, static or shared as it was built.
# The libraries alone are exported; host/app installs the command beside them.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/gnomon")
set(libraries gnomon gnomon_full)
if(NOT BUILD_SHARED_LIBS)
  list(APPEND libraries gnomon_lattice gnomon_samples gnomon_shading gnomon_rivals)
endif()
install(TARGETS ${libraries} EXPORT gnomonTargets
        ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
        LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}"
        RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}"
        INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/host/include/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(EXPORT gnomonTargets NAMESPACE gnomon:: DESTINATION "${package_dir}")

configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/gnomonConfig.cmake.in" "${PROJECT_BINARY_DIR}/gnomonConfig.cmake"
                              INSTALL_DESTINATION "${package_dir}" NO_SET_AND_CHECK_MACRO)
# Before 1.0 every minor version may change the interface.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/gnomonConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/gnomonConfig.cmake" "${PROJECT_BINARY_DIR}/gnomonConfigVersion.cmake"
        DESTINATION "${package_dir}")

# For other build systems: pkg-config gnomon. Its folders are relative to where it lies itself: what is installed
# can be moved. OpenCL is named as it was found here, since not every vendor's has a file of its own for pkg-config.
file(RELATIVE_PATH include_from_pc "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig" "${CMAKE_INSTALL_FULL_INCLUDEDIR}")
# A C compiler that links the static library is told the library of C++.
set(cxx_libraries ${CMAKE_CXX_IMPLICIT_LINK_LIBRARIES})
list(FILTER cxx_libraries INCLUDE REGEX "^(stdc\\+\\+|c\\+\\+|m)$")
list(REMOVE_DUPLICATES cxx_libraries)
list(TRANSFORM cxx_libraries PREPEND "-l")
list(JOIN cxx_libraries " " cxx_libraries)
foreach(name IN ITEMS gnomon gnomon_full)
  set(pc_libraries "-l${name}")
  if(name STREQUAL "gnomon_full" AND NOT BUILD_SHARED_LIBS)
    set(pc_libraries "-lgnomon_lattice -lgnomon_samples -lgnomon_shading -lgnomon_rivals -lgnomon")
  endif()
  configure_file("${CMAKE_CURRENT_LIST_DIR}/gnomon.pc.in" "${PROJECT_BINARY_DIR}/${name}.pc" @ONLY)
endforeach()
install(FILES "${PROJECT_BINARY_DIR}/gnomon.pc" "${PROJECT_BINARY_DIR}/gnomon_full.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
