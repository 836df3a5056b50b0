#include "fullsim/forces/triangle_bins.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double most_bins_of_a_box = 8.0;

}  // namespace

TriangleBins::TriangleBins(std::span<const Box> boxes) : boxes_(boxes) {
    const auto count = static_cast<double>(boxes.size());
    around_ = {Vec3::Constant(infinity), Vec3::Constant(-infinity)};
    for (const Box& box : boxes) {
        around_ = {around_.low.cwiseMin(box.low), around_.high.cwiseMax(box.high)};
        size_ += (box.high - box.low).maxCoeff() / count;
    }
    const auto counts_of = [&] { return Vec3(((around_.high - around_.low) / size_).array().floor() + 1.0); };
    while (counts_of().prod() > most_bins_of_a_box * (count + 8.0))
        size_ *= 1.25;
    counts_ = counts_of().cast<int>();

    first_.assign(static_cast<std::size_t>(counts_.cast<double>().prod()) + 2, 0);
    for (const Box& box : boxes)
        each_bin(box, [&](std::size_t b) { ++first_[b + 2]; });
    for (std::size_t b = 2; b < first_.size(); ++b)
        first_[b] += first_[b - 1];
    in_bins_.resize(static_cast<std::size_t>(first_.back()));
    for (std::size_t t = 0; t < boxes.size(); ++t)
        each_bin(boxes[t], [&](std::size_t b) { in_bins_[first_[b + 1]++] = static_cast<std::int32_t>(t); });
}

Eigen::Vector3i TriangleBins::bin_of(const Vec3& x) const {
    const auto place = ((x - around_.low) / size_).array().floor();
    return place.max(0.0).min(counts_.cast<double>().array() - 1.0).cast<int>();
}

template <class Visit>
void TriangleBins::each_bin(const Box& box, Visit&& visit) const {
    const Eigen::Vector3i a = bin_of(box.low), b = bin_of(box.high);
    for (int i = a.x(); i <= b.x(); ++i)
        for (int j = a.y(); j <= b.y(); ++j)
            for (int k = a.z(); k <= b.z(); ++k)
                visit(index(i, j, k));
}

}  // namespace twinchute::fullsim
