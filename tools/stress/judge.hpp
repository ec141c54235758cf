// SPDX-License-Identifier: MIT
// Puts one question to gnomon, to the oracle (reference::shadowed: exact, independent), to the plain float test and to
// Embree, and counts who was wrong.
#pragma once

#include <array>
#include <memory>
#include <string>

#include <gnomon.hpp>
#include "question.hpp"
#include "reference/bvh.hpp"

namespace stress {

struct EmbreeWay {
    const char* name;
    bool is_robust;
    double offset;  ///< of the scene's size
};
inline constexpr std::array<EmbreeWay, 6> EMBREE_WAYS = {{{"Embree 0", false, 0},
                                                          {"Embree 1e-6", false, 1e-6},
                                                          {"Embree 1e-4", false, 1e-4},
                                                          {"robust 0", true, 0},
                                                          {"robust 1e-6", true, 1e-6},
                                                          {"robust 1e-4", true, 1e-4}}};

/// What is known of one case, over all its questions.
struct Tally {
    std::uint64_t questions = 0, triangles = 0;  ///< the most triangles of any question
    std::uint64_t points = 0;                    ///< without absent ones
    std::uint64_t directional = 0, positional = 0;
    std::uint64_t shadowed = 0, wrong = 0;
    std::string first_wrong{};  ///< one line that says how to see it again

    std::uint64_t by_map = 0, facing_away = 0;  ///< points
    std::uint64_t pairs = 0, open_pairs = 0;    ///< point and triangle, tested by the filter; left open by it
    std::uint64_t by_float = 0, by_double = 0, by_integers = 0;

    bool has_plain = false, has_embree = false;  ///< asked; neither knows of cut-outs
    std::uint64_t plain_wrong = 0;               ///< of the points that do not face away
    std::array<std::uint64_t, EMBREE_WAYS.size()> embree_wrong{};
    std::uint64_t embree_left_out = 0;  ///< points that Embree does not take

    std::uint64_t leaks = 0;  ///< points inside a closed mesh that the oracle says are lit: never
    std::uint64_t star_points = 0, slipped = 0, slipped_too_far = 0;
    double largest_slip_ulp = 0;

    double gnomon_seconds = 0, oracle_seconds = 0, embree_seconds = 0, plain_seconds = 0;

    /// Whether nothing contradicts the contract.
    bool is_right() const { return wrong == 0 && leaks == 0 && slipped_too_far == 0; }
    Tally& operator+=(const Tally& other);
};

class Judge {
public:
    Judge(const gnomon::Device& device, bool with_embree);
    ~Judge();

    /// `settings` of the technique; `where` names the question, should an answer be wrong.
    void ask(const Question& question, const std::vector<std::pair<std::string, std::string>>& settings,
             const std::string& where, Tally& tally);

private:
    struct Trees;
    void hold_triangles(const Question& question);

    gnomon::Device device_;
    bool with_embree_;
    std::unique_ptr<Trees> trees_;
};

}  // namespace stress
