// The force blocks there are, as rows: what each needs, what it promises, and how it is built.
#pragma once

#include <span>

#include "fullsim/forces/force_model.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// A row of the table of force blocks. The promises are what the contract tests hold it to.
struct ForceBlock {
    Block block;
    std::string_view name;
    std::string_view source;
    bool structural;  ///< holds the parachute together: forces derive from a stored energy plus viscosity
    bool without_net_force;  ///< its forces sum to zero
    bool zero_at_rest;    ///< no force on an unstrained parachute that moves as one, in still air of no speed
    bool dissipates;      ///< what it takes out of the motion is booked as damping
    bool fixed_in_space;  ///< its direction is prescribed; everything else turns with the parachute and the
                          ///< air
    bool subcycles;       ///< of lines and risers: evaluated in every subcycle (fullsim/time/subcycling.hpp)
    bool (*needed)(const Scene&, Stage);
    std::string (*why)(const Scene&);  ///< what in a scene makes it needed, or left out
    std::unique_ptr<const ForceModel> (*make)(const Scene&, const Mesh&);
};

std::span<const ForceBlock> force_blocks();
const ForceBlock& force_block(Block block);

/// The stages of a scene's run, in their order.
std::vector<Stage> stages_of(const Scene& scene);
/// Stages in which the block takes part; none: the scene leaves it out.
std::vector<Stage> stages_with(const ForceBlock& block, const Scene& scene);

/// The structural blocks of a scene in a stage of its run. They come first in every step, so that the riser
/// force can be read before anything else acts on the payload. Of `blocks`: all that there are, unless a test
/// wants fewer.
ForceModels make_structure(const Scene& scene, const Mesh& mesh, Stage stage = Stage::flight,
                           std::span<const ForceBlock> blocks = force_blocks());
/// The other blocks that the scene needs in that stage.
ForceModels make_loads(const Scene& scene, const Mesh& mesh, Stage stage = Stage::flight,
                       std::span<const ForceBlock> blocks = force_blocks());

}  // namespace twinchute::fullsim
