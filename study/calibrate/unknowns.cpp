#include "study/calibrate/unknowns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "lib/cli/command.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/units.hpp"

namespace twinchute::study {
namespace {

constexpr double longest_offset = 5.0;  // [s] by which a clock may be off where nobody says

/// Bounds of an input by default, assumptions of this toolkit: for n and the initial ratio what handbooks and
/// tests span over all types, for the exponent what a scene may say; for the drag area what tests of one type
/// span about the coefficient in a table, and a margin.
struct DefaultBounds {
    std::string_view path;
    double low, high;
    bool relative;  ///< to the scene's value
};
constexpr DefaultBounds default_bounds[] = {{"parachute.fill_time.n", 0.25, 4.0, true},
                                            {"parachute.drag_area", 0.6, 1.6, true},
                                            {"parachute.initial_drag_area_ratio", 0.001, 0.5, false},
                                            {"parachute.drag_area_exponent", 0.5, 12.0, false}};

/// The row of a key; those of one of several parachutes carry its name.
const Key* varied_row(const Scene& scene, std::string key) {
    for (const Parachute& p : scene.parachutes)
        if (const std::string head = "parachute." + p.name + "."; key.starts_with(head))
            key = "parachute." + key.substr(head.size());
    return find_key(scene_keys(), key);
}

const Parachute& parachute_of(const Scene& scene, const std::string& key) {
    for (const Parachute& p : scene.parachutes)
        if (key.starts_with("parachute." + p.name + ".")) return p;
    return scene.parachutes.back();
}

/// The scene's value of a key [SI].
std::optional<double> value_in(const Scene& scene, const std::string& key, const Key& row) {
    if (row.path == "parachute.drag_area") {
        const Parachute& chute = parachute_of(scene, key);
        return chute.uncorrected_drag_area.value_or(chute.drag_area);
    }
    const auto input = std::ranges::find(scene.inputs, key, &Input::key);
    if (input == scene.inputs.end()) return {};
    const double* number = std::get_if<double>(&input->value);
    return number ? std::optional(*number) : std::nullopt;
}

/// Keys of the parachute that fills last, as far as its scene has them.
std::vector<std::string> default_keys(const Scene& scene) {
    const std::string head = scene.parachutes.size() == 1
                                 ? std::string("parachute.")
                                 : fmt::format("parachute.{}.", scene.parachutes.back().name);
    std::vector<std::string> keys;
    for (const DefaultBounds& one : default_bounds) {
        const std::string key = head + std::string(one.path.substr(std::string_view("parachute.").size()));
        const Parachute& chute = scene.parachutes.back();
        if (one.path == "parachute.initial_drag_area_ratio" &&
            (chute.filling.is_predicted() || chute.drag_area_table))
            continue;
        if (value_in(scene, key, *find_key(scene_keys(), one.path))) keys.push_back(key);
    }
    return keys;
}

[[noreturn]] void refuse_vary(const std::string& key, const std::string& why, const std::string& hint) {
    throw UsageError(fmt::format("--vary {}: cannot be fitted ({}), {}", key, why, hint));
}

std::vector<std::string_view> numeric_keys() {
    std::vector<std::string_view> names{clock_offset};
    for (const Key& row : scene_keys())
        if (row.is_number() && row.kind != KeyKind::integer) names.push_back(row.path);
    return names;
}

FitVariable variable_of(const Scene& scene, const Vary& vary, const Key& row) {
    FitVariable v;
    const auto value = value_in(scene, vary.key, row);
    if (vary.low) {
        v.low = *vary.low, v.high = *vary.high;
        v.start = value.value_or(0.5 * (v.low + v.high));
    } else {
        const auto bounds = std::ranges::find(default_bounds, row.path, &DefaultBounds::path);
        if (!value)
            refuse_vary(vary.key, "the scene does not give it",
                        fmt::format("write --vary {}=LO..HI", vary.key));
        v.start = *value;
        if (bounds != std::end(default_bounds)) {
            v.low = bounds->low * (bounds->relative ? *value : 1.0);
            v.high = bounds->high * (bounds->relative ? *value : 1.0);
        } else if (*value != 0.0) {
            v.low = std::min(0.25 * *value, 4.0 * *value), v.high = std::max(0.25 * *value, 4.0 * *value);
        } else {
            refuse_vary(vary.key, "it is 0 in the scene, which says nothing of its size",
                        fmt::format("write --vary {}=LO..HI", vary.key));
        }
        v.low = std::max(v.low, row.range.low), v.high = std::min(v.high, row.range.high);
        v.start = std::clamp(v.start, v.low, v.high);
    }
    constexpr double margin = 1e-6;  // [-] of the range, where a bound itself is out
    if (v.low == row.range.low && row.range.above_low) v.low = row.range.low + margin * (v.high - v.low);
    if (v.high == row.range.high && row.range.below_high) v.high = row.range.high - margin * (v.high - v.low);
    if (!row.range.contains(v.low) || !row.range.contains(v.high) || !(v.high > v.low))
        refuse_vary(vary.key, fmt::format("{:g}..{:g} is out of its range", v.low, v.high),
                    allowed_text(row));
    if (vary.low && (v.start < v.low || v.start > v.high))
        refuse_vary(vary.key, fmt::format("the scene's {:g} lies outside {:g}..{:g}", v.start, v.low, v.high),
                    "what is found is told and held relative to it: widen the bounds, or set the key");
    v.logarithmic = v.low > 0.0;
    constexpr double share = 1e-3;
    v.step = v.logarithmic ? share : share * std::max(std::abs(v.start), 1e-2 * (v.high - v.low));
    return v;
}

Unknown key_unknown(const Scene& scene, const Vary& vary) {
    const Key* row = varied_row(scene, vary.key);
    if (row == nullptr) {
        const auto names = numeric_keys();
        throw UsageError(fmt::format("--vary {}: unknown key, {}", vary.key, suggest_key(vary.key, names)));
    }
    if (!row->is_number() || row->kind == KeyKind::integer)
        refuse_vary(vary.key, "it is not a quantity", "name a number of the scene");
    if (row->user != KeyUser::both && row->user != KeyUser::rom)
        refuse_vary(vary.key, "the reduced-order model does not use it", "name another key");
    Unknown unknown{Unknown::Kind::key,
                    vary.key,
                    std::string(row->record_unit()),
                    0,
                    0,
                    variable_of(scene, vary, *row),
                    {}};
    return unknown;
}

Unknown clock_unknown(std::size_t test, double low, double high) {
    FitVariable v;
    v.low = low, v.high = high;
    v.start = std::clamp(0.0, low, high);
    v.step = 1e-3;  // [s]
    return {Unknown::Kind::clock, clock_offset, "s", test, 0, v, {}};
}

}  // namespace

Vary read_vary(const std::string& text) {
    const std::size_t equals = text.find('=');
    Vary vary{text.substr(0, equals), {}, {}};
    if (vary.key.empty())
        throw UsageError(
            fmt::format("'--vary {}' is not understood (a key is wanted), e.g. --vary "
                        "parachute.fill_time.n=2..12",
                        text));
    if (equals == text.npos) return vary;
    const std::string range = text.substr(equals + 1);
    const std::size_t dots = range.find("..");
    const auto refuse = [&](const std::string& why) -> UsageError {
        return UsageError(
            fmt::format("'--vary {}' is not understood ({}), e.g. --vary {}=2..12", text, why, vary.key));
    };
    if (dots == range.npos) throw refuse("bounds are written LO..HI");
    const Key* row = find_key(scene_keys(), vary.key);
    const std::string unit(row && !row->unit.empty() ? row->unit : vary.key == clock_offset ? "s" : "1");
    int bare = 0;  // bounds without a unit
    const auto number = [&](std::string word) {
        double value = 0.0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error == std::errc{} && end == word.data() + word.size()) {
            ++bare;
            return value;
        }
        try {
            return to_si(word, unit);
        } catch (const UnitError& problem) {
            throw refuse(fmt::format("{}: {}", word, problem.problem()));
        }
    };
    vary.low = number(range.substr(0, dots));
    vary.high = number(range.substr(dots + 2));
    if (bare == 1) throw refuse("one bound has a unit and the other has none");
    if (!std::isfinite(*vary.low) || !std::isfinite(*vary.high) || !(*vary.high > *vary.low))
        throw refuse("the lower bound comes first");
    return vary;
}

std::vector<Unknown> unknowns_of(const Scene& scene, const std::vector<DropTest>& tests,
                                 const std::vector<Vary>& vary) {
    std::vector<Unknown> unknowns;
    double low = -longest_offset, high = longest_offset;
    std::vector<Vary> asked = vary;
    bool keys_asked = false;
    for (const Vary& one : vary) {
        if (one.key != clock_offset)
            keys_asked = true;
        else if (one.low)
            low = *one.low, high = *one.high;
    }
    if (!keys_asked)
        for (const std::string& key : default_keys(scene))
            asked.push_back({key, {}, {}});
    for (const Vary& one : asked) {
        if (one.key == clock_offset) continue;
        if (std::ranges::find(unknowns, one.key, &Unknown::name) != unknowns.end())
            throw UsageError(fmt::format("--vary {} is given twice (one key, one range), keep one", one.key));
        unknowns.push_back(key_unknown(scene, one));
    }
    if (unknowns.empty())
        throw UsageError(
            fmt::format("{}: there is nothing to fit by default (its filling is no law with a fill "
                        "constant), name keys with --vary",
                        scene.file.string()));
    for (const DropTest& test : tests)
        for (const Prior& prior : test.priors) {
            const auto found = std::ranges::find(unknowns, prior.key, &Unknown::name);
            if (found == unknowns.end())
                throw UsageError(
                    fmt::format("{}: a prior on '{}', which is not fitted (--vary says what is), take it "
                                "out or vary it",
                                test.name, prior.key));
            if (found->prior && (found->prior->mean != prior.mean || found->prior->sigma != prior.sigma))
                throw UsageError(fmt::format(
                    "{}: another prior on '{}' than an earlier test has ({:.6g} +- {:.6g} here, {:.6g} +- "
                    "{:.6g} "
                    "there), give all tests the same, or put one into one of them",
                    test.name, prior.key, prior.mean, prior.sigma, found->prior->mean, found->prior->sigma));
            found->prior = prior;
        }
    for (std::size_t t = 0; t < tests.size(); ++t)
        if (!tests[t].clock_known && !tests[t].histories.empty())
            unknowns.push_back(clock_unknown(t, low, high));
    return unknowns;
}

std::vector<double> probe_of(const std::vector<Unknown>& unknowns) {
    std::vector<double> probe;
    for (const Unknown& unknown : unknowns) {
        if (unknown.kind != Unknown::Kind::key) continue;
        const FitVariable& v = unknown.variable;
        const double start = v.to_scale(v.start), middle = 0.5 * (v.to_scale(v.low) + v.to_scale(v.high));
        probe.push_back(v.from_scale(start + (start < middle ? 0.01 : -0.01) * v.range()));
    }
    return probe;
}

}  // namespace twinchute::study
