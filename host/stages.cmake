# SPDX-License-Identifier: MIT
# Every stage of gnomon, by wing, in the order in which data flows: a wing includes itself and the wings above it.
# A name stands for all files that carry it:
#   kernels/<wing>/<name>.h .clh .cl    host/<wing>/<name>.cpp    tests/<wing>/<name>_test.cpp
# A new stage is one name here. A file that no name stands for is an error, and so is a name without a file.
set(GNOMON_KERNELS kernels/prelude.h)
set(GNOMON_SOURCES)
set(GNOMON_TEST_SOURCES)

macro(gnomon_wing wing)
  set(wing_files)
  foreach(name IN ITEMS ${ARGN})
    set(name_files)
    foreach(file IN ITEMS kernels/${wing}/${name}.h kernels/${wing}/${name}.clh kernels/${wing}/${name}.cl
                          host/${wing}/${name}.cpp tests/${wing}/${name}_test.cpp)
      if(EXISTS "${PROJECT_SOURCE_DIR}/${file}")
        list(APPEND name_files ${file})
      endif()
    endforeach()
    if(NOT name_files AND EXISTS "${PROJECT_SOURCE_DIR}/tests")  # a source distribution has no tests
      message(FATAL_ERROR "host/stages.cmake names ${wing}/${name}, and no file has that name")
    endif()
    list(APPEND wing_files ${name_files})
  endforeach()
  file(GLOB wing_found CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}" "${PROJECT_SOURCE_DIR}/kernels/${wing}/*.*"
       "${PROJECT_SOURCE_DIR}/host/${wing}/*.cpp" "${PROJECT_SOURCE_DIR}/tests/${wing}/*_test.cpp")
  list(REMOVE_ITEM wing_found ${wing_files})
  if(wing_found)
    message(FATAL_ERROR "host/stages.cmake has no name for ${wing_found}")
  endif()
  foreach(file IN LISTS wing_files)
    if(file MATCHES "^kernels/")
      list(APPEND GNOMON_KERNELS ${file})
    elseif(file MATCHES "^host/")
      list(APPEND GNOMON_SOURCES ${file})
    else()
      list(APPEND GNOMON_TEST_SOURCES ${file})
    endif()
  endforeach()
endmacro()

# The ground: OpenCL, and what implements gnomon.hpp.
gnomon_wing(cl description embedded_files environment forks opencl program session)
gnomon_wing(simd frame_counters lanes points point_blocks projection triangle_blocks)
gnomon_wing(exact wide soft_double accumulator det3 det3_lanes blocks cut_outs cut_outs_exact decide_pair normal_side predicates small_cases self_check)
gnomon_wing(lists append fill group_scan scan shares sort morton whole_to_float)
gnomon_wing(query device errors inputs raster_triangles light_and_camera parts settings_table statistics variants
            library faults regressions leaves waits)

# Lists: one light at a time, by rasterizing.
gnomon_wing(receivers frame_grid light_frame footprint block_bounds facing facing_cache facing_blocks
            facing_cpu facing_gpu facing_picture backfacing vertex_fans
            receiver_depth_pyramid light_frames)
gnomon_wing(occluders bin_lists bin_overlap hull_bounds clusters cluster_boxes conservative_map triangle_setup
            triangle_bounds triangle_records eye_records tile_bins triangle_tiles bins occluder_lists)
gnomon_wing(camera camera camera_rays pixel_rays nearest nearest_gpu camera_filter long_lists shading_point shading_lanes
            small_views)
gnomon_wing(trace light_order trace map_query filter trace_points walk_cpu walk_gpu trace_kernel exact_trace provenance
            map_choice frustum_tracer explain)
gnomon_wing(prepared prepared_light unshadowed_triangles prepared_facing prepared_trace prepared_runs)

# The BVH: tables of many lights.
gnomon_wing(lights lights light_bundle light_bundles position_bundles light_sides light_sums point_order many_lights
            lights_method)
gnomon_wing(horizons height_field strip_triangle strip_walk horizons raster sweep_rays sweeps)
gnomon_wing(bvh binary_tree bvh_rows tree_costs wide_bvh raster_bvh)
gnomon_wing(beams beam beam_lanes bvh_leaf beam_sides point_light_planes beam_intersect beam_walk point_beam)
gnomon_wing(packets parallel_packets converging_packets ray_packets)
gnomon_wing(light_tables light_masks beam_trace point_beam_trace method_costs light_tables implicit_rasters)

# The technique that chooses between both, by its name and through the C interface.
gnomon_wing(technique technique frustum_traced small_cells)
gnomon_wing(c c_interface c_interface_lights c_interface_results c_interface_runs
            nothing_grows)

# Libraries of their own (host/CMakeLists.txt), which the core does not know.
gnomon_wing(lattice world_lattice world_lattice_mesh c_interface_lattice)
gnomon_wing(samples samples fragments pixel_masks_gpu samples_masks_gpu open_samples samples_filter footprints coverage_masks
            sample_points find_receivers_gpu clearance classify_footprints c_interface_samples)
gnomon_wing(shading texture mip_levels appearance surface metering shade picture_mean received_light c_interface_shading)
gnomon_wing(sight sight_lines sight_crossings sight_sweep height_grid)
gnomon_wing(rivals rivals framed_technique conservative_map_alone shadow_volumes sub_pixel_shadow_map izb)
gnomon_wing(rivals/rasterizer map_view depth_pass caster drawing tile_bounds window_depths caster_lanes caster_windows caster_chunks)
gnomon_wing(rivals/shadow_map map_projection homography partition texel_footprint depth_pass lookup depth_lookup moments mip_chain moment_lookup
            visibility_bounds prefilter point_light_perspective rectilinear_warp virtual_map shadow_map soft_shadow diagnostic)
