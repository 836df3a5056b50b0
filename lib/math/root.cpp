#include "lib/math/root.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>

#include <limits>
#include <memory>

namespace twinchute {
namespace {

double value_of(double x, void* f) {
    return (*static_cast<const std::function<double(double)>*>(f))(x);
}

}  // namespace

double root_between(const std::function<double(double)>& f, double a, double b, double relative) {
    // GSL's default handler aborts; every call here is checked instead.
    [[maybe_unused]] static const auto handler_off = gsl_set_error_handler_off();
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    const std::unique_ptr<gsl_root_fsolver, decltype(&gsl_root_fsolver_free)> search(
        gsl_root_fsolver_alloc(gsl_root_fsolver_brent), &gsl_root_fsolver_free);
    gsl_function function{&value_of, const_cast<std::function<double(double)>*>(&f)};
    if (!search || gsl_root_fsolver_set(search.get(), &function, a, b) != GSL_SUCCESS) return none;
    for (int i = 0; i < 100; ++i) {
        if (gsl_root_fsolver_iterate(search.get()) != GSL_SUCCESS) return none;
        const double low = gsl_root_fsolver_x_lower(search.get()),
                     high = gsl_root_fsolver_x_upper(search.get());
        if (gsl_root_test_interval(low, high, 0.0, relative) == GSL_SUCCESS) break;
    }
    return gsl_root_fsolver_root(search.get());
}

}  // namespace twinchute
