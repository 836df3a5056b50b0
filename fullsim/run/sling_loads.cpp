#include "fullsim/run/sling_loads.hpp"

#include <fmt/format.h>

#include <cmath>

#include "fullsim/attitude.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double felt = 0.02;  // share of the largest tension below which a sling is slack without effect

}  // namespace

void SlingLoads::observe(double time, const Vec3& pull, const BodyState& body) {
    const Vec3 own = turn_of(body.attitude).conjugate() * pull;
    const double quarter = 0.25 * slings_.length, along = own.z() / slings_.rise,
                 across = std::abs(own.x()) / slings_.x + std::abs(own.y()) / slings_.y;
    if (const double most = quarter * (along + across); most > now_.tension.value)
        now_.tension = {most, time};
    if (const double push = quarter * (across - along); push > now_.push.value) now_.push = {push, time};
}

void SlingLoads::fill(RunRecord& record) const {
    const auto& [tension, push] = now_;
    record.add_metric("max_sling_tension_N", tension.value, MetricKind::result,
                      fmt::format("of four that stretch alike, at t = {:.4g} s", tension.time));
    if (push.value > felt * tension.value)
        record.warnings.push_back(
            {fmt::format("slings would have been slack: one had to push with {:.0f} N, at t = {:.4g} s",
                         push.value, push.time),
             "the point that they meet at is fixed to the body, which they cannot hold to a pull from so far "
             "aside",
             "lengthen payload.body.sling_length, or do not trust tilt and tension near that time"});
}

void SlingLoads::serialize(Archive& archive) {
    for (Extremes* most : {&now_, &sound_})
        for (Observer::Peak* peak : {&most->tension, &most->push})
            for (double* x : {&peak->value, &peak->time})
                archive.number("slings", *x);
}

}  // namespace twinchute::fullsim
