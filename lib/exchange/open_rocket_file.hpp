// A design of OpenRocket as far as recovery needs it. Sources of what elements mean: file_specification.rst
// and fileformat.txt of OpenRocket, and how OpenRocket itself reads them.
#pragma once

#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "lib/exchange/read_design.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::exchange {

struct RocketStage {
    std::string name;
    pugi::xml_node node;
};

struct RecoveryDevice {
    pugi::xml_node node;
    std::string name, id;
    bool streamer = false;
    std::size_t stage = 0;  ///< number in OpenRocketFile::stages
    int count = 1;          ///< of instances: pods, boosters, clusters of tubes
};

/// A row of results, for the columns that are used, in SI; NaN where a file has none.
struct FlightRow {
    double time, altitude, climb, lateral, speed, mass, gravity, east, north;
};

/// Stored flight of one stage.
struct FlightBranch {
    pugi::xml_node node;
    std::vector<FlightRow> rows;

    /// [s] of the first event of a type, and of a source where one is given.
    std::optional<double> event(std::string_view type, std::string_view source = {}) const;
    /// Whether its events say which device they are of.
    bool names_sources() const;
};

/// The tree of a design, with the simulation and the stored flight that a scene is made from.
class OpenRocketFile {
public:
    /// Throws SceneError. The text, its name and the choice outlive it.
    OpenRocketFile(std::string_view xml, const std::string& file, const ImportChoice& choice);

    /// Throws SceneError about an element, at its line.
    [[noreturn]] void refuse(pugi::xml_node node, std::string problem, std::string why,
                             std::string hint) const;
    /// Number in a text; nothing where it is none.
    static std::optional<double> as_number(std::string_view text);
    /// Value of a child element; nothing where there is none. Throws SceneError: no number, or out of range.
    std::optional<double> number(pugi::xml_node parent, const char* child, double low, double high) const;
    /// Value of a child element that has to be there. Throws SceneError.
    double required(pugi::xml_node parent, const char* child, double low, double high) const;
    static std::string name_of(pugi::xml_node node);
    /// Whether the choice names it, or names none.
    bool is_wanted(const RecoveryDevice& device) const;
    /// Value of a stage's or device's setting in the chosen configuration, else its own.
    pugi::xml_node setting(pugi::xml_node node, const char* list, const char* child) const;
    /// Stages that fall together, by the first of them.
    std::size_t body_of(std::size_t stage) const;
    /// Linear between the rows of the stored flight; `time` [s] in it.
    FlightRow state_at(double time) const;
    // A device in the flown configuration: word of its deploy event, delay [s], altitude above the launch
    // site [m].
    std::string event_of(const RecoveryDevice& device) const;
    double delay_of(const RecoveryDevice& device) const;
    double altitude_of(const RecoveryDevice& device) const;
    // One instance of it: mass [kg], area [m^2] that its drag coefficient is of. "auto" is OpenRocket's own
    // estimate.
    double mass_of(const RecoveryDevice& device) const;
    double area_of(const RecoveryDevice& device) const;
    double drag_coefficient_of(const RecoveryDevice& device) const;
    /// [rad] of the horizontal velocity, from north; nothing where the rows do not tell.
    std::optional<double> heading_at(double time) const;
    /// 8 of file format 1.8; 0 where it is not understood.
    int minor_version() const;
    /// Name of the stage that a device lies in.
    std::string stage_name(const RecoveryDevice& device) const;
    /// Number of the stage whose flight is taken; 0 where none is.
    std::size_t stage_of_branch() const;

    pugi::xml_node root, simulation;
    FlightBranch branch;
    std::vector<RocketStage> stages;
    std::vector<RecoveryDevice> devices;  ///< one or more
    std::vector<std::string> cords;       ///< shock cords, for the list of what is not taken over
    std::vector<std::string> others;      ///< names of the simulations that were not chosen
    std::vector<std::string> notes;       ///< assumptions

private:
    SourcePlace place(std::ptrdiff_t offset) const;
    /// Number of tubes in a cluster, from its name: "single", "double", "3-ring".
    static int tubes_of(pugi::xml_node tube);
    void walk(pugi::xml_node subcomponents, std::size_t stage, int count, int depth);
    void check_names() const;
    void choose_simulation();
    /// Whether a device is of the stage that a stored flight is of, by its name.
    bool falls_in(const RecoveryDevice& device, pugi::xml_node flight) const;
    static bool has_summary(pugi::xml_node one);
    /// The first branch of a simulation in which a wanted device opens.
    pugi::xml_node find_branch(pugi::xml_node one_simulation) const;
    void read_rows();

    std::string_view text_;
    const std::string& file_;
    const ImportChoice& choice_;
    pugi::xml_document document_;
    std::string config_;  ///< flight configuration of the chosen simulation
};

}  // namespace twinchute::exchange
