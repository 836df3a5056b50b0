// Rows of the runs of a campaign on disk: one HDF5 file for each chunk of runs, by index. A chunk is there as
// a whole or not at all, and has the same bytes whoever wrote it; nothing else has to survive a kill.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace twinchute::study {

/// Identity of a store: runs belong together where all of it agrees.
struct StoreIdentity {
    std::string program;  ///< version, commit, compiler and flags
    std::string digest;   ///< SHA-256 of scene, inputs, design and fidelity
    std::uint64_t seed = 0;
    std::uint64_t chunk = 0;            ///< runs of a chunk
    std::vector<std::string> columns;   ///< status, inputs, metrics
    std::vector<std::string> units;     ///< SI, of each column
    std::vector<std::string> statuses;  ///< names of the numbers in the column status
};

class RunStore {
public:
    /// Rows of a chunk: row-major, a column each of the identity.
    using Rows = std::vector<double>;

    RunStore(std::filesystem::path directory, StoreIdentity identity)
        : directory_(std::move(directory)), identity_(std::move(identity)) {}

    const StoreIdentity& identity() const { return identity_; }
    std::size_t columns() const { return identity_.columns.size(); }

    /// Whether a store of any campaign is there.
    bool exists() const;
    /// Throws UsageError where the store is of another campaign, version or seed: it says which.
    void require_same() const;
    /// Writes the identity, unless it is there. Throws WriteError.
    void begin() const;

    /// Rows of a chunk; empty where it is missing, unreadable, of another campaign, or has fewer than `rows`.
    Rows read(std::uint64_t chunk, std::uint64_t rows) const;
    /// Whether read() would give rows.
    bool has(std::uint64_t chunk, std::uint64_t rows) const;
    /// Writes a chunk under its name, whole and safe on disk. Throws WriteError. From any thread.
    void write(std::uint64_t chunk, std::span<const double> rows) const;
    /// One virtual dataset over the chunks of so many runs; those that are missing read as NaN. Throws
    /// WriteError.
    void join(std::uint64_t runs) const;

    /// Rows of chunk `chunk` where there are `runs` in all.
    std::uint64_t rows_of(std::uint64_t chunk, std::uint64_t runs) const;
    std::uint64_t chunks_of(std::uint64_t runs) const {
        return (runs + identity_.chunk - 1) / identity_.chunk;
    }

    std::filesystem::path file_of(std::uint64_t chunk) const;
    std::filesystem::path folder() const;
    std::filesystem::path joined_file() const { return directory_ / "campaign.h5"; }

private:
    std::filesystem::path directory_;
    StoreIdentity identity_;
};

/// "store.json", which says whose runs lie beside it.
std::filesystem::path store_file(const std::filesystem::path& directory);

}  // namespace twinchute::study
