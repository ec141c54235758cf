// SPDX-License-Identifier: MIT
// gnomon._gnomon: gnomon.hpp for Python, one to one. It checks no shapes: the package's Python files do, and their
// docstrings are the documentation. Every call that works on the device releases the GIL.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <gnomon.hpp>

#include "cl/opencl.hpp"
#include "energy_sums.hpp"
#include "facing_suns.hpp"
#include "height_steps.hpp"
#include "lights/whole_weights.hpp"
#include "lit_fractions.hpp"
#include "scene/no_data.hpp"
#include "scene/number_table.hpp"
#include "sight/height_grid.hpp"

#ifdef GNOMON_PYTHON_GLTF
#include "scene/scene.hpp"
#endif

namespace nb = nanobind;
using namespace nb::literals;

namespace {

using Released = nb::call_guard<nb::gil_scoped_release>;
using Floats = nb::ndarray<const float, nb::c_contig, nb::device::cpu>;
using Doubles = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Bytes = nb::ndarray<const std::uint8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Integers = nb::ndarray<const std::int32_t, nb::c_contig, nb::device::cpu>;
using Ids = nb::ndarray<const std::uint32_t, nb::c_contig, nb::device::cpu>;

template <typename Value>
using Numpy = nb::ndarray<nb::numpy, Value>;

// An array that a function writes.
template <typename Value>
using Written = nb::ndarray<Value, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

template <typename Array>
auto span_of(const Array& array) {
    return std::span(array.data(), array.size());
}

// A numpy array that owns these values.
template <typename Value>
Numpy<Value> numpy_of(std::vector<Value> values, std::vector<std::size_t> shape) {
    auto* const owned = new std::vector<Value>(std::move(values));
    const nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<Value>*>(p); });
    return Numpy<Value>(owned->data(), shape.size(), shape.data(), owner);
}

template <typename Value>
Numpy<Value> row_of(std::vector<Value> values) {
    const std::size_t count = values.size();
    return numpy_of(std::move(values), {count});
}

// The result of a call for which the GIL is free. A call guard does the same where the result is no Python object.
template <typename Call>
auto released(const Call& call) {
    const nb::gil_scoped_release free;
    return call();
}

// OpenCL's handles travel as the integers that pyopencl's int_ptr gives.
template <typename Handle>
Handle handle_of(std::uintptr_t integer) {
    return reinterpret_cast<Handle>(integer);
}

// Cut-outs that own their arrays.
struct OwnedCutOuts {
    struct Texture {
        std::uint32_t width, height;
        std::vector<std::uint8_t> alpha;
    };
    std::vector<std::uint32_t> material_of_triangle;
    std::vector<float> texture_coordinates, corner_alphas;
    std::vector<gnomon::CutOutMaterial> materials;
    std::vector<Texture> textures;
};

gnomon::Triangles upload_with_cut_outs(const gnomon::Device& device, const Floats& vertices, const OwnedCutOuts& of) {
    std::vector<gnomon::AlphaTexture> textures;
    for (const auto& [width, height, alpha] : of.textures) textures.push_back({width, height, alpha});
    return gnomon::Triangles::upload(
        device, span_of(vertices),
        {of.material_of_triangle, of.texture_coordinates, of.corner_alphas, of.materials, textures});
}

template <typename Array>
auto vector_of(const Array& array) {
    const auto values = span_of(array);
    return std::vector(values.begin(), values.end());
}

gnomon::Light light_of(const std::array<float, 4>& xyzw) { return gnomon::Light{xyzw}; }

// What Python sees of a device's description, and what travels when it is pickled.
auto fields_of(auto& d) {
    return std::tie(d.selector, d.name, d.platform, d.vendor, d.driver_version, d.opencl_version, d.type,
                    d.compute_units, d.global_memory_bytes, d.has_fp64, d.lacks, d.note, d.is_default);
}
using DeviceFields = decltype(std::apply([](const auto&... field) { return std::tuple(field...); },
                                         fields_of(std::declval<gnomon::DeviceDescription&>())));

void bind_devices(nb::module_& m) {
    using gnomon::DeviceDescription;
    m.def("require_unforked", &gnomon::cl::require_unforked);
    m.def("load_opencl", &gnomon::load_opencl, "library"_a = "");
    m.def("devices", &gnomon::devices, Released());
    nb::class_<DeviceDescription>(m, "DeviceDescription",
                                  "One OpenCL device of this machine: its names, its memory, what it lacks.")
        .def_ro("selector", &DeviceDescription::selector)
        .def_ro("name", &DeviceDescription::name)
        .def_ro("platform", &DeviceDescription::platform)
        .def_ro("vendor", &DeviceDescription::vendor)
        .def_ro("driver_version", &DeviceDescription::driver_version)
        .def_ro("opencl_version", &DeviceDescription::opencl_version)
        .def_ro("type", &DeviceDescription::type)
        .def_ro("compute_units", &DeviceDescription::compute_units)
        .def_ro("memory_bytes", &DeviceDescription::global_memory_bytes)
        .def_ro("has_fp64", &DeviceDescription::has_fp64)
        .def_ro("lacks", &DeviceDescription::lacks)
        .def_ro("note", &DeviceDescription::note)
        .def_ro("is_default", &DeviceDescription::is_default)
        .def("__getstate__", [](const DeviceDescription& d) { return DeviceFields(fields_of(d)); })
        .def("__setstate__",
             [](DeviceDescription& d, const DeviceFields& fields) {
                 new (&d) DeviceDescription();
                 fields_of(d) = fields;
             })
        .def("__repr__", [](const DeviceDescription& d) {
            return "<gnomon.DeviceDescription " + d.selector + " '" + d.name + "' (" + d.type + ", " + d.platform +
                   (d.lacks.empty() ? "" : ", lacks " + d.lacks) + (d.is_default ? ", the default)>" : ")>");
        });
    nb::class_<gnomon::Device>(m, "Device")
        .def(
            "__init__",
            [](gnomon::Device* self, const std::string& selector, std::uint64_t memory_limit_bytes) {
                new (self) gnomon::Device(selector, {.memory_limit_bytes = memory_limit_bytes});
            },
            "selector"_a, "memory_limit_bytes"_a, Released())
        .def_static(
            "of_queue",
            [](std::uintptr_t context, std::uintptr_t queue) {
                return gnomon::Device(handle_of<cl_context>(context), handle_of<cl_command_queue>(queue));
            },
            Released())
        .def_prop_ro("description", &gnomon::Device::description)
        .def_prop_ro("memory_bytes", &gnomon::Device::memory_bytes);
}

gnomon::CutOutMaterial material_of(const nb::handle state) {
    const auto [texture, wrap_u, wrap_v, filter, cutoff, factor] =
        nb::cast<std::tuple<std::uint32_t, int, int, int, float, float>>(state);
    return {texture, gnomon::TextureWrap(wrap_u), gnomon::TextureWrap(wrap_v), gnomon::TextureFilter(filter), cutoff,
            factor};
}

void bind_cut_outs(nb::module_& m) {
    nb::class_<gnomon::CutOutCounts>(m, "CutOutCounts")
        .def_ro("masked", &gnomon::CutOutCounts::masked)
        .def_ro("opaque", &gnomon::CutOutCounts::opaque)
        .def_ro("clear", &gnomon::CutOutCounts::clear)
        .def_ro("unusable", &gnomon::CutOutCounts::unusable);
    nb::class_<OwnedCutOuts>(m, "CutOuts")
        .def("__init__",
             [](OwnedCutOuts* self, const Ids& material_of_triangle, const Floats& coordinates, const Floats& alphas) {
                 new (self)
                     OwnedCutOuts{vector_of(material_of_triangle), vector_of(coordinates), vector_of(alphas), {}, {}};
             })
        .def("add_material",
             [](OwnedCutOuts& to, std::uint32_t texture, int wrap_u, int wrap_v, int filter, float cutoff,
                float factor) {
                 to.materials.push_back({texture, gnomon::TextureWrap(wrap_u), gnomon::TextureWrap(wrap_v),
                                         gnomon::TextureFilter(filter), cutoff, factor});
             })
        .def(
            "add_texture",
            [](OwnedCutOuts& to, const Bytes& alpha) {
                to.textures.push_back({std::uint32_t(alpha.shape(1)), std::uint32_t(alpha.shape(0)), vector_of(alpha)});
            })
        .def("__getstate__",
             [](const OwnedCutOuts& from) {
                 nb::list materials, textures;
                 for (const gnomon::CutOutMaterial& m : from.materials)
                     materials.append(nb::make_tuple(m.texture, int(m.wrap_u), int(m.wrap_v), int(m.filter), m.cutoff,
                                                     m.alpha_factor));
                 for (const auto& [width, height, alpha] : from.textures)
                     textures.append(numpy_of(vector_of(alpha), {height, width}));
                 return nb::make_tuple(row_of(from.material_of_triangle), row_of(from.texture_coordinates),
                                       row_of(from.corner_alphas), materials, textures);
             })
        .def("__setstate__", [](OwnedCutOuts& self, const std::tuple<Ids, Floats, Floats, nb::list, nb::list>& state) {
            const auto& [material_of_triangle, coordinates, alphas, materials, textures] = state;
            OwnedCutOuts made{vector_of(material_of_triangle), vector_of(coordinates), vector_of(alphas), {}, {}};
            for (const nb::handle material : materials) made.materials.push_back(material_of(material));
            for (const nb::handle texture : textures) {
                const auto alpha = nb::cast<Bytes>(texture);
                made.textures.push_back(
                    {std::uint32_t(alpha.shape(1)), std::uint32_t(alpha.shape(0)), vector_of(alpha)});
            }
            new (&self) OwnedCutOuts(std::move(made));
        });
}

void bind_inputs(nb::module_& m) {
    using gnomon::Points;
    using gnomon::Triangles;
    nb::class_<Triangles>(m, "Triangles")
        .def_static(
            "upload",
            [](const gnomon::Device& device, const Floats& v) { return Triangles::upload(device, span_of(v)); },
            Released())
        .def_static("upload", &upload_with_cut_outs, Released())
        .def_prop_ro("cut_out_counts", &Triangles::cut_out_counts)
        .def_static(
            "wrap",
            [](const gnomon::Device& device, std::uintptr_t memory, std::size_t count, std::size_t first_float) {
                return Triangles::wrap(device, handle_of<cl_mem>(memory), count, first_float);
            },
            Released())
        .def_static(
            "raster",
            [](const gnomon::Device& device, const Floats& x, const Floats& y, const Floats& heights,
               bool joins_first_corner) {
                return Triangles::raster(device, {span_of(x), span_of(y), span_of(heights), joins_first_corner});
            },
            Released())
        .def("keep_clusters", &Triangles::keep_clusters, Released())
        .def("__len__", &Triangles::count)
        .def_prop_ro("buffer", [](const Triangles& t) { return reinterpret_cast<std::uintptr_t>(t.buffer()); });
    m.attr("TRIANGLES_WORTH_CLUSTERS") = gnomon::triangles_worth_clusters;
    nb::class_<gnomon::PointLayout>(m, "PointLayout")
        .def(nb::init<std::size_t, std::size_t, std::size_t>(), "first"_a, "point_stride"_a, "coordinate_stride"_a);
    nb::class_<Points>(m, "Points")
        .def_static(
            "upload",
            [](const gnomon::Device& device, const Floats& positions, const Ids& receivers) {
                return Points::upload(device, span_of(positions), span_of(receivers));
            },
            Released())
        .def_static(
            "wrap",
            [](const gnomon::Device& device, std::uintptr_t positions, const gnomon::PointLayout& layout,
               std::size_t count, std::uintptr_t receivers) {
                return Points::wrap(device, handle_of<cl_mem>(positions), layout, count, handle_of<cl_mem>(receivers));
            },
            Released());
    nb::class_<gnomon::Visibility>(m, "Visibility")
        .def(nb::init<const gnomon::Device&, std::size_t>(), Released())
        .def_static(
            "wrap",
            [](const gnomon::Device& device, std::uintptr_t buffer, std::size_t count, std::size_t first_float) {
                return gnomon::Visibility::wrap(device, handle_of<cl_mem>(buffer), count, first_float);
            },
            Released())
        .def("read", [](const gnomon::Visibility& v) { return row_of(released([&] { return v.read(); })); });
}

void bind_techniques(nb::module_& m) {
    using gnomon::Technique;
    nb::class_<gnomon::SettingDescription>(
        m, "SettingDescription", "A setting of a technique: its name, its default, one line with range and unit.")
        .def_ro("name", &gnomon::SettingDescription::name)
        .def_ro("default", &gnomon::SettingDescription::default_value)
        .def_ro("meaning", &gnomon::SettingDescription::meaning)
        .def("__repr__",
             [](const gnomon::SettingDescription& s) {
                 return "<gnomon.SettingDescription " + s.name + "=" + s.default_value + ": " + s.meaning + ">";
             })
        .def("__getstate__",
             [](const gnomon::SettingDescription& s) { return std::tuple(s.name, s.default_value, s.meaning); })
        .def("__setstate__",
             [](gnomon::SettingDescription& s, std::tuple<std::string, std::string, std::string> state) {
                 auto& [name, default_value, meaning] = state;
                 new (&s) gnomon::SettingDescription{std::move(name), std::move(default_value), std::move(meaning)};
             });
    using gnomon::TechniqueDescription;
    using TechniqueState = std::tuple<std::string, std::string, bool, std::vector<gnomon::SettingDescription>>;
    nb::class_<TechniqueDescription>(m, "TechniqueDescription",
                                     "A technique: its name, a line about it, whether it is exact, its settings.")
        .def_ro("name", &gnomon::TechniqueDescription::name)
        .def_ro("summary", &gnomon::TechniqueDescription::summary)
        .def_ro("exact", &gnomon::TechniqueDescription::exact)
        .def_ro("settings", &gnomon::TechniqueDescription::settings)
        .def("__repr__",
             [](const gnomon::TechniqueDescription& t) {
                 return "<gnomon.TechniqueDescription '" + t.name + "': " + t.summary + ">";
             })
        .def("__getstate__",
             [](const TechniqueDescription& t) { return std::tuple(t.name, t.summary, t.exact, t.settings); })
        .def("__setstate__", [](TechniqueDescription& t, TechniqueState state) {
            auto& [name, summary, exact, settings] = state;
            new (&t) TechniqueDescription{std::move(name), std::move(summary), exact, std::move(settings)};
        });
    m.def("techniques", &gnomon::techniques);
    nb::class_<Technique>(m, "Technique")
        .def("set", &Technique::set)
        .def(
            "run",
            [](Technique& technique, const gnomon::Triangles& triangles, const gnomon::Points& points,
               const std::array<float, 4>& light, const gnomon::Visibility& visibility, const gnomon::Facing& facing) {
                technique.run(triangles, points, light_of(light), visibility, {.facing = facing});
            },
            Released())
        .def(
            "prepare",
            [](Technique& technique, const gnomon::Triangles& triangles, const std::array<float, 4>& light) {
                technique.prepare(triangles, light_of(light));
            },
            Released());
    m.def("make_technique", &gnomon::make_technique, "name"_a, "device"_a, Released());
}

// A facing refers to the arrays and fans that it is made of, and keeps them alive. An array is taken as it is, since a
// copy would be gone when the run reads it.
void bind_facing(nb::module_& m) {
    using gnomon::Facing;
    using gnomon::VertexFans;
    nb::class_<VertexFans>(m, "VertexFans")
        .def_static(
            "find",
            [](const gnomon::Device& device, const Floats& vertices, const Floats& points) {
                return VertexFans::find(device, span_of(vertices), span_of(points));
            },
            Released())
        .def("alone", [](const VertexFans& fans) { return row_of(fans.alone()); })
        .def("open", [](const VertexFans& fans) { return row_of(fans.open()); })
        .def("extended", &VertexFans::extended, Released());
    nb::class_<Facing>(m, "Facing")
        .def_static("automatic", &Facing::automatic)
        .def_static("none", &Facing::none)
        .def_static("eye", &Facing::eye, "eye"_a)
        .def_static(
            "normals", [](const Floats& normals) { return Facing::normals(span_of(normals)); }, "normals"_a.noconvert(),
            nb::keep_alive<0, 1>())
        .def_static(
            "normals_in_buffer",
            [](std::uintptr_t normals, const gnomon::PointLayout& layout) {
                return Facing::normals(handle_of<cl_mem>(normals), layout);
            },
            "normals"_a, "layout"_a)
        .def_static("winding", &Facing::winding)
        .def_static(
            "fans",
            [](const VertexFans& fans, const std::optional<gnomon::Float3>& up) { return Facing::fans(fans, up); },
            "fans"_a, "up"_a.none(), nb::keep_alive<0, 1>());
}

// Calls a Python function with the part that is done; an exception in it, such as Ctrl-C's, ends the run. The calling
// thread does not hold the GIL.
std::function<bool(double)> progress_of(const std::optional<nb::callable>& progress) {
    if (!progress) return {};
    return [&function = *progress](double done) {
        const nb::gil_scoped_acquire held;
        const nb::object goes_on = function(done);
        return goes_on.is_none() || nb::cast<bool>(goes_on);
    };
}

void bind_many_lights(nb::module_& m) {
    using gnomon::Lights;
    nb::class_<Lights>(m, "Lights")
        .def(
            "__init__",
            [](Lights* self, const Floats& xyzw, const Floats& weights) {
                std::vector<gnomon::Light> lights(xyzw.size() / 4);
                for (std::size_t i = 0; i < lights.size(); ++i)
                    std::copy_n(xyzw.data() + 4 * i, 4, lights[i].xyzw.begin());
                new (self) Lights(std::move(lights), {weights.data(), weights.data() + weights.size()});
            },
            "xyzw"_a, "weights"_a)
        .def("__len__", &Lights::count)
        .def_prop_ro("exponent", &Lights::exponent)
        .def_prop_ro("largest_rounding", &Lights::largest_rounding);
    m.def(
        "run_light_table",
        [](gnomon::Technique& technique, const gnomon::Triangles& triangles, const gnomon::Points& points,
           const Lights& lights, const gnomon::Facing& facing, bool cosines, bool wants_bits,
           const std::optional<nb::callable>& progress) {
            const gnomon::LightsWanted wanted{wants_bits, true, true, true, true, cosines};
            const gnomon::RunOptions options{.facing = facing, .progress = progress_of(progress)};
            gnomon::LightsOnHost answers = released(
                [&] { return gnomon::run_light_table_to_host(technique, triangles, points, lights, wanted, options); });
            const std::size_t count = answers.counts.size(), words = (lights.count() + 31) / 32;
            return nb::make_tuple(row_of(std::move(answers.sums)), row_of(std::move(answers.counts)),
                                  row_of(std::move(answers.first_lit)), row_of(std::move(answers.last_lit)),
                                  numpy_of(std::move(answers.bits), {wants_bits ? count : 0, words}));
        },
        "technique"_a, "triangles"_a, "points"_a, "lights"_a, "facing"_a, "cosines"_a, "wants_bits"_a,
        "progress"_a.none());
}

// Positions or directions as an array (N, 3).
Numpy<float> triples_of(std::vector<float> coordinates) {
    const std::size_t count = coordinates.size() / 3;
    return numpy_of(std::move(coordinates), {count, 3});
}

Numpy<float> directions_towards(const gnomon::Lights& lights) {
    std::vector<float> towards;
    for (const gnomon::Light& light : lights.lights())
        towards.insert(towards.end(), light.xyzw.begin(), light.xyzw.begin() + 3);
    return triples_of(std::move(towards));
}

void bind_made_lights(nb::module_& m) {
    m.def(
        "sun_disk",
        [](const gnomon::Float3& direction, double angle_degrees, std::uint32_t samples) {
            return directions_towards(gnomon::sun_disk(direction, angle_degrees, samples));
        },
        "direction"_a, "angle_degrees"_a, "samples"_a,
        "(samples, 3) float32: vectors from the ground to samples of a disk in the sky, angle_degrees across, around "
        "the light that travels along direction (3,). Source: gnomon::sun_disk().");
    m.def(
        "sky_patches",
        [](const gnomon::Float3& up, const gnomon::Float3& north, std::uint32_t division) {
            const gnomon::Lights sky = gnomon::sky_patches(up, north, division);
            return nb::make_tuple(directions_towards(sky), row_of(vector_of(sky.weights())));
        },
        "up"_a, "north"_a, "division"_a,
        "(N, 3) float32: vectors from the ground to the N patches of Tregenza's sky, each of its 145 divided into "
        "division x division; (N,) float32: the patches' weights. Source: gnomon::sky_patches().");
    m.def(
        "round_weights",
        [](const Doubles& weights) {
            gnomon::WholeWeights whole = gnomon::round_weights(span_of(weights));
            return nb::make_tuple(row_of(std::move(whole.values)), whole.exponent);
        },
        "weights"_a,
        "(N,) int64: each of the finite weights (N,), float64, rounded once to a whole number times 2^exponent; the "
        "exponent. Source: gnomon::round_weights(), which gnomon::Lights uses.");
}

void bind_lattice(nb::module_& m) {
    using gnomon::WorldLattice;
    nb::class_<WorldLattice>(m, "WorldLattice")
        .def_static("around", [](const Doubles& p, int exponent) { return WorldLattice::around(span_of(p), exponent); })
        .def_static("fit", [](const Doubles& p) { return WorldLattice::fit(span_of(p)); })
        .def_ro("exponent", &WorldLattice::exponent)
        .def_ro("origin", &WorldLattice::origin)
        .def_prop_ro("step", &WorldLattice::step)
        .def("snap",
             [](const WorldLattice& lattice, const Doubles& p) {
                 WorldLattice::Snapped snapped = lattice.snap(span_of(p));
                 return nb::make_tuple(triples_of(std::move(snapped.positions)), snapped.largest_move);
             })
        .def("lift", [](const WorldLattice& lattice, const Doubles& p,
                        const Doubles& normals) { return triples_of(lattice.lift(span_of(p), span_of(normals))); })
        .def("changes",
             [](const WorldLattice& lattice, const Doubles& triangles, double degrees) {
                 std::vector<std::uint8_t> values;
                 for (const WorldLattice::Change change : lattice.changes(span_of(triangles), degrees))
                     values.push_back(static_cast<std::uint8_t>(change));
                 return row_of(std::move(values));
             })
        .def("touched_triangles",
             [](const WorldLattice& lattice, const Doubles& triangles) {
                 const auto values = span_of(triangles);
                 std::vector<std::uint32_t> touched = released([&] { return lattice.touched_triangles(values); });
                 const std::size_t count = touched.size() / 3;
                 return numpy_of(std::move(touched), {count, 3});
             })
        .def("__getstate__", [](const WorldLattice& from) { return std::pair(from.exponent, from.origin); })
        .def("__setstate__",
             [](WorldLattice& self, const std::pair<int, std::array<std::int64_t, 3>>& state) {
                 new (&self) WorldLattice{state.first, state.second};
             })
        .def("world_of", &WorldLattice::world_of)
        .def("rebased", [](const WorldLattice& lattice, const Floats& p, const WorldLattice& other) {
            return triples_of(lattice.rebased(span_of(p), other));
        });
}

// triangles (F, 9) in steps, face (F,), towards (M, 3): low (M, faces), high, and the centroids (M, faces, 3) or
// nothing.
void bind_lit_fractions(nb::module_& m) {
    m.def("lit_fractions",
          [](const Integers& triangles, const Integers& face, std::uint32_t faces, const Floats& towards, double within,
             std::uint64_t limit, unsigned threads, bool centroids, bool is_main) {
              const auto goes_on = [is_main] {  // signals are the main thread's
                  if (!is_main) return true;
                  const nb::gil_scoped_acquire held;
                  return PyErr_CheckSignals() == 0;
              };
              using Triangle = gnomon::python::LatticeTriangle;
              static_assert(sizeof(Triangle) == 9 * sizeof(std::int32_t));
              const std::span corners(reinterpret_cast<const Triangle*>(triangles.data()), triangles.size() / 9);
              gnomon::python::LitFractions found = released([&] {
                  return gnomon::python::lit_fractions(corners, span_of(face), faces, span_of(towards),
                                                       {within, limit, threads, centroids, goes_on});
              });
              if (PyErr_Occurred()) throw nb::python_error();
              const std::size_t lights = towards.size() / 3;
              std::vector<std::size_t> shape{lights, faces};
              auto low = numpy_of(std::move(found.low), shape), high = numpy_of(std::move(found.high), shape);
              return nb::make_tuple(low, high, numpy_of(std::move(found.centroid), {centroids ? lights : 0, faces, 3}));
          });
}

// planes (ceil(M / 32), n), normals (3, n) or None, towards (M, 3), weights (M,): int64 (n,).
void bind_energy_sums(nb::module_& m) {
    m.def(
        "energy_sums",
        [](const Ids& planes, const std::optional<Doubles>& normals, const Doubles& towards, const Doubles& weights) {
            std::vector<gnomon::python::WeighedSun> suns(weights.size());
            for (std::size_t i = 0; i < suns.size(); ++i) {
                std::copy_n(towards.data() + 3 * i, 3, suns[i].towards.begin());
                suns[i].weight = weights.data()[i];
            }
            const auto of_normals = normals ? span_of(*normals) : std::span<const double>();
            return row_of(released(
                [&] { return gnomon::python::energy_sums(span_of(planes), of_normals, planes.shape(1), suns); }));
        },
        "planes"_a, "normals"_a.none(), "towards"_a, "weights"_a);
}

std::vector<gnomon::Eye> eyes_of(const Integers& rows) {
    std::vector<gnomon::Eye> eyes;
    for (std::size_t i = 0; i + 4 <= rows.size(); i += 4) {
        const std::int32_t* const row = rows.data() + i;
        eyes.push_back({row[0], row[1], row[2], row[3]});
    }
    return eyes;
}

// The first row of a band, and the one after the last.
using Rows = std::pair<std::int32_t, std::int32_t>;
gnomon::HeightGrid::Band band_of(const Rows& rows) { return {rows.first, rows.second}; }

// Eyes are rows of four: x, y, height, the targets' height.
void bind_sight(nb::module_& m) {
    using gnomon::HeightGrid;
    m.attr("SUBCELLS") = SUBCELLS;
    m.attr("MAX_GRID_SIDE") = MAX_GRID_SIDE;
    m.attr("MAX_GRID_HEIGHT") = MAX_GRID_HEIGHT;
    m.attr("NO_HEIGHT") = NO_HEIGHT;
    nb::class_<HeightGrid>(m, "HeightGrid")
        .def(
            "__init__",
            [](HeightGrid* self, const gnomon::Device& device, const Integers& heights) {
                new (self) HeightGrid(device, span_of(heights), std::uint32_t(heights.shape(1)));
            },
            nb::keep_alive<1, 3>(), "device"_a, "heights"_a.noconvert(), Released())
        .def("look",
             [](HeightGrid& grid, const Integers& eye, const Rows& rows, const Integers& spans, bool sweeps) {
                 return row_of(
                     released([&] { return grid.look(eyes_of(eye).at(0), band_of(rows), span_of(spans), sweeps); }));
             })
        .def("least_heights",
             [](HeightGrid& grid, const Integers& eye, const Rows& rows, const Integers& spans) {
                 return row_of(
                     released([&] { return grid.least_heights(eyes_of(eye).at(0), band_of(rows), span_of(spans)); }));
             })
        .def(
            "look_from",
            [](HeightGrid& grid, const Integers& eyes, const Rows& rows, const Integers& spans, bool wants_words,
               const std::optional<nb::callable>& progress) {
                HeightGrid::Seen seen = released([&] {
                    return grid.look_from(eyes_of(eyes), band_of(rows), span_of(spans), wants_words,
                                          progress_of(progress));
                });
                return nb::make_tuple(row_of(std::move(seen.counts)), row_of(std::move(seen.words)));
            },
            "eyes"_a, "rows"_a, "spans"_a, "wants_words"_a, "progress"_a.none());
}

void bind_facing_of_rasters(nb::module_& m) {
    using Flags = nb::ndarray<const bool, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
    m.def(
        "clear_below",
        [](const Doubles& normals, const Flags& exist, const Doubles& suns, const Flags& chosen,
           const Written<std::uint32_t>& lit) {
            if (normals.size() != 3 * exist.size() || suns.size() != 3 * chosen.size() ||
                lit.size() != (chosen.size() + 31) / 32 * exist.size())
                throw gnomon::InvalidArgument("clear_below: the arrays have other sizes than each other");
            return row_of(released([&] {
                return gnomon::python::clear_below({span_of(normals), span_of(exist)}, span_of(suns), span_of(chosen),
                                                   span_of(lit));
            }));
        },
        "normals"_a.noconvert(), "exist"_a.noconvert(), "suns"_a.noconvert(), "chosen"_a.noconvert(),
        "lit"_a.noconvert());
}

// Of float32 and of float64: no array is converted from one to the other.
template <typename Height>
void bind_rounding(nb::module_& m) {
    using Heights = nb::ndarray<const Height, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
    m.def(
        "range_of_heights",
        [](const Heights& heights) {
            const auto range = released([&] { return gnomon::python::range_of(span_of(heights)); });
            return std::pair(range.low, range.high);
        },
        "heights"_a.noconvert());
    m.def(
        "round_heights",
        [](const Heights& heights, double base, double per_square, const Doubles& across, const Doubles& along,
           int exponent, const Written<std::int32_t>& steps, const Written<bool>& absent) {
            const nb::gil_scoped_release free;
            const gnomon::python::Rounding rounding{base, per_square, span_of(across), span_of(along), exponent};
            return gnomon::python::round_heights(span_of(heights), rounding, span_of(steps), span_of(absent));
        },
        "heights"_a.noconvert(), "base"_a, "per_square"_a, "across"_a, "along"_a, "exponent"_a, "steps"_a.noconvert(),
        "absent"_a.noconvert());
}

void bind_views(nb::module_& m) {
    using gnomon::Camera;
    using gnomon::View;
    using Axis = std::array<double, 3>;
    nb::class_<Camera>(m, "Camera")
        .def_static("look_at", &Camera::look_at)
        .def_ro("eye", &Camera::eye)
        .def_ro("right", &Camera::right)
        .def_ro("up", &Camera::up)
        .def_ro("forward", &Camera::forward)
        .def_ro("fov_y_radians", &Camera::fov_y_radians)
        .def("at",
             [](const Camera& c, const gnomon::Float3& eye) {
                 return Camera{eye, c.right, c.up, c.forward, c.fov_y_radians};
             })
        .def("__getstate__",
             [](const Camera& c) { return std::tuple(c.eye, c.right, c.up, c.forward, c.fov_y_radians); })
        .def("__setstate__", [](Camera& self, const std::tuple<gnomon::Float3, Axis, Axis, Axis, double>& state) {
            const auto& [eye, right, up, forward, fov_y_radians] = state;
            new (&self) Camera{eye, right, up, forward, fov_y_radians};
        });
    nb::class_<View>(m, "View").def_ro("points", &View::points);
    m.def("look", &gnomon::look, Released());
    m.def("read_view", [](const gnomon::Device& device, const gnomon::Triangles& triangles, const View& view) {
        gnomon::ViewOnHost host = released([&] { return view.read(device, triangles); });
        const std::size_t height = view.height, width = view.width;
        return nb::make_tuple(numpy_of(std::move(host.position), {height, width, 3}),
                              numpy_of(std::move(host.normal), {height, width, 3}),
                              numpy_of(std::move(host.receiver), {height, width}));
    });
    m.def(
        "run_samples",
        [](gnomon::Technique& technique, const gnomon::Triangles& triangles, const View& view,
           const std::array<float, 4>& light, std::uint32_t samples, const gnomon::Visibility& mean) {
            gnomon::run_samples(technique, triangles, view, light_of(light), samples, mean);
        },
        Released());
}

void bind_pictures(nb::module_& m) {
    using gnomon::View;
    nb::class_<gnomon::Appearance>(m, "Appearance")
        .def_static("upload", [](const gnomon::Device& device, const Ids& triangle_material,
                                 const std::vector<gnomon::Float3>& base_color) {
            return released([&] {
                const auto ids = span_of(triangle_material);
                return gnomon::Appearance::upload(device, {{ids.begin(), ids.end()}, base_color});
            });
        });
    m.def("shade",
          [](const gnomon::Appearance& appearance, const gnomon::Triangles& triangles, const View& view,
             const std::vector<gnomon::Visibility>& visibilities, const std::vector<std::array<float, 4>>& lights) {
              const std::size_t height = view.height, width = view.width;
              std::vector<std::uint8_t> rgba = released([&] {
                  std::vector<gnomon::Light> all;
                  for (const auto& light : lights) all.push_back(light_of(light));
                  return gnomon::shade(appearance.surfaces(triangles, view), visibilities, all).rgba;
              });
              return numpy_of(std::move(rgba), {height, width, 4});
          });
    m.def("smooth_picture",
          [](const gnomon::Appearance& appearance, gnomon::Technique& technique, const gnomon::Triangles& triangles,
             const View& view, const std::array<float, 4>& light, std::uint32_t samples) {
              const std::size_t height = view.height, width = view.width;
              std::vector<std::uint8_t> rgba = released([&] {
                  const gnomon::Device& device = technique.device();
                  const gnomon::Light one = light_of(light);
                  gnomon::SampleViews views(device, triangles, view, samples);
                  gnomon::PictureMean mean(device, view.points.count(), samples);
                  const gnomon::Visibility visibility(device, view.points.count());
                  for (std::size_t i = 0; i < views.count(); ++i) {
                      const View at = views.at(i);
                      technique.run(triangles, at.points, one, visibility);
                      mean.add(appearance.surfaces(triangles, at), {&visibility, 1}, {&one, 1});
                  }
                  return mean.read();
              });
              return numpy_of(std::move(rgba), {height, width, 4});
          });
}

#ifdef GNOMON_PYTHON_GLTF
// Alpha images are decoded by `decode`, a Python function from bytes to an array (height, width).
gnomon::scene::AlphaDecoder decoder_of(const nb::callable& decode) {
    return [&decode](std::span<const unsigned char> bytes) {
        const nb::gil_scoped_acquire held;
        const auto alpha = nb::cast<Bytes>(decode(nb::bytes(bytes.data(), bytes.size())));
        return gnomon::scene::SceneCutOuts::Texture{std::uint32_t(alpha.shape(1)), std::uint32_t(alpha.shape(0)),
                                                    vector_of(alpha)};
    };
}

OwnedCutOuts moved_cut_outs(gnomon::scene::Scene& scene) {
    gnomon::scene::SceneCutOuts& from = scene.cut_outs;
    OwnedCutOuts to{std::move(from.material_of_triangle),
                    std::move(scene.texture_coordinates),
                    std::move(from.corner_alphas),
                    std::move(from.materials),
                    {}};
    for (auto& [width, height, alpha] : from.textures) to.textures.push_back({width, height, std::move(alpha)});
    return to;
}

void bind_scene_files(nb::module_& m) {
    using namespace gnomon::scene;
    using Place = std::array<double, 3>;
    nb::class_<Scene>(m, "SceneFile")
        // The arrays move out of the scene: call each once.
        .def("take_triangles",
             [](Scene& scene) {
                 const std::size_t count = scene.triangle_count();
                 return numpy_of(std::move(scene.triangles), {count, 3, 3});
             })
        .def("take_doubles",
             [](Scene& scene) -> std::optional<Numpy<double>> {
                 if (scene.doubles.empty()) return std::nullopt;
                 const std::size_t count = scene.doubles.size() / 9;
                 return numpy_of(std::move(scene.doubles), {count, 3, 3});
             })
        .def("take_triangle_material",
             [](Scene& scene) { return row_of(std::move(scene.materials.triangle_material)); })
        .def("take_cut_outs",
             [](Scene& scene) -> std::optional<OwnedCutOuts> {
                 if (scene.cut_outs.empty()) return std::nullopt;
                 return moved_cut_outs(scene);
             })
        .def_prop_ro("base_color", [](const Scene& scene) { return scene.materials.base_color; })
        .def_prop_ro("cameras",
                     [](const Scene& scene) {
                         std::vector<std::pair<std::string, gnomon::Camera>> all;
                         for (const NamedCamera& c : scene.cameras) all.emplace_back(c.name, c.camera);
                         return all;
                     })
        .def_prop_ro("eyes",
                     [](const Scene& scene) {
                         std::vector<Place> all;
                         for (const NamedCamera& c : scene.cameras) all.push_back(c.eye);
                         return all;
                     })
        .def_prop_ro("positions",
                     [](const Scene& scene) {
                         std::vector<Place> all;
                         for (const NamedLight& l : scene.lights) all.push_back(l.position);
                         return all;
                     })
        .def_prop_ro("lights",
                     [](const Scene& scene) {
                         std::vector<std::pair<std::string, std::array<float, 4>>> all;
                         for (const NamedLight& l : scene.lights) all.emplace_back(l.name, l.light.xyzw);
                         return all;
                     })
        .def_ro("warnings", &Scene::warnings)
        .def_ro("animations", &Scene::animations);
}

void bind_scenes(nb::module_& m) {
    using namespace gnomon::scene;
    bind_scene_files(m);
    m.def(
        "load_scene",
        [](const std::string& file, const std::optional<std::string>& scene,
           const std::optional<std::string>& animation, std::optional<double> time_s, int blend,
           const std::optional<nb::callable>& decode_alpha) {
            LoadOptions options;
            options.scene = scene;
            options.animation = animation;
            options.time_s = time_s;
            options.blend = BlendCasters(blend);
            options.keeps_doubles = true;
            if (decode_alpha) options.decode_alpha = decoder_of(*decode_alpha);
            return released([&] { return load(file, options); });
        },
        "file"_a, "scene"_a.none(), "animation"_a.none(), "time_s"_a.none(), "blend"_a, "decode_alpha"_a.none());
}
#else
void bind_scenes(nb::module_&) {}
#endif

template <typename Value>
void bind_absent_places(nb::module_& m) {
    using Rows = nb::ndarray<const Value, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
    m.def(
        "first_absent_place",
        [](const Rows& rows) -> std::optional<std::size_t> {
            const auto found = gnomon::scene::first_absent_place<Value>(span_of(rows), rows.shape(1));
            return found ? std::optional(found->row) : std::nullopt;
        },
        "rows"_a.noconvert(),
        "The first of the rows (N, C) of coordinates with one that stands for no data, or None. Source: "
        "scene/no_data.hpp.");
}

void bind_tables(nb::module_& m) {
    using gnomon::scene::NumberTable;
    nb::class_<NumberTable>(m, "NumberTable")
        .def(
            "__init__",
            [](NumberTable* table, const nb::bytes& text, const std::string& file,
               const std::vector<std::vector<std::string>>& unnamed, bool are_points) {
                namespace scene = gnomon::scene;
                const scene::TableColumns columns{unnamed,
                                                  are_points ? scene::point_headings() : scene::sun_headings()};
                new (table) NumberTable(std::string_view(text.c_str(), text.size()), file, columns);
            },
            "text"_a, "file"_a, "unnamed"_a, "are_points"_a)
        .def_prop_ro("names", &NumberTable::names)
        .def("__len__", &NumberTable::rows)
        .def("text", &NumberTable::text)
        .def("numbers", [](const NumberTable& table, std::string_view name) { return row_of(table.numbers(name)); })
        .def("float_numbers",
             [](const NumberTable& table, std::string_view name) { return row_of(table.float_numbers(name)); })
        .def("refuse", &NumberTable::refuse)
        .def("require", &NumberTable::require)
        .def("require_places", &NumberTable::require_places)
        .def("require_weights", &NumberTable::require_weights)
        .def("require_all_or_none", &NumberTable::require_all_or_none)
        .def("unread_weights", &NumberTable::unread_weights)
        .def("require_degrees", &NumberTable::require_degrees);
    namespace scene = gnomon::scene;
    m.attr("no_data") = std::vector<double>(scene::no_data.begin(), scene::no_data.end());
    m.attr("no_data_beside_places") =
        std::vector<double>(scene::no_data_beside_places.begin(), scene::no_data_beside_places.end());
    m.def(
        "first_absent_weight", [](const Doubles& weights) { return scene::first_absent_weight(span_of(weights)); },
        "weights"_a, "The first of the weights (N,) that stands for no data, or None. Source: scene/no_data.hpp.");
    bind_absent_places<float>(m);
    bind_absent_places<double>(m);
}

// Each C++ exception becomes the Python exception that its reader expects; the texts are the same.
void bind_errors(nb::module_& m) {
    // Translators run newest first, so the base class comes first.
    nb::exception<gnomon::OpenClError>(m, "OpenCLError", PyExc_RuntimeError);
    nb::exception<gnomon::Cancelled>(m, "Cancelled", PyExc_RuntimeError);
    nb::exception<gnomon::DeviceNotFound>(m, "DeviceNotFoundError", PyExc_OSError);
    nb::register_exception_translator([](const std::exception_ptr& p, void*) {
        try {
            std::rethrow_exception(p);
        } catch (const gnomon::OutOfDeviceMemory& e) {
            PyErr_SetString(PyExc_MemoryError, e.what());
        } catch (const gnomon::InvalidArgument& e) {
            PyErr_SetString(PyExc_ValueError, e.what());
#ifdef GNOMON_PYTHON_GLTF
        } catch (const gnomon::scene::SceneError& e) {
            PyErr_SetString(PyExc_ValueError, e.what());
#endif
        }
    });
#ifdef GNOMON_PYTHON_GLTF
    nb::exception<gnomon::scene::NoDataError>(m, "NoDataError", PyExc_ValueError);
#endif
}

}  // namespace

NB_MODULE(_gnomon, m) {
    nb::set_leak_warnings(false);  // a daemon thread's call may hold objects when the interpreter ends
    m.attr("__version__") = std::string(gnomon::version());
    gnomon::add_rivals();
    bind_errors(m);
    bind_devices(m);
    bind_cut_outs(m);
    bind_inputs(m);
    bind_facing(m);
    bind_techniques(m);
    bind_many_lights(m);
    bind_made_lights(m);
    bind_lattice(m);
    bind_lit_fractions(m);
    bind_energy_sums(m);
    bind_sight(m);
    bind_facing_of_rasters(m);
    bind_rounding<float>(m);
    bind_rounding<double>(m);
    bind_views(m);
    bind_pictures(m);
    bind_scenes(m);
    bind_tables(m);
}
