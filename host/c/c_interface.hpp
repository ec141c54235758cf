// SPDX-License-Identifier: MIT
// What the functions of gnomon.h share: the objects behind the handles, and the way from an exception to a status.
#pragma once

#include <algorithm>

#include <gnomon.h>
#include <gnomon.hpp>

struct gnomon_device {
    gnomon::Device device;
    gnomon_device_description description;  ///< its strings belong to `device`
};
struct gnomon_triangles {
    gnomon::Device device;
    gnomon::Triangles triangles;
};
struct gnomon_points {
    gnomon::Device device;
    gnomon::Points points;
};
struct gnomon_vertex_fans {
    gnomon::Device device;
    gnomon::VertexFans fans;
};
struct gnomon_visibility {
    gnomon::Device device;
    gnomon::Visibility visibility;
};
struct gnomon_technique {
    gnomon::Device device;
    std::unique_ptr<gnomon::Technique> technique;
};
struct gnomon_view {
    gnomon::Device device;
    gnomon::View view;
    gnomon_points points;
};
struct gnomon_camera_pass {
    gnomon::Device device;
    gnomon::CameraPass pass;
};

namespace gnomon::c {

/// A sample sink returned something other than 0.
struct Stopped {};

/// Stores the text of the exception that is being handled, and returns its status. Never throws.
gnomon_status status_of_exception() noexcept;

/// Makes a call whose exceptions become a status.
template <typename Call>
gnomon_status guarded(const Call& call) noexcept {
    try {
        call();
        return GNOMON_SUCCESS;
    } catch (...) {
        return status_of_exception();
    }
}

[[noreturn]] void refuse_null(const char* argument);

/// What a pointer among the arguments points to, or the sentence that it must not be null.
template <typename T>
T& at(T* pointer, const char* argument) {
    if (pointer == nullptr) refuse_null(argument);
    return *pointer;
}

/// A result pointer, set to null until the call has succeeded.
template <typename T>
T*& result_at(T** out, const char* argument) {
    return at(out, argument) = nullptr;
}

/// A call whose only result is a pointer. It is set to null first, so that `value` is not made in vain.
template <typename T, typename Value>
gnomon_status result_of(T** out, const char* argument, const Value& value) noexcept {
    return guarded([&] {
        T*& result = result_at(out, argument);
        result = value();
    });
}

/// Makes an object of a device: a handle that has the device, and what `make` makes of it.
template <typename Handle, typename Make>
gnomon_status made(const gnomon_device* device, Handle** out, const char* argument, const Make& make) noexcept {
    return result_of(out, argument, [&] {
        const Device& cpp_device = at(device, "device").device;
        return new Handle{cpp_device, make(cpp_device)};
    });
}

/// Writes a result that the caller may not want.
template <typename T>
void give(T* out, T value) {
    if (out != nullptr) *out = value;
}

/// `each` * `count` values of the caller's array, which may be null if count is 0.
template <typename T>
std::span<const T> array(const T* values, std::size_t count, std::size_t each, const char* argument) {
    if (count == 0) return {};
    if (count > no_receiver)
        throw InvalidArgument(std::string(argument) + " has too many elements: ids are 32 bits wide");
    return {&at(values, argument), count * each};
}

template <typename T, std::size_t size>
std::array<T, size> values_at(const T* values, const char* argument) {
    std::array<T, size> copy;
    std::copy_n(&at(values, argument), size, copy.begin());
    return copy;
}
inline Float3 float3_at(const float* values, const char* argument) { return values_at<float, 3>(values, argument); }

[[noreturn]] void refuse_size(const char* argument, std::size_t given, std::size_t own);

/// A struct that begins with its size.
template <typename T>
const T& sized_at(const T* given, const char* argument) {
    if (at(given, argument).struct_size != sizeof(T)) refuse_size(argument, given->struct_size, sizeof(T));
    return *given;
}
/// The same where NULL stands for the defaults.
template <typename T>
T sized_or(const T* given, const char* argument, const T& defaults) {
    return given == nullptr ? defaults : sized_at(given, argument);
}

RunOptions run_options_at(const gnomon_run_options* options, const Points& points);

std::vector<CutOutMaterial> materials_at(const gnomon_cut_out_material* materials, std::size_t count);

/// The cut-outs of `count` triangles in the caller's arrays; none if `from` is null.
class CutOutsArgument {
public:
    CutOutsArgument(const gnomon_cut_outs* from, std::size_t count);
    CutOutsArgument(const CutOutsArgument&) = delete;
    CutOutsArgument& operator=(const CutOutsArgument&) = delete;
    const CutOuts* get() const { return is_given_ ? &cut_outs_ : nullptr; }

private:
    bool is_given_;
    std::vector<CutOutMaterial> materials_;
    std::vector<AlphaTexture> textures_;
    CutOuts cut_outs_;
};

/// A scene in the caller's arrays.
class HostSceneArgument {
public:
    explicit HostSceneArgument(const gnomon_host_scene* scene)
        : from_(sized_at(scene, "scene")),
          vertices_(array(from_.vertices, from_.count, 9, "scene.vertices")),
          cut_outs_(from_.cut_outs, from_.count) {}
    SceneOnHost get() const { return {vertices_, cut_outs_.get()}; }

private:
    const gnomon_host_scene& from_;
    std::span<const float> vertices_;
    CutOutsArgument cut_outs_;
};

inline Light light_of(const gnomon_light& light) { return {values_at<float, 4>(light.xyzw, "light")}; }
inline PointLayout layout_or_packed(const gnomon_point_layout* layout) {
    if (layout == nullptr) return {};
    return {layout->first, layout->point_stride, layout->coordinate_stride};
}
Camera camera_at(const gnomon_camera* camera);

std::vector<Light> lights_at(const gnomon_light* lights, std::size_t count);

/// An array of pairs, as two.
struct LightVisibilities {
    LightVisibilities(const gnomon_light_visibility* pairs, std::size_t count);
    std::vector<Light> lights;
    std::vector<Visibility> visibilities;
};

gnomon_device_description description_of(const DeviceDescription& description);

const gnomon_statistics* new_statistics(Statistics&& statistics);
struct StatisticsDestroyer {
    void operator()(const gnomon_statistics* statistics) const { gnomon_statistics_destroy(statistics); }
};
using StatisticsPointer = std::unique_ptr<const gnomon_statistics, StatisticsDestroyer>;

/// The results of a call that enqueues work: an event that completes when all commands so far have, and statistics. The
/// caller may want neither. They are null until finish(), which comes last, so that a call which fails gives neither.
class WorkResults {
public:
    explicit WorkResults(cl_event* event_out, const gnomon_statistics** statistics_out = nullptr)
        : event_out_(event_out), statistics_out_(statistics_out) {
        if (event_out != nullptr) *event_out = nullptr;
        if (statistics_out != nullptr) *statistics_out = nullptr;
    }
    void finish(const Device& device, Statistics&& statistics = {});

private:
    cl_event* event_out_;
    const gnomon_statistics** statistics_out_;
};

}  // namespace gnomon::c
