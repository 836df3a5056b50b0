// The shapes of a full run that its report draws.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "fullsim/forces/membrane.hpp"
#include "fullsim/state.hpp"
#include "lib/record/archive.hpp"
#include "lib/record/frames.hpp"

namespace twinchute::fullsim {

/// A part of a run, and how often frames are taken in it at first.
struct FrameStretch {
    double interval;   ///< [s]
    std::size_t most;  ///< frames; when there are more, every other one goes and the interval doubles
};

/// Takes frames as they are due, few enough for a page and close enough together to see a canopy open:
/// nobody knows beforehand how long a deployment or a descent lasts.
class FrameRecorder {
public:
    /// Unless `wanted`, nothing is ever taken. `meshes`: of each canopy, with the static line that it starts
    /// with; `sectors`: parts of its canopy that are congruent (Layout::sectors), of which one is looked at
    /// for stresses.
    FrameRecorder(std::vector<const Mesh*> meshes, bool wanted, int sectors = 1);
    FrameRecorder(const Mesh& mesh, bool wanted, int sectors = 1)
        : FrameRecorder(std::vector{&mesh}, wanted, sectors) {}

    /// From `time` [s] on frames are taken as `stretch` says; those before stay.
    void begin(double time, const FrameStretch& stretch);

    /// As FieldRecorder: a frame is due at the first step at or after a multiple of the interval from the
    /// begin of the stretch. Needs all nodes of the state.
    bool frame_is_due(double time) const { return time >= next_; }
    void observe(std::span<const State* const> states) {
        if (frame_is_due(states.front()->time)) take(states);
    }
    void observe(const State& state) { observe(std::array{&state}); }
    /// A check found everything sound so far.
    void accept();
    /// A check found something wrong: drops what came after the last accept().
    void forget() { shape_.frames.resize(accepted_); }

    /// Right after accept(): all frames so far.
    const ShapeFrames& so_far() const { return shape_; }

    /// Returns the accepted frames; nothing can be observed after that.
    ShapeFrames finish();

    /// Saves or restores; the mesh has to be the same.
    void serialize(Archive& archive);

private:
    void take(std::span<const State* const> states);
    void add_mesh(const Mesh& mesh);
    void add_places(const State& state, std::size_t k);
    void add_stresses(const State& state, const Mesh& mesh, std::vector<FabricFolds>& folds);

    std::vector<const Mesh*> meshes_;
    std::vector<MembraneLaw> laws_;  // by sheet
    bool wanted_;
    std::size_t most_frames_;  // that memory is given to
    std::size_t sectors_;
    std::vector<std::size_t> tether_nodes_;  // of each mesh,
    std::vector<NodeIndex> apex_;            // where its static line is fixed
    FrameStretch stretch_{1.0, 2};
    double begin_ = 0.0, next_;             // [s]
    std::size_t first_ = 0, accepted_ = 0;  // frames: of the stretch, sound
    ShapeFrames shape_;
    std::vector<double> place_, stress_;
};

}  // namespace twinchute::fullsim
