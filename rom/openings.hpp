// Notes of a run on its parachutes while they open: events, and which force belongs to which parachute.
#pragma once

#include <vector>

#include "lib/solve/opening.hpp"
#include "lib/solve/opening_sequence.hpp"
#include "rom/motion.hpp"
#include "rom/run_context.hpp"

namespace twinchute::rom {

/// The motion as canopies see it.
template <int dimensions>
FlightState flight_state_of(const Scene& scene, double time, const Motion<dimensions>& motion) {
    const Wind* wind = scene.environment.wind ? &*scene.environment.wind : nullptr;
    return {time, motion.altitude(), motion.velocity[dimensions - 1],
            airspeed_of<dimensions>(motion.velocity, motion.altitude(), wind).norm(),
            scene.environment.atmosphere.at(motion.altitude()).density};
}

/// [s] Longest step while something waits for a dynamic pressure, which a longer one could see fall and rise.
inline constexpr double pressure_step = 0.2;

class Openings {
public:
    Openings(const Scene& scene, RunContext& context, const OpeningSequence& sequence, OpeningResult& to)
        : result(to), scene_(scene), context_(context), sequence_(sequence) {}

    OpeningResult& result;

    /// Assigns the forces until now, before the first row of the stage that begins with these events.
    void before_stage(const std::vector<OpeningEvent>& done, const FlightState& now);
    /// Notes events and stop conditions, after that row.
    void after_stage(const std::vector<OpeningEvent>& done, double time);
    /// The lines of a parachute that has left its pack come taut: what they pull from here on is its snatch.
    void lines_taut();
    /// The stage that the force has belonged to ends: its peak is known.
    void close();
    /// As OpeningSequence::is_growing.
    bool is_growing(std::size_t parachute) const { return sequence_.is_growing(parachute); }
    /// Whether all openings take place at all, whatever the speed at snatch turned out to be.
    RunStatus check() const;

private:
    void close_for_another();
    void note_forces(const OpeningEvent& what, const FlightState& now);
    void note_event(const OpeningEvent& what, double time);
    void note_snatch(const OpeningEvent& what, const FlightState& now);
    void note_full(ParachuteResult& chute, const OpeningEvent& what, double time);
    Maximum take_peak();
    CanopyPeak take_canopy_peak();

    const Scene& scene_;
    RunContext& context_;
    const OpeningSequence& sequence_;
    CanopyPeak canopy_peak_;    // taken with the last peak
    bool cut_at_once_ = false;  // the last of them, in the instant in which its stage began
    bool snatches_ = false;     // lines of a parachute are taut that is no result yet
};

}  // namespace twinchute::rom
