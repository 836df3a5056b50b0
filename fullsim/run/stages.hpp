// The parachutes of a scene that come out one after the other: which of them is when, and which force belongs
// to which opening.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "fullsim/run/canopy_run.hpp"
#include "lib/solve/opening_sequence.hpp"

namespace twinchute::fullsim {

class Stages {
public:
    /// The scene outlives it.
    explicit Stages(const Scene& scene);

    OpeningSequence sequence;

    /// The payload as triggers see it.
    FlightState flight_state(const PayloadFlight& payload) const;
    /// [kg] of the payload with the packs that it carries.
    double carried_mass() const { return scene_.payload.mass + sequence.packed_mass(); }
    /// Conditions that end a free flight: what the sequence watches, the ground and where the scene stops.
    FlightWatch watch() const;

    /// Number of a parachute's first canopy among all of the sequence; others of it follow.
    std::size_t first_canopy(std::size_t parachute) const { return first_canopy_[parachute]; }

    /// Meshes of all canopies, as their packs are released.
    std::vector<const Mesh*> meshes() const;
    /// A state for each of them: its own while it is out, before and after that all of it at the payload.
    std::vector<const State*> states(const Cluster& cluster);

    // Openings, from the force of all risers together.

    /// A parachute leaves its pack, `all` having observed the forces until now.
    void leaves_pack(double time, Observer& all);
    /// A parachute, seen as `canopies`, opens from here on. `initial_time`: [s] its shortest initial phase.
    void opens(std::size_t parachute, const RunView& canopies, double initial_time, double time,
               Observer& all);
    void disreefs(std::size_t parachute, double time, Observer& all);
    /// Once the observer has finished. `each`: of the parachutes that have left their packs.
    std::vector<ParachuteResult> openings(std::span<const RunView> each, const Observer& all);

    void serialize(Archive& archive);

private:
    void close_snatch(const Observer& all);
    /// Another parachute begins to pull: the peak of one that still fills is not known.
    void close_for_another();

    const Scene& scene_;
    std::vector<std::size_t> first_canopy_;
    std::vector<std::unique_ptr<Mesh>> meshes_;  // of each parachute,
    std::vector<State> stowed_;                  // and in its pack
    std::vector<ParachuteResult> opened_;
    /// The opening's stage that a peak of the observer belongs to; none: of no opening.
    struct Owner {
        std::ptrdiff_t opening = -1;  // of opened_
        std::size_t stage = 0;
        bool still_fills = false;  ///< as another parachute begins to pull
    };
    std::vector<Owner> owners_{{}};
    bool snatches_ = false;  // the last peak began with a deployment
};

}  // namespace twinchute::fullsim
