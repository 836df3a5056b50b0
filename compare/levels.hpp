// The levels of a ladder: one scene in ever finer settings, and without each physics effect that it may do
// without.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/scene/scene.hpp"

namespace twinchute::compare {

/// Meaning of the distance of a level from a reference.
enum class Physics {
    same,   ///< that of its fidelity: the distance from that fidelity's reference is numerical error
    other,  ///< an effect is left out, or a closed form: a gap, and no error
};

struct Level {
    std::string name = {};           ///< unique in a ladder, e.g. "full, mesh x2"
    std::string label = {};          ///< the same beside its family's colour, e.g. "x2"
    std::string family = {};         ///< what is drawn in one colour, e.g. "full": one of drawn_families
    std::string why = {};            ///< what it shows
    std::string_view fidelity = {};  ///< that runs it; empty: `closed_form` answers
    std::function<void(Scene&)> change = {};
    Physics physics = Physics::same;
    /// Levels that refine one thing, coarsest first, e.g. "mesh"; empty: on its own.
    std::string_view sequence = {};
    double cost = 0.0;             ///< predicted, in runs of the scene as it is by the same fidelity
    bool given = false;            ///< the scene as it is
    std::string_view metric = {};  ///< of a closed form: the metric it gives
    std::string_view key = {};     ///< where a run computes it: its key in the record
    std::function<double()> closed_form = {};
};

/// Predicted cost from which on --quick leaves a level out.
inline constexpr double quick_cost = 4.0;

/// From the cheapest kind of answer to the finest; what the scene has not got is not left out of it either.
std::vector<Level> ladder_levels(const Scene& scene);

/// The scene that a level runs, with random numbers from `seed` where it has any.
Scene scene_of(const Level& level, const Scene& scene, std::optional<std::uint64_t> seed = {});

/// Setting that a level changes, as one would write it: "rom.rtol=1e-06"; "as given" where it changes
/// nothing.
std::string setting_of(const Level& level, const Scene& scene);

/// Typical size of an element of the canopy, in arbitrary units: for Richardson extrapolation.
double mesh_size(const Scene& scene);

}  // namespace twinchute::compare
