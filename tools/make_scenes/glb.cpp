// SPDX-License-Identifier: MIT
// Writes a scene as GLB: a 12-byte header, a JSON chunk, and a BIN chunk with the positions and indices of each part in
// turn, then the images of masks. The JSON is small, the arrays go to the file as they lie in memory, so a scene is
// never held twice.
//
// Cameras and lights are nodes with a matrix, not a quaternion: the -Z column of a light is then exactly the direction
// asked for, unrounded, which scenes made of exact ties need. The other two columns are at right angles to it and as
// long, so that the matrix is a rotation with a uniform scale, as glTF demands; lights ignore the scale.
#include "glb.hpp"

#include <algorithm>
#include <bit>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "png.hpp"

namespace gnomon::make_scenes {

static_assert(std::endian::native == std::endian::little, "GLB is little-endian and arrays are written as they are");

using Json = nlohmann::ordered_json;

std::uint32_t Part::vertex(const Vec3& position) {
    const auto index = static_cast<std::uint32_t>(positions.size() / 3);
    positions.push_back(static_cast<float>(position.x));
    positions.push_back(static_cast<float>(position.y));
    positions.push_back(static_cast<float>(position.z));
    return index;
}

void Part::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    indices.push_back(a);
    indices.push_back(b);
    indices.push_back(c);
}

void Part::quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    triangle(a, b, c);
    triangle(a, c, d);
}

Part& Scene::part(std::string material, const std::array<double, 3>& base_color) {
    return parts.emplace_back(Part{std::move(material), base_color, {}, {}});
}

void Scene::camera(std::string camera_name, const Vec3& eye, const Vec3& target, double fov_y_degrees) {
    cameras.push_back({std::move(camera_name), eye, target, fov_y_degrees});
}

void Scene::directional(std::string light_name, const Vec3& direction) {
    lights.push_back({std::move(light_name), "directional", {}, direction});
}

void Scene::point(std::string light_name, const Vec3& position) {
    lights.push_back({std::move(light_name), "point", position, {0, -1, 0}});
}

void Scene::spot(std::string light_name, const Vec3& position, const Vec3& direction) {
    lights.push_back({std::move(light_name), "spot", position, direction});
}

std::uint64_t Scene::triangle_count() const {
    std::uint64_t count = 0;
    for (const Part& part : parts) count += part.triangle_count();
    return count;
}

namespace {

/// A node's matrix whose -Z column is exactly `forward`.
Json matrix_looking_along(const Vec3& forward, const Vec3& position) {
    const double scale = length(forward);
    const Vec3 unit = forward * (1 / scale);
    const bool is_vertical = unit.x * unit.x + unit.z * unit.z < 1e-12;
    const Vec3 right = normalized(cross(unit, is_vertical ? Vec3{0, 0, -1} : Vec3{0, 1, 0}));
    const Vec3 up = cross(right, unit);
    Json matrix = Json::array();
    for (const auto& [column, last] : {std::pair{right * scale, 0.0}, std::pair{up * scale, 0.0},
                                       std::pair{-forward, 0.0}, std::pair{position, 1.0}}) {
        // Adding 0 turns -0 into 0, which reads better.
        for (const double value : {column.x, column.y, column.z, last}) matrix.push_back(value + 0.0);
    }
    return matrix;
}

Json light_json(const LightNode& light) {
    Json json{{"name", light.name}, {"type", light.type}, {"color", {1, 1, 1}}};
    json["intensity"] = light.type == "directional" ? 3 : 300;  // lux; candela
    if (light.type == "spot") json["spot"] = {{"innerConeAngle", 0.35}, {"outerConeAngle", 0.6}};
    return json;
}

Json camera_json(const CameraNode& camera) {
    const double distance = length(camera.target - camera.eye);
    return {
        {"name", camera.name},
        {"type", "perspective"},
        {"perspective", {{"yfov", camera.fov_y_degrees * 3.14159265358979323846 / 180}, {"znear", distance / 1024}}}};
}

Json material_json(const Part& part) {
    const auto& color = part.base_color;
    Json json{{"name", part.material},
              {"pbrMetallicRoughness",
               {{"baseColorFactor", {color[0], color[1], color[2], 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}}},
              {"doubleSided", true}};
    if (part.mask) {
        json["alphaMode"] = "MASK";
        json["alphaCutoff"] = part.mask->cutoff;
    }
    return json;
}

bool has_texture(const Part& part) { return part.mask && part.mask->width > 0 && !part.indices.empty(); }

std::vector<std::uint8_t> image_of(const Part& part) {
    std::vector<std::uint8_t> png = png_of(part.mask->width, part.mask->height, part.mask->rgba);
    png.resize((png.size() + 3) / 4 * 4);  // what follows IEND is not read
    return png;
}

/// White with the alphas: COLOR_0.
std::vector<float> colors_of(const Part& part) {
    std::vector<float> colors;
    for (const float alpha : part.alphas) colors.insert(colors.end(), {1, 1, 1, alpha});
    return colors;
}

/// The texture of each masked part, behind all arrays. Returns the bytes that the images take.
std::uint64_t add_images(Json& root, const Scene& scene, std::uint64_t offset) {
    const std::uint64_t first = offset;
    std::size_t material = 0;
    for (const Part& part : scene.parts) {
        if (has_texture(part)) {
            const std::uint64_t bytes = image_of(part).size();
            root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
            offset += bytes;
            const std::size_t index = root["images"].size();
            root["images"].push_back(
                {{"bufferView", root["bufferViews"].size() - 1}, {"mimeType", "image/png"}, {"name", part.material}});
            root["samplers"].push_back({{"magFilter", int(part.mask->filter)},
                                        {"wrapS", int(part.mask->wrap)},
                                        {"wrapT", int(part.mask->wrap)}});
            root["textures"].push_back({{"sampler", index}, {"source", index}});
            root["materials"][material]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", index}};
        }
        material += !part.indices.empty();
    }
    return offset - first;
}

Json positions_accessor(const Part& part, std::size_t view) {
    std::array<float, 3> low, high;
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < part.positions.size(); ++i) {
        low[i % 3] = std::min(low[i % 3], part.positions[i]);
        high[i % 3] = std::max(high[i % 3], part.positions[i]);
    }
    return {{"bufferView", view},
            {"componentType", 5126},
            {"count", part.positions.size() / 3},
            {"type", "VEC3"},
            {"min", low},
            {"max", high}};
}

/// The mesh with one primitive for each part that has triangles, and all it refers to. Returns the bytes of BIN.
std::uint64_t add_mesh(Json& root, const Scene& scene) {
    std::uint64_t offset = 0;
    Json primitives = Json::array();
    const auto add_view = [&](std::uint64_t bytes, int target) {
        root["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}, {"target", target}});
        offset += bytes;
        return root["bufferViews"].size() - 1;
    };
    for (const Part& part : scene.parts) {
        if (part.indices.empty()) continue;
        const std::size_t positions_view = add_view(part.positions.size() * sizeof(float), 34962);
        root["accessors"].push_back(positions_accessor(part, positions_view));
        Json attributes{{"POSITION", positions_view}};
        const auto add_attribute = [&](const char* name, const char* type, std::size_t floats) {
            attributes[name] = root["accessors"].size();
            root["accessors"].push_back({{"bufferView", add_view(floats * sizeof(float), 34962)},
                                         {"componentType", 5126},
                                         {"count", part.positions.size() / 3},
                                         {"type", type}});
        };
        if (!part.coordinates.empty()) add_attribute("TEXCOORD_0", "VEC2", part.coordinates.size());
        if (!part.alphas.empty()) add_attribute("COLOR_0", "VEC4", 4 * part.alphas.size());
        const std::size_t indices_view = add_view(part.indices.size() * sizeof(std::uint32_t), 34963);
        root["accessors"].push_back({{"bufferView", indices_view},
                                     {"componentType", 5125},
                                     {"count", part.indices.size()},
                                     {"type", "SCALAR"}});
        root["materials"].push_back(material_json(part));
        primitives.push_back(
            {{"attributes", attributes}, {"indices", indices_view}, {"material", root["materials"].size() - 1}});
    }
    if (primitives.empty()) return 0;
    root["meshes"].push_back({{"name", scene.name}, {"primitives", primitives}});
    root["nodes"].push_back({{"name", scene.name}, {"mesh", 0}});
    offset += add_images(root, scene, offset);
    root["buffers"].push_back({{"byteLength", offset}});
    return offset;
}

void add_cameras_and_lights(Json& root, const Scene& scene) {
    for (const CameraNode& camera : scene.cameras) {
        const Vec3 forward = normalized(camera.target - camera.eye);
        root["nodes"].push_back({{"name", camera.name},
                                 {"camera", root["cameras"].size()},
                                 {"matrix", matrix_looking_along(forward, camera.eye)}});
        root["cameras"].push_back(camera_json(camera));
    }
    Json& lights = root["extensions"]["KHR_lights_punctual"]["lights"];
    for (const LightNode& light : scene.lights) {
        root["nodes"].push_back({{"name", light.name},
                                 {"matrix", matrix_looking_along(light.direction, light.position)},
                                 {"extensions", {{"KHR_lights_punctual", {{"light", lights.size()}}}}}});
        lights.push_back(light_json(light));
    }
}

void write_words(std::ofstream& stream, std::initializer_list<std::uint32_t> words) {
    for (const std::uint32_t word : words) stream.write(reinterpret_cast<const char*>(&word), sizeof word);
}

template <typename Element>
void write_array(std::ofstream& stream, const std::vector<Element>& array) {
    stream.write(reinterpret_cast<const char*>(array.data()),
                 static_cast<std::streamsize>(array.size() * sizeof(Element)));
}

}  // namespace

void write_glb(const Scene& scene, const std::filesystem::path& file) {
    Json root{{"asset", {{"version", "2.0"}, {"generator", "gnomon make_scenes"}}},
              {"extensionsUsed", {"KHR_lights_punctual"}},
              {"scene", 0},
              {"scenes", Json::array()}};
    const std::uint64_t binary_bytes = add_mesh(root, scene);
    add_cameras_and_lights(root, scene);
    Json nodes = Json::array();
    for (std::size_t i = 0; i < root["nodes"].size(); ++i) nodes.push_back(i);
    root["scenes"].push_back({{"name", scene.name}, {"nodes", nodes}});

    std::string json = root.dump();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::uint64_t total = 12 + 8 + json.size() + (binary_bytes > 0 ? 8 + binary_bytes : 0);
    if (total > std::numeric_limits<std::uint32_t>::max()) {
        throw MakeError("the scene '" + scene.name + "' needs more than the 4 GiB a GLB file can hold; ask for fewer " +
                        "triangles");
    }

    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    if (!stream) throw MakeError("cannot write '" + file.string() + "'; is the folder there, and may you write in it?");
    constexpr std::uint32_t magic = 0x46546C67, json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;
    write_words(stream, {magic, 2, static_cast<std::uint32_t>(total)});
    write_words(stream, {static_cast<std::uint32_t>(json.size()), json_chunk});
    stream.write(json.data(), static_cast<std::streamsize>(json.size()));
    if (binary_bytes > 0) write_words(stream, {static_cast<std::uint32_t>(binary_bytes), binary_chunk});
    for (const Part& part : scene.parts) {
        if (part.indices.empty()) continue;
        write_array(stream, part.positions);
        write_array(stream, part.coordinates);
        write_array(stream, colors_of(part));
        write_array(stream, part.indices);
    }
    for (const Part& part : scene.parts)
        if (has_texture(part)) write_array(stream, image_of(part));
    stream.close();
    if (!stream) throw MakeError("could not write all of '" + file.string() + "'; is the disk full?");
}

}  // namespace gnomon::make_scenes
