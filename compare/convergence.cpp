#include "compare/convergence.hpp"

#include <algorithm>
#include <cmath>

namespace twinchute::compare {

bool is_monotone(std::span<const double> values) {
    if (values.size() < 2) return false;
    const bool rising = values[1] > values[0];
    for (std::size_t i = 1; i < values.size(); ++i) {
        const double step = rising ? values[i] - values[i - 1] : values[i - 1] - values[i];
        if (!(step > 0.0) || !std::isfinite(step)) return false;
    }
    return true;
}

std::optional<Extrapolation> richardson(const std::array<double, 3>& size,
                                        const std::array<double, 3>& value) {
    const bool finer = size[0] > size[1] && size[1] > size[2] && size[2] > 0.0;
    if (!finer || !is_monotone(value)) return {};
    const double wanted = (value[0] - value[1]) / (value[1] - value[2]);
    // Sizes over the middle one: their powers stay in range.
    const double coarse = size[0] / size[1], fine = size[2] / size[1];
    const auto excess = [&](double p) {
        return (std::pow(coarse, p) - 1.0) / (1.0 - std::pow(fine, p)) - wanted;
    };
    // The quotient rises with p: the logarithm of its numerator at least as 1/p, of its denominator at most
    // so.
    double low = lowest_order, high = highest_order;
    if (!(excess(low) <= 0.0 && excess(high) >= 0.0)) return {};
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        (excess(middle) > 0.0 ? high : low) = middle;
    }
    const double p = 0.5 * (low + high), power = std::pow(fine, p);
    return Extrapolation{value[2] + (value[2] - value[1]) * power / (1.0 - power), p};
}

std::vector<bool> pareto_front(std::span<const CostAndError> points) {
    const auto is_finite = [](const CostAndError& p) {
        return std::isfinite(p.cost) && std::isfinite(p.error);
    };
    std::vector<bool> front;
    for (const CostAndError& p : points) {
        const bool beaten = std::ranges::any_of(points, [&](const CostAndError& q) {
            return is_finite(q) && q.cost <= p.cost && q.error <= p.error &&
                   (q.cost < p.cost || q.error < p.error);
        });
        front.push_back(is_finite(p) && !beaten);
    }
    return front;
}

}  // namespace twinchute::compare
