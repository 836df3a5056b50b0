// The scene of run i: values of a design put into the scene that varies.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "study/campaign/design.hpp"
#include "study/campaign/spec.hpp"
#include "study/varied_scene.hpp"

namespace twinchute::study {

/// The scene that a campaign's file names, without the overrides that stand there.
SceneWith base_of(const CampaignSpec& spec);

/// Scenes of runs; the same for all threads, each of which has its own Design and scene to put values in.
class Sampler {
public:
    /// `scene_with`: the scene that varies. Throws SceneError where it, or a value from the middle of a
    /// distribution, is refused, and where a key varies without effect.
    Sampler(const CampaignSpec& spec, const SceneWith& scene_with);

    /// The scene that varies, with all that a record says of its inputs.
    const Scene& nominal() const { return nominal_; }
    /// Scene to put values in.
    const Scene& blank() const { return varied_->base(); }
    /// Throws SceneError for values that a scene must not have.
    void put(Scene& scene, std::span<const double> values) const;
    /// The scene of values by reading, as `twinchute rom` would run it. Throws SceneError.
    Scene scene_at(std::span<const double> values) const;
    /// Values are put into the scene without reading it again.
    bool is_quick() const { return varied_->is_quick(); }

private:
    std::vector<KeyValue> key_values(std::span<const double> values) const;
    std::array<std::vector<double>, 2> ends() const;  // of each input, low and high
    void check_effects(const std::vector<double>& low, const std::vector<double>& high) const;
    void disperse_wind(Scene& scene, std::span<const double> values) const;

    const CampaignSpec spec_;
    Scene nominal_;
    std::vector<std::size_t> keyed_;  // inputs that are keys of the scene
    std::unique_ptr<VariedScene> varied_;
    bool through_air_ = false;  // the release goes with the wind
};

}  // namespace twinchute::study
