// Contents of a campaign file: which inputs vary and how, which runs are made, which questions they answer.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/record/metrics.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "study/campaign/dispersed_wind.hpp"
#include "study/campaign/distribution.hpp"

namespace twinchute::study {

/// An input that varies.
struct CampaignInput {
    std::string key;   ///< of the scene, or one of wind_names
    std::string unit;  ///< SI; empty: a ratio or a word
    KeyKind kind = KeyKind::quantity;
    std::optional<Distribution> distribution = {};  ///< nothing: from a table of points
    int levels = 5;                                 ///< of a grid
    std::vector<Wind> winds = {};                   ///< of "wind.table": those of the distribution's words
    std::optional<GustProcess> gusts = {};          ///< of "wind.gusts", whose values name realisations
    std::string source, grade;

    /// Whether runs can be put in the order of its values: a value of gusts names a realisation, no amount.
    bool is_ordered() const { return distribution && !gusts; }
};

/// Where the runs lie in the space of the inputs.
enum class DesignKind { random, lhs, sobol, grid, saltelli, points };
std::string_view design_name(DesignKind kind);

enum class CampaignFidelity { rom, full, both };
std::string_view fidelity_name(CampaignFidelity fidelity);

/// A question, and its limit: the 95 % interval has to lie below it as a whole.
struct AnswerSpec {
    enum class Kind { probability, quantile, mean, ellipse };
    Kind kind = Kind::mean;
    std::string name;
    std::string metric;                ///< key in a record, e.g. "peak_force_N"; empty of an ellipse
    std::string unit;                  ///< of the metric
    bool above = true;                 ///< probability that the metric is above `threshold`; otherwise below
    double threshold = 0.0;            ///< in the metric's unit
    double level = 0.0;                ///< [-] share of runs below a quantile, or inside an ellipse
    std::optional<double> limit = {};  ///< in the answer's unit
    SourcePlace place = {};
    std::string asked;  ///< as written, e.g. "peak_force > 12 kN"
};

/// Stops a campaign once an interval is narrow enough.
struct StopRule {
    std::string answer;
    double halfwidth = 0.0;  ///< in the answer's unit, or a share of the estimate
    bool relative = false;
};

struct CampaignSpec {
    std::filesystem::path file;
    std::string sha256;  ///< of the file's bytes
    std::string name;
    std::string base;              ///< name of the scene's file
    std::vector<std::string> set;  ///< overrides of it, "key=value"
    std::uint64_t runs = 0;        ///< at most, where `until` stops it
    std::uint64_t seed = 0;
    DesignKind design = DesignKind::random;
    std::string points;                           ///< a CSV file
    std::vector<std::vector<double>> point_rows;  ///< [SI] of it, in the order of the inputs
    CampaignFidelity fidelity = CampaignFidelity::rom;
    int pilot = 20;      ///< full runs from which `both` finds out how many it needs
    int full_runs = 60;  ///< of `both` at most, the pilot's among them
    std::optional<StopRule> until = {};
    bool rare = false;                                        ///< probabilities by subset simulation
    std::optional<std::array<double, 2>> release_point = {};  ///< [rad] latitude and longitude, for maps
    std::vector<CampaignInput> inputs;
    Eigen::MatrixXd correlation;  ///< of the inputs' normal scores
    std::vector<AnswerSpec> answers;
};

/// Throws SceneError with file, line and key.
CampaignSpec read_campaign(const std::filesystem::path& file);
/// `bases`: where the files may lie that it names.
CampaignSpec read_campaign_text(std::string_view text, const std::string& name,
                                const std::filesystem::path& directory, Bases bases = Bases::anywhere);

/// Names of the inputs that act on the wind of the scene: one of several tables takes its place, which is
/// scaled and turned as a whole, then gusts are added.
inline constexpr std::string_view wind_table = "wind.table", wind_scale = "wind.scale",
                                  wind_turn = "wind.turn", wind_gusts = "wind.gusts";
inline constexpr std::array wind_names{wind_table, wind_scale, wind_turn, wind_gusts};

}  // namespace twinchute::study
