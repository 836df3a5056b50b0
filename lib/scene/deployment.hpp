// How a parachute gets out of its pack: what a scene says of it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace twinchute {

enum class DeployBy {
    static_line,   ///< a line from the apex to an anchor pays out, and lets go at snatch
    free,          ///< drag and inertia alone
    extraction,    ///< a prescribed force pulls the parachute out
    pilot,         ///< the drag of a pilot chute draws the pack out
    mortar,        ///< a gun throws the pack out, straight behind
    line_stretch,  ///< the scene starts with lines and canopy drawn out: snatch is at time 0
    inflated       ///< the scene starts with the canopy open
};

/// A word of `parachute.deploy.by`.
struct DeploymentRow {
    std::string_view name;
    DeployBy by;
    std::string_view meaning;
};

std::span<const DeploymentRow> deployment_rows();
std::string_view deployment_name(DeployBy by);

/// [N] against time since release; linear between its points, nothing after the last.
struct ForceHistory {
    std::string table;  ///< its file; empty: one force for a while
    std::vector<double> time, force;
    double duration = 0.0;  ///< [s] nothing after that either

    double at(double t) const;

    bool operator==(const ForceHistory&) const = default;
};

/// Parameters of the deployment. Those of other kinds than the chosen one stay zero.
struct Deployment {
    DeployBy by = DeployBy::line_stretch;

    double static_line_length = 0.0;  ///< [m] anchor to apex
    bool anchor_moves = true;         ///< with the velocity of the release; otherwise it stands still

    ForceHistory extraction;         ///< straight behind the release
    bool extraction_on_apex = true;  ///< otherwise on the whole canopy, by area

    double pitch = 0.0;             ///< [rad] of the pack from the line straight behind the release, apex up
    double pack_ratio = 0.0;        ///< length of the pack over that of the parachute drawn out [-]
    double drag_coefficient = 0.0;  ///< of fabric until snatch, on its area across the air [-] (full)
    double pack_drag_area = 0.0;    ///< C_D S of the pack [m^2] (rom); needed by a free deployment; of the
                                    ///< pilot chute, where one draws it out
    double muzzle_speed = 0.0;      ///< [m/s] of the pack relative to the payload (rom)
    double compressive_stiffness_ratio = 0.0;  ///< stiffness of folded fabric over that in tension [-] (full)
    double deployment_resistance = 0.0;        ///< [N/m] of folded fabric against being drawn out (full)

    /// A force draws it out: prescribed, or of a pilot chute.
    bool is_extracted() const { return by == DeployBy::extraction || by == DeployBy::pilot; }
    bool starts_packed() const { return by != DeployBy::line_stretch && by != DeployBy::inflated; }

    bool operator==(const Deployment&) const = default;
};

}  // namespace twinchute
