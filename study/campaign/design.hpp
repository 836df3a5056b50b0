// Where the runs of a campaign lie: the values of the inputs of run i, from seed and i alone.
#pragma once

#include <Eigen/Core>
#include <boost/random/sobol.hpp>
#include <cstdint>
#include <span>
#include <vector>

#include "study/campaign/spec.hpp"

namespace twinchute::study {

/// Points of a design, one after the other or in any order; one of these for each thread.
class Design {
public:
    /// The spec outlives it.
    explicit Design(const CampaignSpec& spec);

    std::size_t dimensions() const { return spec_.inputs.size(); }

    /// Values of the inputs of a run [SI], of words their indices.
    void values(std::uint64_t run, std::span<double> values);
    /// Values of the inputs at a point of independent standard normal scores, one for each.
    void values_at(std::span<const double> scores, std::span<double> values);
    /// The point of a run in the unit cube, before correlation: not of a table of points.
    void point(std::uint64_t run, std::span<double> point);

private:
    double correlated_score(std::span<const double> scores, std::size_t input) const;
    void sobol(std::uint64_t index, std::span<double> point);
    double stratified(std::uint64_t run, std::uint32_t dimension) const;
    void grid(std::uint64_t run, std::span<double> point) const;
    void saltelli(std::uint64_t run, std::span<double> point);

    const CampaignSpec& spec_;
    Eigen::MatrixXd root_;  // of the correlation; empty: none
    std::vector<double> point_, scores_;
    std::vector<std::uint64_t> shift_;  // of Sobol's sequence
    std::uint64_t next_ = 0;            // index that the sequence stands at; 0: nowhere
    boost::random::sobol sequence_;
};

/// The place of `index` in a random permutation of 0 to count - 1, found without the others: a Feistel
/// network on the next power of four, again and again until it is in range (Black, Rogaway, "Ciphers with
/// arbitrary finite domains", CT-RSA 2002).
std::uint64_t permuted(std::uint64_t index, std::uint64_t count, std::uint64_t seed, std::uint32_t dimension);

/// Runs of one base point of Saltelli's design: A, B, and A with each column of B.
inline std::uint64_t saltelli_block(std::size_t dimensions) {
    return dimensions + 2;
}

}  // namespace twinchute::study
