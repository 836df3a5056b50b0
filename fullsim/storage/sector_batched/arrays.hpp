// Sector arrays: what stands in memory behind a SectorFrame, and the plan that goes with it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "fullsim/storage/sector_batched/kernels.hpp"
#include "fullsim/storage/sector_batched/sector.hpp"
#include "fullsim/time/central_difference.hpp"
#include "lib/record/archive.hpp"
#include "lib/scene/scene.hpp"
#include "lib/solve/plan.hpp"

namespace twinchute::fullsim {

/// Rows of doubles of one length, each at the start of a register and none a multiple of a page apart.
class AlignedRows {
public:
    AlignedRows() = default;
    AlignedRows(int rows, std::size_t length)
        : lines_((length + Line{}.size() - 1) / Line{}.size() | 1), memory_(rows * lines_, Line{}) {}
    double* operator[](int row) { return memory_[row * lines_].data(); }
    std::size_t bytes() const { return bytes_of(memory_); }
    std::span<double> all() { return {memory_.front().data(), Line{}.size() * memory_.size()}; }

private:
    struct alignas(128) Line : std::array<double, 16> {};  // the widest register, or two interleaved
    std::size_t lines_ = 0;
    std::vector<Line> memory_;
};

/// One sector in memory, for one width of registers and so many of them interleaved.
class SectorArrays {
public:
    SectorArrays(const Sector& sector, const Mesh& mesh, const NodeConstants& constants,
                 const FullSettings& settings, int lanes, int unroll_factor);
    SectorArrays(const SectorArrays&) = delete;
    SectorArrays& operator=(const SectorArrays&) = delete;

    /// Row sums of everything unstrained with these weights of nodes (PerronScaling), by local node; those of
    /// halo nodes are those of the nodes themselves. To be called before any bound is asked for.
    void weigh(const Sector& sector, const std::vector<double>& weight);

    /// Row sums of cords alone, whose nodes weigh the same [N/m], [N s/m]; by node, the payload the last.
    struct CordRow {
        LocalNode node;
        double stiffness = 0.0, damping = 0.0;
    };
    std::vector<CordRow> cord_rows() const;

    /// Sizes of the arrays behind the frame.
    std::vector<PlanArray> sizes() const;

    /// Saves or restores the data that a step leaves behind.
    void serialize(Archive& archive) {
        archive.numbers("nodes of the sector", node_arrays_.all());
        archive.numbers("buffers", buffer_rows_.all());
    }

    SectorFrame frame;
    SectorPlan plan;
    std::vector<RemainderPull> payload;  ///< buffers that act on the payload

private:
    template <std::size_t corners>
    struct Group;
    template <std::size_t corners>
    std::vector<Group<corners>> groups(const std::vector<std::array<LocalNode, corners>>& elements,
                                       std::vector<NodeCopy>& copies, bool chains);
    void lay_triangles(const Sector& sector, const MembraneLaw& law);
    void lay_cables(const Sector& sector, const Mesh& mesh, double bulk_viscosity, double beta);
    void lay_contacts(const Sector& sector, const Mesh& mesh);
    void lay_halo(const Sector& sector);
    void lay_nodes(const Sector& sector, const NodeConstants& constants);
    void collect_sources(const Sector& sector);
    NodeSources sources_of(int first, int nodes);
    template <std::size_t corners>
    int lanes_in(const std::vector<Group<corners>>& groups) const;
    template <std::size_t corners, std::size_t buffers>
    void lay(std::vector<ElementBatch<corners, buffers>>& batches, const Group<corners>& group,
             const std::array<std::int32_t, buffers>& element_force) const;
    std::int32_t new_buffer(int elements);
    int padded(int elements) const { return (elements + lanes_ - 1) / lanes_ * lanes_; }
    /// Filled up, so that all have their partners.
    template <class T>
    void pair_up(std::vector<T>& of_registers) const {
        while (of_registers.size() % unroll_factor_ != 0)
            of_registers.emplace_back();
    }

    /// A buffer of forces and the nodes on which it acts.
    struct Act {
        enum class What { plus, minus, push, aero, cord_plus, cord_minus } what;
        std::int32_t element_force, node;
        int elements;
    };
    std::vector<Act> acts_;
    int lanes_, unroll_factor_;
    int nodes_;                 // with copies
    std::int32_t buffers_ = 0;  // length of a row of all buffers so far
    struct UnstrainedRow {
        int at, triangle;
        TriangleRows of_triangle;
    };
    std::vector<UnstrainedRow> unstrained_;
    struct CableTangent {
        std::array<LocalNode, 2> node;
        double stiffness, damping;  // [N/m], [N s/m]
    };
    std::vector<CableTangent> tape_tangents_, cord_tangents_;
    static constexpr int first_stiffness_row = 6;  // of a triangle's, in triangle_rows_; damping behind it
    static constexpr int cable_stiffness_row = 7;  // in node_rows_, likewise; those of cords behind these
    AlignedRows triangle_rows_, tape_constants_, cord_constants_, line_rows_, contact_rows_, node_rows_,
        node_arrays_, buffer_rows_;
};

}  // namespace twinchute::fullsim
