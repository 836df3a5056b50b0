#include "fullsim/run/moving_average.hpp"

#include <algorithm>

namespace twinchute::fullsim {

MovingAverage::MovingAverage(double window) : half_(0.5 * window), ring_(1024) {}

void MovingAverage::push(double t, double value) {
    double integral = 0.0;
    if (end_ > 0) {
        const Sample& last = at(end_ - 1);
        integral = last.integral + 0.5 * (t - last.t) * (last_value_ + value);
    } else {
        start_ = t;
    }
    if (end_ - first_ == ring_.size()) {
        std::vector<Sample> larger(2 * ring_.size());
        for (std::size_t i = first_; i < end_; ++i)
            larger[i & (larger.size() - 1)] = at(i);
        ring_ = std::move(larger);
    }
    ring_[end_++ & (ring_.size() - 1)] = {t, integral};
    last_value_ = value;

    centre_ = t - half_;
    ready_ = centre_ >= start_;
    if (!ready_) {
        // Until then the average so far is the best there is.
        value_ = t > start_ ? integral / (t - start_) : value;
        return;
    }
    const double left = std::max(start_, centre_ - half_);
    while (first_ + 1 < end_ && at(first_ + 1).t <= left)
        ++first_;
    const Sample &a = at(first_), &b = at(std::min(first_ + 1, end_ - 1));
    const double before =
        b.t > a.t ? a.integral + (b.integral - a.integral) * (left - a.t) / (b.t - a.t) : a.integral;
    value_ = (integral - before) / (t - left);
}

void MovingAverage::serialize(Archive& archive) {
    std::vector<Sample> held;
    if (!archive.reads())
        for (std::size_t i = first_; i < end_; ++i)
            held.push_back(at(i));
    archive.rows("samples", held, [](Sample& sample, auto&& each) {
        auto& [t, integral] = sample;
        each(t), each(integral);
    });
    if (archive.reads()) {
        while (ring_.size() < held.size())
            ring_.resize(2 * ring_.size());
        std::ranges::copy(held, ring_.begin());
        first_ = 0;
        end_ = held.size();
    }
    for (double* value : {&start_, &last_value_, &centre_, &value_})
        archive.number("average", *value);
    archive.flag("ready", ready_);
}

}  // namespace twinchute::fullsim
