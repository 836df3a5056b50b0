#include "lib/math/maximum.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_min.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace twinchute {
namespace {

double negated(double x, void* f) {
    return -(*static_cast<const std::function<double(double)>*>(f))(x);
}

}  // namespace

Maximum maximum_on(const std::function<double(double)>& f, double a, double b, int samples,
                   double closeness) {
    std::vector<double> values(static_cast<std::size_t>(samples) + 1);
    for (int i = 0; i <= samples; ++i)
        values[static_cast<std::size_t>(i)] = f(i == samples ? b : a + i * ((b - a) / samples));
    return maximum_on(f, a, b, values, closeness);
}

Maximum maximum_on(const std::function<double(double)>& f, double a, double b, std::span<const double> values,
                   double closeness) {
    const auto samples = static_cast<std::ptrdiff_t>(values.size()) - 1;
    const double spacing = (b - a) / static_cast<double>(samples);
    const auto index = std::ranges::max_element(values) - values.begin();
    Maximum best{index == samples ? b : a + static_cast<double>(index) * spacing,
                 values[static_cast<std::size_t>(index)]};
    if (!(spacing > 0.0)) return best;
    double low = best.at - spacing, high = best.at + spacing;
    if (index == 0 || index == samples) {
        // At an end: a true one, unless f still rises a little way inside.
        const double inside = best.at + (index == 0 ? 1e-3 : -1e-3) * spacing;
        const double value = f(inside);
        if (value <= best.value) return best;
        low = std::max(a, low);
        high = std::min(b, high);
        best = {inside, value};
    }

    // GSL's default handler aborts; every call here is checked instead.
    [[maybe_unused]] static const auto handler_off = gsl_set_error_handler_off();
    const std::unique_ptr<gsl_min_fminimizer, decltype(&gsl_min_fminimizer_free)> search(
        gsl_min_fminimizer_alloc(gsl_min_fminimizer_brent), &gsl_min_fminimizer_free);
    gsl_function negative{&negated, const_cast<std::function<double(double)>*>(&f)};
    // A flat top has no strict bracket: the sampled point stands then.
    if (search && gsl_min_fminimizer_set(search.get(), &negative, best.at, low, high) == GSL_SUCCESS) {
        for (int i = 0; i < 60; ++i) {
            if (gsl_min_fminimizer_iterate(search.get()) != GSL_SUCCESS) break;
            const double left = gsl_min_fminimizer_x_lower(search.get());
            const double right = gsl_min_fminimizer_x_upper(search.get());
            if (gsl_min_test_interval(left, right, 0.0, closeness) == GSL_SUCCESS) break;
        }
        const double value = -gsl_min_fminimizer_f_minimum(search.get());
        if (value > best.value) best = {gsl_min_fminimizer_x_minimum(search.get()), value};
    }
    return best;
}

Maximum maximum_of_quartic(const std::array<double, 5>& values, double a, double b) {
    const auto& [f0, f1, f2, f3, f4] = values;
    // About the middle, in spacings: f2 + x (c1 + x (c2 + x (c3 + x c4))).
    const double odd = f4 - f0, inner_odd = f3 - f1, even = f4 + f0, inner_even = f3 + f1;
    const double c1 = (8.0 * inner_odd - odd) / 12.0, c2 = (16.0 * inner_even - even - 30.0 * f2) / 24.0;
    const double c3 = (odd - 2.0 * inner_odd) / 12.0, c4 = (even - 4.0 * inner_even + 6.0 * f2) / 24.0;
    const double first = static_cast<double>(std::ranges::max_element(values) - values.begin()) - 2.0;
    const double low = std::max(-2.0, first - 1.0), high = std::min(2.0, first + 1.0);
    double x = first;
    for (int i = 0; i < 5; ++i) {
        const double slope = c1 + x * (2.0 * c2 + x * (3.0 * c3 + x * 4.0 * c4));
        const double bend = 2.0 * c2 + x * (6.0 * c3 + x * 12.0 * c4);
        // Where it bends up, towards the end that it rises to.
        x = bend < 0.0 ? std::clamp(x - slope / bend, low, high) : slope > 0.0 ? high : low;
    }
    const double at_sample = values[static_cast<std::size_t>(first + 2.0)];
    const double value = f2 + x * (c1 + x * (c2 + x * (c3 + x * c4)));
    if (!(value > at_sample)) x = first;
    return {0.5 * (a + b) + 0.25 * x * (b - a), std::max(value, at_sample)};
}

}  // namespace twinchute
