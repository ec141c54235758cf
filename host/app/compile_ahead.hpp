// SPDX-License-Identifier: MIT
// The first start. A driver compiles one kernel (PoCL) or program after the other within a process
// (docs/notebook/experiments.md). So a second process compiles what a picture needs after its camera, while the first
// compiles the camera's kernels; both find all of them in the caches on disk.
#pragma once

#include <sys/types.h>

#include <filesystem>

#include "options.hpp"
#include "scene/scene.hpp"

namespace gnomon::app {

/// The second process, which ends with this object at the latest. What it computes is read by nobody.
class CompileAhead {
public:
    /// Call before OpenCL is used. Starts the process only at the first picture of a scene of this kind (with cut-outs
    /// or without, textured or not) on the options' device, as a file beside the kernels' binaries says, and only on
    /// a machine with two cores or more.
    CompileAhead(const RenderOptions& options, const scene::Scene& scene);
    ~CompileAhead();
    CompileAhead(const CompileAhead&) = delete;
    CompileAhead& operator=(const CompileAhead&) = delete;

    /// Waits until the process has built the program that the camera's kernels are in, or has ended: a program that
    /// two processes need at the same time is built by both.
    void wait_for_program_of_camera();
    /// Says in the file that a picture was made.
    void note_picture() const;

private:
    std::filesystem::path note_;  ///< empty: there is no folder for it
    pid_t process_ = 0;           ///< 0: none
    int built_ = -1;              ///< a pipe, closed by the process when it has built the program
};

}  // namespace gnomon::app
