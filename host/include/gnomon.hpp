// SPDX-License-Identifier: MIT
// gnomon: exact hard shadows as OpenCL kernels. The whole C++ interface; each header says what of it is stable:
//
//   gnomon/device.hpp   errors and devices          gnomon/lattice.hpp  float64 coordinates without loss
//   gnomon/inputs.hpp   triangles and points        gnomon/samples.hpp  several samples per pixel
//   gnomon/lights.hpp   one light, tables of many   gnomon/shading.hpp  colours: visibility does not need it
//   gnomon/trace.hpp    facing, techniques, runs    gnomon/rivals.hpp   the classic techniques
//   gnomon/view.hpp     views, scenes in parts      gnomon/version.h    the version
//
// In short:
//
//   gnomon::Device device;                                        // or your own cl_context and queue
//   auto triangles = gnomon::Triangles::upload(device, nine_floats_each);
//   auto points    = gnomon::Points::upload(device, three_floats_each);
//   auto technique = gnomon::make_technique("frustum-traced", device);
//   gnomon::Visibility visibility(device, points.count());
//   technique->run(triangles, points, gnomon::Light::directional({0, -1, 0}), visibility);
//   std::vector<float> lit = visibility.read();                   // 1 lit, 0 in shadow
//
// A point is "in shadow" by the visibility contract of docs/numerics.md, which is decided in exact real arithmetic on
// the float32 inputs: the same bits on every device. Objects are cheap handles (shared ownership). One Device and the
// objects made from it may be used from one thread at a time. A failure throws one of the exceptions of
// gnomon/device.hpp. The library never prints, never exits, and has no global state but the OpenCL functions that it
// has loaded (and gnomon.h's error texts, one per thread).
//
// Waits. All work is enqueued on the device's in-order queue. Which functions then wait for the queue, and so for all
// that was enqueued before (tests/query/waits_test.cpp counts the blocking calls and compares them with this table):
//   always   each call waits
//   large    a call waits only where it makes a buffer of 4 MiB or more for a CPU, which is then mapped once
//   never    no call waits (shade_into() and PictureMean::add() wait where they meter, or copy the sky's shares from
//            the host)
// What is not in the table never waits; share() does as wrap() where device and host share memory, else as upload(). A
// kernel that is launched for the first time may wait for its build, and a queue that profiles for each stage.
// Device::kernel_builds() waits after a first launch. `always` is measured with frustum-traced: another technique may
// wait less.
//
// WAITS
//   Device::Device                   always
//   Device::finish                   always
//   Triangles::upload                always
//   Triangles::copy                  always
//   Triangles::wrap                  never
//   Triangles::raster                always
//   Triangles::keep_clusters         always
//   Points::upload                   always
//   Points::wrap                     never
//   Points::read                     always
//   Visibility::Visibility           large
//   Visibility::wrap                 never
//   Visibility::read                 always
//   Visibility::fetch                always
//   lift                             large
//   look                             always
//   CameraPass::look                 always
//   View::read                       always
//   Appearance::upload               always
//   Appearance::surfaces             large
//   Surfaces::Surfaces               always
//   Surfaces::read                   always
//   shade                            always
//   shade_into                       never
//   PictureMean::PictureMean         large
//   PictureMean::add                 never
//   PictureMean::read                always
//   VertexFans::find                 always
//   VertexFans::extended             always
//   make_technique                   never
//   Technique::set                   never
//   Technique::run                   always
//   Technique::run_each_light        always
//   Technique::run_light_table       always
//   Technique::prepare               always
//   Technique::release_prepared_light never
//   Technique::diagnose              always
//   run_light_table_to_host          always
//   run_mean                         always
//   run_samples                      always
//   run_samples_mean                 always
//   SampleViews::SampleViews         always
//   SampleViews::at                  always
//   run_in_parts                     always
//   look_in_parts                    always
//   explain                          always
// END OF WAITS
#pragma once

#include <gnomon/version.h>
#include <gnomon/device.hpp>
#include <gnomon/inputs.hpp>
#include <gnomon/lattice.hpp>
#include <gnomon/lights.hpp>
#include <gnomon/rivals.hpp>
#include <gnomon/samples.hpp>
#include <gnomon/shading.hpp>
#include <gnomon/trace.hpp>
#include <gnomon/view.hpp>
