// Opening sequence of the parachutes of a scene, one after the other or at once: they wait, open in stages
// and are cut. Shared by all fidelities: a model computes the flight, the sequence decides what happens when.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/models/inflation.hpp"
#include "lib/record/archive.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute {

/// Whether single canopies pull less than all of them together may.
inline bool has_several_canopies(const Scene& scene) {
    return scene.parachutes.size() > 1 || scene.parachutes.front().count > 1;
}

/// State of the payload's flight at one instant, as far as triggers need it.
struct FlightState {
    double time = 0.0;      ///< [s] since release
    double altitude = 0.0;  ///< [m] above sea level
    double climb = 0.0;     ///< [m/s] upward
    double airspeed = 0.0;  ///< [m/s]
    double density = 0.0;   ///< [kg/m^3]

    double dynamic_pressure() const { return 0.5 * density * airspeed * airspeed; }
};

/// One canopy, or several of a cluster that behave alike.
struct Canopy {
    enum class State { packed, open, cut };

    const Parachute* chute = nullptr;
    std::size_t index = 0;  ///< of its parachute in the scene
    int count = 1;
    double lag = 0.0;            ///< [s] by which its filling begins later
    bool skips_reefing = false;  ///< its reefing lines do not hold: stage is the open canopy's from the first
    State state = State::packed;
    std::size_t stage = 0;  ///< below reefing.size(): reefed
    Phase phase = Phase::initial;
    Inflation inflation;         ///< of one of them; set once it is open
    double steady_radius = 0.0;  ///< R_0 [m]
    double porosity = 0.0;       ///< lambda_g [-]
    double snatch_speed = 0.0, snatch_density = 0.0;
    double waited = 0.0;  ///< [s] beyond deploy.when, for another to leave its pack
    std::shared_ptr<const FillingCanopy> filling = {};  ///< null: its filling is prescribed
    FillingMotion bulb = {};                            ///< of a predicted filling: where it has come to
    bool squids = false;                                ///< its fabric lets out all that its mouth takes in
    bool held = false;                                  ///< as full as its reefing line lets it be, no more

    /// Its drag and its air are a model's to compute, not the sequence's: while it fills, and while a reefing
    /// line holds it.
    bool fills_itself() const { return filling && is_out() && (phase != Phase::open || held); }
    bool is_out() const { return state == State::open; }
    bool is_reefed() const { return stage < chute->reefing.size(); }
};

/// Event in the opening of a parachute.
struct OpeningEvent {
    enum class Kind {
        snatch,       ///< line stretch, or snatch of one that was packed
        filling,      ///< its drag area begins to rise: end of the initial phase
        reefed_open,  ///< a reefed stage is full
        disreef,      ///< a reefing line is cut
        full_open,    ///< the last of its canopies is full
        cut           ///< let go
    };
    Kind kind;
    std::size_t index;      ///< of the parachute in the scene
    std::size_t stage = 0;  ///< that begins or ends
};

/// [m] from the payload to the mean place of the drag of an open canopy: risers, lines that spread to the
/// skirt, and two thirds of the radius, the mean height of a hemisphere over its projected area.
double drag_distance(const Parachute& chute);

class OpeningSequence {
public:
    /// Whether canopies of a cluster that behave alike are one in the sequence, or each has its own opening.
    enum class Alike { as_one, each };

    /// All in their packs. The scene outlives it.
    explicit OpeningSequence(const Scene& scene, Alike alike = Alike::as_one);
    /// None: nothing ever happens.
    OpeningSequence() = default;
    /// One that is out and stays in its phase: a right-hand side without events, for integrators alone. The
    /// parachute outlives it.
    OpeningSequence(const Parachute& chute, const Inflation& inflation, Phase phase);

    /// Release: what waits for nothing happens, and is told by advance().
    void release(const FlightState& now);

    /// Everything that is due by now, in order. Stop at next_time(), and where watch() falls to zero, and
    /// ask.
    std::vector<OpeningEvent> advance(const FlightState& now);
    /// The parachute that has to leave its pack now, if any; others stay in theirs until it has snatched.
    std::optional<std::size_t> leaves_pack() const { return leaving_; }
    /// Snatch, of a parachute that has left its pack: of all its canopies,
    void snatched(std::size_t index, const FlightState& now);
    /// or of one. The parachute's comes with the last of them.
    void canopy_snatched(std::size_t canopy, const FlightState& now);
    /// A canopy whose filling is predicted has come to this, with a drag area [m^2] of one canopy that holds
    /// until this is called again.
    void grown(std::size_t canopy, const FillingMotion& bulb, bool squids, double drag_area);
    /// It is full at `time` [s], or as full as its reefing line lets it be (`held`): advance() tells so.
    void fills_up(std::size_t canopy, double time, bool held);
    /// A steady descent has been found.
    void descends_steadily(const FlightState& now);

    /// [s] The next time at which something is known to happen; infinite when nothing is.
    double next_time() const;
    /// Conditions on the flight that something waits for: each is met where it falls to zero. [m], [m/s],
    /// [Pa]
    std::vector<double> watch(const FlightState& now) const;
    std::size_t watch_count() const;
    /// Whether one of them may be met for a short while only, so that a long step could miss it.
    bool watches_pressure() const;
    /// The condition of that number among watch() is met.
    void met(std::size_t watched, const FlightState& now);
    bool waits_for_steady_descent() const;

    /// Whether a canopy of this parachute fills, and grows: its peak force may be yet to come.
    bool is_growing(std::size_t parachute) const;
    /// No drag area changes.
    bool is_quiet() const;
    /// Nothing fills, and nothing will.
    bool is_filled() const;
    /// No drag area changes, and none will, but for a cut of the last parachute.
    bool is_settled() const;
    /// Nothing is waited for, not even a cut.
    bool is_over() const { return waits_.empty(); }
    /// A canopy whose filling is predicted, and which still grows; null: none does.
    const Canopy* fills_itself() const;
    /// Whether any has yet to snatch.
    bool any_waits_to_leave() const;

    /// C_D S [m^2] of all canopies that are out.
    double drag_area(double time) const {
        double sum = 0.0;
        for (const Canopy& c : all_)
            if (c.is_out()) sum += c.count * drag_area_of(c, time);
        return sum;
    }
    /// Whether a parachute's drag area goes by the Mach number; then it is that in air met at `mach` [-].
    bool go_by_mach() const;
    double drag_area(double time, double mach) const;
    /// C_D S [m^2] of one canopy that is out; `mach` [-] counts where its drag area goes by it.
    static double drag_area_of(const Canopy& c, double time) {
        return c.inflation.steady_drag_area * c.inflation.drag_area_ratio(c.phase, time).value;
    }
    static double drag_area_of(const Canopy& c, double time, double mach);
    /// Added mass [kg] and rate [kg/s] of one canopy that is out.
    static ValueAndRate added_mass_of(const Canopy& c, const AddedMassSpec& spec, double time,
                                      double density) {
        return c.inflation.added_mass(spec, c.phase, time, density, c.steady_radius, c.porosity);
    }
    /// Added mass [kg] and rate [kg/s] of all that are out.
    ValueAndRate added_mass(const AddedMassSpec& spec, double time, double density) const {
        ValueAndRate sum;
        for (const Canopy& c : all_) {
            if (!c.is_out()) continue;
            const ValueAndRate one = added_mass_of(c, spec, time, density);
            sum.value += c.count * one.value;
            sum.rate += c.count * one.rate;
        }
        return sum;
    }
    double out_mass() const { return out_mass_; }        ///< [kg] of canopies that are out
    double packed_mass() const { return packed_mass_; }  ///< [kg] of those that the payload still carries
    /// [m] from the payload to the canopy with most drag area of those that are out, open and steady: to
    /// where its drag acts (see drag_distance()).
    double distance() const { return distance_; }

    const std::vector<Canopy>& all() const { return all_; }

    /// A canopy, or several of a cluster, that nothing has let open.
    struct Unopened {
        std::size_t canopy;  ///< of all()
        std::string why;     ///< e.g. "deploy.when, altitude 0 m, was not met"
    };
    /// Canopies still in their packs, or behind a reefing line that has not been cut.
    std::vector<Unopened> unopened() const;
    /// Whether all that are out are full.
    bool is_open() const;

    /// Writes or reads the sequence of one scene.
    void serialize(Archive& archive);

private:
    /// Something that a canopy's trigger has yet to bring about.
    struct Wait {
        enum class What { deploy, disreef, cut };
        What what;
        std::size_t canopy;
        const Trigger* trigger;
        double due = std::numeric_limits<double>::infinity();  ///< [s]
    };

    /// Trigger that a canopy in its stage waits for.
    const Trigger* trigger_of(Wait::What what, const Canopy& c) const;
    void arm(Wait wait, const FlightState& now);
    void occurred(Trigger::Kind kind, std::size_t index, double time);
    bool is_about(const Wait& wait, Trigger::Kind kind, std::size_t index) const;
    double left(const Wait& wait, const FlightState& now) const;
    bool is_watched(const Wait& wait) const;
    bool is_blocked(const Wait& wait) const;
    void open(std::size_t index, const FlightState& now, std::vector<OpeningEvent>& done);
    void open_canopy(std::size_t canopy, const FlightState& now);
    void own_event(Trigger::Kind kind, std::size_t canopy, double time);
    void end_phase(Canopy& c, const FlightState& now, std::vector<OpeningEvent>& done);
    void act(const Wait& wait, const FlightState& now, std::vector<OpeningEvent>& done);
    void weigh();

    const Scene* scene_ = nullptr;
    std::vector<Canopy> all_;
    std::vector<Wait> waits_;
    struct Past {
        Trigger::Kind kind;
        std::size_t index;
        double time;
    };
    std::vector<Past> past_;
    std::vector<OpeningEvent> unreported_;
    std::optional<std::size_t> leaving_;
    double out_mass_ = 0.0, packed_mass_ = 0.0, distance_ = 0.0;
};

}  // namespace twinchute
