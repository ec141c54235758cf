// SPDX-License-Identifier: MIT
// Triangles, points and visibility buffers: uploads and wraps them, and fills the kernels' descriptions of them.
#include "query/inputs.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <type_traits>

#include "cl/opencl.hpp"
#include "exact/cut_outs.hpp"
#include "query/raster_triangles.hpp"
#include "query/vectors.hpp"

namespace gnomon {
namespace {

constexpr std::size_t largest_index = std::numeric_limits<cl_uint>::max();

template <typename Value>
Value info_of(cl_mem memory, cl_mem_info what, const char* call) {
    Value value{};
    cl::check(clGetMemObjectInfo(memory, what, sizeof(value), &value, nullptr), call);
    return value;
}

void require_context(const Device& device, cl_mem memory, const char* what) {
    if (memory == nullptr) throw InvalidArgument(std::string("the ") + what + " buffer must not be null");
    if (info_of<cl_context>(memory, CL_MEM_CONTEXT, "asking a buffer for its context") != device.context())
        throw InvalidArgument(std::string("the ") + what + " buffer belongs to another OpenCL context than the device");
}

std::shared_ptr<void> retained(const Device& device, cl_mem memory, const char* what) {
    require_context(device, memory, what);
    cl::check(clRetainMemObject(memory), std::string("retaining the ") + what + " buffer");
    return {memory, [](void* m) { clReleaseMemObject(static_cast<cl_mem>(m)); }};
}

// The caller chooses `first`: the sum of both may exceed the range of a size.
template <typename Value = float>
void require_values(cl_mem memory, std::size_t count, const char* what, std::size_t first = 0) {
    const std::size_t held = bytes_of(memory) / sizeof(Value);
    if (first <= held && count <= held - first) return;
    throw InvalidArgument(std::string("the ") + what + " buffer holds " + std::to_string(bytes_of(memory)) +
                          " bytes, fewer than the " + std::to_string(count * sizeof(Value)) + " its layout needs" +
                          (first != 0 ? " after the first " + std::to_string(first) + " values" : ""));
}

/// The values of a caller's buffer from `first` on; none if it is null. Waits for the queue.
template <typename Value>
std::vector<Value> values_of(const Device& device, cl_mem memory, std::size_t count, const char* what,
                             std::size_t first = 0) {
    if (memory == nullptr) return {};
    require_context(device, memory, what);
    require_values<Value>(memory, count, what, first);
    std::vector<Value> values(count);
    session_of(device).read(memory, values.data(), count * sizeof(Value), first * sizeof(Value));
    return values;
}

/// Bytes [first, end) of a buffer that has no parent (a sub-buffer counts as part of its parent).
struct Extent {
    cl_mem root;
    std::size_t first, end;
};
Extent extent_of(cl_mem memory, std::size_t first_float, std::size_t end_float) {
    const auto parent = info_of<cl_mem>(memory, CL_MEM_ASSOCIATED_MEMOBJECT, "asking a buffer for its parent");
    const std::size_t offset =
        parent != nullptr ? info_of<std::size_t>(memory, CL_MEM_OFFSET, "asking a buffer for its offset") : 0;
    return {parent != nullptr ? parent : memory, offset + first_float * sizeof(float),
            offset + end_float * sizeof(float)};
}

/// A sub-buffer of `count` floats of the caller's buffer, which it keeps; `count` is not 0.
std::shared_ptr<void> retained_part(const Device& device, cl_mem memory, std::size_t first_float, std::size_t count) {
    cl_uint align_bits = 0;
    cl::check(clGetDeviceInfo(device.description().device_id, CL_DEVICE_MEM_BASE_ADDR_ALIGN, sizeof(align_bits),
                              &align_bits, nullptr),
              "asking the device for the alignment of sub-buffers");
    const std::size_t align = std::max<std::size_t>(align_bits / 8, sizeof(float));
    if (first_float * sizeof(float) % align != 0)
        throw InvalidArgument("the visibility's first float " + std::to_string(first_float) +
                              " must be a multiple of " + std::to_string(align / sizeof(float)) + " on this device");
    const Extent part = extent_of(memory, first_float, first_float + count);
    const cl_buffer_region region{part.first, part.end - part.first};
    cl_int code;
    cl_mem made = clCreateSubBuffer(part.root, 0, CL_BUFFER_CREATE_TYPE_REGION, &region, &code);
    cl::check(code, "making a sub-buffer of the visibility buffer");
    return {made, [](void* m) { clReleaseMemObject(static_cast<cl_mem>(m)); }};
}

/// The end of the last point's floats; `count` is not 0.
std::size_t end_of(const PointLayout& at, std::size_t count) {
    return at.first + (count - 1) * at.point_stride + 2 * at.coordinate_stride + 1;
}

bool overlap(const Extent& a, const Extent& b) { return a.root == b.root && a.first < b.end && b.first < a.end; }

void require_count(std::size_t count, const char* what) {
    if (count >= largest_index)
        throw InvalidArgument(std::to_string(count) + " " + what + " are too many: ids are 32 bits wide");
}

void require_points(std::span<const float> positions, std::span<const std::uint32_t> receivers) {
    require_groups(positions.size(), 3, "points");
    require_count(positions.size() / 3, "points");
    if (!receivers.empty() && receivers.size() != positions.size() / 3)
        throw InvalidArgument("there are " + std::to_string(receivers.size()) + " receivers for " +
                              std::to_string(positions.size() / 3) + " points: give one each, or none at all");
}

/// A buffer in the host's memory, until it is retained; null if the device has memory of its own, or refuses.
class SharedMemory {
public:
    SharedMemory(const Device& device, const void* data, std::size_t bytes, cl_mem_flags use) {
        if (!device.description().shares_host_memory || bytes == 0) return;
        cl_int code;
        cl_mem made =
            clCreateBuffer(device.context(), CL_MEM_USE_HOST_PTR | use, bytes, const_cast<void*>(data), &code);
        if (code == CL_SUCCESS) memory_.reset(made);
    }
    cl_mem get() const { return memory_.get(); }

private:
    struct Release {
        void operator()(cl_mem memory) const { clReleaseMemObject(memory); }
    };
    std::unique_ptr<std::remove_pointer_t<cl_mem>, Release> memory_;
};

}  // namespace

// ---- Triangles ------------------------------------------------------------------------------------------------------

void require_groups(std::size_t numbers, std::size_t each, const char* what, const char* kind) {
    if (numbers % each == 0) return;
    throw InvalidArgument(std::string(what) + " take " + std::to_string(each) + " " + kind + " each, and " +
                          std::to_string(numbers) + " were given");
}

bool has_cut_outs(const Triangles& triangles) {
    return triangles.cut_out_counts().masked + triangles.cut_out_counts().clear != 0;
}

Triangles Triangles::upload(const Device& device, std::span<const float> vertices) {
    require_groups(vertices.size(), 9, "triangles");
    require_count(vertices.size() / 9, "triangles");
    Triangles triangles;
    triangles.buffer_ = uploaded(device, vertices.data(), vertices.size_bytes());
    triangles.count_ = vertices.size() / 9;
    return triangles;
}

Triangles Triangles::upload(const Device& device, std::span<const float> vertices, const CutOuts& cut_outs) {
    require_groups(vertices.size(), 9, "triangles");
    const PackedCutOuts packed = pack_cut_outs(vertices.size() / 9, cut_outs);
    Triangles triangles;
    if (packed.words.empty()) {
        triangles = upload(device, vertices);
    } else {
        std::vector<cl_uint> words(vertices.size() + packed.words.size());
        std::memcpy(words.data(), vertices.data(), vertices.size_bytes());
        std::copy(packed.words.begin(), packed.words.end(), words.begin() + std::ptrdiff_t(vertices.size()));
        require_count(vertices.size() / 9, "triangles");
        triangles.buffer_ = uploaded(device, words.data(), words.size() * sizeof(cl_uint));
        triangles.count_ = vertices.size() / 9;
    }
    triangles.cut_out_counts_ = packed.counts;
    return triangles;
}

Triangles Triangles::copy(const Device& device, cl_mem vertices, std::size_t count, std::size_t first_float,
                          const CutOutBuffers& cut_outs) {
    require_count(count, "triangles");
    const auto materials = values_of<std::uint32_t>(device, cut_outs.material_of_triangle, count, "material");
    const auto coordinates = values_of<float>(device, cut_outs.texture_coordinates, 6 * count, "texture coordinate");
    const auto alphas = values_of<float>(device, cut_outs.corner_alphas, 3 * count, "corner alpha");
    std::vector<std::vector<std::uint8_t>> texels;
    std::vector<AlphaTexture> textures;
    for (const CutOutBuffers::Texture& texture : cut_outs.textures) {
        const std::size_t size = std::size_t(texture.width) * texture.height;
        texels.push_back(values_of<std::uint8_t>(device, texture.alpha, size, "texture"));
        textures.push_back({texture.width, texture.height, texels.back()});
    }
    require_context(device, vertices, "triangle");
    return upload(device, values_of<float>(device, vertices, 9 * count, "triangle", first_float),
                  {materials, coordinates, alphas, cut_outs.materials, textures});
}

Triangles Triangles::share(const Device& device, std::span<const float> vertices) {
    require_groups(vertices.size(), 9, "triangles");
    const SharedMemory shared(device, vertices.data(), vertices.size_bytes(), CL_MEM_READ_ONLY);
    return shared.get() != nullptr ? wrap(device, shared.get(), vertices.size() / 9) : upload(device, vertices);
}

Triangles Triangles::wrap(const Device& device, cl_mem vertices, std::size_t count, std::size_t first_float) {
    require_count(count, "triangles");
    Triangles triangles;
    triangles.buffer_ = retained(device, vertices, "triangle");
    require_values(vertices, 9 * count, "triangle", first_float);
    triangles.count_ = count;
    triangles.first_float_ = first_float;
    return triangles;
}

cl_mem Triangles::buffer() const {
    return raster_ != nullptr ? raster_->vertices() : static_cast<cl_mem>(buffer_.get());
}

bool Triangles::is_same_as(const Triangles& other) const {
    return buffer_ == other.buffer_ && raster_ == other.raster_ && first_float_ == other.first_float_ &&
           count_ == other.count_ && has_cut_outs(*this) == has_cut_outs(other);
}

// ---- Points ---------------------------------------------------------------------------------------------------------

Points Points::upload(const Device& device, std::span<const float> positions,
                      std::span<const std::uint32_t> receivers) {
    require_points(positions, receivers);
    Points points;
    points.count_ = positions.size() / 3;
    points.positions_ = uploaded(device, positions.data(), positions.size_bytes());
    if (!receivers.empty()) points.receivers_ = uploaded(device, receivers.data(), receivers.size_bytes());
    return points;
}

Points Points::share(const Device& device, std::span<const float> positions, std::span<const std::uint32_t> receivers) {
    require_points(positions, receivers);
    const SharedMemory places(device, positions.data(), positions.size_bytes(), CL_MEM_READ_ONLY);
    const SharedMemory ids(device, receivers.data(), receivers.size_bytes(), CL_MEM_READ_ONLY);
    const bool is_shared = places.get() != nullptr && (ids.get() != nullptr || receivers.empty());
    return is_shared ? wrap(device, places.get(), {}, positions.size() / 3, ids.get())
                     : upload(device, positions, receivers);
}

void Points::set_lifted_off(const Triangles& triangles, const Float3& eye) {
    lifted_off_ = triangles.buffer_;
    lifted_off_first_float_ = triangles.first_float();
    lifted_towards_ = eye;
}

bool Points::is_lifted_off(const Triangles& triangles, const Float3& eye) const {
    const std::shared_ptr<void> buffer = lifted_off_.lock();
    return buffer != nullptr && buffer.get() == triangles.buffer() &&
           lifted_off_first_float_ == triangles.first_float() && lifted_towards_ == eye;
}

Points Points::wrap(const Device& device, cl_mem positions, const PointLayout& layout, std::size_t count,
                    cl_mem receivers) {
    require_count(count, "points");
    if (layout.first > largest_index || layout.point_stride > largest_index || layout.coordinate_stride > largest_index)
        throw InvalidArgument("the point layout's offset and strides must fit 32 bits");
    Points points;
    points.count_ = count;
    points.layout_ = layout;
    points.positions_ = retained(device, positions, "point");
    if (count != 0) require_values(positions, end_of(layout, count), "point");
    if (receivers != nullptr) {
        points.receivers_ = retained(device, receivers, "receiver");
        require_values(receivers, count, "receiver");
    }
    return points;
}

cl_mem Points::positions() const { return static_cast<cl_mem>(positions_.get()); }
cl_mem Points::receivers() const { return static_cast<cl_mem>(receivers_.get()); }

PointsOnHost Points::read(const Device& device) const {
    cl::Session& session = session_of(device);
    PointsOnHost host{std::vector<float>(3 * count_), std::vector<std::uint32_t>(count_, no_receiver)};
    if (count_ == 0) return host;
    const auto floats = session.read_values<float>(positions(), end_of(layout_, count_));
    for (std::size_t i = 0; i < count_; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            host.position[3 * i + c] = floats[layout_.first + i * layout_.point_stride + c * layout_.coordinate_stride];
    if (receivers() != nullptr) host.receiver = session.read_values<cl_uint>(receivers(), count_);
    return host;
}

// ---- Visibility -----------------------------------------------------------------------------------------------------

Visibility::Visibility(const Device& device, std::size_t count)
    : device_(device),
      buffer_(shared_buffer(device, cl::Buffer(session_of(device), count * sizeof(float)))),
      count_(count) {}

Visibility::Visibility(const Device& device, std::shared_ptr<void> buffer, std::size_t count)
    : device_(device), buffer_(std::move(buffer)), count_(count) {}

Visibility Visibility::wrap(const Device& device, cl_mem buffer, std::size_t count, std::size_t first_float) {
    std::shared_ptr<void> kept = retained(device, buffer, "visibility");
    require_values(buffer, count, "visibility", first_float);
    if (first_float != 0 && count != 0) kept = retained_part(device, buffer, first_float, count);
    return Visibility(device, std::move(kept), count);
}

Visibility Visibility::share(const Device& device, std::span<float> values) {
    const SharedMemory shared(device, values.data(), values.size_bytes(), CL_MEM_READ_WRITE);
    Visibility made =
        shared.get() != nullptr ? wrap(device, shared.get(), values.size()) : Visibility(device, values.size());
    made.shared_ = values.data();
    return made;
}

void Visibility::fetch() const {
    if (shared_ == nullptr && count_ != 0)
        throw InvalidArgument("fetch() is for visibility that Visibility::share() made: call read()");
    const void* const host = info_of<void*>(buffer(), CL_MEM_HOST_PTR, "asking a buffer for its place");
    if (host == shared_ && count_ != 0)
        session_of(device_).bring_to_host(buffer(), count_ * sizeof(float));
    else
        session_of(device_).read(buffer(), shared_, count_ * sizeof(float));
}

cl_mem Visibility::buffer() const { return static_cast<cl_mem>(buffer_.get()); }

std::vector<float> Visibility::read() const { return session_of(device_).read_values<float>(buffer(), count_); }

// ---- Facing ---------------------------------------------------------------------------------------------------------

Facing Facing::eye(const Float3& eye) {
    Facing facing(Kind::eye);
    facing.eye_ = eye;
    return facing;
}

Facing Facing::normals(std::span<const float> normals) {
    Facing facing(Kind::normals_on_host);
    facing.host_normals_ = normals;
    return facing;
}

Facing Facing::normals(cl_mem normals, const PointLayout& layout) {
    Facing facing(Kind::normals);
    facing.normals_ = normals;
    facing.normals_layout_ = layout;
    return facing;
}

Facing Facing::fans(const VertexFans& fans, const std::optional<Float3>& up) {
    Facing facing(Kind::fans);
    facing.fans_ = &fans;
    facing.up_ = up;
    return facing;
}

namespace {

void require_fans(const Triangles& triangles, const Points& points, const VertexFans& fans,
                  const std::optional<Float3>& up) {
    if (fans.count() != points.count())
        throw InvalidArgument("the fans are of " + std::to_string(fans.count()) + " points, and the run has " +
                              std::to_string(points.count()));
    const std::size_t triangle_count = Internals::on_device(fans).triangle_count;
    if (triangles.count() != triangle_count)
        throw InvalidArgument("the fans were found among " + std::to_string(triangle_count) + " triangles, not " +
                              std::to_string(triangles.count()));
    if (up && (!is_finite(*up) || *up == Float3{}))
        throw InvalidArgument("the direction `up` must be finite and not zero");
}

Points uploaded_normals(const Device& device, const Points& points, std::span<const float> normals) {
    if (normals.size() / 3 < points.count())
        throw InvalidArgument("there are normals for " + std::to_string(normals.size() / 3) + " of " +
                              std::to_string(points.count()) + " points: give three floats each");
    return Points::upload(device, normals.first(3 * points.count()));
}

}  // namespace

FacingInputs Internals::facing_inputs(const Device& device, const Points& points, const Facing& facing) {
    FacingInputs sides;
    switch (facing.kind_) {
        case Facing::Kind::automatic:
            if (points.camera()) sides.eye = points.camera()->camera.eye;
            break;
        case Facing::Kind::none:
            break;
        case Facing::Kind::eye:
            sides.eye = facing.eye_;
            break;
        case Facing::Kind::normals_on_host:
            sides.uploaded = uploaded_normals(device, points, facing.host_normals_);
            sides.normals = sides.uploaded->positions();
            break;
        case Facing::Kind::normals:
            Points::wrap(device, facing.normals_, facing.normals_layout_, points.count());  // checks the buffer
            sides.normals = facing.normals_;
            sides.normals_layout = facing.normals_layout_;
            break;
        case Facing::Kind::winding:
            sides.front = true;
            break;
        case Facing::Kind::fans:
            sides.fans = facing.fans_;
            sides.up = facing.up_;
            break;
    }
    return sides;
}

FacingInputs facing_inputs(const Device& device, const Triangles& triangles, const Points& points,
                           const Facing& facing) {
    FacingInputs sides = Internals::facing_inputs(device, points, facing);
    if (sides.fans != nullptr) require_fans(triangles, points, *sides.fans, sides.up);
    return sides;
}

Points seen_from_eye(const Device& device, const Points& points, const Facing& facing) {
    if (!Internals::is_by_eye(facing))
        throw InvalidArgument(
            "explain() and diagnose() take points that face by an eye or by nothing: normals, winding and fans decide "
            "after the technique");
    return Internals::seen_from(points, Internals::facing_inputs(device, points, facing).eye);
}

void require_apart(const Points& points, const FacingInputs& sides, const Visibility& visibility) {
    if (sides.normals == nullptr || points.count() == 0) return;
    if (overlap(extent_of(visibility.buffer(), 0, points.count()),
                extent_of(sides.normals, sides.normals_layout.first, end_of(sides.normals_layout, points.count()))))
        throw InvalidArgument(
            "the visibility buffer overlaps the normals, which the run reads after it writes: give visibility memory "
            "of its own");
}

// ---- For the stages -------------------------------------------------------------------------------------------------

std::size_t bytes_of(cl_mem memory) {
    return info_of<std::size_t>(memory, CL_MEM_SIZE, "asking a buffer for its size");
}

std::shared_ptr<void> shared_buffer(const Device& device, cl::Buffer buffer) {
    struct Owned {
        Device device;
        cl::Buffer buffer;
    };
    auto owned = std::make_shared<Owned>(Owned{device, std::move(buffer)});
    return {owned, owned->buffer.get()};
}

std::shared_ptr<void> uploaded(const Device& device, const void* data, std::size_t bytes) {
    cl::Buffer buffer(session_of(device), bytes);
    session_of(device).write(buffer.get(), data, bytes);
    return shared_buffer(device, std::move(buffer));
}

void require_light(const Light& light) {
    const auto& [x, y, z, w] = light.xyzw;
    const bool is_direction = w == 0 && (x != 0 || y != 0 || z != 0);
    if (!is_finite(light.xyzw) || !(is_direction || w == 1))
        throw InvalidArgument(
            "the light must be finite, and either a direction other than 0,0,0 (w = 0) or a position (w = 1)");
}

void require_eye(const Points& points) {
    if (Internals::eye(points) && !is_finite(*Internals::eye(points)))
        throw InvalidArgument("the eye of the points must be finite numbers");
}

void require_apart(const Triangles& triangles, const Points& points, cl_mem written, std::size_t floats,
                   const std::string& name) {
    const std::size_t count = points.count();
    if (count == 0) return;
    const Extent extent = extent_of(written, 0, floats);
    const PointLayout& layout = points.layout();
    const std::size_t first = triangles.first_float();
    const char* what = nullptr;
    if (overlap(extent, extent_of(points.positions(), layout.first, end_of(layout, count)))) what = "positions";
    if (points.receivers() != nullptr && overlap(extent, extent_of(points.receivers(), 0, count))) what = "receivers";
    const bool is_wrapped = Internals::raster(triangles) == nullptr && triangles.count() != 0;
    if (is_wrapped && overlap(extent, extent_of(triangles.buffer(), first, first + 9 * triangles.count())))
        what = "triangles";
    if (what != nullptr)
        throw InvalidArgument("the " + name + " buffer overlaps the " + what +
                              ", which the run reads while it writes: give " + name + " memory of its own");
}

bool overlap(cl_mem a, std::size_t floats_a, cl_mem b, std::size_t floats_b) {
    return overlap(extent_of(a, 0, floats_a), extent_of(b, 0, floats_b));
}

void require_run(const Triangles& triangles, const Points& points, const Light& light, const Visibility& visibility) {
    require_light(light);
    require_eye(points);
    if (visibility.count() < points.count())
        throw InvalidArgument("the visibility buffer holds " + std::to_string(visibility.count()) + " of " +
                              std::to_string(points.count()) + " points");
    require_apart(triangles, points, visibility.buffer(), points.count(), "visibility");
}

void require_run_lights(const Triangles& triangles, const Points& points, std::span<const Light> lights,
                        std::span<const Visibility> visibilities) {
    if (lights.size() != visibilities.size())
        throw InvalidArgument("each light needs a visibility of its own: there are " + std::to_string(lights.size()) +
                              " lights and " + std::to_string(visibilities.size()) + " visibilities");
    for (std::size_t i = 0; i < lights.size(); ++i) {
        require_run(triangles, points, lights[i], visibilities[i]);
        for (std::size_t j = 0; j < i; ++j)
            if (overlap(visibilities[i].buffer(), points.count(), visibilities[j].buffer(), points.count()))
                throw InvalidArgument("lights " + std::to_string(j) + " and " + std::to_string(i) +
                                      " have the same visibility: give each its own");
    }
}

TriangleInputs triangle_inputs(const Triangles& triangles) {
    return {{.first_float = triangles.first_float(), .count = static_cast<cl_uint>(triangles.count()), .padding = 0},
            triangles.buffer(),
            Internals::clusters(triangles),
            has_cut_outs(triangles)};
}

PointInputs point_inputs(const Points& points, bool is_lifted) {
    PointsLayout layout{};
    layout.first = static_cast<cl_uint>(points.layout().first);
    layout.point_stride = static_cast<cl_uint>(points.layout().point_stride);
    layout.coordinate_stride = static_cast<cl_uint>(points.layout().coordinate_stride);
    layout.count = static_cast<cl_uint>(points.count());
    layout.has_receivers = points.receivers() != nullptr;
    const std::optional<Float3>& eye = Internals::eye(points);
    layout.has_eye = eye.has_value();
    layout.is_lifted = is_lifted;
    if (eye) std::copy(eye->begin(), eye->end(), layout.eye);
    if (const auto& picture = points.camera())
        if (picture->width % 4 == 0 && points.count() % (std::size_t(picture->width) * 4) == 0)
            layout.picture_width = picture->width;
    return {layout, points.positions(), points.receivers() != nullptr ? points.receivers() : points.positions()};
}

}  // namespace gnomon
