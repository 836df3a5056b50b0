// Loads of the four slings between a payload that is a body and the point that parachutes hang on.
#pragma once

#include <optional>

#include "fullsim/run/observer.hpp"
#include "fullsim/state.hpp"
#include "lib/record/archive.hpp"
#include "lib/record/run_record.hpp"
#include "lib/scene/needs.hpp"

namespace twinchute::fullsim {

/// The body has their apex as one of its own points. Tensions are those of slings that stretch alike: of all
/// that hold the pull, those with the least sum of squares. A sling that would have to push is slack in
/// truth.
class SlingLoads {
public:
    explicit SlingLoads(const SlingGeometry& slings) : slings_(slings) {}

    /// `pull` [N] of all risers together on a body that has turned so, at `time` [s].
    void observe(double time, const Vec3& pull, const BodyState& body);

    /// Adds the metric and, where slings would have been slack under load, the warning.
    void fill(RunRecord& record) const;

    /// Marks all that has been observed so far as sound, or forgets what has come since.
    void accept() { sound_ = now_; }
    void forget() { now_ = sound_; }
    void serialize(Archive& archive);

private:
    struct Extremes {
        Observer::Peak tension, push;  // [N] of one sling
    };
    SlingGeometry slings_;
    Extremes now_, sound_;
};

}  // namespace twinchute::fullsim
