# SPDX-License-Identifier: MIT
# find_package(OpenImageIO), made to work with Debian's package. Its targets name the folder /usr/include/opencv4, which
# its dependencies do not install, and CMake refuses a target with a folder that is not there. Nobody here includes the
# one header that would need it. It also reports, each time anew, that Imath's Python library is missing.
set(log_level_before "${CMAKE_MESSAGE_LOG_LEVEL}")
set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
find_package(OpenImageIO CONFIG QUIET)
set(CMAKE_MESSAGE_LOG_LEVEL "${log_level_before}")

if(OpenImageIO_FOUND)
  foreach(target OpenImageIO::OpenImageIO OpenImageIO::OpenImageIO_Util)
    get_target_property(folders ${target} INTERFACE_INCLUDE_DIRECTORIES)
    set(existing_folders "")
    foreach(folder IN LISTS folders)
      if(EXISTS "${folder}")
        list(APPEND existing_folders "${folder}")
      endif()
    endforeach()
    set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${existing_folders}")
  endforeach()
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenImageIO REQUIRED_VARS OpenImageIO_DIR VERSION_VAR OpenImageIO_VERSION
  REASON_FAILURE_MESSAGE "install libopenimageio-dev and openimageio-tools, or build without the command: -D GNOMON_COMMAND=OFF")
