// The shapes of a full run that its report draws.
#pragma once

#include <cstddef>
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
    /// Unless `wanted`, nothing is ever taken. `mesh` with the static line that it starts with; `sectors`:
    /// parts of its canopy that are congruent (Layout::sectors), of which one is looked at for
    /// stresses.
    FrameRecorder(const Mesh& mesh, bool wanted, int sectors = 1);

    /// From `time` [s] on frames are taken as `stretch` says; those before stay.
    void begin(double time, const FrameStretch& stretch);

    /// As FieldRecorder: a frame is due at the first step at or after a multiple of the interval from the
    /// begin of the stretch. Needs all nodes of the state.
    bool frame_is_due(double time) const { return time >= next_; }
    void observe(const State& state) {
        if (frame_is_due(state.time)) take(state);
    }
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
    void take(const State& state);

    const Mesh& mesh_;
    MembraneLaw law_;
    bool wanted_;
    std::size_t most_frames_;  // that memory is given to
    std::size_t sectors_, tether_nodes_;
    NodeIndex apex_ = 0;  // where the static line is fixed
    FrameStretch stretch_{1.0, 2};
    double begin_ = 0.0, next_;             // [s]
    std::size_t first_ = 0, accepted_ = 0;  // frames: of the stretch, sound
    ShapeFrames shape_;
    std::vector<double> place_, stress_;
};

}  // namespace twinchute::fullsim
