// Fields of a full run at one instant, cell by cell, for VTK.
#pragma once

#include <array>
#include <cassert>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "fullsim/forces/membrane.hpp"
#include "fullsim/state.hpp"
#include "lib/record/archive.hpp"
#include "lib/record/vtu.hpp"

namespace twinchute::fullsim {

/// The cell array "kind", by number: fabric, the kinds of cables, the payload.
std::span<const std::string_view> cell_kind_names();

/// Points and cells of a mesh as it starts: fabric, then cables, then the payload, each with its kind.
VtuGrid mesh_grid(const Mesh& mesh);

/// Adds an array by cells: `fabric` of each triangle, `cable` of each cable, where there is such a value;
/// `none` for the other cells.
void add_cell_data(VtuGrid& grid, const Mesh& mesh, const char* name,
                   const std::function<double(const Triangle&)>& fabric,
                   const std::function<double(const Cable&)>& cable, double none = 0.0);

/// A grid of mesh_grid with the state's positions and its fields:
///
/// points  velocity_m_s, at the time of the positions
/// fabric  stress_first_N_m and stress_second_N_m, principal second Piola-Kirchhoff resultants;
///         strain_first and strain_second, principal Green strains; wrinkling_state, 0 slack, 1 wrinkled,
///         2 taut; pressure_Pa, the canopy pressure
/// cables  cable_tension_N; cable_strain, over the unstrained length, negative when slack
///
/// Cells to which a field does not apply hold 0, as wrinkling_state -1. Stress and tension are elastic,
/// without what viscosity adds. Stresses have the weight of the finite elements, state and strains are
/// geometric: while springs carry the canopy there is strain without stress.
VtuGrid field_frame(const VtuGrid& of_mesh, const Mesh& mesh, const State& state);

/// Takes frames at a rate, as they are due, and gives them away once the state that they show is found sound.
class FieldRecorder {
public:
    using Sink = std::function<void(const VtuGrid&)>;

    /// rate [1/s]; without one, or without a sink, nothing is ever taken. The sink must outlive this.
    FieldRecorder(std::vector<const Mesh*> meshes, std::optional<double> rate, const Sink& sink);
    FieldRecorder(const Mesh& mesh, std::optional<double> rate, const Sink& sink)
        : FieldRecorder(std::vector{&mesh}, rate, sink) {}

    /// Called once a step with the forces at state.time evaluated. A frame is due at the first step at or
    /// after a multiple of 1/rate, as a row of the history.
    bool frame_is_due(double time) const { return time >= next_; }
    void observe(std::span<const State* const> states) {
        if (frame_is_due(states.front()->time)) take(states);
    }
    void observe(const State& state) { observe(std::array{&state}); }
    /// A check found everything sound so far.
    void accept();
    /// A check found something wrong: drops what came after the last accept().
    void forget() { pending_.clear(); }

    /// While no frame waits to be accepted.
    void serialize(Archive& archive) {
        assert(pending_.empty());
        archive.number("next frame of the fields", next_);
    }

private:
    void take(std::span<const State* const> states);

    std::vector<const Mesh*> meshes_;  // of each canopy
    const Sink& sink_;
    double interval_ = 0.0, next_;  // [s]
    std::vector<VtuGrid> grids_;    // what all frames share, of each mesh
    std::vector<VtuGrid> pending_;
};

}  // namespace twinchute::fullsim
