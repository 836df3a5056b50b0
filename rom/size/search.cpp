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

/// [-] to which an edge of what meets the limits is found.
constexpr double closeness = 1e-7;
/// Samples between the bounds: of the row that is decided on first, and of each that follows inside it.
constexpr int outer_samples = 40, inner_samples = 12;

class Search {
public:
    explicit Search(const std::stop_token& stop) : stop_(stop) {}

    Found find(Scene scene, Rows vary) {
        std::vector<std::string> notes;
        for (; !vary.empty(); vary = vary.subspan(1)) {
            const VaryRow& row = *vary.front();
            row.set(scene, decide(scene, row, vary.subspan(1), notes));
        }
        Judged judged = judge_now(scene);
        return {std::move(scene), std::move(judged), std::move(notes)};
    }

private:
    Judged judge_now(const Scene& scene) {
        if (stop_.stop_requested()) throw Interrupted{};
        Judged judged = judge(scene, stop_);
        if (judged.record.status.code == StatusCode::interrupted) throw Interrupted{};
        return judged;
    }

    /// Least share of the limits that `rest` can bring a scene to.
    double least_used(const Scene& scene, Rows rest) {
        if (rest.empty()) return judge_now(scene).used;
        const VaryRow& row = *rest.front();
        const Bounds bounds = row.bounds(scene);
        return -maximum_on(
                    [&](double logarithm) {
                        return -used_at(scene, row, std::exp(logarithm), rest.subspan(1));
                    },
                    std::log(bounds.low), std::log(bounds.high), inner_samples)
                    .value;
    }

    double used_at(Scene scene, const VaryRow& row, double value, Rows rest) {
        row.set(scene, value);
        return least_used(scene, rest);
    }

    /// The value of a row that its goal asks for.
    double decide(const Scene& scene, const VaryRow& row, Rows rest, std::vector<std::string>& notes) {
        const auto used = [&](double value) { return used_at(scene, row, value, rest); };
        const Bounds bounds = row.bounds(scene);
        std::vector<double> at, share;
        for (int i = 0; i <= outer_samples; ++i) {
            at.push_back(bounds.low *
                         std::pow(bounds.high / bounds.low, static_cast<double>(i) / outer_samples));
            share.push_back(used(at.back()));
        }
        const auto meets = [&](std::size_t i) { return share[i] <= 1.0; };
        std::size_t first = 0;
        while (first < at.size() && !meets(first))
            ++first;
        if (first == at.size()) {  // between samples, perhaps
            const double least = least_between(at, share, used);
            if (used(least) > 1.0) return least;
            const auto above = std::ranges::upper_bound(at, least);
            first = static_cast<std::size_t>(above - at.begin());
            at.insert(above, least);
            share.insert(share.begin() + static_cast<std::ptrdiff_t>(first), used(least));
        }
        std::size_t last = first;
        while (last + 1 < at.size() && meets(last + 1))
            ++last;
        note_others(row, at, share, last, notes);
        const bool smallest = row.goal(*scene.size) == Goal::smallest;
        const std::size_t in = smallest ? first : last;
        if (smallest ? in == 0 : in + 1 == at.size()) {
            notes.push_back(fmt::format("{}: no limit binds down or up to {:.4g} {}, where the search ends",
                                        row.title, at[in], row.unit));
            return at[in];
        }
        return edge(used, at[in], at[smallest ? in - 1 : in + 1]);
    }

    /// The value that misses the limits least.
    static double least_between(const std::vector<double>& at, const std::vector<double>& share,
                                const auto& used) {
        const auto best = static_cast<std::size_t>(std::ranges::min_element(share) - share.begin());
        const double low = at[best == 0 ? 0 : best - 1], high = at[std::min(best + 1, at.size() - 1)];
        return maximum_on([&](double value) { return -used(value); }, low, high, 4).at;
    }

    /// The last value, from one that meets the limits toward one that does not, that still meets them.
    static double edge(const auto& used, double inside, double outside) {
        const auto miss = [&](double value) { return std::log(std::max(used(value), 1e-9)); };
        const double root =
            root_between(miss, std::min(inside, outside), std::max(inside, outside), closeness);
        if (!std::isfinite(root)) return inside;
        // The root is met to rounding, on either side.
        double back = closeness * (inside - root) / std::max(std::abs(inside - root), 1e-300) * root;
        for (double value = root; std::abs(value - root) < std::abs(inside - root);
             value = root + back, back *= 2.0)
            if (used(value) <= 1.0) return value;
        return inside;
    }

    /// Ranges beyond the lowest that meet the limits as well.
    static void note_others(const VaryRow& row, const std::vector<double>& at,
                            const std::vector<double>& share, std::size_t last,
                            std::vector<std::string>& notes) {
        for (std::size_t i = last + 1; i < at.size(); ++i) {
            if (share[i] > 1.0) continue;
            std::size_t end = i;
            while (end + 1 < at.size() && share[end + 1] <= 1.0)
                ++end;
            notes.push_back(
                fmt::format("{}: from about {:.3g} to {:.3g} {} would meet the limits, too; the lowest range "
                            "was taken",
                            row.title, at[i], at[end], row.unit));
            i = end;
        }
    }

    const std::stop_token& stop_;
};

}  // namespace

Found search(const Scene& scene, const std::vector<const VaryRow*>& vary, const std::stop_token& stop) {
    return Search(stop).find(scene, vary);
}

}  // namespace twinchute::rom
