// Integrals of smooth functions.
#pragma once

#include <gsl/gsl_integration.h>

#include <memory>

namespace twinchute {

/// Integral of f from 0 to b by Gauss and Legendre, exact to round-off for what is smooth in it.
template <class F>
double integral(const F& f, double b) {
    using Table =
        std::unique_ptr<gsl_integration_glfixed_table, decltype(&gsl_integration_glfixed_table_free)>;
    static const Table table(gsl_integration_glfixed_table_alloc(24), &gsl_integration_glfixed_table_free);
    double sum = 0.0;
    for (std::size_t i = 0; i < table->n; ++i) {
        double x = 0.0, weight = 0.0;
        gsl_integration_glfixed_point(0.0, b, i, &x, &weight, table.get());
        sum += weight * f(x);
    }
    return sum;
}

}  // namespace twinchute
