#include "rom/size/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "lib/math/maximum.hpp"
#include "lib/math/root.hpp"

namespace twinchute::rom {
namespace {

using Rows = std::span<const VaryRow* const>;

/// [-] to which an edge of what meets the limits is found, where others are decided on after it, and where a
/// load is least.
constexpr double closeness = 1e-7, closeness_before = 1e-4, closeness_at_minimum = 1e-5;
/// [-] of its value by which a row stays inside its edge when others are decided on after it: with what they
/// change the edge itself moves a little, and would leave them no margin.
constexpr double margin = 5e-3;
/// Samples between the bounds: of a row alone, of one that others follow, of those others meanwhile.
constexpr int samples_alone = 40, samples_before = 16, samples_inside = 6;
/// [-] share of the limits up to which a minimum between such samples may still meet them.
constexpr double unclear = 1.3;

/// Used share [-] of all limits, and of those on loads.
struct Share {
    double used, loaded;
};

/// Shares of the limits at values between the bounds, from low to high.
struct Samples {
    std::vector<double> at, used;

    std::size_t size() const { return at.size(); }
    bool meet(std::size_t i) const { return used[i] <= 1.0; }
    /// The first from i on that meets the limits, or does not; size() where there is none.
    std::size_t next(std::size_t i, bool meeting) const {
        while (i < size() && meet(i) != meeting)
            ++i;
        return i;
    }
    void add(double value, double share) {
        const auto above = std::ranges::upper_bound(at, value);
        used.insert(used.begin() + (above - at.begin()), share);
        at.insert(above, value);
    }
};

Samples sample(const auto& used, const Bounds& bounds, int count) {
    Samples samples;
    for (int i = 0; i <= count; ++i) {
        const double value = bounds.low * std::pow(bounds.high / bounds.low, static_cast<double>(i) / count);
        samples.add(value, used(value));
    }
    return samples;
}

/// The value, between the neighbours of the best sample, that misses the limits least.
double argmin_excess(const auto& used, const Samples& samples) {
    const auto best = static_cast<std::size_t>(std::ranges::min_element(samples.used) - samples.used.begin());
    const double low = samples.at[best == 0 ? 0 : best - 1];
    const double high = samples.at[std::min(best + 1, samples.size() - 1)];
    return maximum_on([&](double value) { return -used(value); }, low, high, 4, closeness_at_minimum).at;
}

/// The last value, from one that meets the limits toward one that does not, that still meets them.
double edge(const auto& used, double inside, double outside, double relative) {
    const auto miss = [&](double value) { return std::log(std::max(used(value), 1e-9)); };
    const double root = root_between(miss, std::min(inside, outside), std::max(inside, outside), relative);
    if (!std::isfinite(root)) return inside;
    // The root is found to its closeness, on either side.
    for (double back = relative * root; back < std::abs(inside - root); back *= 2.0)
        if (const double value = root + std::copysign(back, inside - root); used(value) <= 1.0) return value;
    return inside;
}

class Search {
public:
    explicit Search(const std::stop_token& stop) : stop_(stop) {}

    Found find(Scene scene, Rows vary) {
        for (; !vary.empty(); vary = vary.subspan(1)) {
            const VaryRow& row = *vary.front();
            row.set(scene, decide(scene, row, vary.subspan(1)));
        }
        Judged judged = judge_now(scene);
        return {std::move(scene), std::move(judged), std::move(notes_)};
    }

private:
    Judged judge_now(const Scene& scene) {
        if (stop_.stop_requested()) throw Interrupted{};
        Judged judged = judge(scene, stop_);
        if (judged.record.status.code == StatusCode::interrupted) throw Interrupted{};
        return judged;
    }

    /// Shares that a scene with this value uses at least, whatever `rest` is.
    Share used_at(Scene scene, const VaryRow& row, double value, Rows rest) {
        row.set(scene, value);
        if (rest.empty()) {
            const Judged judged = judge_now(scene);
            return {judged.used, judged.loaded()};
        }
        const VaryRow& inner = *rest.front();
        const auto share = [&](double v) { return used_at(scene, inner, v, rest.subspan(1)); };
        const Bounds bounds = inner.bounds(scene);
        Share best{nowhere, nowhere};
        const Samples samples = sample(
            [&](double v) {
                const Share one = share(v);
                if (one.used < best.used) best = one;
                return one.used;
            },
            bounds, samples_inside);
        // Where it is not clear from the samples whether the loads can be borne.
        if (best.loaded <= 1.0 || best.used >= unclear) return best;
        return share(argmin_excess([&](double v) { return share(v).used; }, samples));
    }

    /// The value of a row that its goal asks for; where none meets the limits, the one that misses them
    /// least.
    double decide(const Scene& scene, const VaryRow& row, Rows rest) {
        const Goal goal = row.goal(*scene.size);
        const auto used = [&](double value) {
            const Share share = used_at(scene, row, value, rest);
            // Loads count among values that meet the limits; where none does, how far off it is.
            return goal == Goal::min_load && share.used <= 1.0 ? share.loaded : share.used;
        };
        const Bounds bounds = row.bounds(scene);
        const int count = rest.empty() ? samples_alone : samples_before;
        Samples samples = sample(used, bounds, count);
        if (goal == Goal::min_load) return argmin_excess(used, samples);
        go_on(samples, used, goal, row.ends(scene), std::pow(bounds.high / bounds.low, 1.0 / count));
        if (samples.next(0, true) == samples.size()) {  // between samples, perhaps
            const double best = argmin_excess(used, samples), share = used(best);
            if (share > 1.0) return best;
            samples.add(best, share);
        }
        const std::size_t first = samples.next(0, true), behind = samples.next(first, false);
        note_others(row, samples, behind);
        const bool smallest = goal == Goal::smallest;
        if (smallest ? first == 0 : behind == samples.size()) {
            const double end = smallest ? samples.at.front() : samples.at.back();
            notes_.push_back(fmt::format("{}: no limit binds {} {:.4g} {}, where the search ends", row.title,
                                         smallest ? "down to" : "up to", end, row.unit));
            return end;
        }
        const std::size_t in = smallest ? first : behind - 1, out = smallest ? first - 1 : behind;
        const double found =
            edge(used, samples.at[in], samples.at[out], rest.empty() ? closeness : closeness_before);
        if (rest.empty()) return found;
        notes_.push_back(fmt::format("{}: {:.1f} % inside its edge, room for what is decided after it",
                                     row.title, 100.0 * margin));
        return found * (smallest ? 1.0 + margin : 1.0 - margin);
    }

    /// Samples beyond the first bounds, a factor of `ratio` from one to the next: while the end of them is
    /// what is wanted, or misses the limits least.
    static void go_on(Samples& samples, const auto& used, Goal goal, const Bounds& ends, double ratio) {
        const auto goes_on = [&](bool down) {
            const std::size_t last = samples.size() - 1, end = down ? 0 : last, next = down ? 1 : last - 1;
            if (samples.next(0, true) < samples.size())
                return samples.meet(end) && down == (goal == Goal::smallest);
            const bool is_best = std::ranges::min(samples.used) == samples.used[end];
            return is_best && samples.used[end] < samples.used[next];
        };
        for (const bool down : {true, false})
            while (goes_on(down)) {
                const double from = down ? samples.at.front() : samples.at.back();
                const double value =
                    down ? std::max(from / ratio, ends.low) : std::min(from * ratio, ends.high);
                if (value == from) break;
                samples.add(value, used(value));
            }
    }

    /// Ranges beyond the lowest that meet the limits as well: loads need not grow with what varies.
    void note_others(const VaryRow& row, const Samples& samples, std::size_t behind) {
        for (std::size_t i = samples.next(behind, true); i < samples.size();) {
            const std::size_t end = samples.next(i, false);
            notes_.push_back(fmt::format(
                "{}: from about {:.3g} to {:.3g} {} would meet the limits, too; the lowest range was taken",
                row.title, samples.at[i], samples.at[end - 1], row.unit));
            i = samples.next(end, true);
        }
    }

    const std::stop_token& stop_;
    std::vector<std::string> notes_;
};

}  // namespace

Found search(const Scene& scene, const std::vector<const VaryRow*>& vary, const std::stop_token& stop) {
    return Search(stop).find(scene, vary);
}

}  // namespace twinchute::rom
