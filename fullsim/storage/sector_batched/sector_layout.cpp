// One sector of a symmetric parachute, the rows of its mesh in lanes; the others are the same, turned about
// the axis.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "fullsim/forces/canopy_pressure.hpp"
#include "fullsim/forces/inflow.hpp"
#include "fullsim/forces/node_loads.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/storage/layout.hpp"
#include "fullsim/storage/sector_batched/arrays.hpp"
#include "fullsim/time/critical_step.hpp"
#include "fullsim/time/node_mover.hpp"
#include "fullsim/time/subcycling.hpp"
#include "lib/scene/line_stretch.hpp"

namespace twinchute::fullsim {
namespace {

/// Up, and nothing across: what is left of a sum over all sectors.
Lanes up(double a) {
    return Lanes{0.0, 0.0, a, 0.0};
}

/// From the first sector to another.
struct Turn {
    Lanes cosine, sine;  ///< of the angle; 1 and 0 upwards
    explicit Turn(double angle)
        : cosine{std::cos(angle), std::cos(angle), 1.0, 0.0},
          sine{std::sin(angle), std::sin(angle), 0.0, 0.0} {}
};

/// A vector of a node of the first sector, and of its like in the others.
class Around {
public:
    Around(const Components& a, LocalNode n)
        : first_{a[0][n], a[1][n], a[2][n], 0.0}, quarter_{-a[1][n], a[0][n], 0.0, 0.0} {}
    Lanes at(const Turn& turn) const { return turn.cosine * first_ + turn.sine * quarter_; }

private:
    Lanes first_, quarter_;  // a quarter turn further
};

class SectorLayout final : public Layout {
public:
    static bool knows(Block block) { return row_of(block) != nullptr; }

    SectorLayout(const Scene& scene, const Mesh& mesh, const NodeConstants& constants, Sector sector,
                 const SectorKernels& kernels)
        : scene_(scene),
          mesh_(mesh),
          constants_(constants),
          kernels_(kernels),
          sector_(std::move(sector)),
          arrays_(sector_, mesh, constants, scene.full, kernels.lanes, kernels.unroll_factor),
          membranes_{membrane_law(mesh.fabric, scene.full.bulk_viscosity)},
          name_(sector_.gores == 1 ? fmt::format("one gore of {}, sector-batched", sector_.count)
                                   : fmt::format("{} gores of {}, sector-batched", sector_.gores,
                                                 sector_.gores * sector_.count)),
          smallest_area_(smallest_projected_area(scene.parachutes.front())),
          line_diameter_(mesh.cord(CableKind::line).diameter),
          axis_(mesh.axis.z() > 0.0 ? 1.0 : -1.0),
          cord_rows_(arrays_.cord_rows()) {
        for (int s = 0; s < sector_.count; ++s)
            turns_.emplace_back(s * sector_.turn);
        if (inflow_) find_edges();
    }

    std::string_view name() const override { return name_; }
    std::string_view instruction_set() const override { return kernels_.instruction_set; }
    ElementCount elements(const ForceModels&) const override {
        const auto tapes = std::ranges::count_if(sector_.cables, is_tape, &GoreCable::kind);
        return {sector_.triangles.size() + sector_.cables.size(),
                sector_.cables.size() - static_cast<std::size_t>(tapes)};
    }

    std::vector<PlanArray> arrays() const override { return arrays_.sizes(); }

    void begin(State& state, const ForceModels& structure, const ForceModels& loads, const Body*) override {
        clear_forces(state, static_cast<std::size_t>(mesh_.payload()));
        load(state);
        step_ = {};
        structure_.clear();
        loads_.clear();
        for (const ForceModels* models : {&structure, &loads})
            for (const auto& model : *models) {
                const Row* row = model->node_load() ? nullptr : row_of(model->block());
                (models == &structure ? structure_ : loads_).push_back({row, model.get()});
            }
        weights_.begin(state, constants_, structure, find_block(structure, Block::lines));
        weigh_rows();
    }

    int sectors() const override { return sector_.count; }

    void store(State& state) const override {
        const SectorFrame& f = arrays_.frame;
        for (LocalNode n = 0; n < sector_.own; ++n) {
            const Around x(f.x, n), v(f.v, n), v_half(f.v_half, n);
            const NodeIndex* node = sector_.node.data() + n;
            for (const Turn& turn : turns_) {
                state.node[*node] = {x.at(turn), v.at(turn)};
                state.v_half[*node].value = v_half.at(turn);
                node += sector_.own;
            }
        }
    }

    double membrane_energy(State&) const override { return fabric_levels().energy; }

    EnergiesAndStrains levels(const State& state) const override {
        const NodeIndex payload = mesh_.payload();
        const double v = state.node[payload].v[2];
        EnergiesAndStrains levels{
            0.5 * constants_.mass[payload] * v * v +
                sector_.count * kernels_.kinetic(arrays_.frame, arrays_.plan, state.added_mass),
            0.0,
            {}};
        for (const Acting& block : structure_) {
            const EnergyAndStrain of_row = (this->*block.row->levels)();
            levels.elastic += of_row.energy;
            levels.strain.push_back(of_row.strain);
        }
        return levels;
    }

    void evaluate(State& state, BlockClock& clock) override {
        node_loads_ = {};
        for (const Acting& block : structure_)
            clock.run([&] { (this->*block.row->add)(state); });
        state.force[mesh_.payload()].value = pull_ = pull_on_payload();
        note_riser_force(state, mesh_.payload());
        for (const Acting& block : loads_)
            clock.run([&] {
                if (!block.row) return block.model->node_load()->add_to(node_loads_, state);
                block.row->add ? (this->*block.row->add)(state) : block.model->add_forces(state);
            });
        damp_payload(state);
    }

    /// A pack has no sectors.
    double fabric_strain(const State&) const override { return 0.0; }

    CriticalSteps critical_steps(const State& state) override {
        if (weights_.renew(state)) weigh_rows();
        NodeLoads loads;
        for (const Acting& block : loads_)
            if (const NodeLoad* load = block.model->node_load()) load->add_to(loads, state);
        const double by_share = loads.damping_by_share(), by_mass = loads.mass_damping;
        const double payload_mass = constants_.mass[mesh_.payload()];
        const NodeRows& rows_of = arrays_.frame.node;
        const double payload = critical_step_of(
            sector_.count * rows_of.cord_stiffness[sector_.payload()],
            sector_.count * rows_of.cord_damping[sector_.payload()] + by_mass * payload_mass, payload_mass);
        const SectorBounds own =
            kernels_.critical_step(arrays_.frame, arrays_.plan, state.added_mass, by_share, by_mass);
        CriticalSteps steps{std::min(payload, own.all), own.canopy, std::numeric_limits<double>::infinity()};
        for (const SectorArrays::CordRow& row : cord_rows_) {
            const bool all = row.node == sector_.payload();
            const double count = all ? sector_.count : 1.0;
            const double mass = all ? payload_mass : rows_of.mass[row.node];
            const double inertia =
                all ? mass : rows_of.inertia[row.node] + rows_of.share[row.node] * state.added_mass;
            steps.lines = std::min(
                steps.lines,
                critical_step_of(count * row.stiffness, count * row.damping + by_mass * mass, inertia));
        }
        return steps;
    }

    void accelerate(const Vec3&) override {}  // one sector stands alone: scenes of several are refused
    void impulse(State& state) override {
        const NodeIndex payload = mesh_.payload();
        const double mass = constants_.mass[payload], all = sector_.count;
        NodeMover mover(state, constants_, dt_);
        const Subcycle first = subcycle_of(state, 0);
        StepSums& sums = step_sums_;
        const Lanes others = state.force[payload].value - pull_;
        state.force[payload].value = pull_;
        mover.kick_alone(payload, others, mass, mass, first.kick, sums);
        step_.kick = mover.kick();
        step_.dt = dt_;
        step_.first = first;
        step_.only = together();
        step_.weighs = state.energy.weighs;
        step_.last_dt = state.dt;
        step_.last_line_dt = state.line_dt;
        step_.gravity = constants_.gravity;
        step_.added_mass = state.added_mass;
        step_.on_fabric = node_loads_.on_fabric.z();
        step_.breathing = node_loads_.breathing;
        step_.canopy_mean = node_loads_.canopy_mean.z();
        step_.accretion = node_loads_.accretion;
        step_.mass_damping = node_loads_.mass_damping;
        step_.system_mean = node_loads_.system_mean.z();
        const SectorSums one = kernels_.advance(arrays_.frame, arrays_.plan, step_);
        sums.drag_power += up(all * one.drag_power);
        sums.momentum += up(all * one.momentum);
        sums.share_square = all * one.share_square;
        sums.kinetic += all * one.kinetic;
        state.damping_power += all * one.dissipated;
        state.accretion_power += all * one.accretion_power;
        add_positions(one, sums);
        if (together()) drift(state, 0);
    }
    void pull(State& state, int k) override {
        place_payload(state);
        const SectorSubcycle next{subcycle_of(state, k), k + 1 == subcycles_ ? 0.5 * dt_ : 0.0};
        const SectorSums further = kernels_.subcycle(arrays_.frame, arrays_.plan, next);
        add_positions(further, step_sums_);
        line_damping_ = sector_.count * further.dissipated;
        state.largest.add_tension(further.largest_tension);
        state.force[mesh_.payload()].value = pull_on_payload();
        state.in_subcycles.add(state.force[mesh_.payload()].value);
    }
    void drift(State& state, int k) override {
        const NodeIndex payload = mesh_.payload();
        const Subcycle step = subcycle_of(state, k);
        step_sums_.line_damping += step.kick * line_damping_;
        NodeMover(state, constants_, dt_).move_in_subcycle(payload, constants_.mass[payload], step);
    }
    void end_step(State& state, double next_added_mass) override {
        const NodeIndex payload = mesh_.payload();
        NodeMover mover(state, constants_, dt_);
        step_sums_.line_damping_power = line_damping_ / subcycles_;
        mover.end_subcycles(payload);
        mover.add_other(payload, constants_.mass[payload], step_sums_);
        place_payload(state);
        kernels_.refresh(arrays_.frame, arrays_.plan);
        finish_step(state, constants_, step_sums_, mover.kick(), dt_, dt_ / subcycles_, next_added_mass);
    }

    void serialize(Archive& archive, const State&) override {
        arrays_.serialize(archive);
        weights_.serialize(archive);
        if (archive.reads()) weigh_rows();
    }

private:
    void separate(State&) override {}  // the impulse does
    Subcycle subcycle_of(const State& state, int k) const {
        return together() ? Subcycle{0.5 * (dt_ + state.dt), dt_} : subcycle(state, dt_, subcycles_, k);
    }

    /// How a block of the registry acts on a sector. None other may act: see check_scene.
    struct Row {
        Block block;
        void (SectorLayout::*add)(State&);                          // null: by its own loop, on the payload
        EnergyAndStrain (SectorLayout::*levels)() const = nullptr;  // of structure
    };
    static const std::array<Row, 7> rows;
    static const Row* row_of(Block block) {
        const auto row = std::ranges::find(rows, block, &Row::block);
        return row == rows.end() ? nullptr : &*row;
    }
    struct Acting {
        const Row* row;  // none of a load on nodes
        const ForceModel* model;
    };

    void weigh_rows() {
        std::vector<double> weight;
        for (LocalNode n = 0; n < sector_.own; ++n)
            weight.push_back(weights_.by_node()[sector_.node[n]]);
        weight.push_back(weights_.by_node()[mesh_.payload()]);
        arrays_.weigh(sector_, weight);
    }

    void load(State& state) {
        // The axis is that of the sector: rounding may have left the payload beside it.
        NodeRecord& payload = state.node[mesh_.payload()];
        payload = {up(payload.x[2]), up(payload.v[2])};
        NodeVector& v_half = state.v_half[mesh_.payload()];
        v_half.value = up(v_half.value[2]);
        const SectorFrame& f = arrays_.frame;
        for (LocalNode n = 0; n < sector_.own; ++n)
            for (int c = sector_.on_axis[n] ? 2 : 0; c < 3; ++c) {
                const NodeIndex i = sector_.node[n];
                f.x[c][n] = state.node[i].x[c];
                f.v[c][n] = state.node[i].v[c];
                f.v_half[c][n] = state.v_half[i].value[c];
            }
        place_payload(state);
        kernels_.refresh(f, arrays_.plan);
    }

    void place_payload(const State& state) {
        const NodeRecord& payload = state.node[mesh_.payload()];
        arrays_.frame.x[2][sector_.payload()] = payload.x[2];
        arrays_.frame.v[2][sector_.payload()] = payload.v[2];
    }

    /// [N] of all cords.
    Lanes pull_on_payload() const {
        double pull = 0.0;
        for (const RemainderPull& p : arrays_.payload)
            pull += p.sign * arrays_.frame.element_force[2][p.from];
        return up(sector_.count * pull);
    }

    void add_positions(const SectorSums& one, StepSums& sums) const {
        const double all = sector_.count;
        sums.canopy_position += up(all * one.canopy_position);
        sums.canopy_velocity += up(all * one.canopy_velocity);
        sums.other_position += up(all * one.other_position);
        sums.other_velocity += up(all * one.other_velocity);
        sums.area_velocity += up(all * one.area_velocity);
    }

    /// Energies of all sectors.
    EnergyAndStrain of_all(EnergyAndStrain one) const { return {sector_.count * one.energy, one.strain}; }
    EnergyAndStrain fabric_levels() const {
        return of_all(kernels_.fabric_levels(arrays_.frame, arrays_.plan, membranes_));
    }
    EnergyAndStrain tape_levels() const {
        return of_all(kernels_.cable_levels(arrays_.frame, arrays_.plan.tapes, arrays_.frame.tape));
    }
    EnergyAndStrain line_levels() const {
        return of_all(kernels_.cable_levels(arrays_.frame, arrays_.plan.cords, arrays_.frame.cord));
    }

    /// Membranes, and the areas that pressure acts on with them.
    void add_membrane(State& state) {
        membranes_.direction = {0.0, 0.0, state.air.direction.z()};
        membranes_.radial_pressure = state.air.radial_pressure;
        fabric_ = kernels_.triangles[static_cast<int>(inflow_ ? AirOnFabric::fills : AirOnFabric::pushes)](
            arrays_.frame, arrays_.plan, membranes_);
        state.damping_power += sector_.count * fabric_.dissipated;
        state.largest.add_stress(fabric_.largest_load);
    }
    void add_tapes(State& state) {
        state.damping_power +=
            sector_.count * kernels_.cables(arrays_.frame, arrays_.plan.tapes, arrays_.frame.tape).dissipated;
    }
    /// Adds the forces of lines and risers. Their dissipation enters the energy balance with its subcycle.
    void add_cords(State& state) {
        const ElementSums cords = kernels_.cables(arrays_.frame, arrays_.plan.cords, arrays_.frame.cord);
        line_damping_ = sector_.count * cords.dissipated;
        state.largest.add_tension(cords.largest_load);
    }
    /// On the axis, which stays where it is, nothing is left of what they do.
    void add_contacts(State&) { kernels_.contacts(arrays_.frame, arrays_.plan, contact_pass()); }
    ContactPass contact_pass() const { return {{}, {0.0, 0.0, axis_}}; }
    EnergyAndStrain contact_levels() const {
        return of_all(kernels_.contact_levels(arrays_.frame, arrays_.plan, contact_pass()));
    }
    void add_pressure(State& state) {
        if (inflow_) {
            ElementSums all;
            all.positive_area = sector_.count * fabric_.positive_area;
            all.area[2] = sector_.count * fabric_.area[2];  // across, they cancel
            all.swept = sector_.count * fabric_.swept;
            const Openings open = inflow_->openings([this](std::size_t k) { return edge_node(k); });
            node_loads_.on_fabric += inflow_->set_pressure(state, all, open);
        } else {
            state.air.projected_area = sector_.count * fabric_.positive_area;
            state.air.signed_area = sector_.count * fabric_.signed_area;
            node_loads_.on_fabric += set_pressure(state.air, smallest_area_);
        }
        step_.pressure = state.air.pressure;
    }
    /// Where the nodes along openings are.
    void find_edges() {
        for (const NodeIndex i : inflow_->edges()) {
            const auto at = std::ranges::find(sector_.node, i) - sector_.node.begin();
            edge_nodes_.push_back({static_cast<int>(at % sector_.own), static_cast<int>(at / sector_.own)});
        }
    }
    NodeRecord edge_node(std::size_t k) const {
        const auto [n, sector] = edge_nodes_[k];
        const Turn& turn = turns_[static_cast<std::size_t>(sector)];
        return {Around(arrays_.frame.x, n).at(turn), Around(arrays_.frame.v, n).at(turn)};
    }
    void add_line_drag(State& state) {
        if (!(state.air.density > 0.0)) return;  // no Reynolds number without air
        kernels_.line_drag(arrays_.frame, arrays_.plan,
                           {&drag_coefficient_, line_diameter_, state.air.density, state.air.viscosity, {}});
    }
    void damp_payload(State& state) const {
        if (!(node_loads_.mass_damping > 0.0)) return;
        const NodeIndex payload = mesh_.payload();
        Lanes dissipated = splat(0.0);
        law::resist(node_loads_.mass_damping * constants_.mass[payload],
                    state.node[payload].v - up(node_loads_.system_mean.z()), state.force[payload].value,
                    dissipated);
        state.damping_power += sum3(dissipated);
    }

    const Scene& scene_;
    const Mesh& mesh_;
    const NodeConstants& constants_;
    const SectorKernels& kernels_;
    Sector sector_;
    SectorArrays arrays_;
    std::vector<Turn> turns_;  // to each sector
    MembranePass membranes_;
    std::string name_;
    double smallest_area_;  // [m^2] of the whole canopy
    double line_diameter_;  // [m]
    double axis_;           // 1 where the canopy is above the payload, else -1
    std::vector<SectorArrays::CordRow> cord_rows_;
    Lanes pull_ = splat(0.0);    // [N] of all cords on the payload at the time of the forces
    double line_damping_ = 0.0;  // [W] by all cords, likewise or in the last subcycle
    CylinderDragTable drag_coefficient_;
    std::vector<Acting> structure_, loads_;
    NodeLoads node_loads_;  // of the step
    PerronScaling weights_;
    ElementSums fabric_;  // of the sector
    std::optional<InflowBalance> inflow_ = InflowBalance::of(scene_, mesh_);
    std::vector<std::array<int, 2>> edge_nodes_;  // along openings: of the sector, sector
    SectorAdvance step_;
};

const std::array<SectorLayout::Row, 7> SectorLayout::rows{{
    {Block::membrane, &SectorLayout::add_membrane, &SectorLayout::fabric_levels},
    {Block::tapes, &SectorLayout::add_tapes, &SectorLayout::tape_levels},
    {Block::lines, &SectorLayout::add_cords, &SectorLayout::line_levels},
    {Block::gore_contact, &SectorLayout::add_contacts, &SectorLayout::contact_levels},
    {Block::canopy_pressure, &SectorLayout::add_pressure},
    {Block::line_drag, &SectorLayout::add_line_drag},
    {Block::payload_drag, nullptr},
}};

}  // namespace

std::unique_ptr<Layout> make_sector_layout(const Scene& scene, const Mesh& mesh,
                                           const NodeConstants& constants, std::string* why,
                                           const SectorKernels* kernels) {
    for (const ForceBlock& block : force_blocks())
        if (!SectorLayout::knows(block.block) && !stages_with(block, scene).empty() &&
            !block.make(scene, mesh)->node_load()) {
            if (why) *why = fmt::format("'{}' acts on all of it", block.name);
            return nullptr;
        }
    auto sector = find_sector(mesh, why);
    if (!sector) return nullptr;
    return std::make_unique<SectorLayout>(scene, mesh, constants, std::move(*sector),
                                          kernels ? *kernels : sector_kernels());
}

}  // namespace twinchute::fullsim
