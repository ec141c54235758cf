// SPDX-License-Identifier: MIT
// Fuzz target: the bytes choose what an embedder hands to the library (triangles, points in any layout, receivers,
// lights, cameras, settings, buffers that are too small or that overlap), sound or not. The
// library must refuse unsound inputs with InvalidArgument, give the oracle's visibility for sound ones, and free all
// device memory.
#include <signal.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <gnomon.hpp>
#include "reference/visibility.hpp"
#include "require.hpp"

namespace {

using fuzz::require;
using gnomon::Float3;
using Floats = std::vector<float>;
using Ids = std::vector<std::uint32_t>;

// ---- Bytes to choices -----------------------------------------------------------------------------------------------

/// The input, read from the front; zeros after its end.
class Choices {
public:
    Choices(const std::uint8_t* data, std::size_t size) : at_(data), end_(data + size) {}

    std::uint32_t byte() { return at_ == end_ ? 0u : *at_++; }
    bool once_in(std::uint32_t count) { return byte() % count == count - 1; }
    std::uint32_t below(std::uint32_t count) { return byte() % count; }
    std::uint32_t word() {
        std::uint32_t bits = 0;
        for (int i = 0; i < 4; ++i) bits = bits << 8 | byte();
        return bits;
    }

    /// Mostly a small lattice, where ties are exact; else a number from the edges of float, a neighbour, or any bits.
    float number() {
        static constexpr float infinity = std::numeric_limits<float>::infinity();
        static constexpr float edges[] = {
            0.0f,           -0.0f,        1e-45f,    -1e-45f, 1.1754942e-38f, 1.17549435e-38f, 3.4028235e38f,
            -3.4028235e38f, infinity,     -infinity, NAN,     1e-20f,         1e20f,           16777216.0f,
            0.1f,           0.333333343f, 1e10f,     -1e10f,  1e-6f,          1.0000001f};
        const std::uint32_t choice = byte();
        if (choice < 200) return last_ = float(int(choice) - 100) / 8;
        if (choice < 220) return last_ = edges[choice - 200];
        if (choice < 240) return last_ = std::bit_cast<float>(std::bit_cast<std::uint32_t>(last_) + choice - 230);
        return last_ = std::bit_cast<float>(word());
    }
    Floats numbers(std::size_t count) {
        Floats all(count);
        for (float& one : all) one = number();
        return all;
    }
    Float3 vector() {
        const float x = number(), y = number();
        return {x, y, number()};
    }

private:
    const std::uint8_t *at_, *end_;
    float last_ = 1;
};

bool is_finite(const Float3& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

/// Runs `action`, which must throw InvalidArgument if `wrong` and nothing otherwise. Returns whether it succeeded.
template <typename Action>
bool succeeds_unless(bool wrong, const char* what, Action&& action) {
    try {
        action();
    } catch (const gnomon::InvalidArgument& error) {
        if (!wrong) std::fprintf(stderr, "%s\n", error.what());
        require(wrong, what);
        return false;
    }
    require(!wrong, what);
    return true;
}

// ---- The caller's buffers -------------------------------------------------------------------------------------------

/// Signals go on to the handlers that were there: the LLVM inside a driver takes them over when it first compiles, and
/// the fuzzer would not see a crash.
class KeptSignalHandlers {
public:
    KeptSignalHandlers() {
        for (std::size_t i = 0; i < before_.size(); ++i) sigaction(int(i), nullptr, &before_[i]);
    }
    ~KeptSignalHandlers() {
        for (std::size_t i = 0; i < before_.size(); ++i) sigaction(int(i), &before_[i], nullptr);
    }
    KeptSignalHandlers(const KeptSignalHandlers&) = delete;
    KeptSignalHandlers& operator=(const KeptSignalHandlers&) = delete;

private:
    std::array<struct sigaction, 32> before_{};
};

const gnomon::Device& device() {
    static const gnomon::Device one = [] {
        const KeptSignalHandlers kept;
        return gnomon::Device();  // its check of the arithmetic compiles a kernel
    }();
    return one;
}

/// A buffer of the embedder's own; kept as long as this lives.
class OwnBuffer {
public:
    template <typename T>
    explicit OwnBuffer(const std::vector<T>& content) {
        const std::size_t bytes = std::max<std::size_t>(content.size() * sizeof(T), 4);
        cl_int code = CL_SUCCESS;
        memory_ = clCreateBuffer(device().context(), CL_MEM_READ_WRITE, bytes, nullptr, &code);
        require(code == CL_SUCCESS, "a buffer of the embedder's own");
        if (!content.empty())
            require(clEnqueueWriteBuffer(device().queue(), memory_, CL_TRUE, 0, content.size() * sizeof(T),
                                         content.data(), 0, nullptr, nullptr) == CL_SUCCESS,
                    "writing to it");
    }
    ~OwnBuffer() { clReleaseMemObject(memory_); }
    OwnBuffer(const OwnBuffer&) = delete;
    OwnBuffer& operator=(const OwnBuffer&) = delete;

    cl_mem get() const { return memory_; }

private:
    cl_mem memory_ = nullptr;
};

// ---- Sound or unsound inputs ----------------------------------------------------------------------------------------

struct Scene {
    Floats vertices;
    std::optional<gnomon::Triangles> triangles;
    std::size_t first_float = 0;
    std::optional<OwnBuffer> own;
};

bool choose_triangles(Choices& choices, Scene& scene) {
    const std::size_t count = choices.below(13);
    if (choices.once_in(4)) {
        const std::size_t first = choices.below(9), room = first + 9 * count;
        const Floats content = choices.numbers(room);
        const bool too_far = choices.once_in(8);
        scene.own.emplace(content);
        scene.first_float = too_far ? std::numeric_limits<std::size_t>::max() - choices.below(99) : first;
        scene.vertices.assign(content.begin() + std::ptrdiff_t(first), content.end());
        return succeeds_unless(too_far, "triangles wrapped", [&] {
            scene.triangles = gnomon::Triangles::wrap(device(), scene.own->get(), count, scene.first_float);
        });
    }
    const std::size_t more = choices.once_in(16) ? 1 + choices.below(8) : 0;
    scene.vertices = choices.numbers(9 * count + more);
    return succeeds_unless(more != 0, "triangles uploaded",
                           [&] { scene.triangles = gnomon::Triangles::upload(device(), scene.vertices); });
}

struct Places {
    Floats positions;  ///< packed
    Ids receivers;     ///< or none
    std::optional<gnomon::Points> points;
    gnomon::PointLayout layout;
    std::optional<OwnBuffer> own_positions, own_receivers;
};

gnomon::PointLayout choose_layout(Choices& choices, std::size_t count) {
    switch (choices.below(4)) {
        case 0:
            return {};
        case 1:
            return {choices.below(9), 1, count};
        case 2:
            return {choices.below(64), choices.below(7), choices.below(7)};
        default:
            return {choices.byte(), choices.byte(), choices.byte()};
    }
}

bool choose_points(Choices& choices, std::size_t triangle_count, Places& places) {
    const std::size_t count = choices.below(50);
    if (choices.once_in(2))
        for (std::size_t i = 0; i < count; ++i)
            places.receivers.push_back(choices.once_in(8) ? choices.word()
                                                          : choices.below(std::uint32_t(triangle_count) + 1));
    if (!choices.once_in(3)) {
        const std::size_t more = choices.once_in(16) ? 1 + choices.below(2) : 0;
        places.positions = choices.numbers(3 * count + more);
        const bool odd = count != 0 && !places.receivers.empty() && choices.once_in(16);
        if (odd) places.receivers.push_back(0);
        return succeeds_unless(more != 0 || odd, "points uploaded", [&] {
            places.points = gnomon::Points::upload(device(), places.positions, places.receivers);
        });
    }
    places.layout = choose_layout(choices, count);
    const auto& [first, point_stride, coordinate_stride] = places.layout;
    const std::size_t needed = count == 0 ? 0 : first + (count - 1) * point_stride + 2 * coordinate_stride + 1;
    const bool too_small = needed > 1 && choices.once_in(8);
    Floats content = choices.numbers(std::min<std::size_t>(needed, 150));  // and the same again, if that is not enough
    for (std::size_t i = 0; content.size() < needed; ++i) content.push_back(content[i]);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            places.positions.push_back(content[first + i * point_stride + c * coordinate_stride]);
    if (too_small) content.pop_back();
    places.own_positions.emplace(content);
    const bool few_receivers = places.receivers.size() > 1 && choices.once_in(8);
    if (!places.receivers.empty())
        places.own_receivers.emplace(few_receivers ? Ids(places.receivers.size() - 1) : places.receivers);
    return succeeds_unless(too_small || few_receivers, "points wrapped", [&] {
        places.points = gnomon::Points::wrap(device(), places.own_positions->get(), places.layout, count,
                                             places.own_receivers ? places.own_receivers->get() : nullptr);
    });
}

gnomon::Light choose_light(Choices& choices) {
    gnomon::Light light{};
    const Float3 v = choices.vector();
    const std::uint32_t kind = choices.below(8);
    light.xyzw = {v[0], v[1], v[2], kind == 7 ? choices.number() : float(kind % 2)};
    if (kind > 5) return light;  // made by hand
    const bool is_zero = v[0] == 0 && v[1] == 0 && v[2] == 0;
    if (kind % 2 == 0)
        succeeds_unless(!is_finite(v) || is_zero, "a directional light",
                        [&] { light = gnomon::Light::directional(v); });
    else
        succeeds_unless(!is_finite(v), "a positional light", [&] { light = gnomon::Light::point(v); });
    return light;
}

bool is_light(const gnomon::Light& light) {
    const auto& [x, y, z, w] = light.xyzw;
    return is_finite({x, y, z}) && (w == 1 || (w == 0 && (x != 0 || y != 0 || z != 0)));
}

void choose_setting(Choices& choices, gnomon::Technique& technique) {
    static const std::string names[] = {"conservative-map", "cover-test", "map-size", "first-capacity", "", "magic"};
    static const std::string values[] = {"on",   "off", "auto", "tight", "circle", "16",  "64",
                                         "200",  "1",   "3",    "0",     "-1",     "15",  "99999999999999999999",
                                         "0x10", "16 ", " 16",  "+16",   "",       "1e2", "ON"};
    const std::string& name = names[choices.below(std::size(names))];
    std::string value = values[choices.below(std::size(values))];
    if (value.empty())
        for (std::uint32_t i = choices.below(6); i > 0; --i) value += char(choices.byte() | 128);  // no large number
    try {
        technique.set(name, value);
    } catch (const gnomon::InvalidArgument&) {
    }
}

// ---- Runs -----------------------------------------------------------------------------------------------------------

/// The visibility buffer, which may be one of the inputs.
struct Output {
    std::optional<gnomon::Visibility> visibility;
    std::optional<OwnBuffer> own;
    bool overlaps = false;
};

void choose_output(Choices& choices, const Scene& scene, const Places& places, Output& output) {
    const std::size_t count = places.points->count();
    const auto wrap = [&](cl_mem memory, bool overlaps) {
        std::size_t bytes = 0;
        clGetMemObjectInfo(memory, CL_MEM_SIZE, sizeof(bytes), &bytes, nullptr);
        const std::size_t room = std::min(count, bytes / sizeof(float));
        output.visibility = gnomon::Visibility::wrap(device(), memory, room);
        output.overlaps = overlaps && count != 0;
    };
    switch (choices.below(16)) {
        case 1:
            output.visibility.emplace(device(), count == 0 ? 0 : count - 1);
            return;
        case 2:
            output.own.emplace(Floats(count + 5, 7.0f));
            return wrap(output.own->get(), false);
        case 3:
            if (places.own_positions) return wrap(places.own_positions->get(), places.layout.first < count);
            return wrap(places.points->positions(), true);
        case 4:
            if (places.points->receivers() != nullptr) return wrap(places.points->receivers(), true);
            break;
        case 5:
            if (scene.triangles->count() == 0) break;
            return wrap(scene.triangles->buffer(), scene.first_float < count);
        default:
            break;
    }
    output.visibility.emplace(device(), count + choices.below(3));
}

void check_answer(const Scene& scene, const Floats& positions, const Ids& receivers, const std::optional<Float3>& eye,
                  const gnomon::Light& light, const Floats& visibility) {
    const auto shadowed = reference::shadowed(scene.vertices, positions, receivers, light.xyzw, eye);
    for (std::size_t i = 0; i < shadowed.size(); ++i)
        require(visibility[i] == (shadowed[i] != 0 ? 0.0f : 1.0f), "the oracle's answer for every point");
}

/// Mostly the first, frustum-traced; else any, with small maps.
std::unique_ptr<gnomon::Technique> choose_technique(Choices& choices, gnomon::TechniqueDescription& chosen) {
    static const std::vector<gnomon::TechniqueDescription> all = gnomon::techniques();
    chosen = all[choices.once_in(4) ? choices.below(std::uint32_t(all.size())) : 0];
    auto technique = gnomon::make_technique(chosen.name, device());
    for (const gnomon::SettingDescription& setting : chosen.settings)
        if (setting.name == "size") technique->set(setting.name, "128");
    return technique;
}

void run_points(Choices& choices, Scene& scene) {
    Places places;
    if (!choose_points(choices, scene.triangles->count(), places)) return;
    std::optional<Float3> eye;
    if (choices.once_in(4)) eye = choices.vector();
    const gnomon::Facing facing = eye ? gnomon::Facing::eye(*eye) : gnomon::Facing::none();
    Output output;
    choose_output(choices, scene, places, output);
    gnomon::TechniqueDescription description;
    const auto technique = choose_technique(choices, description);
    const bool takes_any_points = description.name == "frustum-traced";  // others may want those of a view
    for (std::uint32_t i = choices.below(4); i > 0; --i) choose_setting(choices, *technique);
    for (int run = 0; run < 2; ++run) {  // the second with what the first left in the technique
        const gnomon::Light light = choose_light(choices);
        const bool wrong = !is_light(light) || output.visibility->count() < places.points->count() || output.overlaps ||
                           (eye && !is_finite(*eye));
        try {
            technique->run(*scene.triangles, *places.points, light, *output.visibility, {.facing = facing});
            require(!wrong, "a wrong run is refused");
        } catch (const gnomon::InvalidArgument&) {
            require(wrong || !takes_any_points, "a run");
            continue;
        }
        if (description.exact)
            check_answer(scene, places.positions, places.receivers, eye, light, output.visibility->read());
        if (!output.own) return;  // it may have been an input
    }
}

// ---- Views ----------------------------------------------------------------------------------------------------------

gnomon::Camera choose_camera(Choices& choices, bool& is_sound) {
    gnomon::Camera camera;
    const Float3 eye = choices.vector(), target = choices.vector();
    is_sound = true;
    try {
        camera = gnomon::Camera::look_at(eye, target, {0, 1, 0}, double(choices.number()) * 10);
        return camera;
    } catch (const gnomon::InvalidArgument&) {
    }
    is_sound = false;
    camera.eye = eye;
    for (int i = 0; i < 3; ++i) camera.right[i] = target[i];
    if (choices.once_in(2)) camera.fov_y_radians = choices.number();
    return camera;
}

void check_view(const Scene& scene, const gnomon::ViewOnHost& host) {
    for (std::size_t i = 0; i < host.receiver.size(); ++i) {
        const Float3 p{host.position[3 * i], host.position[3 * i + 1], host.position[3 * i + 2]};
        const Float3 n{host.normal[3 * i], host.normal[3 * i + 1], host.normal[3 * i + 2]};
        const double length = std::sqrt(double(n[0]) * n[0] + double(n[1]) * n[1] + double(n[2]) * n[2]);
        const bool is_sky = host.receiver[i] == gnomon::no_receiver;
        require(is_sky || host.receiver[i] < scene.triangles->count(), "receivers that exist");
        require(is_sky ? p == Float3{} && n == Float3{} : std::fabs(length - 1) < 1e-5, "normals of unit length");
    }
}

void run_view(Choices& choices, Scene& scene) {
    bool is_sound = false;
    const gnomon::Camera camera = choose_camera(choices, is_sound);
    const std::uint32_t width = choices.below(18), height = choices.below(18);
    gnomon::View view;
    try {
        view = look(device(), *scene.triangles, camera, width, height);
    } catch (const gnomon::InvalidArgument&) {
        require(!is_sound || width == 0 || height == 0, "a view");
        return;
    }
    require(width != 0 && height != 0, "a picture without pixels is refused");
    const gnomon::ViewOnHost host = view.read(device(), *scene.triangles);
    check_view(scene, host);
    const gnomon::Light light = choose_light(choices);
    if (!is_light(light)) return;
    gnomon::TechniqueDescription description;
    const auto technique = choose_technique(choices, description);
    const gnomon::Visibility visibility(device(), view.points.count());
    technique->run(*scene.triangles, view.points, light, visibility);
    Floats positions = host.position;
    for (std::size_t i = 0; i < host.receiver.size(); ++i)
        if (host.receiver[i] == gnomon::no_receiver) positions[3 * i] = NAN;
    if (description.exact) check_answer(scene, positions, host.receiver, camera.eye, light, visibility.read());
    gnomon::Materials materials;
    const std::uint32_t colors = choices.below(3), ids_below = 1 + choices.below(3);
    for (std::uint32_t i = 0; i < colors; ++i) materials.base_color.push_back(choices.vector());
    for (std::size_t i = 0; i < scene.triangles->count(); ++i)
        materials.triangle_material.push_back(std::uint32_t(i) % ids_below);
    const bool wrong =
        scene.triangles->count() != 0 && std::min<std::size_t>(ids_below, scene.triangles->count()) > colors;
    succeeds_unless(wrong, "a picture", [&] {
        const auto rgba = shade(device(), *scene.triangles, view, visibility, materials, light);
        require(rgba.size() == std::size_t(4) * width * height, "four bytes for each pixel");
    });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    gnomon::add_rivals();
    Choices choices(data, size);
    const bool with_camera = choices.once_in(3);
    {
        Scene scene;
        if (choose_triangles(choices, scene)) with_camera ? run_view(choices, scene) : run_points(choices, scene);
    }
    require(device().memory_bytes() == 0, "all device memory given back");
    return 0;
}
