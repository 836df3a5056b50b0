// Drops that nobody chose, by both models: how each ends, and whether the descent rate that a run gives is
// the one that the same run comes to when it is flown on. docs/verification.md says what is asked and how one
// of them is run again.
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "fullsim/fidelity.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/write_scene.hpp"
#include "rom/fidelity.hpp"
#include "tests/support/predicted.hpp"
#include "tests/support/random_drops.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute::test {
namespace {

constexpr int drops = 300, shards = 6;
constexpr double flown_on = 60.0;           // [s] after the end of a run
constexpr double largest_error = 0.005;     // of a descent rate
constexpr double largest_residual = 0.005;  // of the energy that changed hands; a run may have 0.002
constexpr double share_of_failures = 0.05, share_without_rate = 0.05;
// Air that grows denser below brakes: by v/(4 g H) v, 1 % at 60 m/s; a swing takes s^2/(8 v^2). A canopy that
// did not open, or fell in, is off by far more.
constexpr double off_balance = 0.02;

std::string from_environment(const char* name, const char* otherwise) {
    const char* value = std::getenv(name);
    return value ? value : otherwise;
}

std::uint64_t battery_seed() {
    return std::stoull(from_environment("TWINCHUTE_DROPS_SEED", "1"));
}

/// Mean descent [m/s] between two times, each part of it as it would be in air of density `rho`. Under a Hann
/// window: of an oscillation with n periods between the two it leaves less than 1/n^3, wherever they begin.
double mean_descent(const RunRecord& record, const Atmosphere& air, double rho, double from, double to) {
    const auto& time = record.find_channel("time")->values;
    const auto& altitude = record.find_channel("altitude")->values;
    double way = 0.0, weights = 0.0;
    for (std::size_t i = 1; i < time.size(); ++i) {
        const double middle = 0.5 * (time[i - 1] + time[i]);
        if (time[i - 1] < from || time[i] > to) continue;
        const double wave = std::sin(pi * (middle - from) / (to - from)), weight = wave * wave;
        const double density = air.at(0.5 * (altitude[i - 1] + altitude[i])).density;
        way += weight * (altitude[i - 1] - altitude[i]) * std::sqrt(density / rho);
        weights += weight * (time[i] - time[i - 1]);
    }
    return way / weights;
}

/// [m/s] at which drag and weight balance, of all that stays with the payload.
double balanced_speed(const Scene& scene, double rho) {
    double drag_area = scene.payload.drag_area.value_or(0.0), mass = scene.payload.mass;
    for (const Parachute& chute : scene.parachutes) {
        if (chute.cut) continue;
        drag_area += chute.count * chute.cluster_drag_ratio * chute.drag_area;
        mass += chute.count * chute.mass;
    }
    return std::sqrt(2.0 * mass * scene.environment.gravity / (rho * drag_area));
}

/// Share of what changed hands, from the lines of the ledger themselves.
double energy_residual(const EnergyLedger& e, double kinetic_start) {
    const double left = e.kinetic + e.elastic - e.gravity_work - e.drag_work + e.damping - e.added_mass -
                        e.ramp - e.external_work;
    return left /
           (kinetic_start + std::abs(e.gravity_work) + std::abs(e.drag_work) + std::abs(e.external_work));
}

/// Whether a run names a remedy for its end: in its own sentence, as a key of the scene, or beside a warning
/// that says what the run has not come to ("no descent rate", "no snatch").
bool names_remedy(const RunRecord& record) {
    const std::string& detail = record.status.detail;
    return std::ranges::any_of(
               record.warnings,
               [](const Warning& w) { return w.what.starts_with("no ") && !w.suggestion.empty(); }) ||
           std::ranges::any_of(scene_keys(), [&](const Key& key) {
               return key.path.find('.') != key.path.npos && detail.find(key.path) != detail.npos;
           });
}

/// Mean [(m^3/kg)^1/2] of 1/sqrt(rho) over the time that the descent rate of a record is the mean of, which
/// stands in its note; the last second where it does not.
double lightness_of_claim(const RunRecord& record, const Atmosphere& air) {
    const auto& time = record.find_channel("time")->values;
    const auto& altitude = record.find_channel("altitude")->values;
    double from = time.back() - 1.0, to = time.back();
    const std::string& note = record.find_metric("descent_rate_m_s")->note;
    if (const auto at = note.find("mean from "); at != note.npos)
        std::sscanf(note.c_str() + at, "mean from %lf to %lf", &from, &to);
    double sum = 0.0, all = 0.0;
    for (std::size_t i = 1; i < time.size(); ++i) {
        const double part = std::min(to, time[i]) - std::max(from, time[i - 1]);
        if (!(part > 0.0)) continue;
        sum += part / std::sqrt(air.at(0.5 * (altitude[i - 1] + altitude[i])).density);
        all += part;
    }
    return sum / all;
}

struct Verdict {
    std::string ending;               ///< the status, or in which way there was no rate to judge
    std::string detail;               ///< of the status
    std::vector<std::string> faults;  ///< none: nothing silent
    bool unfinished = false;
    double claim = 0.0, truth = 0.0, first_half = 0.0;  ///< [m/s]; first_half: of what was flown on
    double balance = 0.0;                               ///< [m/s]
    double end = 0.0, flown_to = 0.0;                   ///< [s]
    double residual = 0.0, cpu = 0.0;
};

void look_for_bad_numbers(const RunRecord& record, Verdict& v) {
    for (const Metric& metric : record.metrics)
        if (!std::isfinite(metric.value)) v.faults.push_back(metric.key + " is not finite");
    for (const Channel& channel : record.channels)
        if (!std::ranges::all_of(channel.values, [](double x) { return std::isfinite(x); }))
            v.faults.push_back("channel " + channel.name + " is not finite");
    for (const Event& event : record.events)
        if (!std::isfinite(event.time + event.altitude + event.speed))
            v.faults.push_back("event " + event.name + " is not finite");
}

/// Checks that hold for every run that ended, whether it became steady or not.
void look_at_end(const Scene& scene, const RunRecord& record, Verdict& v) {
    const auto raw = record.metric("peak_force_raw_N"), filtered = record.metric("peak_force_N");
    if (raw && filtered && !(*raw >= *filtered * (1.0 - 1e-12)))
        v.faults.push_back(
            fmt::format("raw peak {:.6g} N below the filtered one, {:.6g} N", *raw, *filtered));
    if (!record.energy) return;
    const double speed = scene.release.speed;
    v.residual = energy_residual(*record.energy, 0.5 * scene.payload.mass * speed * speed);
    if (!(std::abs(v.residual) < largest_residual))
        v.faults.push_back(fmt::format("energy residual {:.2g}", v.residual));
}

/// Repeats a run that ends later and is otherwise equal; the truth is its late flight.
void fly_on(const Scene& scene, const RandomDrop& drop, const Fidelity& model, const RunRecord& record,
            Verdict& v) {
    Scene longer = scene;
    longer.stop = {Trigger::Kind::time, v.end + flown_on, 0.0};
    Run run;
    const RunRecord on = model.run(longer, run);
    v.cpu += on.cost.cpu_s;
    v.flown_to = on.find_channel("time")->values.back();
    if (is_numerical_failure(on.status.code)) v.faults.push_back("flown on: " + on.status.detail);
    const Atmosphere& air = scene.environment.atmosphere;
    const double lightness = lightness_of_claim(record, air), rho = 1.0 / (lightness * lightness);
    // Half of it, or as many swings as average out, the speed's own decay, v/(2 g), aside.
    const double fall_time = v.claim / scene.environment.gravity;
    const double window = std::max({10.0, 4.0 * drop.swing, 4.0 * fall_time});
    const double half = 0.5 * (v.end + v.flown_to);
    v.truth = mean_descent(on, air, rho, std::max(v.end, std::min(half, v.flown_to - window)), v.flown_to);
    v.first_half = mean_descent(on, air, rho, v.end, half);
    v.balance = balanced_speed(scene, rho);
    // One body neither swings nor bounces.
    const bool swings = model.name == "full";
    if (v.flown_to - v.end < (swings ? 2.0 * drop.swing : 0.0) + 2.0 * fall_time) {
        v.ending = "too near the ground to judge";
        return;
    }
    if (const double error = v.claim / v.truth - 1.0; !(std::abs(error) <= largest_error))
        v.faults.push_back(fmt::format("descent rate {:.4f} m/s, flown on {:.4f} m/s: {:+.2f} %", v.claim,
                                       v.truth, 100.0 * error));
    // A leak that leaves an open canopy less than its drag area is said.
    const bool said = std::ranges::any_of(
        record.warnings, [](const Warning& w) { return w.what.starts_with("the open canopy drags with"); });
    if (!said && !(std::abs(v.truth / v.balance - 1.0) < off_balance))
        v.faults.push_back(
            fmt::format("it falls at {:.4f} m/s, open it would at {:.4f} m/s", v.truth, v.balance));
}

Verdict judge(const Scene& scene, const RandomDrop& drop, const Fidelity& model) {
    Run run;
    const RunRecord record = model.run(scene, run);
    Verdict v;
    v.ending = status_name(record.status.code);
    v.detail = record.status.detail;
    v.cpu = record.cost.cpu_s;
    v.end = record.find_channel("time")->values.back();
    v.unfinished =
        record.status.code != StatusCode::completed && record.status.code != StatusCode::stopped_by_event;
    look_for_bad_numbers(record, v);
    if (v.detail.empty()) v.faults.emplace_back("no reason");
    if (!v.unfinished) look_at_end(scene, record, v);
    const auto claim = record.metric("descent_rate_m_s");
    if (claim && !v.unfinished) {
        v.claim = *claim;
        fly_on(scene, drop, model, record, v);
        return v;
    }
    if (!v.unfinished) v.ending = "not steady";
    if (record.status.code == StatusCode::completed)
        v.faults.emplace_back("completed without a descent rate");
    if (!names_remedy(record)) v.faults.emplace_back("no remedy");
    return v;
}

/// Writes a drop to be run again; the file.
std::filesystem::path keep_drop(const RandomDrop& drop, std::string_view model, std::uint64_t seed,
                                int number, const Verdict& v, const std::string& faults) {
    const auto directory =
        std::filesystem::absolute(from_environment("TWINCHUTE_DROPS_DIR", "random-drops")) / model;
    write_drop_data(directory);
    std::string ending = v.ending;
    std::ranges::replace(ending, ' ', '_');
    const auto file = directory / fmt::format("{}-{}-{}.toml", seed, number, ending);
    std::ofstream(file) << fmt::format("# {}\n# {}\n# {}\n", drop.kind, faults, v.detail) << drop.text;
    return file;
}

/// One drop of the battery, read.
struct Drawn {
    RandomDrop drop;
    Scene scene;
};

class RandomDrops : public testing::Test {
protected:
    RandomDrops() { write_drop_data(here_.path()); }
    Drawn draw(const Fidelity& model, int number) const {
        const RandomDrop drop = DropGenerator(seed_, number, model.name == "full").drop();
        const Scene scene = read_scene_text(drop.text, fmt::format("drop {}", number), here_.path());
        EXPECT_TRUE(model.unsupported_keys(scene).empty()) << drop.text;
        return {drop, scene};
    }

    /// Every one of a range: nothing that it says may be wrong.
    void judge_all(const Fidelity& model, int from, int to) const {
        for (int number = from; number < to; ++number) {
            const auto [drop, scene] = draw(model, number);
            const Verdict v = judge(scene, drop, model);
            const std::string faults = fmt::format("{}", fmt::join(v.faults, "; "));
            fmt::print(
                "DROP|{}|{}|{}|{}|{}|{:.3g}|{:.3g}|{:.4f}|{:.4f}|{:.4f}|{:.2f}|{:.2f}|{:.2g}|{:.2f}|{}|{}|{:."
                "4f}\n",
                model.name, seed_, number, drop.kind, v.ending, scene.parachutes.back().nominal_diameter,
                drop.terminal_speed, v.claim, v.truth, v.first_half, v.end, v.flown_to, v.residual, v.cpu,
                faults, v.detail, v.balance);
            std::fflush(stdout);
            if (faults.empty() && !v.unfinished) continue;
            const auto file = keep_drop(drop, model.name, seed_, number, v, faults);
            EXPECT_TRUE(v.faults.empty()) << "drop " << number << " (" << drop.kind << "): " << faults
                                          << "\n  twinchute " << model.name << ' ' << file.string();
        }
    }

    /// All of them, once: few fail, and few that have room for it come to no rate.
    void count_ends(const Fidelity& model) const {
        int failures = 0, without_rate = 0;
        for (int number = 0; number < drops; ++number) {
            const auto [drop, scene] = draw(model, number);
            twinchute::Run run;
            const RunRecord record = model.run(scene, run);
            const bool ended = record.status.code == StatusCode::completed ||
                               record.status.code == StatusCode::stopped_by_event;
            failures += !ended;
            without_rate += ended && !drop.too_low && !record.metric("descent_rate_m_s");
        }
        fmt::print("ENDS|{}|{}|{} fail|{} without a rate\n", model.name, seed_, failures, without_rate);
        EXPECT_LE(failures, share_of_failures * drops);
        EXPECT_LE(without_rate, share_without_rate * drops);
    }

    const std::uint64_t seed_ = battery_seed();
    ScratchDir here_;
};

TEST_F(RandomDrops, AlmostAllRomRunsEnd) {
    count_ends(rom::rom_fidelity());
}
TEST_F(RandomDrops, AlmostAllFullRunsEnd) {
    count_ends(fullsim::full_fidelity());
}
TEST_F(RandomDrops, RomEndsAsItSays) {
    judge_all(rom::rom_fidelity(), 0, drops);
}

class RandomDropsShard : public RandomDrops, public testing::WithParamInterface<int> {};

TEST_P(RandomDropsShard, FullEndsAsItSays) {
    const int each = drops / shards;
    judge_all(fullsim::full_fidelity(), GetParam() * each, (GetParam() + 1) * each);
}
INSTANTIATE_TEST_SUITE_P(Of6, RandomDropsShard, testing::Range(0, shards));

/// The drop with a filling that is predicted, from a mouth and through a fabric that its number draws;
/// nothing of one that starts open.
bool predict_filling(Scene& scene, int number) {
    Parachute& chute = scene.parachutes.front();
    if (scene.parachutes.size() > 1 || chute.deploy.by == DeployBy::inflated || chute.drag_area_mach_table)
        return false;
    scene = test::predicted(std::move(scene), std::pow(10.0, -2.7 + 1.3 * std::fmod(0.618 * number, 1.0)));
    // A pack that goes through itself is not_opened by name; the time is better spent on other drops.
    if (scene.parachutes.front().deploy.starts_packed()) scene.full.mesh.gore_rows /= 2;
    scene.parachutes.front().permeability = 1.5 * std::pow(std::fmod(0.414 * number, 1.0), 2);
    return true;
}

class RandomPredictions : public RandomDrops {
protected:
    /// Every one of 400, or every so many of them, ends in a named status, and nothing of it is silently
    /// wrong.
    void judge_predictions(const Fidelity& model, int first = 0, int every = 1) const {
        std::map<std::string, int> endings;
        for (int number = 0, found = 0; found < 400; ++number) {
            auto [drop, scene] = draw(model, number);
            if (!predict_filling(scene, number)) continue;
            if (found++ % every != first) continue;
            const Verdict v = judge(scene, drop, model);
            const std::string faults = fmt::format("{}", fmt::join(v.faults, "; "));
            ++endings[v.ending];
            fmt::print("PREDICTED|{}|{}|{}|{}|{:.3g}|{:.4f}|{:.4f}|{:.4f}|{:.2g}|{:.2f}|{}|{}\n", model.name,
                       number, drop.kind, v.ending, scene.parachutes.front().filling.initial_mouth, v.claim,
                       v.truth, v.balance, v.residual, v.cpu, faults, v.detail);
            std::fflush(stdout);
            if (v.faults.empty()) continue;
            drop.text = write_scene(scene);
            const auto file = keep_drop(drop, model.name, seed_, number, v, faults);
            ADD_FAILURE() << "drop " << number << " (" << drop.kind << "): " << faults << "\n  twinchute "
                          << model.name << ' ' << file.string();
        }
        for (const auto& [ending, count] : endings)
            fmt::print("PREDICTED ENDS|{}|{}|{}\n", model.name, ending, count);
    }
};

TEST_F(RandomPredictions, OfTheRomEndAsTheySay) {
    judge_predictions(rom::rom_fidelity());
}

class RandomPredictionsShard : public RandomPredictions, public testing::WithParamInterface<int> {};

TEST_P(RandomPredictionsShard, OfTheFullModelEndAsTheySay) {
    judge_predictions(fullsim::full_fidelity(), GetParam(), shards);
}
INSTANTIATE_TEST_SUITE_P(Of6, RandomPredictionsShard, testing::Range(0, shards));

/// Noise stands for what nobody knows of a pack: which of many a run got must not decide whether there is an
/// answer. Some packed drops, each with 16 seeds of its noise and again with a tenth of it. That a canopy
/// tears is an answer, as long as the energy adds up, which is looked at first: a pack that hangs on for ten
/// seconds or twenty meets its opening at other speeds.
TEST_F(RandomDrops, NoiseDecidesNothing) {
    constexpr int wanted = 8, seeds = 16;
    int found = 0;
    for (int number = 0; found < wanted && number < drops; ++number) {
        auto [drop, scene] = draw(fullsim::full_fidelity(), number);
        if (!scene.parachutes.front().deploy.starts_packed() || drop.too_low) continue;
        ++found;
        const Noise given = *scene.full.noise;
        std::map<std::string, std::vector<std::string>> endings;  // by whether there is an answer
        int torn = 0;
        for (int i = 0; i < 2 * seeds; ++i) {
            scene.full.noise = Noise{i < seeds ? given.amplitude : 0.1 * given.amplitude,
                                     static_cast<std::uint64_t>(i % seeds + 1)};
            twinchute::Run run;
            const RunRecord record = fullsim::full_fidelity().run(scene, run);
            const bool tears = record.status.code == StatusCode::strain_limit;
            const bool fails = !tears && is_numerical_failure(record.status.code);
            torn += tears;
            endings[fails ? "fails" : "ends"].push_back(
                fmt::format("full.noise.amplitude={:.4g}, seed={}: {}", scene.full.noise->amplitude,
                            scene.full.noise->seed, record.status.detail));
        }
        fmt::print("NOISE|{}|{}|{} end, {} of these torn|{} fail\n", number, drop.kind,
                   endings["ends"].size(), torn, endings["fails"].size());
        std::fflush(stdout);
        if (endings["ends"].empty() || endings["fails"].empty()) continue;
        const auto& fewer = endings[endings["ends"].size() < endings["fails"].size() ? "ends" : "fails"];
        Verdict v;
        v.ending = "noise";
        ADD_FAILURE() << "drop " << number << " (" << drop.kind << "): " << endings["ends"].size() << " end, "
                      << endings["fails"].size() << " fail\n  " << fmt::format("{}", fmt::join(fewer, "\n  "))
                      << "\n  twinchute full "
                      << keep_drop(drop, "noise", seed_, number, v, fewer.front()).string();
    }
    EXPECT_EQ(found, wanted);
}

}  // namespace
}  // namespace twinchute::test
