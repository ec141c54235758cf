// SPDX-License-Identifier: MIT
// Formulas: glTF 2.0, appendix C. Quaternions are normalized before and after they are interpolated.
#include "animation.hpp"

#include <algorithm>
#include <cmath>

namespace gnomon::scene {
namespace {

glm::dquat unit(glm::dquat q) {
    const double length = glm::length(q);
    return length > 0 ? q / length : q;
}

glm::dquat quaternion(std::span<const double> xyzw) { return {xyzw[3], xyzw[0], xyzw[1], xyzw[2]}; }

std::vector<double> slerped(const std::vector<double>& from, const std::vector<double>& to, double fraction) {
    const glm::dquat q = unit(glm::slerp(unit(quaternion(from)), unit(quaternion(to)), fraction));
    return {q.x, q.y, q.z, q.w};
}

}  // namespace

std::size_t morph_target_count(const tinygltf::Model& model, int node) {
    const int mesh = model.nodes[std::size_t(node)].mesh;
    std::size_t most = 0;
    if (mesh >= 0)
        for (const tinygltf::Primitive& primitive : model.meshes[std::size_t(mesh)].primitives)
            most = std::max(most, primitive.targets.size());
    return most;
}

AnimationReader::Interval AnimationReader::interval(int input, double time_s, const std::string& what) {
    const Elements& times = accessors_.elements(input);
    if (times.count == 0) fail(file_, what + " has no keyframes");
    // The last keyframe that is not later than the time.
    std::size_t first = 0;
    for (std::size_t i = 0; i < times.count; ++i) {
        const double t = times.number(i, 0);
        if (!std::isfinite(t) || (i > 0 && t <= times.number(i - 1, 0)))
            fail(file_, "{} has keyframes whose times do not rise: {:f} s at keyframe {}", what, t, i);
        if (t <= time_s) first = i;
    }
    const double start = times.number(first, 0);
    if (first + 1 == times.count || time_s <= start) return {first, 0, 0, false};
    const double seconds = times.number(first + 1, 0) - start;
    return {first, (time_s - start) / seconds, seconds, true};
}

std::vector<double> AnimationReader::sample(const tinygltf::AnimationSampler& sampler, double time_s,
                                            std::size_t components, bool is_rotation, const std::string& what) {
    const bool is_cubic = sampler.interpolation == "CUBICSPLINE";
    const Interval at = interval(sampler.input, time_s, what);
    const Elements& output = accessors_.elements(sampler.output);
    const std::size_t needed = accessors_.count(sampler.input) * (is_cubic ? 3 : 1);
    const std::size_t width = std::size_t(output.components);
    if (output.count % needed != 0 || output.count / needed * width != components)
        fail(file_, "{} has {} for its keyframes, but needs {} times {}", what, counted(output.count * width, "number"),
             needed, components);
    // Value `part` of a keyframe; a cubic spline has three: in-tangent, value, out-tangent.
    const auto value = [&](std::size_t keyframe, std::size_t part) {
        const std::size_t begin = (keyframe * (is_cubic ? 3 : 1) + part) * components;
        std::vector<double> v(components);
        for (std::size_t i = 0; i < components; ++i)
            v[i] = output.number((begin + i) / width, int((begin + i) % width));
        return v;
    };
    const std::vector<double> from = value(at.first, is_cubic ? 1 : 0);
    if (!at.is_between || sampler.interpolation == "STEP") return from;
    const std::vector<double> to = value(at.first + 1, is_cubic ? 1 : 0);
    if (is_rotation && !is_cubic) return slerped(from, to, at.fraction);
    std::vector<double> out(components);
    const double t = at.fraction, t2 = t * t, t3 = t2 * t;
    if (!is_cubic) {
        for (std::size_t i = 0; i < components; ++i) out[i] = glm::mix(from[i], to[i], t);
        return out;
    }
    const std::vector<double> leave = value(at.first, 2), arrive = value(at.first + 1, 0);
    for (std::size_t i = 0; i < components; ++i)
        out[i] = (2 * t3 - 3 * t2 + 1) * from[i] + at.seconds * (t3 - 2 * t2 + t) * leave[i] +
                 (-2 * t3 + 3 * t2) * to[i] + at.seconds * (t3 - t2) * arrive[i];
    return out;
}

std::map<int, AnimatedNode> AnimationReader::at(int index, double time_s, std::set<std::string>& not_supported) {
    const tinygltf::Animation& animation = model_.animations[std::size_t(index)];
    std::map<int, AnimatedNode> nodes;
    for (std::size_t i = 0; i < animation.channels.size(); ++i) {
        const tinygltf::AnimationChannel& channel = animation.channels[i];
        const std::string& path = channel.target_path;
        const bool is_rotation = path == "rotation", is_weights = path == "weights";
        if (path.empty()) continue;  // it names no node, and glTF says: ignore it
        if (!is_rotation && !is_weights && path != "translation" && path != "scale") {
            not_supported.insert("an animation of " + in_quotes(path) + " (ignored)");
            continue;
        }
        const std::string what = fmt::format("animations[{}].channels[{}]", index, i);
        if (!is_weights && !model_.nodes[std::size_t(channel.target_node)].matrix.empty())
            fail(file_,
                 "{} moves nodes[{}], which has a matrix; glTF allows this only for translation, rotation and scale",
                 what, channel.target_node);
        const std::size_t components = is_weights    ? morph_target_count(model_, channel.target_node)
                                       : is_rotation ? 4
                                                     : 3;
        if (components == 0) continue;
        std::vector<double> value =
            sample(animation.samplers[std::size_t(channel.sampler)], time_s, components, is_rotation, what);
        AnimatedNode& node = nodes[channel.target_node];
        if (is_rotation)
            node.rotation = unit(quaternion(value));
        else if (is_weights)
            node.weights = std::move(value);
        else
            (path == "scale" ? node.scale : node.translation) = glm::dvec3(value[0], value[1], value[2]);
    }
    return nodes;
}

}  // namespace gnomon::scene
