// A scene in plain SI: what is dropped, with what, from where, through what air, until when.
// Immutable after read_scene. Optional physics is std::optional: absent means no object, no
// array and no branch in any inner loop; choices are enums or pointers to rows of model tables.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/models/added_mass.hpp"
#include "lib/models/atmosphere.hpp"
#include "lib/models/attitude_drag.hpp"
#include "lib/models/calibration.hpp"
#include "lib/models/canopy_type.hpp"
#include "lib/models/drag_area.hpp"
#include "lib/models/drag_correction.hpp"
#include "lib/models/fill_time.hpp"
#include "lib/models/filling.hpp"
#include "lib/models/mach_drag.hpp"
#include "lib/models/material.hpp"
#include "lib/models/wind.hpp"
#include "lib/record/metrics.hpp"
#include "lib/record/run_record.hpp"
#include "lib/scene/deployment.hpp"

namespace twinchute {

struct Environment {
    Atmosphere atmosphere;
    double gravity = 0.0;           ///< [m/s^2], downward
    double ground = 0.0;            ///< [m] elevation above sea level
    std::optional<Wind> wind = {};  ///< absent: the air is at rest

    bool operator==(const Environment&) const = default;
};

/// Elasticity of a deformable body: isotropic, linear (Saint Venant and Kirchhoff's).
struct Elasticity {
    double youngs_modulus = 0.0;  ///< [Pa]
    double poisson_ratio = 0.0;   ///< [-]

    bool operator==(const Elasticity&) const = default;
};

/// A payload that turns: a homogeneous body, of the full model.
struct PayloadBody {
    enum class Shape {
        box,
        cylinder,
        mesh  ///< the tetrahedra of the group `payload` in Parachute::mesh
    };
    Shape shape = Shape::box;
    /// [m] A box: its edges, two across and the last along the parachute's axis. A cylinder: diameter,
    /// height. Of a mesh: none.
    std::vector<double> size;
    /// [m] of four slings, from the upper corners of a box or a cylinder's upper rim to one point over its
    /// middle; absent: risers end on the body.
    std::optional<double> sling_length = {};
    std::optional<Elasticity> elasticity = {};  ///< absent: rigid

    bool operator==(const PayloadBody&) const = default;
};

struct Payload {
    double mass = 0.0;                ///< [kg]
    std::optional<double> drag_area;  ///< C_D S [m^2]; absent: no payload drag
    /// C_D S by attitude, of a body in the full model; drag_area is then that of one that hangs straight.
    std::optional<AttitudeDrag> drag_area_table = {};
    std::optional<double> diameter = {};   ///< D_B [m] of a disc with its frontal area; for its wake
    std::optional<PayloadBody> body = {};  ///< absent: a point mass

    bool operator==(const Payload&) const = default;
};

/// The initial state of the payload, over ground. A scene that gives an airspeed means path angle
/// and heading through the air as well; the reader has added the wind.
struct Release {
    double altitude = 0.0;    ///< [m] above sea level
    double speed = 0.0;       ///< [m/s] over ground
    double path_angle = 0.0;  ///< [rad] below the horizon, in [-pi/2, pi/2]
    double heading = 0.0;     ///< [rad] from north, clockwise
    // Where and when a parachute of the full model leaves its pack; zero in the release of a scene.
    double time = 0.0;               ///< [s]
    double east = 0.0, north = 0.0;  ///< [m]
    /// How payload.body has turned by then: unit quaternion w x y z, its axes to x y z. Absent: it hangs
    /// straight behind the parachute.
    std::optional<std::array<double, 4>> attitude = {};

    bool operator==(const Release&) const = default;
};

/// Start of the drag-area rise after snatch (paper, 3.2.2).
struct InitialPhase {
    bool transit = true;   ///< t_i = 0.5 D0/v_s, the air's way from skirt to apex
    double seconds = 0.0;  ///< [s] otherwise

    bool operator==(const InitialPhase&) const = default;
};

/// Materials of the reinforcements; each is a cable of the full model.
struct Tapes {
    Cord radial;  ///< along the gore seams
    Cord skirt;
    Cord vent;

    bool operator==(const Tapes&) const = default;
};

/// Lines from the edge of the vent: one from each seam to its suspension line, which hold the vent down, or
/// one for every two seams across the vent. At most one of length and pull-down ratio is given; a line across
/// the vent is as long as the vent is wide by default.
struct VentLines {
    enum class Model { pull_down, across };
    Model model = Model::pull_down;
    std::optional<double> length = {};  ///< [m] of each, as made
    /// [-] share of the seam by which the vent is held down in a canopy that is drawn out along its seams: 0
    /// not at all, 1 as far as the skirt.
    std::optional<double> pull_down_ratio = {};
    std::optional<double> joint = {};  ///< [m] below the skirt along the suspension line; absent: at its link
    Cord cord = {};                    ///< without a name: as the suspension line

    bool operator==(const VentLines&) const = default;
};

/// When something happens: exactly one condition, and a delay after it. Altitude and dynamic pressure are met
/// in falling, or where they are below already.
struct Trigger {
    enum class Kind {
        steady_descent,
        peak_force,
        full_open,
        line_stretch,  ///< met at snatch
        ground,
        time,
        altitude,
        release,
        apogee,
        dynamic_pressure,
        cut
    };
    Kind kind = Kind::steady_descent;
    /// [s] since release, for Kind::time; [m] above sea level, for Kind::altitude; [Pa], for
    /// Kind::dynamic_pressure.
    double value = 0.0;
    double delay = 0.0;   ///< [s] after the condition
    std::string of = {};  ///< whose line stretch, full opening or cut; empty: one's own

    bool operator==(const Trigger&) const = default;
};

/// A stage of an opening with the mouth of the canopy held together by a line.
struct Reefing {
    double drag_area_ratio = 0.0;       ///< (C_D S)_r/(C_D S)_0 [-]
    std::optional<double> line_length;  ///< [m] once around the mouth
    std::optional<FillTime> fill_time;  ///< absent: as the parachute's
    Trigger until;                      ///< the line is cut

    bool operator==(const Reefing&) const = default;
};

/// Materials of one panel of a gore.
struct PanelMaterials {
    Fabric fabric;  ///< without a name: as the parachute's

    bool operator==(const PanelMaterials&) const = default;
};

/// A mesh of somebody's own, in place of the generated one.
struct MeshFile {
    std::string name;            ///< as the scene says it
    std::filesystem::path file;  ///< where it was found

    bool operator==(const MeshFile& other) const { return name == other.name; }
};

/// One parachute, or several alike that open together. Unless said otherwise a value is that of one of them.
/// Values that only a structure needs may be absent: 0 or an empty name. See missing_structure.
struct Parachute {
    std::string name;
    std::optional<CanopyType> type;                   ///< what handbooks say of its kind
    double nominal_diameter = 0.0;                    ///< D0 [m]
    double drag_area = 0.0;                           ///< (C_D S)_0 [m^2], corrections included
    std::optional<double> uncorrected_drag_area;      ///< [m^2] as stated; absent: nothing corrects it
    double projected_diameter_ratio = 0.0;            ///< D_p/D0 of the steady canopy [-]; 0: unknown
    std::optional<double> opening_force_coefficient;  ///< C_x [-], for estimates by formula
    double mass = 0.0;                                ///< canopy and lines [kg]
    int gores = 0;
    double vent_diameter = 0.0;  ///< [m]
    double line_length = 0.0;    ///< [m] skirt to link
    double riser_length = 0.0;   ///< [m] link to confluence
    int risers = 0;              ///< links; divides gores
    Fabric fabric;
    Cord line;
    Tapes tapes;
    std::optional<VentLines> vent_lines = {};
    std::optional<MeshFile> mesh;  ///< of the full model; absent: generated from the sizes above
    StrengthFactors strength;

    int count = 1;                    ///< of a cluster
    std::vector<double> lag;          ///< [s] of each in a cluster; empty: none
    int skips_reefing = 0;            ///< canopies, the first of a cluster, whose reefing lines do not hold
    double cluster_drag_ratio = 1.0;  ///< drag coefficient in the cluster over that of one alone [-]

    Deployment deploy;
    std::optional<Trigger> deploy_when;  ///< absent: at release
    std::optional<Trigger> cut;          ///< absent: never let go
    std::vector<Reefing> reefing;        ///< stages before the canopy may open fully
    FillTime fill_time;                  ///< of the whole opening; after reefing, of the rest
    const DragAreaLaw* drag_area_law = nullptr;
    std::optional<double> drag_area_exponent;      ///< j of a power of the fill fraction [-], likewise
    std::optional<DragAreaTable> drag_area_table;  ///< of a whole opening, in place of the law
    double initial_drag_area_ratio = 0.0;          ///< (C_D S)_i/(C_D S)_0 = eta^2 [-]
    InitialPhase initial_phase;
    /// In place of the six above, if it is predicted; they are then empty.
    Filling filling = {};
    std::optional<double> permeability = {};  ///< [m/s] at half an inch of water, in place of the fabric's
    double geometric_porosity = 0.0;          ///< lambda_g [-]
    /// Constructed angle of each panel [rad] and its length along the seam [-], in place of the type's;
    /// empty: as the type has them. See gore_panels.
    std::vector<double> cone_angle = {}, panel_length = {};
    std::vector<PanelMaterials> panel = {};  ///< of each panel, from apex to skirt; empty: all of `fabric`
    double corner_tie = 0.0;                 ///< of a cross, from arm to arm [m]; 0: see cross_outline
    std::optional<double> arm_ratio = {};    ///< of a cross in place of the type's, see cross_arm_ratio [-]
    std::optional<CalibrationTable> calibration = {};   ///< of the reduced-order model
    std::optional<MachDrag> drag_area_mach_table = {};  ///< absent: one drag area at all Mach numbers

    bool operator==(const Parachute&) const = default;
};

/// Cylinder drag of the suspension lines (paper, Eq. 10); present or not.
struct LineDrag {
    bool operator==(const LineDrag&) const = default;
};

struct Aerodynamics {
    std::optional<AddedMassSpec> added_mass;
    std::optional<LineDrag> line_drag;
    std::optional<double> breathing_damping;                     ///< k_b [-]
    double radial_pressure = 0.0;                                ///< phi(t_f) of Eq. 12 [-]
    std::optional<const LineRatioModel*> line_ratio = {};        ///< corrects (C_D S)_0
    std::optional<const ForebodyWakeModel*> forebody_wake = {};  ///< likewise

    bool operator==(const Aerodynamics&) const = default;
};

struct RomSettings {
    std::string method;  ///< a row of explicit_methods(), lib/solve/sundials.hpp
    double rtol = 0.0;   ///< [-] relative tolerance of position and velocity

    bool operator==(const RomSettings&) const = default;
};

/// Initial disturbance of the canopy nodes: uniform in a cube of half edge `amplitude`.
struct Noise {
    double amplitude = 0.0;  ///< [m]
    std::uint64_t seed = 0;

    bool operator==(const Noise&) const = default;
};

/// How the elements of a gore are distributed from vent to skirt.
enum class Grading {
    graded,  ///< one element across a gore at the vent, longer ones beside it: the vent does not set the time
             ///< step
    uniform  ///< the same number across a gore everywhere, all equally long
};

inline std::string_view grading_name(Grading grading) {
    return grading == Grading::graded ? "graded" : "uniform";
}

struct MeshCounts {
    int gore_columns = 0;    ///< elements across a gore; a graded mesh has one at the vent
    int gore_rows = 0;       ///< elements from vent to skirt
    int line_elements = 0;   ///< per suspension line
    int riser_elements = 0;  ///< per riser
    Grading grading = Grading::graded;

    bool operator==(const MeshCounts&) const = default;
};

/// Which structure carries a parachute that starts in its pack.
enum class Structure {
    msd_fe,  ///< edges as springs and dashpots until the canopy begins to fill, then finite elements
    fe       ///< finite elements throughout
};

/// How much of a parachute is computed.
enum class Symmetry {
    none,   ///< all of it
    sector  ///< the smallest part that a turn about the axis brings onto the rest; the rest moves as it does
};

/// Contact model, which keeps fabric from passing through fabric.
enum class Contact {
    none,   ///< nothing, as in the paper
    gores,  ///< the fabric of a gore stays between its seams, in the order of the gores around the axis
    self    ///< nodes of fabric and lines do not pass through triangles of fabric
};

struct FullSettings {
    MeshCounts mesh;
    Symmetry symmetry = Symmetry::none;
    Structure structure = Structure::msd_fe;
    Contact contact = Contact::none;
    double contact_friction = 0.2;   ///< coefficient of friction in self-contact [-]
    double switch_area_ratio = 0.0;  ///< mouth area over the steady projected area at the change [-]
    /// [s] over which the stiffness of the finite elements grows; absent: by D0/v
    std::optional<double> ramp_time = {};
    double beta = 0.0;                ///< [s] stiffness-proportional damping of cables and spring edges
    double alpha = 0.0;               ///< [1/s] mass-proportional Rayleigh damping about the mean motion
    bool alpha_from_release = false;  ///< otherwise from snatch on
    double bulk_viscosity = 0.0;      ///< b1 [-] (paper, Eq. 3)
    double time_step_factor = 0.0;    ///< share of the bound on the critical time step [-]
    int line_substeps = 1;            ///< most steps of lines and risers within one of the canopy
    double mass_scaling = 0.0;        ///< mass added where nodes set the step, of canopy and its air [-]
    double strain_limit = 0.0;        ///< largest strain that a run may reach [-]
    double output_rate = 0.0;         ///< [1/s] rows of the history
    /// [1/s] of the rows that a run takes: a whole multiple of it, and enough for what is found from rows,
    /// such as an impulse or the stress that most of the fabric bears.
    double row_rate() const { return output_rate * std::max(1.0, std::ceil(200.0 / output_rate)); }
    std::optional<double> fields_rate;  ///< [1/s] frames of the fields; absent: none
    std::optional<Noise> noise;
    double checkpoint_interval = 0.0;  ///< [s] of wall time from one checkpoint to the next; 0: none

    bool operator==(const FullSettings&) const = default;
};

/// Uncertainty of inputs that were calibrated: normal, with their covariance.
struct Uncertainty {
    std::vector<std::string> inputs;  ///< keys; "ln KEY": the logarithm of its value
    std::vector<double> covariance;   ///< [SI] lower triangle, row by row
};

/// Requirements of `size`, and the quantities that it may change to meet them.
struct SizeSpec {
    std::optional<double> max_descent_rate;  ///< [m/s]
    std::optional<double> max_force;         ///< [N] largest opening force
    std::optional<double> max_canopy_force;  ///< [N] largest force of any single canopy
    std::optional<double> max_deceleration;  ///< [m/s^2]
    std::string parachute;                   ///< name of the one that is sized; empty: the last
    std::vector<std::string> vary;           ///< in the order in which it is decided on them
    std::vector<CanopyType> types;           ///< to compare; empty: the scene's own canopy alone

    bool operator==(const SizeSpec&) const = default;
};

/// How the cases of a series are shown together. Metrics by name without unit.
struct SeriesSpec {
    std::string x, y;   ///< metrics of the plot
    std::string group;  ///< of this case: cases of one group are joined; empty: all are one
    std::string test;   ///< name of the CSV file with points of a test; empty: none
    std::vector<double> test_x, test_y;

    bool operator==(const SeriesSpec&) const = default;
};

struct Scene {
    std::string name;
    std::string case_name;  ///< of a series, safe as the name of a directory; empty: no series
    std::filesystem::path file;
    std::string sha256;  ///< of the scene file's bytes

    Environment environment;
    Payload payload;
    Release release;
    std::vector<Parachute> parachutes;  ///< one or more; names differ
    Aerodynamics aerodynamics;
    Trigger stop;
    std::string then;  ///< fidelity that flies the rest of the fall once a run has stopped; empty: none
    RomSettings rom;
    FullSettings full;
    std::map<std::string, Tolerance> tolerances;  ///< by metric name without unit, e.g. "peak_force"
    std::optional<SizeSpec> size;
    std::optional<Uncertainty> uncertainty;  ///< of inputs that a campaign may draw
    std::optional<SeriesSpec> series;

    std::vector<Input> inputs;      ///< every effective key, for the record
    std::vector<Warning> warnings;  ///< about the inputs, for the record
    /// Keys of designs and types that a predicted filling takes the place of.
    std::vector<std::string> overridden;
};

}  // namespace twinchute
