#include "study/campaign/read_inputs.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "lib/scene/data_files.hpp"
#include "lib/scene/logged_table.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/soundings.hpp"
#include "lib/scene/units.hpp"

namespace twinchute::study {
namespace {

namespace fs = std::filesystem;
using compare::SuiteTable;

/// Correlations as they were read: of two keys each.
struct Pair {
    std::string one, other;
    double value = 0.0;
};

/// The row of a key, also of one of several parachutes ("parachute.main.mass"); null: there is none.
const Key* row_of_key(const std::string& path) {
    if (const Key* row = find_key(scene_keys(), path)) return row;
    constexpr std::string_view head = "parachute.";
    const std::size_t dot = path.starts_with(head) ? path.find('.', head.size()) : std::string::npos;
    if (dot == std::string::npos) return nullptr;
    return find_key(scene_keys(), std::string(head) + path.substr(dot + 1));
}

CampaignInput input_of(const SuiteTable& reader, std::string_view where, const std::string& key) {
    CampaignInput input;
    input.key = key;
    if (key == wind_scale || key == wind_gusts) return input;
    if (key == wind_turn) return input.unit = "rad", input;
    if (key == wind_table) return input.kind = KeyKind::word, input;
    const Key* row = row_of_key(key);
    if (!row) {
        std::vector<std::string_view> paths(wind_names.begin(), wind_names.end());
        for (const Key& known : scene_keys())
            paths.push_back(known.path);
        reader.refuse(where, fmt::format("'{}' is no key of a scene", key), "", suggest_key(key, paths));
    }
    input.kind = row->kind;
    if (!row->is_number() && row->kind != KeyKind::word && row->kind != KeyKind::quantity_or_word)
        reader.refuse(where, fmt::format("'{}' is neither a number nor one of several words", key), "",
                      "vary a key that is");
    input.unit = row->record_unit();
    return input;
}

/// Numbers of a list, each with a unit or in SI.
std::vector<double> amounts(SuiteTable& reader, std::string_view key, std::string_view unit) {
    reader.need(key, "a list of numbers");
    const toml::array* array = reader.find(key)->as_array();
    if (!array || array->empty()) reader.refuse(key, "a list of numbers belongs here", "", "e.g. [1, 2]");
    std::vector<double> found;
    for (const toml::node& node : *array) {
        const auto words = node.value_exact<std::string>();
        const auto number = node.is_number() ? node.value<double>() : std::nullopt;
        if (!words && !number) reader.refuse(key, "a list of numbers belongs here", "", "e.g. [1, 2]");
        try {
            found.push_back(words ? to_si(*words, unit) : *number);
        } catch (const UnitError& error) {
            reader.refuse(key, error.problem(), error.why(), error.suggestion());
        }
        if (!std::isfinite(found.back())) reader.refuse(key, "is not finite", "", "give numbers");
    }
    return found;
}

double needed(SuiteTable& reader, std::string_view key, std::string_view unit) {
    reader.need(key, "the distribution needs it");
    return *reader.amount(key, unit);
}

/// A standard deviation: an amount, or "10 %" of the mean.
double spread(SuiteTable& reader, std::string_view key, std::string_view unit, double mean) {
    reader.need(key, "the distribution needs it");
    const Tolerance sd = *reader.tolerance(key, unit);
    const double value = sd.relative ? sd.value * std::abs(mean) : sd.value;
    if (!(value > 0.0)) reader.refuse(key, "is not positive", "", "a fixed input belongs to the scene");
    return value;
}

Distribution read_lognormal(SuiteTable& reader, const std::string& unit) {
    const bool by_median = reader.find("median") != nullptr;
    const char* place = by_median ? "median" : "mean";
    const double middle = needed(reader, place, unit);
    if (!(middle > 0.0)) reader.refuse(place, "is not positive", "", "a lognormal has positive values alone");
    if (!by_median) return Distribution::lognormal(middle, spread(reader, "sd", unit, middle));
    const double log_sd = needed(reader, "log_sd", "1");
    if (!(log_sd > 0.0)) reader.refuse("log_sd", "is not positive", "", "a fixed input belongs to the scene");
    return Distribution::lognormal_by_median(middle, log_sd);
}

Distribution read_range(SuiteTable& reader, const std::string& unit, bool triangular) {
    const double low = needed(reader, "low", unit), high = needed(reader, "high", unit);
    if (!(low < high)) reader.refuse("high", "is not above low", "", "give low < high");
    if (!triangular) return Distribution::uniform(low, high);
    const double mode = needed(reader, "mode", unit);
    if (!(low <= mode && mode <= high)) reader.refuse("mode", "is not between low and high", "", "");
    return Distribution::triangular(low, mode, high);
}

std::vector<double> weights_of(SuiteTable& reader, std::size_t count) {
    if (!reader.find("weights")) return std::vector<double>(count, 1.0);
    const std::vector<double> weights = amounts(reader, "weights", "1");
    if (weights.size() != count)
        reader.refuse("weights", fmt::format("{} for {} values", weights.size(), count), "", "one a value");
    if (!std::ranges::all_of(weights, [](double w) { return w > 0.0; }))
        reader.refuse("weights", "are not all positive", "", "leave out values that never occur");
    return weights;
}

Distribution read_discrete(SuiteTable& reader, const CampaignInput& input) {
    if (input.kind != KeyKind::word && input.kind != KeyKind::quantity_or_word) {
        std::vector<double> values = amounts(reader, "values", input.unit.empty() ? "1" : input.unit);
        const auto weights = weights_of(reader, values.size());
        return Distribution::discrete(std::move(values), weights);
    }
    std::vector<std::string> words = reader.texts("values");
    if (words.empty())
        reader.refuse("values", "is missing", "which words there are", "values = [\"a\", \"b\"]");
    const auto weights = weights_of(reader, words.size());
    return Distribution::discrete(std::move(words), weights);
}

Distribution read_table(SuiteTable& reader, const std::string& unit) {
    std::vector<double> values = amounts(reader, "values", unit), below = amounts(reader, "below", "1");
    const auto rises = [](const std::vector<double>& list) {
        return std::ranges::adjacent_find(list, [](double a, double b) { return !(a < b); }) == list.end();
    };
    if (values.size() < 2 || values.size() != below.size())
        reader.refuse("below", fmt::format("{} shares for {} values", below.size(), values.size()), "",
                      "give as many of both, two or more");
    if (!rises(values)) reader.refuse("values", "do not rise", "", "sort them");
    if (!rises(below) || below.front() != 0.0 || below.back() != 1.0)
        reader.refuse("below", "do not rise from 0 to 1", "they are the shares below each value", "");
    return Distribution::table(std::move(values), std::move(below));
}

Distribution read_kind(SuiteTable& vary, SuiteTable& dist, const CampaignInput& input) {
    constexpr std::array kinds{"normal", "lognormal", "uniform", "triangular", "discrete", "table"};
    std::vector<std::string_view> given;
    for (const char* kind : kinds)
        if (dist.find(kind)) given.push_back(kind);
    if (given.size() != 1)
        vary.refuse("dist", given.empty() ? "no distribution" : "two distributions", "",
                    fmt::format("give one of {}", joined({kinds.begin(), kinds.end()})));
    const std::string_view kind = given.front();
    SuiteTable reader(*dist.table(kind), dist.file(), fmt::format("vary.dist.{}", kind));
    const bool words = input.kind == KeyKind::word;
    if (words && kind != "discrete")
        dist.refuse(kind, fmt::format("'{}' is one of several words", input.key), "", "write discrete = ...");
    const std::string unit = input.unit.empty() ? "1" : input.unit;
    const auto read = [&]() -> Distribution {
        if (kind == "normal") {
            const double mean = needed(reader, "mean", unit);
            return Distribution::normal(mean, spread(reader, "sd", unit, mean));
        }
        if (kind == "lognormal") return read_lognormal(reader, unit);
        if (kind == "discrete") return read_discrete(reader, input);
        if (kind == "table") return read_table(reader, unit);
        return read_range(reader, unit, kind == "triangular");
    };
    Distribution found = read();
    reader.end();
    return found;
}

Distribution read_distribution(SuiteTable& vary, const CampaignInput& input) {
    SuiteTable dist(*vary.table("dist"), vary.file(), "vary.dist");
    Distribution found = read_kind(vary, dist, input);
    const std::string unit = input.unit.empty() ? "1" : input.unit;
    const auto low = dist.amount("min", unit), high = dist.amount("max", unit);
    dist.end();
    if (!low && !high) return found;
    const char* key = low ? "min" : "max";
    if (found.kind() == Distribution::Kind::discrete)
        dist.refuse(key, "does not go with discrete values", "", "leave values out of the list");
    if (!found.cut(low.value_or(-std::numeric_limits<double>::infinity()),
                   high.value_or(std::numeric_limits<double>::infinity())))
        dist.refuse(key, "leaves nothing of the distribution", "", "give min < max around it");
    return found;
}

/// Several inputs by mean and covariance.
void read_joint(SuiteTable& vary, CampaignSpec& spec, std::vector<Pair>& pairs) {
    const std::vector<std::string> keys = vary.texts("keys");
    if (keys.size() < 2) vary.refuse("keys", "two or more belong here", "one has no covariance", "write key");
    const std::vector<double> mean = [&] {
        vary.need("mean", "of each of the keys");
        std::vector<double> all;
        const toml::array* array = vary.find("mean")->as_array();
        if (!array || array->size() != keys.size())
            vary.refuse("mean", fmt::format("{} numbers belong here", keys.size()), "", "one a key, in SI");
        for (const toml::node& node : *array)
            all.push_back(node.is_number() ? *node.value<double>() : NAN);
        return all;
    }();
    vary.need("covariance", "how they vary together");
    const toml::array* rows = vary.find("covariance")->as_array();
    const auto n = static_cast<Eigen::Index>(keys.size());
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j) {
            const toml::array* row = rows && rows->size() == keys.size() ? (*rows)[i].as_array() : nullptr;
            const bool has = row && row->size() == keys.size() && (*row)[j].is_number();
            if (!has || !std::isfinite(mean[i]))
                vary.refuse("covariance", fmt::format("{0} rows of {0} numbers belong here", keys.size()),
                            "in SI, as are the means", "");
            covariance(i, j) = *(*row)[j].value<double>();
        }
    if (!covariance.isApprox(covariance.transpose(), 1e-12) || !(covariance.diagonal().minCoeff() > 0.0))
        vary.refuse("covariance", "is not symmetric with positive variances", "", "correct it");
    for (Eigen::Index i = 0; i < n; ++i) {
        CampaignInput& input = spec.inputs.emplace_back(input_of(vary, "keys", keys[i]));
        input.distribution = Distribution::normal(mean[i], std::sqrt(covariance(i, i)));
        for (Eigen::Index j = 0; j < i; ++j)
            if (covariance(i, j) != 0.0)
                pairs.push_back(
                    {keys[i], keys[j], covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j))});
    }
}

/// Calibrated inputs of a scene, about its values with the covariance of its `uncertainty`.
void read_calibrated(SuiteTable& vary, const NamedFiles& files, CampaignSpec& spec,
                     std::vector<Pair>& pairs) {
    const std::string named = vary.text("calibrated");
    const fs::path file = files.at(named, vary.place("calibrated"), vary.path_of("calibrated"));
    const std::vector<std::string> wanted = vary.texts("keys");
    const Scene scene =
        read_scene_text(read_text_file(file), file.string(), file.parent_path(), {}, files.bases);
    if (!scene.uncertainty)
        vary.refuse("calibrated", fmt::format("'{}' has no uncertainty", named),
                    "`twinchute calibrate` writes it to the scene that it calibrates to tests",
                    "name its calibrated.toml");
    const Uncertainty& known = *scene.uncertainty;
    const auto covariance = [&](std::size_t i, std::size_t j) {
        return known.covariance[i * (i + 1) / 2 + j];
    };
    std::vector<std::pair<std::size_t, std::string>> taken;
    for (std::size_t i = 0; i < known.inputs.size(); ++i) {
        const bool logarithmic = known.inputs[i].starts_with("ln ");
        const std::string key = logarithmic ? known.inputs[i].substr(3) : known.inputs[i];
        if (!wanted.empty() && std::ranges::count(wanted, key) == 0) continue;
        const auto value = std::ranges::find(scene.inputs, key, &Input::key);
        const double* middle = value == scene.inputs.end() ? nullptr : std::get_if<double>(&value->value);
        if (middle == nullptr || (logarithmic && !(*middle > 0.0)))
            vary.refuse("calibrated", fmt::format("'{}' does not give {}", named, key), "", "give it there");
        CampaignInput& input = spec.inputs.emplace_back(input_of(vary, "calibrated", key));
        const double sd = std::sqrt(covariance(i, i));
        input.distribution =
            logarithmic ? Distribution::lognormal_by_median(*middle, sd) : Distribution::normal(*middle, sd);
        const KeyRange& range = row_of_key(key)->range;
        input.distribution->cut(range.low, range.high);
        input.source = value->source;
        for (const auto& [j, other] : taken)
            pairs.push_back({key, other, covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j))});
        taken.emplace_back(i, key);
    }
    for (const std::string& key : wanted)
        if (std::ranges::find(taken, key, &std::pair<std::size_t, std::string>::second) == taken.end())
            vary.refuse("keys", fmt::format("'{}' is not known there", key), "", "leave it out");
}

Vec3 three(SuiteTable& vary, std::string_view key, std::string_view unit) {
    const std::vector<double> all = amounts(vary, key, unit);
    if (all.size() != 3)
        vary.refuse(key, fmt::format("{} numbers", all.size()), "", "give those of east, north and up");
    return {all[0], all[1], all[2]};
}

/// Each run has gusts of its own: the number that names them is spread over the interval from 0 to 1.
void read_gusts(SuiteTable& vary, CampaignInput& input) {
    const Vec3 sd = three(vary, "sd", "m/s"), length = three(vary, "correlation_length", "m");
    if (!(sd.minCoeff() >= 0.0 && sd.maxCoeff() > 0.0))
        vary.refuse("sd", "is negative, or zero of all three", "", "e.g. [\"2 m/s\", \"2 m/s\", 0]");
    if (!(length.minCoeff() >= 1.0))
        vary.refuse("correlation_length", "is below 1 m", "gusts as small as that are no wind", "");
    input.gusts = GustProcess{sd, length};
    input.distribution = Distribution::uniform(0.0, 1.0);
}

void read_winds(SuiteTable& vary, const NamedFiles& files, CampaignInput& input) {
    for (const std::string& word : input.distribution->words()) {
        const fs::path file = files.at(word, vary.place("dist"), vary.path_of("dist"));
        std::error_code ignored;
        if (!fs::exists(file, ignored))
            vary.refuse("dist", fmt::format("there is no file '{}'", file.string()), "",
                        "name tables beside the campaign file");
        input.winds.push_back(read_wind_table(read_text_file(file), file.string(), word));
    }
}

void read_one(SuiteTable& vary, const NamedFiles& files, CampaignSpec& spec) {
    const std::string key = vary.needed_text("key", "which input varies");
    CampaignInput& input = spec.inputs.emplace_back(input_of(vary, "key", key));
    if (key == wind_gusts) return read_gusts(vary, input);
    if (vary.find("dist")) input.distribution = read_distribution(vary, input);
    if (key == wind_table && input.distribution) read_winds(vary, files, input);
    input.levels = vary.count("levels", input.levels, 10'000);
}

void read_pairs(SuiteTable& top, std::vector<Pair>& pairs) {
    for (SuiteTable& reader : top.list("correlation")) {
        const std::vector<std::string> keys = reader.texts("between");
        if (keys.size() != 2)
            reader.refuse("between", "two keys belong here", "", "between = [\"a\", \"b\"]");
        const double value = needed(reader, "value", "1");
        if (!(std::abs(value) < 1.0)) reader.refuse("value", "is not between -1 and 1", "", "");
        reader.end();
        pairs.push_back({keys[0], keys[1], value});
    }
}

void correlate(SuiteTable& top, CampaignSpec& spec, const std::vector<Pair>& pairs) {
    const auto n = static_cast<Eigen::Index>(spec.inputs.size());
    spec.correlation = Eigen::MatrixXd::Identity(n, n);
    const auto index = [&](const std::string& key) {
        const auto found = std::ranges::find(spec.inputs, key, &CampaignInput::key);
        if (found == spec.inputs.end())
            top.refuse("correlation", fmt::format("'{}' does not vary", key), "", "name keys of [[vary]]");
        return found - spec.inputs.begin();
    };
    std::set<std::pair<Eigen::Index, Eigen::Index>> told;
    for (const Pair& pair : pairs) {
        const Eigen::Index i = index(pair.one), j = index(pair.other);
        if (i == j) top.refuse("correlation", fmt::format("'{}' with itself", pair.one), "", "name two keys");
        if (!told.insert(std::minmax(i, j)).second)
            top.refuse("correlation", fmt::format("'{}' with '{}' is given twice", pair.one, pair.other), "",
                       "leave out one of them");
        spec.correlation(i, j) = spec.correlation(j, i) = pair.value;
    }
    if (Eigen::LLT<Eigen::MatrixXd>(spec.correlation).info() != Eigen::Success)
        top.refuse("correlation", "is not positive definite", "no inputs can go together in this way",
                   "correct the correlations or the covariance");
}

void read_points(const NamedFiles& files, CampaignSpec& spec) {
    const fs::path file = files.at(spec.points, {spec.file.string(), 1, 1}, "campaign.design");
    const LoggedTable table = read_logged_table(read_text_file(file), file.string());
    for (const CampaignInput& input : spec.inputs) {
        if (input.key == wind_table)
            throw SceneError({spec.file.string(), 1, 1}, input.key, "does not go with a table of points",
                             "its cells are numbers", "choose another design");
        const LoggedColumn* column = table.find(input.key);
        if (!column)
            throw SceneError({file.string(), table.head_line, 1}, input.key, "has no column", "it varies",
                             "name a column by its key");
        std::vector<std::vector<double>>& rows = spec.point_rows;
        rows.resize(column->values.size());
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const SourcePlace place{file.string(), table.lines[i], column->column};
            if (!column->values[i])
                throw SceneError(place, input.key, "an empty cell", "each point has all inputs",
                                 "fill it in");
            const double value = *column->values[i];
            try {
                rows[i].push_back(column->unit.empty() ? value
                                                       : to_si(fmt::format("{} {}", value, column->unit),
                                                               input.unit.empty() ? "1" : input.unit));
            } catch (const UnitError& error) {
                throw SceneError({file.string(), column->unit_line, column->unit_column}, input.key,
                                 error.problem(), error.why(), error.suggestion());
            }
            if (input.kind == KeyKind::integer && std::nearbyint(rows[i].back()) != rows[i].back())
                throw SceneError(place, input.key, fmt::format("{:g} is no whole number", rows[i].back()),
                                 "the key counts", "round it");
        }
    }
    for (const LoggedColumn& column : table.columns) {
        const bool is_input = std::ranges::count(spec.inputs, column.name, &CampaignInput::key) > 0;
        if (!is_input && find_key(scene_keys(), column.name) != nullptr)
            throw SceneError({file.string(), table.head_line, column.column}, column.name, "is not varied",
                             "its numbers would not count", "add [[vary]] for it, or take the column out");
    }
    spec.runs = spec.point_rows.size();
}

}  // namespace

fs::path NamedFiles::at(const std::string& name, const SourcePlace& place, std::string_view key) const {
    if (bases == Bases::beneath && !is_data_name(name))
        throw SceneError(place, std::string(key), fmt::format("'{}' leaves the directory of the scene", name),
                         "this campaign may name files beneath it alone", "copy the file there");
    return fs::path(name).is_absolute() ? fs::path(name) : directory / name;
}

void read_inputs(SuiteTable& top, const NamedFiles& files, CampaignSpec& spec) {
    std::vector<Pair> pairs;
    top.need("vary", "which inputs vary");
    for (SuiteTable& vary : top.list("vary")) {
        const std::size_t before = spec.inputs.size();
        if (vary.find("calibrated"))
            read_calibrated(vary, files, spec, pairs);
        else if (vary.find("keys"))
            read_joint(vary, spec, pairs);
        else
            read_one(vary, files, spec);
        const std::string source = vary.text("source"), grade = vary.text("grade");
        for (std::size_t i = before; i < spec.inputs.size(); ++i) {
            CampaignInput& input = spec.inputs[i];
            if (!source.empty()) input.source = source;
            input.grade = grade;
            const auto same = [&](const CampaignInput& other) { return other.key == input.key; };
            if (std::ranges::count_if(spec.inputs, same) > 1)
                vary.refuse("key", fmt::format("'{}' varies twice", input.key), "", "name each key once");
        }
        vary.end();
    }
    read_pairs(top, pairs);
    correlate(top, spec, pairs);
}

void finish_inputs(const NamedFiles& files, CampaignSpec& spec) {
    if (spec.design == DesignKind::points) return read_points(files, spec);
    for (const CampaignInput& input : spec.inputs)
        if (!input.distribution)
            throw SceneError({spec.file.string(), 1, 1}, "vary.dist",
                             fmt::format("of '{}' is missing", input.key), "points.csv alone does without",
                             "add e.g. dist = { normal = { mean = 4, sd = 0.4 } }");
    if (spec.design != DesignKind::grid) return;
    double runs = 1.0;
    for (const CampaignInput& input : spec.inputs)
        runs *= input.levels;
    if (runs > 1e9)
        throw SceneError({spec.file.string(), 1, 1}, "campaign.design",
                         fmt::format("a grid of {:g} points", runs), "",
                         "give fewer levels, or choose sobol");
    spec.runs = static_cast<std::uint64_t>(runs);
}

}  // namespace twinchute::study
