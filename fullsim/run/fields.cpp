#include "fullsim/run/fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "fullsim/forces/blocks.hpp"

namespace twinchute::fullsim {
namespace {

constexpr int cable_kinds = 5;
constexpr std::int8_t fabric_kind = 0, first_cable_kind = 1, payload_kind = first_cable_kind + cable_kinds,
                      vent_line_kind = first_cable_kind + static_cast<int>(CableKind::vent_line),
                      reefing_line_kind = vent_line_kind + 1;
constexpr std::int8_t no_state = -1;

std::int8_t state_number(FabricState state) {
    switch (state) {
        case FabricState::slack:
            return 0;
        case FabricState::wrinkled:
            return 1;
        case FabricState::taut:
            break;
    }
    return 2;
}

std::string legend() {
    std::string text = "twinchute; kind:";
    for (std::size_t i = 0; i < cell_kind_names().size(); ++i)
        text += fmt::format("{} {} {}", i == 0 ? "" : ",", i, cell_kind_names()[i]);
    return text;
}

}  // namespace

std::span<const std::string_view> cell_kind_names() {
    static const auto names = [] {
        std::array<std::string_view, reefing_line_kind + 1> all;
        all[fabric_kind] = "fabric";
        for (int i = 0; i < cable_kinds; ++i)
            all[first_cable_kind + i] = cable_kind_name(static_cast<CableKind>(i));
        all[payload_kind] = "payload";
        all[vent_line_kind] = cable_kind_name(CableKind::vent_line);
        all[reefing_line_kind] = "reefing line";
        return all;
    }();
    return names;
}

VtuGrid mesh_grid(const Mesh& mesh) {
    VtuGrid grid;
    grid.note = legend();
    for (const Vec3& x : mesh.position)
        grid.points.insert(grid.points.end(), {x.x(), x.y(), x.z()});
    std::vector<std::int8_t> kind;
    for (const Triangle& t : mesh.triangles) {
        grid.add_cell(VtuCell::triangle, t.node);
        kind.push_back(fabric_kind);
    }
    for (std::size_t i = 0; i < mesh.cables.size(); ++i) {
        const Cable& c = mesh.cables[i];
        // Risers are drawn to the middle of a body.
        grid.add_cell(VtuCell::line,
                      std::array{std::min(c.node[0], mesh.payload()), std::min(c.node[1], mesh.payload())});
        kind.push_back(std::ranges::binary_search(mesh.reefing_line, i)
                           ? reefing_line_kind
                           : static_cast<std::int8_t>(first_cable_kind + static_cast<int>(c.kind)));
    }
    grid.add_cell(VtuCell::vertex, std::array{mesh.payload()});
    kind.push_back(payload_kind);
    grid.cell_data.push_back({"kind", 1, std::move(kind)});
    return grid;
}

void add_cell_data(VtuGrid& grid, const Mesh& mesh, const char* name,
                   const std::function<double(const Triangle&)>& fabric,
                   const std::function<double(const Cable&)>& cable, double none) {
    std::vector<float> values;
    values.reserve(grid.cells.size());
    for (const Triangle& t : mesh.triangles)
        values.push_back(static_cast<float>(fabric ? fabric(t) : none));
    for (const Cable& c : mesh.cables)
        values.push_back(static_cast<float>(cable ? cable(c) : none));
    values.resize(grid.cells.size(), static_cast<float>(none));
    grid.cell_data.push_back({name, 1, std::move(values)});
}

VtuGrid field_frame(const VtuGrid& of_mesh, const Mesh& mesh, const State& state) {
    VtuGrid grid = of_mesh;
    grid.time = state.time;
    std::vector<float> velocity;
    for (int i = 0; i < mesh.node_count(); ++i) {
        for (int k = 0; k < 3; ++k) {
            grid.points[3 * i + k] = state.node[i].x[k];
            velocity.push_back(static_cast<float>(state.node[i].v[k]));
        }
    }
    grid.point_data.push_back({"velocity_m_s", 3, std::move(velocity)});

    const std::size_t cells = grid.cells.size();
    std::array<std::vector<float>, 4> fabric;  // stresses, strains
    for (auto& values : fabric)
        values.reserve(cells);
    std::vector<std::int8_t> states;
    const std::vector<MembraneLaw> laws = membrane_laws(mesh, 0.0);
    for (const Triangle& t : mesh.triangles) {
        const MembraneLaw& law = laws[static_cast<std::size_t>(t.sheet)];
        const PlaneTensor strain = green_strain(t, state);
        FabricState wrinkling{};
        const Principal n = principal_values(membrane_stress(law, strain, &wrinkling));
        const Principal e = principal_values(strain);
        const std::array values{state.fe_weight * n.first, state.fe_weight * n.second, e.first, e.second};
        for (std::size_t k = 0; k < values.size(); ++k)
            fabric[k].push_back(static_cast<float>(values[k]));
        states.push_back(state_number(wrinkling));
    }
    constexpr std::array names{"stress_first_N_m", "stress_second_N_m", "strain_first", "strain_second"};
    for (std::size_t k = 0; k < names.size(); ++k) {
        fabric[k].resize(cells);
        grid.cell_data.push_back({names[k], 1, std::move(fabric[k])});
    }
    states.resize(cells, no_state);
    grid.cell_data.push_back({"wrinkling_state", 1, std::move(states)});

    add_cell_data(grid, mesh, "cable_tension_N", {},
                  [&](const Cable& c) { return c.strands * strand_tension(state, mesh, c); });
    add_cell_data(grid, mesh, "cable_strain", {}, [&](const Cable& c) { return cable_strain(state, c); });
    add_cell_data(grid, mesh, "pressure_Pa", [&](const Triangle&) { return state.air.pressure; }, {});
    return grid;
}

FieldRecorder::FieldRecorder(std::vector<const Mesh*> meshes, std::optional<double> rate, const Sink& sink)
    : meshes_(std::move(meshes)), sink_(sink), next_(std::numeric_limits<double>::infinity()) {
    if (!rate || !sink) return;
    interval_ = 1.0 / *rate;
    next_ = 0.0;
    for (const Mesh* mesh : meshes_)
        grids_.push_back(mesh_grid(*mesh));
}

void FieldRecorder::take(std::span<const State* const> states) {
    VtuGrid all = field_frame(grids_.front(), *meshes_.front(), *states.front());
    for (std::size_t k = 1; k < states.size(); ++k)
        all.append(field_frame(grids_[k], *meshes_[k], *states[k]));
    pending_.push_back(std::move(all));
    next_ = interval_ * (std::floor(states.front()->time / interval_ + 1e-9) + 1.0);
}

void FieldRecorder::accept() {
    for (const VtuGrid& frame : pending_)
        sink_(frame);
    pending_.clear();
}

}  // namespace twinchute::fullsim
