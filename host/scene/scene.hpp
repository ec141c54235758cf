// SPDX-License-Identifier: MIT
// A scene as the command uses it: world triangles, colours, cameras and lights, from a glTF 2.0 file or built in. Not
// part of the core library: only this folder uses tinygltf.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <gnomon.hpp>

namespace gnomon::scene {

/// A file that cannot be used. what() is one sentence that names the file, the wrong part of it and the remedy.
class SceneError : public Error {
public:
    using Error::Error;
};

/// A vertex or an instance stands for no data.
class NoDataError : public SceneError {
public:
    using SceneError::SceneError;
};

struct NamedCamera {
    std::string name;     ///< node name, else camera name, else "camera N"
    Camera camera;        ///< transformed in double; the eye is rounded once
    int file_index = -1;  ///< of the file's cameras; -1: of no file
    std::array<double, 3> eye{};
};

/// KHR_lights_punctual. A spot is positional for visibility: its cone and range are shading.
struct NamedLight {
    std::string name;     ///< node name, else light name, else "light N"
    std::string type;     ///< "directional", "point" or "spot"
    Light light;          ///< transformed in double, rounded once
    int file_index = -1;  ///< of the file's lights; -1: of no file
    std::array<double, 3> position{};
};

/// Cut-outs that the scene owns.
struct SceneCutOuts {
    std::vector<std::uint32_t> material_of_triangle;  ///< empty: there are no cut-outs
    std::vector<float> corner_alphas;
    std::vector<CutOutMaterial> materials;
    struct Texture {
        std::uint32_t width = 0, height = 0;
        std::vector<std::uint8_t> alpha;
    };
    std::vector<Texture> textures;

    bool empty() const { return material_of_triangle.empty(); }
};

/// An image of base colours: 8-bit sRGB with unassociated alpha, 4 bytes per texel.
struct ColorImage {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgba;
};

/// The colours of surfaces beside base colour factors, and shading normals. Each array may be empty.
struct SceneColors {
    std::vector<ColorTextureUse> texture_uses;              ///< one per material
    std::shared_ptr<const std::vector<ColorImage>> images;  ///< the scenes of a file share them
    std::vector<float> corner_colors;                       ///< linear RGB, 9 per triangle
    std::vector<std::uint32_t> corner_normals;              ///< pack_normal(), 3 per triangle
};

struct Scene;

/// What Triangles::upload() takes: get() refers to the arrays of the scene and to its own.
class CutOutsView {
public:
    explicit CutOutsView(const Scene& scene);
    CutOutsView(const CutOutsView&) = delete;
    CutOutsView& operator=(const CutOutsView&) = delete;
    /// Null if there are no cut-outs.
    const CutOuts* get() const { return is_empty_ ? nullptr : &cut_outs_; }

private:
    bool is_empty_;
    std::vector<AlphaTexture> textures_;
    CutOuts cut_outs_;
};

/// What Surfaces takes: get() refers to the arrays of the scene and to its own.
class SurfaceDetailView {
public:
    explicit SurfaceDetailView(const Scene& scene);
    SurfaceDetailView(const SurfaceDetailView&) = delete;
    SurfaceDetailView& operator=(const SurfaceDetailView&) = delete;
    const SurfaceDetail& get() const { return detail_; }

private:
    std::vector<ColorTexture> textures_;
    SurfaceDetail detail_;
};

/// A mesh of the file as a node draws it: from this triangle to the next one's.
struct MeshUse {
    std::size_t first_triangle = 0;
    int mesh = 0;
};

/// Casters with alphaMode BLEND: as opaque ones, as if they were not there, or as masks with a cutoff of .5.
enum class BlendCasters { opaque, clear, mask };

/// The alpha of an image file in memory, 8 bits each. Throws an exception that says why if it cannot be read.
using AlphaDecoder = std::function<SceneCutOuts::Texture(std::span<const unsigned char> bytes)>;
/// The same for colours, where an image that unpacks to more than `max_bytes` cannot be read.
using ColorDecoder = std::function<ColorImage(std::span<const unsigned char> bytes, std::uint64_t max_bytes)>;

struct Scene {
    /// 9 per triangle: world space. Morph targets, skins, node transforms and instances are applied in double and
    /// rounded once; under an identity transform the floats have the file's own bits.
    std::vector<float> triangles;
    /// Before they were rounded, where LoadOptions asks for this and float32 moves vertices visibly; else empty.
    std::vector<double> doubles;
    Materials materials;                     ///< base colour factors, linear
    std::vector<float> texture_coordinates;  ///< u, v of the corners, 6 per triangle; empty: no triangle has a texture
    SceneCutOuts cut_outs;
    SceneColors colors;
    std::vector<MeshUse> mesh_uses;       ///< in the triangles' order; empty: the scene is of no file
    std::vector<std::string> mesh_names;  ///< "mesh 'sky'", or "mesh 3" without a name
    std::vector<NamedCamera> cameras;
    std::vector<NamedLight> lights;
    std::vector<std::string> warnings;     ///< each one sentence; --strict turns them into errors
    std::vector<std::string> notes;        ///< each one sentence, on what the file has beside the scene; no errors
    std::vector<std::string> animations;   ///< the names of the file's animations; "animation N" without a name
    std::vector<double> animation_ends_s;  ///< of each the last keyframe's time, as the file says; 0 if it does not
    std::string animation;                 ///< the one that is shown; empty: the pose at rest

    std::size_t triangle_count() const { return triangles.size() / 9; }
    /// A triangle with a NaN or infinite vertex casts no shadow.
    bool is_finite(std::size_t triangle) const {
        const auto first = triangles.begin() + std::ptrdiff_t(9 * triangle);
        return std::all_of(first, first + 9, [](float c) { return std::isfinite(c); });
    }
};

/// The scene's triangles on the device, with their cut-outs.
Triangles upload(const Device& device, const Scene& scene);

/// What of a file is loaded. A name that none has is read as an index from 0.
struct LoadOptions {
    std::uint64_t memory_bytes = 0;          ///< that the triangles may take; 0: the machine's memory
    std::optional<std::string> scene{};      ///< none: the file's default scene
    std::optional<std::string> animation{};  ///< none: the first, if there is a time
    std::optional<double> time_s{};          ///< none: the pose at rest, or an animation's start if one is named
    BlendCasters blend = BlendCasters::opaque;
    AlphaDecoder decode_alpha{};   ///< none: the scene has no cut-outs, and a warning says that they are drawn opaque
    ColorDecoder decode_colors{};  ///< none: the scene has no SceneColors
    bool keeps_doubles = false;    ///< Scene::doubles, and no warning where they are there
};

/// Loads a .glb or .gltf file. Throws SceneError, also if its triangles need more memory than they may take.
Scene load(const std::filesystem::path& file, const LoadOptions& options = {});

/// A file that is read once, for its scene at several times.
class SceneFile {
public:
    /// Throws SceneError. The time of the options is not used.
    explicit SceneFile(const std::filesystem::path& file, const LoadOptions& options = {});
    ~SceneFile();
    /// The scene at this time, in seconds (none: as LoadOptions::time_s). Throws SceneError.
    Scene at(std::optional<double> time_s);

private:
    struct Inside;
    std::unique_ptr<Inside> inside_;
};

/// The built-in sundial, with a camera and a light.
Scene sundial();

class Content;

/// The camera of scenes without one. It frames the content, which is all finite triangles without strays and without
/// wide planes and not a sky around all else, in the middle of the picture (fov_y 50 degrees), from a three-quarter
/// view, or from where far more of it is seen. An interior, whose walls and floor show their fronts to its middle and
/// to the outside backs or a plain box, is seen from inside (65 degrees).
class Framing {
public:
    /// `aspect`: the picture's width over its height.
    Framing(const Scene& scene, double aspect);
    /// Frames this scene's triangles, too: another time of an animation.
    void add(const Scene& scene);
    Camera camera() const;
    /// One sentence on the triangles of this scene that are not framed, and their meshes; empty if all are.
    std::string left_out(const Scene& scene) const;
    /// One sentence on a mesh that is seen from outside and has all others inside, far smaller; empty if there is none.
    std::string hidden(const Scene& scene) const;

private:
    static constexpr double nothing = -std::numeric_limits<double>::infinity();

    double aspect_;
    Camera camera_;
    bool is_interior_ = false;
    std::shared_ptr<const Content> content_;
    std::array<double, 3> middle_{};  ///< the other numbers count from it
    /// What is known for one slope of the sides of the seen pyramid, to the right, left, up and down.
    struct Reach {
        double slope = 0;  ///< as a part of the picture's
        std::array<double, 4> sides{nothing, nothing, nothing, nothing};
    };
    std::array<Reach, 16> reaches_{};
};
Camera framing_camera(const Scene& scene, double aspect = 1);

/// The light of a scene without lights, if no option gives one: directional, travelling along (-0.4, -1, -0.3).
Light default_light();

}  // namespace gnomon::scene
