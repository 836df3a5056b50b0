// Draws from what is known of the inputs, run through the scene.
#include <fmt/format.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_qrng.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <memory>

#include "lib/scene/scene_error.hpp"
#include "study/calibrate/unknowns.hpp"

namespace twinchute::study {
namespace {

constexpr int draws = 400;
constexpr const char* predicted_metrics[] = {"peak_force", "max_deceleration", "descent_rate"};

/// The value below which a share of sorted numbers lies, straight between them.
double quantile_of(const std::vector<double>& sorted, double share) {
    const double at = share * static_cast<double>(sorted.size() - 1);
    const auto left = static_cast<std::size_t>(at);
    const std::size_t right = std::min(left + 1, sorted.size() - 1);
    return sorted[left] + (at - static_cast<double>(left)) * (sorted[right] - sorted[left]);
}

std::optional<RunRecord> run_once(const Scene& scene, const Fidelity& fidelity) {
    Run run;
    RunRecord record = fidelity.run(scene, run);
    if (is_numerical_failure(record.status.code)) return {};
    return record;
}

}  // namespace

InputDraws draw_inputs(const Calibration& calibration, int draws) {
    InputDraws drawn;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < calibration.parameters.size(); ++i) {
        const Parameter& p = calibration.parameters[i];
        if (p.unknown.kind != Unknown::Kind::key) continue;
        drawn.keys.push_back(p.unknown.name);
        drawn.best.push_back(p.estimate);
        places.push_back(i);
    }
    const auto count = static_cast<Eigen::Index>(places.size());
    // The next drop scatters as the tests did.
    Eigen::MatrixXd spread(count, count);
    for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index j = 0; j < count; ++j) {
            const std::size_t a = places[static_cast<std::size_t>(i)],
                              b = places[static_cast<std::size_t>(j)];
            spread(i, j) = calibration.covariance(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
            if (i == j) spread(i, j) += std::pow(calibration.parameters[a].scatter.value_or(0.0), 2);
        }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(spread);
    const Eigen::MatrixXd root =
        eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();

    const std::unique_ptr<gsl_qrng, decltype(&gsl_qrng_free)> halton(
        gsl_qrng_alloc(gsl_qrng_halton, static_cast<unsigned>(count)), gsl_qrng_free);
    std::vector<double> share(places.size());
    for (int draw = 0; draw < draws; ++draw) {
        gsl_qrng_get(halton.get(), share.data());
        Eigen::VectorXd normal(count);
        for (Eigen::Index i = 0; i < count; ++i)
            normal[i] = gsl_cdf_ugaussian_Pinv(share[static_cast<std::size_t>(i)]);
        const Eigen::VectorXd moved = root * normal;
        std::vector<double> values = drawn.best;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const FitVariable& v = calibration.parameters[places[i]].unknown.variable;
            const double scale = v.to_scale(values[i]) + moved[static_cast<Eigen::Index>(i)];
            values[i] = std::clamp(v.from_scale(scale), v.low, v.high);
        }
        drawn.values.push_back(std::move(values));
    }
    return drawn;
}

void predict_next_drop(Calibration& calibration, const SceneWith& scene_with, const Fidelity& fidelity,
                       const std::stop_token& stop) {
    const InputDraws drawn = draw_inputs(calibration, draws);
    std::vector<Unknown> unknowns;
    for (const Parameter& p : calibration.parameters)
        if (p.unknown.kind == Unknown::Kind::key) unknowns.push_back(p.unknown);
    const VariedScene varied(scene_with, drawn.keys, probe_of(unknowns));
    const auto before = run_once(scene_with({}), fidelity),
               after = run_once(varied.read(drawn.best), fidelity);
    if (!after) return;
    std::vector<Band> bands;
    for (const char* name : predicted_metrics) {
        const MetricRow* row = find_metric_row(name);
        const auto value = after->metric(row->key);
        if (!value) continue;
        bands.push_back({row, before ? before->metric(row->key) : std::nullopt, *value, *value, *value, {}});
    }
    int failed = 0;
    for (const std::vector<double>& values : drawn.values) {
        if (stop.stop_requested()) break;
        std::optional<RunRecord> record;
        try {
            record = run_once(varied.at(values), fidelity);
        } catch (const SceneError&) {
        }
        if (!record) {
            ++failed;
            continue;
        }
        for (Band& band : bands)
            if (const auto value = record->metric(band.row->key)) band.draws.push_back(*value);
    }
    if (failed > 0)
        calibration.notes.push_back(fmt::format("{} of {} draws of the inputs gave no drop", failed, draws));
    for (Band& band : bands) {
        std::ranges::sort(band.draws);
        if (band.draws.size() < 2) continue;
        band.low = quantile_of(band.draws, 0.025);
        band.high = quantile_of(band.draws, 0.975);
    }
    calibration.predictive = std::move(bands);
}

}  // namespace twinchute::study
